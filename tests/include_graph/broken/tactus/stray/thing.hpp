#pragma once

#include <tactus/core/upward.hpp>
