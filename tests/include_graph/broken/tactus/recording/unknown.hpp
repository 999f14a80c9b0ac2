#pragma once

#include <tactus/stray/thing.hpp>
