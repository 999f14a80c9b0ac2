#include <tactus/cli/interruption.hpp>
#include <tactus/cli/outcome_files.hpp>
#include <tactus/cli/run_site.hpp>
#include <tactus/cli/site_loop.hpp>
#include <tactus/cli/site_report.hpp>
#include <tactus/configuration/document.hpp>
#include <tactus/simulation/experiment.hpp>

#include <array>
#include <atomic>
#include <csignal>
#include <cstddef>
#include <filesystem>
#include <iostream>
#include <string>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>
#include <poll.h>
#include <unistd.h>

namespace tactus::cli {

namespace {

std::atomic<bool> asked_to_arm{false};

Error refused(ErrorCode code, const char* option, std::string message) {
  return Error{.code = code, .parameter = {}, .message = std::move(message), .place = option};
}

control::SiteRole role_of(const SiteOptions& options) {
  return options.site == "master" ? control::SiteRole::master : control::SiteRole::slave;
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
  return link::Endpoint::Settings{.site = role_of(options), .peer = *peer, .listen = *listen, .key = key};
}

/// What a person asks a site for while it runs: words on standard input, and SIGUSR1.
class Person {
 public:
  explicit Person(control::SiteRole role) : role_(role) {
    std::signal(SIGUSR1, [](int) { asked_to_arm.store(true, std::memory_order_relaxed); });
  }

  /// Passes on what came since the last call; a wrong word is told on standard error.
  void ask(SiteExchange& exchange) {
    const bool master = role_ == control::SiteRole::master;
    if (asked_to_arm.exchange(false, std::memory_order_relaxed) && master) exchange.words.try_push(SiteWord::arm);
    read_what_waits();
    for (auto end = typed_.find('\n'); end != std::string::npos; end = typed_.find('\n')) {
      const auto word = parse_site_word(std::string_view(typed_).substr(0, end), role_);
      if (word) {
        if (!exchange.words.try_push(*word)) return;  // asked again at the next call
      } else {
        std::cerr << "tactus: " << describe(word.error()) << "\n";
      }
      typed_.erase(0, end + 1);
    }
  }

 private:
  /// No more than a line ahead of what was passed on. A standard input that has ended is left alone, after its last
  /// line.
  void read_what_waits() {
    pollfd input{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    if (!open_ || typed_.find('\n') != std::string::npos || poll(&input, 1, 0) <= 0) return;
    std::array<char, 256> text{};
    const ssize_t size = read(STDIN_FILENO, text.data(), text.size());
    open_ = size > 0;
    if (open_) {
      typed_.append(text.data(), static_cast<std::size_t>(size));
      // No word is that long: what is piped in without an end of line shall not fill the memory.
      if (typed_.size() > longest_line && typed_.find('\n') == std::string::npos) typed_ += '\n';
    } else if (!typed_.empty()) {
      typed_ += '\n';
    }
  }

  static constexpr std::size_t longest_line = 1000;
  control::SiteRole role_;
  std::string typed_;
  bool open_ = true;
};

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
}

Check run_site(const SiteOptions& options, runtime::ServoThreadParams servo_params, const simulation::Request& request,
               OutputFolder& output, std::uint64_t log_limit_bytes) {
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

  SiteRun run;
  run.role = role_of(options);
  SiteExchange exchange;
  auto loop =
      SiteLoop::make(*params, {.link = *link, .duration_s = options.duration_s, .arm_at_once = options.arm}, exchange);
  if (!loop) return document.locate(loop.error());
  const std::string configuration = configuration::to_toml(*params);
  std::optional<SiteLog> log;
  if (output.wanted()) {
    if (auto error = output.begin()) return error;
    auto created = SiteLog::create(output.log_folder(), request, configuration, run.role, log_limit_bytes);
    if (!created) return created.error();
    log.emplace(*std::move(created));
    loop->log_to(log->streams());
  }

  const Interruption interruption;
  Person person(run.role);
  servo_params.rate_Hz = params->servo.rate_Hz;
  auto servo = runtime::ServoThread<SiteLoop>::start(servo_params, *std::move(loop));
  if (!servo) return servo.error();
  std::ostream& lines = output.json() ? std::cerr : std::cout;
  lines << second_head(run.role) << std::flush;
  const auto take_seconds = [&] {
    SiteSecond second;
    while (exchange.seconds.try_pop(second)) {
      lines << second_line(second) << std::flush;
      run.seconds.push_back(second);
    }
  };
  while (!(*servo)->ended()) {
    if (interruption.asked()) (*servo)->stop();
    person.ask(exchange);
    take_seconds();
    usleep(20'000);
  }
  run.servo = (*servo)->finish();
  (*servo)->step().finish();
  take_seconds();
  run.totals = (*servo)->step().totals();
  Check log_error;
  if (log) {
    log_error = log->close();
    run.log_dropped = log->dropped();
  }
  if (auto error = write_outcome(output, site_outcome(run, request, configuration))) return error;
  if (log && !log_error) output.announce_log(log->removed());
  return log_error;
}

}  // namespace tactus::cli
