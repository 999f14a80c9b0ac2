// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/upward.hpp>
#include <tactus/kernel/signal/foreign.hpp>

#include <cmath>

#include <Eigen/Dense>
