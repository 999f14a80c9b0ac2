// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/emulation/dynamixel/dynamixel_peer.hpp>
#include <tactus/hardware/emulation/feetech/feetech_peer.hpp>
#include <tactus/hardware/wire/paced.hpp>
#include <tactus/interfaces/cli/emulate.hpp>

#include <algorithm>
#include <utility>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

using emulation::dynamixel::DynamixelPeer;
using emulation::feetech::FeetechPeer;

struct ServoOptions {
  std::int64_t servos = 2;
  std::vector<std::string> models;
  std::int64_t bits_per_s = 1'000'000;
  std::vector<std::string> faults;
  bool old_firmware = false;
  bool deaf_otherwise = false;
  std::int64_t seed = 1;
};

/// Of the servos from 1 to `servos`.
Result<emulation::WrittenFault> read_servo_fault(const std::string& word, std::int64_t servos) {
  auto fault = emulation::parse_servo_fault(word);
  if (fault && fault->id > servos) {
    return Error{ErrorCode::out_of_bounds, {}, "'" + word + "': the ids go from 1 to " + std::to_string(servos), {}};
  }
  return fault;
}

template <class Peer>
LiveMotors live_servos(Peer& peer) {
  return {.inject = [&peer](const std::string& word, std::int64_t now_ns) -> Check {
            const auto fault = read_servo_fault(word, static_cast<std::int64_t>(peer.servos()));
            if (!fault) return fault.error();
            return peer.inject(*fault, now_ns);
          },
          .powered =
              [&peer](std::int64_t now_ns) {
                peer.advance(now_ns);
                std::uint32_t powered = 0;
                for (std::size_t i = 0; i < peer.servos(); ++i) {
                  if (peer.has_power(i)) powered |= 1U << i;
                }
                return powered;
              }};
}

/// Servos 1 and on behind a line of that pace, with the faults that were asked for.
template <class Peer, class Model>
Result<EmulatedPeer> make_servos(const ServoOptions& options, typename Peer::Params params, const Model& set_model) {
  params.servos.clear();
  for (std::int64_t id = 1; id <= options.servos; ++id) {
    typename Peer::Servo servo{.id = id};
    set_model(servo, of_motor(options.models, id));
    params.servos.push_back(servo);
  }
  params.bits_per_s = options.bits_per_s;
  params.seed = options.seed;
  if (Check wrong = add_servo_faults(params, options.faults)) return *std::move(wrong);
  auto peer = Peer::make(params);
  if (!peer) return peer.error();
  auto motors = std::make_unique<Peer>(*std::move(peer));
  const LiveMotors live = live_servos(*motors);
  EmulatedPeer made{.motors = std::move(motors), .line = nullptr, .only_at_bits_per_s = 0, .live = live};
  if (options.deaf_otherwise) made.only_at_bits_per_s = options.bits_per_s;
  made.line =
      std::make_unique<wire::Paced>(*made.motors, wire::byte_ns(options.bits_per_s), wire::Paced::Line::half_duplex);
  return made;
}

std::shared_ptr<ServoOptions> add_servo_options(CLI::App& verb, const std::string& model,
                                                const std::vector<std::string>& models, std::int64_t most_bits_per_s) {
  auto options = std::make_shared<ServoOptions>();
  options->models = {model};
  verb.add_option("--motors", options->servos, "Number of servos, with identifiers from 1")->check(CLI::Range(1, 16));
  verb.add_option("--model", options->models, models_help)->delimiter(',')->check(CLI::IsMember(models));
  verb.add_option("--bits-per-s", options->bits_per_s, "Bit rate of the line")
      ->check(CLI::Range(std::int64_t{9600}, most_bits_per_s));
  verb.add_option(
          "--fault", options->faults,
          "Fault to inject, as KIND[:ID][@SECONDS]: at which servo, and from when; may be repeated. Kinds of "
          "a servo: silence, power-cycle, hot, wrong-model, low-limit, twin, clash, error=0x24 (an error byte), "
          "ignores-disable; of the line, without id and time: "
          "corrupt, garbage, split, echo")
      ->type_name("FAULT");
  verb.add_option("--seed", options->seed, "Seed of the faults on the line");
  verb.add_flag("--deaf-otherwise", options->deaf_otherwise, "Receive nothing while the line has another bit rate");
  return options;
}

}  // namespace

std::function<Result<EmulatedPeer>()> add_dynamixel_options(CLI::App& verb) {
  std::vector<std::string> models;
  for (const auto& [name, number] : dynamixel_models) models.emplace_back(name);
  const auto options = add_servo_options(verb, "xl330-m288", models, 4'000'000);
  verb.add_flag("--old-firmware", options->old_firmware, "Do not support fast sync read");
  return [options] {
    DynamixelPeer::Params params;
    params.knows_fast_sync_read = !options->old_firmware;
    return make_servos<DynamixelPeer>(*options, params, [](auto& servo, const std::string& model) {
      const auto same = [&model](const auto& each) { return each.first == model; };
      servo.model_number = std::ranges::find_if(dynamixel_models, same)->second;
    });
  };
}

std::function<Result<EmulatedPeer>()> add_feetech_options(CLI::App& verb) {
  using emulation::feetech::Make;
  const auto options = add_servo_options(verb, name_of(Make::sts3215), words_of<Make>(), 1'000'000);
  return [options] {
    return make_servos<FeetechPeer>(*options, {},
                                    [](auto& servo, const std::string& model) { servo.make = value_of<Make>(model); });
  };
}

}  // namespace tactus::cli
