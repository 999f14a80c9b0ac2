#pragma once

#include <tactus/recording/internal/tools.hpp>
