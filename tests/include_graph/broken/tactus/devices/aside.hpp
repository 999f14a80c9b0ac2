#pragma once

#include <tactus/core/upward.hpp>
#include <tactus/simulation/plant.hpp>
