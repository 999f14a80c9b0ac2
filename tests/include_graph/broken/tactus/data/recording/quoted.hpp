#pragma once

#include "quoted.hpp"
