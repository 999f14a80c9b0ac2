#pragma once

#include <tactus/data/recording/internal/tools.hpp>
