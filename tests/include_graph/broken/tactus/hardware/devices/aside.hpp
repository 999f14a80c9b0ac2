// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/upward.hpp>
#include <tactus/simulation/arm_plants/plant.hpp>
