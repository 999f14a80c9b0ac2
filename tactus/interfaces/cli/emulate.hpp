// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/hardware/emulation/inverse3/inverse3_server.hpp>
#include <tactus/hardware/emulation/servo_faults.hpp>
#include <tactus/hardware/wire/wire_end.hpp>
#include <tactus/interfaces/cli/emulate_live.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace CLI {  // NOLINT: the name is not ours
class App;
}

namespace tactus::cli {

/// Emulated motors, and the serial line around them that is to be driven.
struct EmulatedPeer {
  std::unique_ptr<wire::WireEnd> motors;
  std::unique_ptr<wire::WireEnd> line;
  std::int64_t only_at_bits_per_s = 0;  ///< it receives nothing while the line is set to another rate; 0: at each
  LiveMotors live = {};                 ///< of these motors
};

/// What `tactus emulate` can be: a word of its command line, and its options.
struct EmulatedKind {
  const char* name;
  const char* summary;
  /// Adds the options to the command; the returned function makes the peer when they are read.
  std::function<Result<EmulatedPeer>()> (*add_options)(CLI::App& verb);
};

std::function<Result<EmulatedPeer>()> add_damiao_options(CLI::App& verb);
std::function<Result<EmulatedPeer>()> add_dynamixel_options(CLI::App& verb);
std::function<Result<EmulatedPeer>()> add_feetech_options(CLI::App& verb);
/// A server, not a line: it has no path but an address.
std::function<Result<emulation::inverse3::Inverse3Server>()> add_inverse3_options(CLI::App& verb);

/// Of a list of models, in which the last one continues, that of the motor with this identifier, from 1.
inline const std::string& of_motor(const std::vector<std::string>& models, std::int64_t id) {
  return models[std::min(static_cast<std::size_t>(id), models.size()) - 1];
}
inline constexpr const char* live_help =
    "Read faults from standard input while the command runs, one per line, with times that count from then on; and "
    "print a line when the power of a motor changes, such as 'power 2 off 1234.567', with its number and the time of "
    "CLOCK_MONOTONIC in s";
inline constexpr const char* models_help = "Model of each, separated by commas; the last one applies to the rest";

/// Models of Dynamixel servos that are emulated, with the number that each reports.
inline constexpr std::array<std::pair<const char*, std::int64_t>, 6> dynamixel_models{{{"xl330-m077", 1190},
                                                                                       {"xl330-m288", 1200},
                                                                                       {"xc330-m288", 1240},
                                                                                       {"xc330-t288", 1220},
                                                                                       {"xm430-w210", 1030},
                                                                                       {"xm430-w350", 1020}}};

/// Adds these faults, as a user writes them, to emulated servos and their line. Errors: those of `parse_servo_fault`;
/// `out_of_bounds` for a servo that is not there.
template <class Params>
Check add_servo_faults(Params& params, const std::vector<std::string>& words) {
  const auto by_id = [](const auto& one, const auto& other) { return one.id < other.id; };
  const auto [first, last] = std::ranges::minmax_element(params.servos, by_id);
  for (const std::string& word : words) {
    auto fault = emulation::parse_servo_fault(word);
    const auto named = [&fault](const auto& servo) { return fault->id < 0 || servo.id == fault->id; };
    if (fault && !std::ranges::any_of(params.servos, named)) {
      fault = Error{ErrorCode::out_of_bounds,
                    {},
                    "'" + word + "': the ids go from " + std::to_string(first->id) + " to " + std::to_string(last->id),
                    {}};
    }
    if (!fault) {
      Error error = fault.error();
      error.place = "--fault";
      return error;
    }
    params.line.corrupt = std::max(params.line.corrupt, fault->line.corrupt);
    params.line.garbage = std::max(params.line.garbage, fault->line.garbage);
    params.line.split = std::max(params.line.split, fault->line.split);
    params.line.echo = std::max(params.line.echo, fault->line.echo);
    if (fault->servo == emulation::ServoFault::none) continue;
    for (auto& servo : params.servos) {
      if (!named(servo)) continue;
      servo.fault = fault->servo;
      servo.fault_from_ns = fault->from_ns;
      servo.error = fault->error;
    }
  }
  return std::nullopt;
}

/// The words of an enum, for an option that takes one.
template <NamedEnum E>
std::vector<std::string> words_of() {
  std::vector<std::string> words;
  for (const auto& entry : enumerators(E{})) words.emplace_back(entry.name);
  return words;
}
/// The value that one of these words stands for.
template <NamedEnum E>
E value_of(const std::string& word) {
  for (const auto& entry : enumerators(E{})) {
    if (entry.name == word) return entry.value;
  }
  return E{};
}

}  // namespace tactus::cli
