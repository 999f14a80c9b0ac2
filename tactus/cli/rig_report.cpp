#include <tactus/cli/internal/json_text.hpp>
#include <tactus/cli/rig_report.hpp>
#include <tactus/experiments/presentation.hpp>
#include <tactus/report/figure.hpp>
#include <tactus/report/page.hpp>
#include <tactus/runtime/servo_presentation.hpp>

#include <algorithm>
#include <array>
#include <cstdio>

#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

using devices::RigPair;
using devices::RigSecond;

std::string fixed(double value, int digits) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.*f", digits, value);
  return text.data();
}

/// What a person does next, where there is something.
std::string advice(const RigSecond& second, const RigPair& pair) {
  using control::SiteState;
  const auto& joint = pair.leader->joints[std::min(second.joint, pair.leader->joints.size() - 1)];
  if (second.leader_health == station::DeviceHealth::lost || second.follower_health == station::DeviceHealth::lost) {
    return std::string("; the ") + (second.leader_health == station::DeviceHealth::lost ? "leader" : "follower") +
           " is lost: look at 'tactus device check'";
  }
  if (second.too_far) {
    return "; too far apart to arm: move " + joint.path + " by " + fixed(second.farthest, 2) + " " +
           joint.words().position_unit + " to where its follower is";
  }
  if (second.leader == SiteState::fault || second.follower == SiteState::fault) return "; type 'clear', then 'arm'";
  const bool waits = second.leader == SiteState::configure || second.leader == SiteState::hold;
  return waits ? "; hold the leader still and type 'arm'" : "";
}

}  // namespace

std::string line_of(const RigSecond& second, const RigPair& pair) {
  return fixed(second.time_s, 0) + " s: leader " + name_of(second.leader) + ", follower " + name_of(second.follower) +
         " (" + name_of(second.cause) + "), most torque " + fixed(second.most_torque, 2) + ", farthest apart " +
         fixed(second.farthest, 3) + advice(second, pair) + "\n";
}

namespace {

std::string summary_of(const RigRun& run) {
  const devices::RigTotals& totals = run.totals;
  return std::to_string(totals.ticks) + " ticks in " + fixed(totals.duration_s, 1) + " s, " +
         std::to_string(totals.active_ticks) + " of them coupled; armed " + std::to_string(totals.armings) +
         " times, held " + std::to_string(totals.holds) + " times, a device lost in " +
         std::to_string(totals.lost_ticks) + " ticks; " + std::to_string(run.servo.missed) +
         " deadlines missed, late " + std::to_string(run.servo.late_ours()) + " by us and " +
         std::to_string(run.servo.late_machine()) + " by the machine; ended by " + run.ended_by + ".";
}

/// The joint that was farthest from its leader's.
const devices::RigJoint& farthest_joint(const RigSecond& second, const RigPair& pair) {
  return pair.leader->joints[std::min(second.joint, pair.leader->joints.size() - 1)];
}

nlohmann::ordered_json json_of(const RigRun& run, const RigPair& pair) {
  const devices::RigTotals& totals = run.totals;
  nlohmann::ordered_json document{{"pair", pair.name}, {"joints", nlohmann::ordered_json::array()}};
  for (const devices::RigJoint& joint : pair.leader->joints) document["joints"].push_back(joint.name());
  document.update({{"duration_s", totals.duration_s},
                   {"ticks", totals.ticks},
                   {"active_ticks", totals.active_ticks},
                   {"armings", totals.armings},
                   {"holds", totals.holds},
                   {"lost_ticks", totals.lost_ticks},
                   {"ended_by", run.ended_by},
                   {"lines_dropped", run.lines_dropped},
                   {"seconds", nlohmann::ordered_json::array()}});
  for (const RigSecond& second : run.seconds) {
    document["seconds"].push_back({{"time_s", second.time_s},
                                   {"leader", name_of(second.leader)},
                                   {"follower", name_of(second.follower)},
                                   {"cause", name_of(second.cause)},
                                   {"leader_health", name_of(second.leader_health)},
                                   {"follower_health", name_of(second.follower_health)},
                                   {"most_torque", second.most_torque},
                                   {"farthest", second.farthest},
                                   {"joint", farthest_joint(second, pair).name()},
                                   {"too_far", second.too_far}});
  }
  document["servo"] = nlohmann::ordered_json::parse(runtime::servo_json(run.servo));
  if (run.log_dropped) document["log_dropped"] = *run.log_dropped;
  return document;
}

report::Figure seconds_figure(const RigRun& run, const RigPair& pair) {
  const devices::JointWords& words = pair.leader->joints.front().words();
  const auto panel = [&](const char* label, const char* unit, auto value) {
    report::Line line{.name = "", .x = {}, .y = {}, .colour = 0};
    for (const RigSecond& second : run.seconds) {
      line.x.push_back(second.time_s);
      line.y.push_back(value(second));
    }
    return report::Panel{.title = {},
                         .x = {.label = "time", .unit = "s"},
                         .y = {.label = label, .unit = unit, .lower = 0.0},
                         .lines = {std::move(line)},
                         .rules = {}};
  };
  return {
      .title = "Second by second",
      .caption =
          "The most that any motor gave, and how far the joint that is farthest is from its leader's at the end.",
      .columns = 1,
      .panels = {panel("most torque", words.force_unit, [](const RigSecond& one) { return one.most_torque; }),
                 panel("farthest apart", words.position_unit, [](const RigSecond& one) { return one.farthest; }),
                 panel("coupled", "",
                       [](const RigSecond& one) { return one.follower == control::SiteState::active ? 1.0 : 0.0; })},
      .share_x = report::Sharing::in_line};
}

}  // namespace

experiments::Outcome rig_outcome(const RigRun& run, const RigPair& pair, const experiments::Request& request,
                                 std::string_view configuration) {
  const std::string summary = summary_of(run);
  const std::vector<report::Figure> figures{seconds_figure(run, pair), runtime::timing_figure(run.servo)};
  report::Page page(request.name + ": " + pair.name + ", leader and follower");
  page.paragraph(summary);
  page.figure(figures[0]);
  runtime::add_timing(page, run.servo, figures[1]);
  experiments::add_provenance(page, request, configuration);
  std::string text = summary + "\n";
  if (run.log_dropped) text += std::to_string(*run.log_dropped) + " records of the log dropped.\n";
  return {.text = std::move(text),
          .json = json_text(json_of(run, pair)),
          .html = page.to_html(),
          .figures = figures,
          .traces = {},
          .configuration = std::string(configuration)};
}

}  // namespace tactus::cli
