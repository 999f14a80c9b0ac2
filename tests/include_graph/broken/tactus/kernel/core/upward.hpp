// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/signal/sound.hpp>
