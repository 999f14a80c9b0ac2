#pragma once

#include <tactus/core/parameters.hpp>

#include <array>
#include <cstdint>

namespace tactus::emulation {

/// What may be wrong with an emulated servo.
enum class ServoFault : std::int64_t {
  none,
  silent,       ///< it hears and does not answer
  power_cycle,  ///< it is off for 0.3 s, and begins anew
  hot,          ///< it tells so, and takes its own torque away
  wrong_model,  ///< it is another one than its owner believes
  low_limit     ///< it was set to a tenth of its current
};
constexpr auto enumerators(ServoFault) {
  return std::array{Enumerator{ServoFault::none, "none"},
                    Enumerator{ServoFault::silent, "silent"},
                    Enumerator{ServoFault::power_cycle, "power-cycle"},
                    Enumerator{ServoFault::hot, "hot"},
                    Enumerator{ServoFault::wrong_model, "wrong-model"},
                    Enumerator{ServoFault::low_limit, "low-limit"}};
}

/// What may be wrong with the line of emulated servos. Shares are those of all answers, drawn from a seed.
struct LineFaults {
  double corrupt = 0.0;   ///< a bit of the answer is wrong
  double garbage = 0.0;   ///< bytes that nobody sent stand before it
  double split = 0.0;     ///< it comes in two pieces, 0.3 ms apart
  std::int64_t echo = 0;  ///< 1: what is sent comes back, as some adapters do
};

}  // namespace tactus::emulation
