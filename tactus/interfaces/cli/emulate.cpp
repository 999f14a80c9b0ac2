#include <tactus/hardware/wire/port.hpp>
#include <tactus/hardware/wire/talk.hpp>
#include <tactus/interfaces/cli/commands.hpp>
#include <tactus/interfaces/cli/emulate.hpp>
#include <tactus/interfaces/cli/interruption.hpp>
#include <tactus/interfaces/cli/standard_output.hpp>

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

Check emulate(const std::function<Result<EmulatedPeer>()>& make) {
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
  return wire::talk(line, *port, [&end] { return end.asked(); });
}

Check serve_inverse3(const std::function<Result<emulation::inverse3::Inverse3Server>()>& start) {
  runtime::EndRequest end;
  const auto interruption = Interruption::start(end);
  if (!interruption) return interruption.error();
  const auto server = start();
  if (!server) return server.error();
  std::cout << server.value().url() << "\n";
  if (Check error = flush_standard_output()) return error;
  while (!end.asked()) std::this_thread::sleep_for(std::chrono::milliseconds(20));
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
    run(*chosen, [make = kind.add_options(*chosen)] { return emulate(make); });
  }
  CLI::App* chosen = verb->add_subcommand("inverse3",
                                          "Haply's Inverse Service with an Inverse3, at a port whose address "
                                          "it prints");
  run(*chosen, [start = add_inverse3_options(*chosen)] { return serve_inverse3(start); });
}

}  // namespace tactus::cli
