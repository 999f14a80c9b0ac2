#include <tactus/recording/internal/tools.hpp>
