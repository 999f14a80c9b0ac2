#pragma once

#include <tactus/interfaces/cli/leak.hpp>
