// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/core/upward.hpp>

#include <chrono>
