// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/data/telemetry/wide_table.hpp>
#include <tactus/interfaces/cli/rig_figures.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tactus::cli {

namespace {

constexpr double most_points = 1500.0;
constexpr double most_points_per_s = 50.0;

/// The log at equal steps, for lines.
class JointTraces {
 public:
  JointTraces(const telemetry::WideLog& log, const telemetry::Episode& whole) : log_(&log), whole_(whole) {
    rate_Hz_ = std::min(most_points_per_s, most_points / std::max(1.0, whole.duration_s()));
    const std::size_t rows = telemetry::WideLog::rows(whole, rate_Hz_);
    for (std::size_t row = 0; row < rows; ++row) {
      time_s.push_back(1e-9 * static_cast<double>(whole.from_ns) + static_cast<double>(row) / rate_Hz_);
      coupled.push_back(std::ranges::any_of(log.episodes(), [&](const telemetry::Episode& episode) {
        const double at_ns = 1e9 * time_s.back();
        return at_ns >= static_cast<double>(episode.from_ns) && at_ns <= static_cast<double>(episode.to_ns);
      }));
    }
  }

  /// The column whose name begins so; empty where there is none.
  [[nodiscard]] std::vector<double> of(const std::string& begin) const {
    const std::vector<std::string> heads = log_->heads();
    const auto found = std::ranges::find_if(heads, [&](const std::string& head) { return head.starts_with(begin); });
    return found == heads.end() ? std::vector<double>() : log_->column(*found, whole_, rate_Hz_);
  }
  [[nodiscard]] double rate_Hz() const { return rate_Hz_; }

  std::vector<double> time_s;
  std::vector<bool> coupled;  ///< whether the follower follows

 private:
  const telemetry::WideLog* log_;
  telemetry::Episode whole_;
  double rate_Hz_ = 1.0;
};

report::Panel trace_panel(std::string title, const char* label, const char* unit, std::vector<report::Line> lines) {
  std::erase_if(lines, [](const report::Line& line) { return line.y.empty(); });
  return {.title = std::move(title),
          .x = {.label = "time", .unit = "s"},
          .y = {.label = label, .unit = unit},
          .lines = std::move(lines),
          .rules = {}};
}

/// Received less reached, while the follower follows.
std::vector<double> tracking_error(const JointTraces& traces, const std::vector<double>& commanded,
                                   const std::vector<double>& reached) {
  if (commanded.empty() || reached.empty()) return {};
  std::vector<double> error;
  for (std::size_t row = 0; row < traces.time_s.size(); ++row) {
    error.push_back(traces.coupled[row] ? commanded[row] - reached[row] : std::numeric_limits<double>::quiet_NaN());
  }
  return error;
}

}  // namespace

std::optional<report::Figure> joints_figure(const std::filesystem::path& log, const devices::RigPair& pair) {
  const auto wide = telemetry::WideLog::read(log);
  if (!wide) return std::nullopt;
  const telemetry::LogTable* site = telemetry::site_that_follows(wide->content());
  if (site == nullptr || site->times_ns.size() < 2) return std::nullopt;
  const JointTraces traces(*wide, {.number = 1, .from_ns = site->times_ns.front(), .to_ns = site->times_ns.back()});
  report::Figure figure{.title = "Joints",
                        .caption = "Positions; what the follower was commanded less what it reached, while it follows",
                        .columns = 2,
                        .panels = {},
                        .share_x = report::Sharing::in_line};
  const devices::RigSide& side = pair.leader ? *pair.leader : *pair.follower;
  bool any_external = false;
  std::vector<report::Panel> external;
  for (const devices::RigJoint& joint : side.joints) {
    const std::string name(joint.name());
    const devices::JointWords& words = joint.words();
    const std::string of_leader = "leader." + name + ".", of_follower = "follower." + name + ".";
    std::vector<double> reached = traces.of(of_follower + "position");
    std::vector<double> error = tracking_error(traces, traces.of(of_follower + "commanded_position"), reached);
    std::vector<double> pushed = traces.of(of_follower + "external");
    any_external = any_external || !pushed.empty();
    figure.panels.push_back(
        trace_panel(name, "position", words.position_unit,
                    {{.name = "leader", .x = traces.time_s, .y = traces.of(of_leader + "position"), .colour = 0},
                     {.name = "follower", .x = traces.time_s, .y = std::move(reached), .colour = 1}}));
    figure.panels.push_back(
        trace_panel(name, "tracking error", words.position_unit,
                    {{.name = "tracking error", .x = traces.time_s, .y = std::move(error), .colour = 2}}));
    external.push_back(
        trace_panel(name, joint.slides ? "external force" : "external torque", words.force_unit,
                    {{.name = "external torque", .x = traces.time_s, .y = std::move(pushed), .colour = 3}}));
  }
  if (any_external) {
    figure.columns = 3;
    figure.caption += "; what the environment does to the follower";
    for (std::size_t joint = external.size(); joint-- > 0;) {
      figure.panels.insert(figure.panels.begin() + static_cast<std::ptrdiff_t>(2 * joint + 2), external[joint]);
    }
  }
  figure.caption += ". " + report::number(traces.rate_Hz(), 3) + " points a second: the log has every control cycle.";
  return figure;
}

}  // namespace tactus::cli
