#include <tactus/recording/internal/tools.hpp>
#include <tactus/signal/sound.hpp>

#include <chrono>

#include <matio.h>
