#include <tactus/cli/emulate.hpp>
#include <tactus/emulation/damiao/damiao_peer.hpp>
#include <tactus/wire/paced.hpp>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

using emulation::damiao::AdapterType;
using emulation::damiao::DamiaoPeer;
using emulation::damiao::MotorType;

constexpr std::int64_t bits_per_s = 921'600;

struct DamiaoOptions {
  std::uint32_t motors = 2;
  std::vector<std::string> models{name_of(MotorType::dm4310)};
  std::string framing = name_of(AdapterType::usb2can);
  std::vector<std::string> faults;
  std::uint64_t seed = 1;
};

Result<EmulatedPeer> make_peer(const DamiaoOptions& options) {
  emulation::damiao::PeerSettings settings;
  settings.adapter = value_of<AdapterType>(options.framing);
  settings.seed = options.seed;
  for (std::uint32_t id = 1; id <= options.motors; ++id) {
    settings.motors.push_back(
        {.id = id, .feedback_id = id + 0x10, .type = value_of<MotorType>(of_motor(options.models, id))});
  }
  for (const std::string& word : options.faults) {
    const auto fault = emulation::damiao::parse_fault(word);
    if (!fault) {
      Error error = fault.error();
      error.place = "--fault";
      return error;
    }
    settings.faults.push_back(*fault);
  }
  auto peer = DamiaoPeer::make(settings);
  if (!peer) return peer.error();
  EmulatedPeer made{.motors = *std::move(peer), .line = nullptr};
  made.line = std::make_unique<wire::Paced>(*made.motors, wire::byte_ns(bits_per_s), wire::Paced::Line::full_duplex);
  return made;
}

}  // namespace

std::function<Result<EmulatedPeer>()> add_damiao_options(CLI::App& verb) {
  auto options = std::make_shared<DamiaoOptions>();
  verb.add_option("--motors", options->motors, "How many, with the ids 1 and on")->check(CLI::Range(1, 15));
  verb.add_option("--model", options->models, models_help)->delimiter(',')->check(CLI::IsMember(words_of<MotorType>()));
  // A terminal passes no frames of Linux.
  verb.add_option("--framing", options->framing, "Adapter: usb2can is Damiao's own, slcan is text")
      ->check(
          CLI::IsMember({name_of(AdapterType::usb2can), name_of(AdapterType::slcan), name_of(AdapterType::slcan_fd)}));
  verb.add_option(
          "--fault", options->faults,
          "What goes wrong, as KIND[:MOTOR][@SECONDS][+SECONDS]: of which motor, from when and how long; may be "
          "given again. Kinds: silence, wrong-scale, over-voltage, under-voltage, over-current, hot-drive, "
          "hot-winding, communication-lost, overload, register-answer, twin, wrap, garbage, heartbeat, bus-off, split")
      ->type_name("FAULT");
  verb.add_option("--seed", options->seed, "Of delays and garbage");
  return [options] { return make_peer(*options); };
}

}  // namespace tactus::cli
