#pragma once

#include <tactus/kernel/signal/sound.hpp>
