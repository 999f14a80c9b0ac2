#pragma once

#include <tactus/cli/leak.hpp>
