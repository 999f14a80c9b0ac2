// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/urdf/urdf.hpp>
#include <tactus/hardware/emulation/damiao/damiao_peer.hpp>
#include <tactus/hardware/wire/paced.hpp>
#include <tactus/interfaces/cli/emulate.hpp>
#include <tactus/interfaces/cli/internal/touch_options.hpp>
#include <tactus/interfaces/cli/real_between.hpp>
#include <tactus/simulation/real_time/emulated_arm.hpp>

#include <algorithm>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

using emulation::damiao::AdapterType;
using emulation::damiao::DamiaoPeer;
using emulation::damiao::MotorType;

constexpr std::int64_t bits_per_s = 921'600;

struct DamiaoOptions {
  std::optional<std::uint32_t> motors;
  std::vector<std::string> models{name_of(MotorType::dm4310)};
  std::string framing = name_of(AdapterType::usb2can);
  std::vector<std::string> faults;
  std::uint64_t seed = 1;
  std::string arm, tip;
  TouchOptions touch;
  double tool_m = 0.0;
  std::vector<double> armature_kg_m2{0.01};
  std::vector<double> held_rad;
  std::vector<double> led;
};

Error wrong(const char* option, std::string message) {
  return {.code = ErrorCode::inconsistent, .parameter = {}, .message = std::move(message), .place = option};
}

/// The arm that its motors move; null where each moves a joint of its own.
Result<std::unique_ptr<real_time::EmulatedArm>> make_arm(const DamiaoOptions& options) {
  if (options.arm.empty()) return std::unique_ptr<real_time::EmulatedArm>();
  auto read = urdf::read(options.arm, options.tip);
  if (!read) return read.error();
  real_time::EmulatedArm::Settings settings{.chain = std::move(read->params)};
  const std::size_t joints = settings.chain.joints.size();
  if (options.armature_kg_m2.size() > joints) {
    return wrong("--armature", std::to_string(options.armature_kg_m2.size()) + " numbers for an arm of " +
                                   std::to_string(joints) + " joints: one for each, or fewer");
  }
  for (std::size_t i = 0; i < joints; ++i) {
    settings.chain.joints[i].drive.armature_kg_m2 =
        options.armature_kg_m2[std::min(i, options.armature_kg_m2.size() - 1)];
  }
  if (!options.held_rad.empty()) {
    if (options.held_rad.size() != joints) {
      return wrong("--held", std::to_string(options.held_rad.size()) + " positions for an arm of " +
                                 std::to_string(joints) + " joints: write one for each");
    }
    settings.held_at = arm::JointVector::Map(options.held_rad.data(), static_cast<Eigen::Index>(joints));
  }
  constexpr double farthest_rad = 3.0;
  if (!options.led.empty() && options.led[0] > farthest_rad) {
    return wrong("--led", rounded_number(options.led[0]) + " rad is more than an arm can be led, " +
                              rounded_number(farthest_rad) + " rad: name less");
  }
  if (!options.led.empty()) settings.led = {.reach_rad = options.led[0], .after_s = options.led[1]};
  if (Check wrong = options.touch.check()) return *std::move(wrong);
  settings.tool_m = options.tool_m * arm::Vector3::UnitZ();
  settings.surface = options.touch.surface();
  settings.tapping = options.touch.tapping();
  return real_time::EmulatedArm::make(settings);
}

/// Of the motors from 1 to `motors`.
Result<emulation::damiao::Fault> read_fault(const std::string& word, std::size_t motors) {
  auto fault = emulation::damiao::parse_fault(word);
  if (fault && fault->motor > motors) {
    return Error{ErrorCode::out_of_bounds, {}, "'" + word + "': the motors go from 1 to " + std::to_string(motors), {}};
  }
  return fault;
}

LiveMotors live_motors(DamiaoPeer& peer, std::size_t motors) {
  return {.inject = [&peer, motors](const std::string& word, std::int64_t now_ns) -> Check {
            const auto fault = read_fault(word, motors);
            if (!fault) return fault.error();
            return peer.inject(*fault, now_ns);
          },
          .powered =
              [&peer, motors](std::int64_t now_ns) {
                peer.advance(now_ns);
                std::uint32_t powered = 0;
                for (std::size_t i = 0; i < motors; ++i) {
                  if (peer.motor(i).enabled()) powered |= 1U << i;
                }
                return powered;
              }};
}

