#include <tactus/signal/sound.hpp>

#include <chrono>

#include <matio.h>
