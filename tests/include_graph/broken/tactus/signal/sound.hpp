#pragma once

#include <tactus/core/upward.hpp>
#include <tactus/signal/foreign.hpp>

#include <cmath>

#include <Eigen/Dense>
