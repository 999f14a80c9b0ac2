#include <tactus/kernel/core/upward.hpp>

#include <chrono>
