// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/internal/tools.hpp>
#include <tactus/kernel/signal/sound.hpp>

#include <chrono>

#include <matio.h>
