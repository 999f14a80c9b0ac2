#pragma once

#include <tactus/kernel/core/upward.hpp>
