#include <tactus/core/upward.hpp>

#include <chrono>
