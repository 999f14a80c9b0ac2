#pragma once

#include <tactus/signal/sound.hpp>
