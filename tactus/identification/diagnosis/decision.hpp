// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/diagnosis/evidence.hpp>
#include <tactus/identification/diagnosis/oscillation.hpp>
#include <tactus/identification/diagnosis/signals.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::diagnosis {

/// Which loop makes an oscillation. What each must show is in docs/theory/diagnosis.md.
enum class Mechanism {
  induced_motion,  ///< the displayed force moves the master, the slave follows, its tip force comes back
  slave_servo,     ///< the slave's own loop: too stiff for its delay, filter or damping
  delay,           ///< two devices that are coupled by position, over a delay
  quantisation,    ///< to and fro between neighbouring counts
  stick_slip,      ///< friction that sticks and slips
  tremor,          ///< the hand's own
  virtual_wall,    ///< one device and a wall or spring that its controller makes of its position, too late for its
                   ///< stiffness
  unknown,         ///< these signals do not determine
};
constexpr auto enumerators(Mechanism) {
  return std::array{Enumerator{Mechanism::induced_motion, "induced-motion"},
                    Enumerator{Mechanism::slave_servo, "slave-servo"},
                    Enumerator{Mechanism::delay, "delay"},
                    Enumerator{Mechanism::quantisation, "quantisation"},
                    Enumerator{Mechanism::stick_slip, "stick-slip"},
                    Enumerator{Mechanism::tremor, "tremor"},
                    Enumerator{Mechanism::virtual_wall, "virtual-wall"},
                    Enumerator{Mechanism::unknown, "unknown"}};
}
std::string_view word_of(Mechanism mechanism);
/// `induced master motion`.
std::string_view words_of(Mechanism mechanism);
/// What would help, in one sentence.
std::string_view remedy_of(Mechanism mechanism);

struct Decision {
  Mechanism mechanism = Mechanism::unknown;
  double confidence = 0;              ///< 0 to 1: the weakest piece of its evidence, less what the runner-up has
  std::vector<std::string> evidence;  ///< sentences with numbers
  std::vector<Role> missing;          ///< signals that were not recorded and would show it
  std::vector<Mechanism> possible;    ///< where it is unknown: what is not refuted
  /// The hand moves the master on purpose and the slave follows it: no fault.
  bool led = false;
  /// No oscillation to report: what a hand does on purpose, or a tremor as everybody has.
  bool harmless = false;
};

/// Weighs the evidence. A mechanism is as likely as the weakest thing that it must show; what was not recorded neither
/// speaks for it nor refutes it. The most likely one is named where it leads clearly, else none is.
Decision decide(const Signals& signals, const Oscillation& oscillation, const Evidence& evidence);

}  // namespace tactus::diagnosis
