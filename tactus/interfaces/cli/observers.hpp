// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/live/run_view.hpp>
#include <tactus/interfaces/live/server.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/runtime/ros2/observer.hpp>
#include <tactus/runtime/servo/site_exchange.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {  // NOLINT: the name is not ours
class App;
}

namespace tactus::cli {

/// Observers of a run in real time, in addition to its log.
struct ObserverOptions {
  std::optional<std::string> live;  ///< `[[HOST:]PORT]` of the live page; empty for any free port of the loopback
  bool ros2 = false;
  bool requests = false;  ///< whether these may ask for something as well
  std::string name_space = "tactus";
  [[nodiscard]] bool any() const { return live || ros2; }
};

/// Adds `--live`, `--ros2`, `--namespace` and `--requests` to a command.
void add_observer_options(CLI::App& verb, ObserverOptions& options);

/// The live page and the ROS 2 nodes of a run. They read its record streams on threads of their own, as its log does,
/// so the servo thread waits for none of them. They change nothing, unless `ObserverOptions::requests` lets them ask
/// for what `runtime::parse_site_command` allows them.
class Observers {
 public:
  /// Opens what is asked for before anything runs; `site` states whose topics go to ROS 2, `joints` how several are
  /// called there. `exchange` takes what is asked of the sites, if there are any that an operator commands. Errors: an
  /// invalid place; `inconsistent` for requests without it; those of `ros2::Observer::create`.
  static Result<Observers> open(const ObserverOptions& options, const experiments::Request& request,
                                const std::optional<control::SiteRole>& site = {},
                                const std::vector<std::string>& joints = {}, runtime::SiteExchange* exchange = nullptr);

  /// Shows what goes into these streams from now on: `RealTimeStreams`, `SiteStreams`, `JointStreams` or
  /// `ArmTapStreams`. Before `begin`.
  template <class Streams>
  void watch(const Streams& streams) {
    if (view_) {
      streams.for_each([this](const std::string& topic, const char* type_name, const auto& stream) {
        view_->add(topic, type_name, stream);
      });
    }
    if (ros2_) ros2_->watch(streams);
  }
  /// Begins to serve, and states at once where. Errors: those of `live::Server::start` and `ros2::Observer::start`.
  Check begin(const std::function<void(const std::string&)>& say);
  /// Ends it, and reports in a line for each how much it received; empty without observers.
  std::string end();

  [[nodiscard]] bool any() const { return view_ || ros2_; }

 private:
  Observers() = default;

  live::ServerOptions where_;
  std::unique_ptr<live::RunView> view_;
  std::unique_ptr<ros2::Observer> ros2_;
  std::optional<live::Server> server_;  ///< before the view it goes
};

}  // namespace tactus::cli
