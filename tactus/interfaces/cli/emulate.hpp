#pragma once

#include <tactus/hardware/emulation/inverse3/inverse3_server.hpp>
#include <tactus/hardware/wire/wire_end.hpp>
#include <tactus/interfaces/cli/emulate_live.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
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
  LiveMotors live;                      ///< of these motors
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
    "Read faults from standard input while it runs, one a line, with times from then on, and print a line whenever the "
    "power of a motor changes, as 'power 2 off 1234.567': its number and the time of CLOCK_MONOTONIC in s";
inline constexpr const char* models_help = "Model of each, separated by commas; the last one applies to the rest";

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