Result<EmulatedPeer> make_peer(const DamiaoOptions& options) {
  emulation::damiao::PeerSettings settings;
  settings.adapter = value_of<AdapterType>(options.framing);
  settings.seed = options.seed;
  auto arm = make_arm(options);
  if (!arm) return arm.error();
  constexpr std::uint32_t usual_motors = 2;
  const auto joints = *arm ? static_cast<std::uint32_t>((*arm)->motors()) : usual_motors;
  for (std::uint32_t id = 1; id <= options.motors.value_or(joints); ++id) {
    settings.motors.push_back(
        {.id = id, .feedback_id = id + 0x10, .type = value_of<MotorType>(of_motor(options.models, id))});
  }
  for (const std::string& word : options.faults) {
    auto fault = read_fault(word, settings.motors.size());
    if (!fault) {
      Error error = fault.error();
      error.place = "--fault";
      return error;
    }
    settings.faults.push_back(*fault);
  }
  auto peer = DamiaoPeer::make(settings, *std::move(arm));
  if (!peer) return wrong("--motors", peer.error().message);
  const LiveMotors live = live_motors(**peer, settings.motors.size());
  EmulatedPeer made{.motors = *std::move(peer), .line = nullptr, .only_at_bits_per_s = 0, .live = live};
  made.line = std::make_unique<wire::Paced>(*made.motors, wire::byte_ns(bits_per_s), wire::Paced::Line::full_duplex);
  return made;
}

}  // namespace

std::function<Result<EmulatedPeer>()> add_damiao_options(CLI::App& verb) {
  auto options = std::make_shared<DamiaoOptions>();
  verb.add_option("--motors", options->motors,
                  "Number of motors, with identifiers from 1; by default 2, or one for each joint of --arm")
      ->check(CLI::Range(1, 15));
  verb.add_option("--model", options->models, models_help)->delimiter(',')->check(CLI::IsMember(words_of<MotorType>()));
  // A terminal passes no frames of Linux.
  verb.add_option("--framing", options->framing, "Adapter: usb2can is Damiao's own protocol, slcan is text")
      ->check(
          CLI::IsMember({name_of(AdapterType::usb2can), name_of(AdapterType::slcan), name_of(AdapterType::slcan_fd)}));
  verb.add_option(
          "--fault", options->faults,
          "Fault to inject, as KIND[:MOTOR][@SECONDS][+SECONDS]: at which motor, from when and how long; may be "
          "repeated. Kinds: silence, wrong-scale, over-voltage, under-voltage, over-current, hot-drive, "
          "hot-winding, communication-lost, overload, status=0x7 (one that it does not have), ignores-disable, "
          "register-answer, twin, wrap, power-cycle, garbage, heartbeat, bus-off, split")
      ->type_name("FAULT");
  verb.add_option("--seed", options->seed, "Seed of delays and garbage");
  CLI::Option* arm =
      verb.add_option("--arm", options->arm,
                      "Emulate an arm with its weight: the first motors move its joints, and each further motor turns "
                      "a joint of its own. The arm hangs, and without power it falls")
          ->type_name("URDF");
  verb.add_option("--tip", options->tip, "Link at which that arm ends, if the URDF continues or branches")
      ->type_name("LINK")
      ->needs(arm);
  verb.add_option(
          "--armature", options->armature_kg_m2,
          "Inertia of each motor's rotor at its joint, in kg m², separated by commas; the last one applies to the rest")
      ->delimiter(',')
      ->check(real_between(1e-6, 10.0))
      ->needs(arm);
  verb.add_option(
          "--held", options->held_rad,
          "Joint positions in rad at which a hand holds the arm until gravity compensation is on, separated by commas")
      ->type_name("Q,Q,...")
      ->delimiter(',')
      ->check(real_between(-12.0, 12.0))
      ->needs(arm);
  const TouchOptionsOf touch =
      add_touch_options(verb, options->touch, "Horizontal surface for the arm's tool, GAP metres below it",
                        "Afterwards a hand taps: it moves the tool down by DEPTH, in m, and up again, once every "
                        "PERIOD s, starting SECONDS after the release");
  touch.wall->needs(arm);
  touch.tapped->needs(arm);
  verb.add_option("--tool", options->tool_m,
                  "Distance of the tool's point along z of the last link, in m; 0 by default")
      ->type_name("Z")
      ->check(real_between(-1.0, 1.0))
      ->needs(arm);
  verb.add_option(
          "--led", options->led,
          "Afterwards a hand moves each joint back and forth by REACH, in rad, starting SECONDS after the release")
      ->type_name("REACH,SECONDS")
      ->delimiter(',')
      ->expected(2)
      ->check(real_between(0.0, 1000.0))
      ->needs(arm);
  return [options] { return make_peer(*options); };
}

}  // namespace tactus::cli
