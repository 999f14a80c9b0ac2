// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/interfaces/cli/observers.hpp>
#include <tactus/kernel/core/version.hpp>

#include <charconv>
#include <utility>

#include <CLI/CLI.hpp>

namespace tactus::cli {

namespace {

Error no_place(const std::string& text) {
  return {.code = ErrorCode::syntax,
          .parameter = {},
          .message = "'" + report::printable(text) +
                     "' is no place to listen: write PORT or HOST:PORT, as 8765 or 127.0.0.1:8765, or nothing for any "
                     "free port of the loopback",
          .place = "--live"};
}

/// `[[HOST:]PORT]`; a host with colons stands in brackets.
Result<live::ServerOptions> place_of(const std::string& text) {
  live::ServerOptions options{.port = 0, .conversation = {}};
  if (text.empty()) return options;
  const std::size_t colon = text.rfind(':');
  const std::string port = colon == std::string::npos ? text : text.substr(colon + 1);
  const auto [end, error] = std::from_chars(port.data(), port.data() + port.size(), options.port);
  if (error != std::errc{} || end != port.data() + port.size() || options.port == 0) return no_place(text);
  if (colon == std::string::npos) return options;
  options.address = text.substr(0, colon);
  const bool bracketed = options.address.starts_with('[') && options.address.ends_with(']');
  if (bracketed) options.address = options.address.substr(1, options.address.size() - 2);
  if (options.address.empty() || (!bracketed && options.address.find(':') != std::string::npos)) return no_place(text);
  return options;
}

}  // namespace

void add_observer_options(CLI::App& verb, ObserverOptions& options) {
  constexpr const char* group = "Observers, in real time";
  verb.add_option(
          "--live", options.live,
          "Serve every control cycle to Foxglove and PlotJuggler; without a value, on a free port of the loopback")
      ->type_name("[[HOST:]PORT]")
      ->expected(0, 1)
      ->group(group);
  CLI::Option* const ros2 =
      verb.add_flag(
              "--ros2", options.ros2,
              "Publish to ROS 2 nodes under the names of CRTK (Collaborative Robotics Toolkit); in a virtual-time run "
              "(neither --realtime nor --site), messages on operator/servo_jp move the simulated hand")
          ->group(group);
  verb.add_flag("--requests", options.requests,
                "Let the live page and ROS 2 nodes set the force gain, request a tare (measurement of the "
                "gravity-compensation error) and mark episodes")
      ->group(group);
  verb.add_option("--namespace", options.name_space, "Namespace of the ROS 2 topics")
      ->type_name("NAME")
      ->needs(ros2)
      ->group(group);
}

Result<Observers> Observers::open(const ObserverOptions& options, const experiments::Request& request,
                                  const std::optional<control::SiteRole>& site, const std::vector<std::string>& joints,
                                  runtime::SiteExchange* exchange) {
  Observers made;
  if (options.requests && (!options.any() || exchange == nullptr)) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = {},
                 .message = options.any() ? "no operator controls this run: requests need --device or --site"
                                          : "requests come from a page or a ROS 2 node: add --live or --ros2",
                 .place = "--requests"};
  }
  const auto ask_as = [exchange, role = site.value_or(control::SiteRole::master)](runtime::RequestSource source) {
    return [exchange, role, source](const std::string& line) -> Check {
      const auto asked = exchange->ask(line, role, source);
      return asked ? Check() : Check(asked.error());
    };
  };
  if (options.live) {
    const auto where = place_of(*options.live);
    if (!where) return where.error();
    made.where_ = *where;
    std::map<std::string, std::string> about{{"tactus.version", std::string(version())},
                                             {"tactus.experiment", request.name}};
    if (site) about["tactus.site"] = name_of(*site);
    std::optional<live::RunRequests> requests;
    if (options.requests) {
      requests = {.ask = ask_as(runtime::RequestSource::page), .force_gain = [exchange]() -> std::optional<double> {
                    if (!exchange->settable.most_force_gain) return std::nullopt;
                    return exchange->asked_force_gain.load(std::memory_order_relaxed);
                  }};
    }
    made.view_ = std::make_unique<live::RunView>(std::move(about), std::move(requests));
  }
  if (options.ros2) {
    const auto network = ros2::network_of(ros2::environment());
    if (!network) return network.error();
    ros2::Bridge::Params params{.network = *network,
                                .name_space = options.name_space,
                                .joints = joints,
                                .master = !site || *site == control::SiteRole::master,
                                .slave = !site || *site == control::SiteRole::slave};
    if (options.requests) {
      params.ask = [ask = ask_as(runtime::RequestSource::node)](const std::string& line) {
        const Check refused = ask(line);
        return refused ? "refused: " + describe(*refused) : "asked for: " + line;
      };
    }
    auto observer = ros2::Observer::create(std::move(params));
    if (!observer) return observer.error();
    made.ros2_ = *std::move(observer);
  }
  return made;
}

Check Observers::begin(const std::function<void(const std::string&)>& say) {
  if (view_) {
    auto server = live::Server::start(where_, {}, *view_);
    if (!server) {
      Error error = server.error();
      error.place = "--live " + error.place;
      return error;
    }
    server_.emplace(*std::move(server));
    say("Live: " + server_->url() + ", for Foxglove and PlotJuggler ws" + server_->url().substr(4) + "\n");
  }
  return ros2_ ? ros2_->start() : std::nullopt;
}

std::string Observers::end() {
  std::string told;
  if (server_) {
    const live::ServerCounts counts = server_->counts();
    server_.reset();
    told += "Live: " + std::to_string(counts.accepted) + " connections, " +
            std::to_string(counts.dropped + view_->lost_records()) + " messages dropped for slow viewers\n";
  }
  if (ros2_) {
    const ros2::Bridge::Counts counts = ros2_->finish();
    told += "ROS 2: " + std::to_string(counts.published) + " snapshots published, " + std::to_string(counts.dropped) +
            " dropped, " + std::to_string(counts.lost) + " messages lost\n";
  }
  return told;
}

}  // namespace tactus::cli
