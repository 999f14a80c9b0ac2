#include <tactus/cli/emulate.hpp>
#include <tactus/cli/interruption.hpp>
#include <tactus/cli/standard_output.hpp>
#include <tactus/cli/verbs.hpp>
#include <tactus/wire/port.hpp>
#include <tactus/wire/talk.hpp>

#include <array>
#include <iostream>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

/// A kind of motors is a line here.
constexpr std::array emulated_kinds{
    EmulatedKind{"damiao", "Motors of Damiao's DM series behind a serial CAN adapter", &add_damiao_options},
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
  return wire::talk(*peer->line, *port, [&end] { return end.asked(); });
}

}  // namespace

void add_emulate(CLI::App& app, int& status) {
  CLI::App* verb = app.add_subcommand("emulate", "Be motors at a pseudo-terminal, whose path it prints");
  verb->require_subcommand(1);
  for (const EmulatedKind& kind : emulated_kinds) {
    CLI::App* chosen = verb->add_subcommand(kind.name, kind.summary);
    chosen->callback([make = kind.add_options(*chosen), &app, &status] {
      if (const auto error = emulate(make)) {
        std::cerr << app.get_name() << ": " << describe(*error) << "\n";
        status = exit_status(*error);
      }
    });
  }
}

}  // namespace tactus::cli
