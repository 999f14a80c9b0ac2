#pragma once

#include <tactus/data/stray/thing.hpp>
