// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Whether this is built with a sanitizer, 0 or 1: GCC and clang say it each in a way of its own.
#if defined(__has_feature)
#define TACTUS_HAS_FEATURE(name) __has_feature(name)
#else
#define TACTUS_HAS_FEATURE(name) 0
#endif
#if defined(__SANITIZE_ADDRESS__) || TACTUS_HAS_FEATURE(address_sanitizer)
#define TACTUS_UNDER_ADDRESS_SANITIZER 1
#else
#define TACTUS_UNDER_ADDRESS_SANITIZER 0
#endif
#if defined(__SANITIZE_THREAD__) || TACTUS_HAS_FEATURE(thread_sanitizer)
#define TACTUS_UNDER_THREAD_SANITIZER 1
#else
#define TACTUS_UNDER_THREAD_SANITIZER 0
#endif
