// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/wire/port.hpp>
#include <tactus/hardware/wire/talk.hpp>
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/emulate.hpp>
#include <tactus/interfaces/cli/interruption.hpp>
#include <tactus/interfaces/cli/standard_output.hpp>

#include <algorithm>
#include <array>
#include <chrono>
#include <iostream>
#include <span>
#include <thread>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

/// A kind of motors is a line here.
constexpr std::array emulated_kinds{
    EmulatedKind{"damiao", "Emulate Damiao DM motors behind a serial CAN adapter", &add_damiao_options},
    EmulatedKind{"dynamixel", "Emulate Dynamixel X servos on a serial line", &add_dynamixel_options},
    EmulatedKind{"feetech", "Emulate Feetech STS3215 or HLS3625 servos on a serial line", &add_feetech_options},
};

/// Hears nothing while whoever opened the terminal has set it to another bit rate, as motors behind a line do.
class OnlyAtItsRate final : public wire::WireEnd {
 public:
  OnlyAtItsRate(wire::WireEnd& end, const wire::Port& port, std::int64_t bits_per_s)
      : end_(&end), port_(&port), bits_per_s_(bits_per_s) {}
  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept override {
    if (port_->bits_per_s() == bits_per_s_) end_->hear(bytes, now_ns);
  }
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept override { return end_->say(now_ns); }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override { return end_->wakes_ns(); }

 private:
  wire::WireEnd* end_;
  const wire::Port* port_;
  std::int64_t bits_per_s_;
};

/// Lets the console look whenever the line has been spoken to or nothing is left to say. It wakes once a millisecond at
/// most and not for each byte, so that many can run at once: the motors live at their exact times all the same, but
/// their answers may come so much later.
class Live final : public wire::WireEnd {
 public:
  Live(wire::WireEnd& end, LiveConsole& console) : end_(&end), console_(&console) {}
  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept override { end_->hear(bytes, now_ns); }
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept override {
    const auto said = end_->say(now_ns);
    if (!said.empty()) return said;
    console_->look(now_ns);
    spoke_ns_ = now_ns;
    return said;
  }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override {
    constexpr std::int64_t shortest_ns = 1'000'000;
    return std::max(end_->wakes_ns(), spoke_ns_ + shortest_ns);
  }

 private:
  wire::WireEnd* end_;
  LiveConsole* console_;
  std::int64_t spoke_ns_ = 0;
};

Check emulate(const std::function<Result<EmulatedPeer>()>& make, bool live) {
  const auto peer = make();
  if (!peer) return peer.error();
  runtime::EndRequest end;
  const auto interruption = Interruption::start(end);
  if (!interruption) return interruption.error();
  auto port = wire::Port::pseudo_terminal();
  if (!port) return port.error();
  std::cout << port->path() << "\n";
  if (Check error = flush_standard_output()) return error;
  OnlyAtItsRate deaf(*peer->line, *port, peer->only_at_bits_per_s);
  wire::WireEnd& line = peer->only_at_bits_per_s > 0 ? static_cast<wire::WireEnd&>(deaf) : *peer->line;
  LiveConsole console(peer->live);
  Live steered(line, console);
  return wire::talk(live ? static_cast<wire::WireEnd&>(steered) : line, *port, [&end] { return end.asked(); });
}

/// All devices, as one motor each.
LiveMotors live_devices(emulation::inverse3::Inverse3Server& server) {
  using emulation::inverse3::Inverse3Service;
  return {.inject = [&server](const std::string& word, std::int64_t) -> Check {
            auto fault = emulation::inverse3::parse_fault(word);
            if (!fault) return fault.error();
            server.with_service(
                [&fault](Inverse3Service& service, std::int64_t now_ns) { service.inject(*std::move(fault), now_ns); });
            return std::nullopt;
          },
          .powered =
              [&server](std::int64_t) {
                std::uint32_t powered = 0;
                server.with_service([&powered](Inverse3Service& service, std::int64_t now_ns) {
                  for (std::size_t i = 0; i < service.devices(); ++i) {
                    if (service.gives_force(i, now_ns)) powered |= 1U << i;
                  }
                });
                return powered;
              }};
}

Check serve_inverse3(const std::function<Result<emulation::inverse3::Inverse3Server>()>& start, bool live) {
  runtime::EndRequest end;
  const auto interruption = Interruption::start(end);
  if (!interruption) return interruption.error();
  auto server = start();
  if (!server) return server.error();
  std::cout << server.value().url() << "\n";
  if (Check error = flush_standard_output()) return error;
  LiveConsole console(live_devices(*server));
  while (!end.asked()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(live ? 5 : 20));
    if (live) console.look(wire::monotonic_ns());
  }
  return std::nullopt;
}

}  // namespace

void add_emulate(CLI::App& app, int& status) {
  CLI::App* verb = app.add_subcommand("emulate", "Emulate motors or a haptic handle on a pseudo-terminal or port");
  verb->require_subcommand(1);
  const auto run = [&app, &status](CLI::App& chosen, const auto& emulated) {
    chosen.callback([emulated, &app, &status] {
      if (const Check error = emulated()) {
        std::cerr << app.get_name() << ": " << describe(*error) << "\n";
        status = exit_status(*error);
      }
    });
  };
  for (const EmulatedKind& kind : emulated_kinds) {
    CLI::App* chosen = verb->add_subcommand(kind.name, kind.summary);
    const auto live = std::make_shared<bool>(false);
    const auto make = kind.add_options(*chosen);
    chosen->add_flag("--live", *live, live_help);
    run(*chosen, [make, live] { return emulate(make, *live); });
  }
  CLI::App* chosen = verb->add_subcommand(
      "inverse3", "Emulate Haply's Inverse Service with an Inverse3, at a port whose address it prints");
  const auto live = std::make_shared<bool>(false);
  const auto start = add_inverse3_options(*chosen);
  chosen->add_flag("--live", *live,
                   std::string(live_help) +
                       ". Faults: mode=WORD (empty: none), calibrated=0, "
                       "power_supply=0, ready=0 (as reported), keeps-force; each as KIND[=VALUE][@SECONDS]");
  run(*chosen, [start, live] { return serve_inverse3(start, *live); });
}

}  // namespace tactus::cli
