#include <tactus/cli/interruption.hpp>
#include <tactus/cli/outcome_files.hpp>
#include <tactus/cli/run_site.hpp>
#include <tactus/cli/site_loop.hpp>
#include <tactus/cli/site_report.hpp>
#include <tactus/configuration/document.hpp>
#include <tactus/simulation/experiment.hpp>

#include <atomic>
#include <csignal>
#include <iostream>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <poll.h>
#include <unistd.h>

namespace tactus::cli {

namespace {

std::atomic<bool> asked_to_arm{false};

Error refused(ErrorCode code, const char* option, std::string message) {
  return Error{.code = code, .parameter = {}, .message = std::move(message), .place = option};
}

/// `PORT` or `HOST:PORT`; without it the peer's port on every own address.
Result<link::Address> listening_address(const std::optional<std::string>& listen, const link::Address& peer) {
  if (!listen) return peer.any_host();
  if (listen->find(':') != std::string::npos) return link::Address::parse(*listen);
  auto port = link::Address::parse((peer.is_ipv6() ? "[::1]:" : "127.0.0.1:") + *listen);
  if (!port) return port.error();
  return port->any_host();
}

Result<link::Endpoint::Settings> link_settings(const SiteOptions& options) {
  if (options.peer.empty()) return refused(ErrorCode::missing, "--peer", "name the other site: HOST:PORT");
  const auto peer = link::Address::parse(options.peer);
  if (!peer) return peer.error();
  const auto listen = listening_address(options.listen, *peer);
  if (!listen) return listen.error();
  std::optional<link::Key> key;
  if (options.unencrypted && options.key) {
    return refused(ErrorCode::inconsistent, "--unencrypted", "a key encrypts: leave out one of the two");
  }
  if (options.key) {
    const auto read = link::read_key_file(*options.key);
    if (!read) return read.error();
    key = *read;
  } else if (!options.unencrypted) {
    return refused(ErrorCode::missing, "--key",
                   "the link is encrypted: make a key with `tactus key FILE` and give it to both sites; on one host, "
                   "--unencrypted does without");
  }
  return link::Endpoint::Settings{.site = options.site == "master" ? link::SiteName::master : link::SiteName::slave,
                                  .peer = *peer,
                                  .listen = *listen,
                                  .key = key,
                                  .longest_age_s = options.longest_age_s};
}

/// Whether a person typed a line. A standard input that has ended is left alone.
bool line_typed(bool& open) {
  pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
  if (!open || poll(&input, 1, 0) <= 0) return false;
  char text[256];
  const ssize_t size = read(STDIN_FILENO, text, sizeof(text));
  open = size > 0;
  return open;
}

}  // namespace

void add_site_options(CLI::App& verb, SiteOptions& options) {
  constexpr const char* group = "One site, in real time";
  const auto add = [&verb](const char* name, auto& value, const char* help, const char* type) {
    return verb.add_option(name, value, help)->type_name(type)->group(group);
  };
  add("--site", options.site, "Run only this site, the other being elsewhere", "SITE")
      ->check(CLI::IsMember({"master", "slave"}));
  add("--peer", options.peer, "Where the other site listens", "HOST:PORT");
  add("--listen", options.listen, "Where to listen; without it at the peer's port on every own address", "[HOST:]PORT");
  add("--key", options.key, "The key that both sites share, made by `tactus key`", "FILE");
  verb.add_flag("--unencrypted", options.unencrypted, "Plain text, on this host's loopback only")->group(group);
  verb.add_flag("--arm", options.arm, "At the master: arm once, as soon as the slave is heard")->group(group);
  add("--duration-s", options.duration_s, "How long to run; 0 is until interrupted", "S")->capture_default_str();
  add("--hold-after-s", options.following.hold_after_s, "Silence of the other site that ends in hold", "S")
      ->capture_default_str();
  add("--longest-age-s", options.longest_age_s, "Older messages are not applied", "S")->capture_default_str();
}

Check run_site(const SiteOptions& options, runtime::ServoThreadParams servo_params, const simulation::Request& request,
               const std::optional<std::string>& out, bool json) {
  const configuration::Document& document = request.document;
  const auto experiment = simulation::choose_experiment(document);
  if (!experiment) return experiment.error();
  if ((*experiment)->kind() != "tapping") {
    return refused(ErrorCode::inconsistent, "--site", "only an experiment of the kind tapping runs as two sites");
  }
  const auto params = document.read<simulation::TappingParams>();
  if (!params) return params.error();
  const auto link = link_settings(options);
  if (!link) return link.error();

  SiteExchange exchange;
  auto following = options.following;
  following.stale_after_s = std::min(following.stale_after_s, 0.5 * following.hold_after_s);
  auto loop = SiteLoop::make(
      *params, {.link = *link, .following = following, .duration_s = options.duration_s, .arm_at_once = options.arm},
      exchange);
  if (!loop) return document.locate(loop.error());

  const Interruption interruption;
  std::signal(SIGUSR1, [](int) { asked_to_arm.store(true, std::memory_order_relaxed); });
  servo_params.rate_Hz = params->servo.rate_Hz;
  auto servo = runtime::ServoThread<SiteLoop>::start(servo_params, *std::move(loop));
  if (!servo) return servo.error();
  std::ostream& lines = json ? std::cerr : std::cout;
  lines << second_head(options.site) << std::flush;
  bool input_open = true;
  std::vector<SiteSecond> seconds;
  const auto take_seconds = [&] {
    SiteSecond second;
    while (exchange.seconds.try_pop(second)) {
      lines << second_line(second) << std::flush;
      seconds.push_back(second);
    }
  };
  while (!(*servo)->ended()) {
    if (interruption.asked()) (*servo)->stop();
    const bool typed = line_typed(input_open);
    if (asked_to_arm.exchange(false, std::memory_order_relaxed) || typed) {
      exchange.arm.store(true, std::memory_order_relaxed);
    }
    take_seconds();
    usleep(20'000);
  }
  const auto& report = (*servo)->finish();
  take_seconds();
  const SiteTotals totals = (*servo)->step().totals();
  return write_outcome(
      out, site_outcome(options.site, totals, seconds, report, request, configuration::to_toml(*params)), json);
}

}  // namespace tactus::cli
