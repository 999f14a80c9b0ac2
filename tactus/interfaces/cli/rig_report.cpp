// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/figure.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/interfaces/cli/internal/link_json.hpp>
#include <tactus/interfaces/cli/probe_words.hpp>
#include <tactus/interfaces/cli/rig_report.hpp>
#include <tactus/interfaces/cli/support_words.hpp>
#include <tactus/runtime/servo/servo_presentation.hpp>
#include <tactus/simulation/experiments/presentation.hpp>

#include <algorithm>
#include <cmath>

#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

using devices::RigPair;
using devices::RigSecond;

const devices::RigJoint& joint_of(const devices::RigSide& side, std::size_t joint) {
  return side.joints[std::min(joint, side.joints.size() - 1)];
}

/// A side that the file has; both have the same joints.
const devices::RigSide& any_side(const RigPair& pair) { return pair.leader ? *pair.leader : *pair.follower; }

/// The path of a joint of the leader, whether the file has one or not.
std::string leading(const RigPair& pair, const devices::RigJoint& joint) {
  return join(join(pair.name, "leader"), joint.name());
}

/// What kept a side from being good, as the rest of a line.
std::string words_of(const devices::DeviceTrouble& trouble, const char* name, const devices::RigSide& side) {
  using devices::Trouble;
  if (trouble.what == Trouble::none) return {};
  const std::string place = std::string("; ") + name + ": ";
  const std::string joint(joint_of(side, trouble.joint).name());
  switch (trouble.what) {
    case Trouble::bus_ended:
      return place + (side.bus.kind == devices::BusKind::plugged ? "its driver has ended" : "its port was closed");
    case Trouble::bus_refused:
      return place + "its motors differ from the rig file";
    case Trouble::late:
    case Trouble::not_responding: {
      // A cycle ends in time where motors are silent; only a thread that stands still ends none.
      const bool stood = trouble.cycle_age_s > 0.5 * trouble.age_s;
      const std::string said = trouble.fault == devices::MotorFault::lost_master
                                   ? joint + " received no command in time"
                                   : joint + " not responding for " + report::fixed(1e3 * trouble.age_s, 1) + " ms";
      return place + said +
             (stood ? ", no cycle of its bus for " + report::fixed(1e3 * trouble.cycle_age_s, 1) + " ms" : "");
    }
    case Trouble::motor_fault:
      return place + joint + " has the fault " + name_of(trouble.fault) + " (" +
             devices::status_text(side.bus.kind, trouble.status) + ")";
    case Trouble::guard_gone:
      return place + "the guard process of its motors is gone, so they get no power: start the run again";
    case Trouble::guard_acted:
      return place + "this program was stopped, and the guard process switched its motors off";
    case Trouble::no_power:
      return place + joint + " has no power";
    default:
      return place + joint + " is beyond its limit of " + name_of(trouble.what);
  }
}

/// What the position and the drive's own report disagreed by, in the units of the joint; empty where that is not what
/// the gate latched.
std::string evidence_of(const RigSecond& second, const devices::RigJoint& joint) {
  const auto& found = second.fault_evidence;
  const devices::JointWords& words = joint.words();
  if (second.fault == control::GateFault::contradicted) {
    return ", its position moved by " + report::fixed(found.travelled_m, 3) + " " + words.position_unit + " in " +
           report::fixed(found.time_s, 3) + " s, its reported velocity gives " + report::fixed(found.reported_m, 3) +
           " " + words.position_unit;
  }
  if (second.fault == control::GateFault::encoder_frozen && found.time_s > 0.0) {
    return ", its motor reported the same for " + report::fixed(found.time_s, 3) + " s while its force changed by " +
           report::fixed(found.force_N, 3) + " " + words.force_unit;
  }
  return {};
}

/// What a gate latched, as the rest of a line; of a device that is lost the device says more.
std::string words_of_fault(const RigSecond& second, const RigPair& pair) {
  const auto& trouble = second.fault_of_leader ? second.leader_trouble : second.follower_trouble;
  const bool of_motor = second.motor.what != arm_control::MotorFinding::none;
  const bool told = trouble.what > devices::Trouble::not_responding || of_motor;
  if (second.fault == control::GateFault::none || (told && second.fault == control::GateFault::not_finite)) return {};
  const devices::RigSide& side = second.fault_of_leader ? *pair.leader : *pair.follower;
  const devices::RigJoint& joint = joint_of(side, second.fault_joint);
  return std::string("; gate of ") + joint.path + ": " + name_of(second.fault) + evidence_of(second, joint);
}

/// The joint whose support is at fault.
const devices::RigJoint& support_joint(const RigSecond& second, const RigPair& pair) {
  return joint_of(second.support_of_leader ? *pair.leader : *pair.follower, second.support.joint);
}

/// What is wrong with gravity compensation, as the rest of a line.
std::string words_of_support(const RigSecond& second, const RigPair& pair) {
  if (second.support.fault == control::SupportFault::none) return {};
  return cli::words_of(second.support, support_joint(second, pair));
}

/// The joint whose motor did not pass its sign probe.
const devices::RigJoint& probe_joint(const RigSecond& second, const RigPair& pair) {
  return joint_of(second.probe_of_leader ? *pair.leader : *pair.follower, second.probe.joint);
}

/// What its sign probe found, as the rest of a line.
std::string words_of_probe(const RigSecond& second, const RigPair& pair) {
  if (second.probe.report.verdict == control::ProbeVerdict::none) return {};
  return cli::words_of(second.probe.report, probe_joint(second, pair));
}

/// What a motor did otherwise than it was commanded, as the rest of a line.
std::string words_of_motor(const RigSecond& second, const RigPair& pair) {
  using arm_control::MotorFinding;
  const auto& found = second.motor;
  if (found.what == MotorFinding::none) return {};
  const devices::RigJoint& joint = joint_of(second.motor_of_leader ? *pair.leader : *pair.follower, found.joint);
  const std::string difference = report::fixed(std::fabs(found.wrong_N_m), 2) + " " + joint.words().force_unit +
                                 (found.wrong_N_m < 0.0 ? " less" : " more");
  const bool reports = found.what == MotorFinding::reports_otherwise;
  return "; " + joint.path + ": " +
         (reports ? "its drive reports " + difference + " than it was commanded"
                  : "the arm moves as if its motor gave " + difference + " than its drive reports") +
         ": look at the motor and its sign, or correct the URDF";
}

bool is_over(const RigSecond::Tare& tare) {
  return tare.report.state != control::TareState::none && tare.report.state != control::TareState::under_way;
}

/// How the tare of a side goes, as the rest of a line.
std::string words_of(const RigSecond::Tare& tare, const char* name, const devices::RigSide& side) {
  using control::TareState;
  const control::TareReport& report = tare.report;
  const std::string begin = std::string("; tare of the ") + name;
  if (report.state == TareState::none) return {};
  if (report.state == TareState::under_way) return begin + " is under way: touch nothing";
  if (report.state == TareState::stopped) return begin + " was stopped, nothing has changed";
  if (report.state == TareState::done) {
    std::string all;
    for (std::size_t joint = 0; joint < side.joints.size() && joint < tare.found_Nm.size(); ++joint) {
      all += (all.empty() ? "" : ", ") + report::fixed(tare.found_Nm[joint], 2);
    }
    return begin + " added to gravity compensation: " + all + " N m";
  }
  const devices::RigJoint& joint = joint_of(side, report.joint);
  if (report.state == TareState::still) {
    return begin + " is refused, nothing has changed: " + joint.path + " made " +
           report::fixed(100.0 * report.value, 0) +
           " % of the motion: free it, or raise control.tare.amplitude_rad above its play and friction";
  }
  return begin + " is refused, nothing has changed: " + joint.path + " lacks " + report::fixed(report.value, 2) +
         " N m, more than control.tare.most_share of its limit: look at the URDF and at the motor's sign";
}

/// What a person does next, where there is something.
std::string advice(const RigSecond& second, const RigPair& pair, std::optional<control::SiteRole> only) {
  using control::SiteState;
  const auto& joint = joint_of(any_side(pair), second.joint);
  if (const auto worse = std::max(second.leader_health, second.follower_health);
      worse >= station::DeviceHealth::not_responding) {
    return std::string("; the ") + (second.leader_health == worse ? "leader" : "follower") + " is " +
           (worse == station::DeviceHealth::lost ? "lost" : "not responding") + ": look at 'tactus device check'";
  }
  if (second.too_far) {
    if (only && !(second.farthest > 0.0)) {
      return std::string("; no packet from the ") + (*only == control::SiteRole::master ? "follower" : "leader");
    }
    return "; too far apart to arm: move " + leading(pair, joint) + " by " + report::fixed(second.farthest, 2) + " " +
           joint.words().position_unit + " to where its follower is";
  }
  if (only == control::SiteRole::slave && second.leader == SiteState::configure) return "; armed at its leader's";
  if (second.leader == SiteState::fault || second.follower == SiteState::fault) return "; type 'clear', then 'arm'";
  if (second.leader == SiteState::armed && is_over(second.leader_tare) && is_over(second.follower_tare)) {
    return "; type 'press' to couple the arms";
  }
  const bool waits = second.leader == SiteState::configure || second.leader == SiteState::hold;
  return waits ? "; hold the leader still and type 'arm'" : "";
}

}  // namespace

std::string line_of(const RigSecond& second, const RigPair& pair, std::optional<control::SiteRole> only) {
  std::string line = report::fixed(second.time_s, 0) + " s: leader " + name_of(second.leader) + ", follower " +
                     name_of(second.follower) + " (" + name_of(second.cause) + "), most torque " +
                     report::fixed(second.most_torque, 2) + ", farthest apart " + report::fixed(second.farthest, 3);
  if (only) {
    line += ", round trip " + report::fixed(1e3 * second.link.round_trip_s, 2) + " ms, lost " +
            report::fixed(100.0 * second.link.loss_fraction, 1) + " %";
  }
  if (second.force_gain > 0.0) line += ", force gain " + rounded_number(second.force_gain);
  if (only != control::SiteRole::slave) line += words_of(second.leader_trouble, "leader", *pair.leader);
  if (only != control::SiteRole::master) line += words_of(second.follower_trouble, "follower", *pair.follower);
  if (only != control::SiteRole::slave) line += words_of(second.leader_tare, "leader", *pair.leader);
  if (only != control::SiteRole::master) line += words_of(second.follower_tare, "follower", *pair.follower);
  return line + words_of_fault(second, pair) + words_of_motor(second, pair) + words_of_support(second, pair) +
         words_of_probe(second, pair) + advice(second, pair, only) + "\n";
}

std::string fault_of(const RigRun& run, const RigPair& pair) {
  const RigSecond& last = run.last;
  const auto faulty = [&](control::SiteRole role, control::SiteState state) {
    return (!run.only || *run.only == role) && state == control::SiteState::fault;
  };
  const bool leader = faulty(control::SiteRole::master, last.leader),
             follower = faulty(control::SiteRole::slave, last.follower);
  if (!leader && !follower) return {};
  std::string text = std::string(leader ? (follower ? "leader and follower" : "leader") : "follower") + " (" +
                     name_of(last.cause) + ")";
  if (leader) text += words_of(last.leader_trouble, "leader", *pair.leader);
  if (follower) text += words_of(last.follower_trouble, "follower", *pair.follower);
  return text + words_of_fault(last, pair) + words_of_motor(last, pair);
}

namespace {

std::string summary_of(const RigRun& run, const RigPair& pair) {
  const devices::RigTotals& totals = run.totals;
  std::string link;
  if (run.link) {
    link = "; round trip " + report::fixed(1e3 * run.link->round_trip_mean_s, 2) + " ms, at most " +
           report::fixed(1e3 * run.link->round_trip_max_s, 2) + " ms, " + std::to_string(run.link->link.sent) +
           " packets sent, " + std::to_string(run.link->link.inbound.counted) + " came";
  }
  const std::string fault = fault_of(run, pair), probe = words_of_probe(run.last, pair);
  return (fault.empty() ? "" : "Ended in a fault: " + fault + ". ") +
         (probe.empty() ? "" : "Not coupled at the end" + probe + ". ") + std::to_string(totals.ticks) +
         " control cycles in " + report::fixed(totals.duration_s, 1) + " s, " + std::to_string(totals.active_ticks) +
         " of them coupled; armed " + std::to_string(totals.armings) + " times, held " + std::to_string(totals.holds) +
         " times, a device late in " + std::to_string(totals.late_ticks) + ", not responding in " +
         std::to_string(totals.not_responding_ticks) + ", lost in " + std::to_string(totals.lost_ticks) + " cycles; " +
         std::to_string(run.servo.missed) + " deadlines missed, late " + std::to_string(run.servo.late_ours()) +
         " by us and " + std::to_string(run.servo.late_machine()) + " by the machine" + link + "; ended by " +
         run.ended_by + ".";
}

/// The joint that was farthest from its leader's.
const devices::RigJoint& farthest_joint(const RigSecond& second, const RigPair& pair) {
  return joint_of(any_side(pair), second.joint);
}

nlohmann::ordered_json json_of(const devices::DeviceTrouble& trouble, const devices::RigSide& side) {
  return {{"what", name_of(trouble.what)},
          {"joint", joint_of(side, trouble.joint).name()},
          {"motor_fault", name_of(trouble.fault)},
          {"age_s", trouble.age_s},
          {"cycle_age_s", trouble.cycle_age_s}};
}

/// The path of the joint whose gate latched; empty where none did.
std::string gate_joint(const RigSecond& second, const RigPair& pair) {
  if (second.fault == control::GateFault::none) return {};
  return joint_of(second.fault_of_leader ? *pair.leader : *pair.follower, second.fault_joint).path;
}

/// What was found wrong with gravity compensation; null where nothing was.
nlohmann::ordered_json json_of_support(const RigSecond& second, const RigPair& pair) {
  const control::SupportFinding& found = second.support;
  if (found.fault == control::SupportFault::none) return nullptr;
  return {{"fault", name_of(found.fault)},
          {"joint", support_joint(second, pair).path},
          {"share", found.share},
          {"moved", found.moved_m},
          {"speed", found.speed_m_per_s},
          {"excess_torque", found.excess_N},
          {"gravity_torque", found.weight_N},
          {"torque_limit", found.limit_N}};
}

/// The motor that did not pass its sign probe; null where none is what stops a side.
nlohmann::ordered_json json_of_probe(const RigSecond& second, const RigPair& pair) {
  const control::ProbeReport& found = second.probe.report;
  if (found.verdict == control::ProbeVerdict::none) return nullptr;
  return {{"verdict", name_of(found.verdict)},
          {"joint", probe_joint(second, pair).path},
          {"torque", found.force_N},
          {"moved", found.moved_m},
          {"needed", found.needed_m}};
}

nlohmann::ordered_json json_of(const RigRun& run, const RigPair& pair) {
  const devices::RigTotals& totals = run.totals;
  nlohmann::ordered_json document{
      {"fault", fault_of(run, pair)}, {"pair", pair.name}, {"joints", nlohmann::ordered_json::array()}};
  for (const devices::RigJoint& joint : any_side(pair).joints) document["joints"].push_back(joint.name());
  document.update({{"duration_s", totals.duration_s},
                   {"ticks", totals.ticks},
                   {"active_ticks", totals.active_ticks},
                   {"armings", totals.armings},
                   {"holds", totals.holds},
                   {"late_ticks", totals.late_ticks},
                   {"not_responding_ticks", totals.not_responding_ticks},
                   {"lost_ticks", totals.lost_ticks},
                   {"ended_by", run.ended_by},
                   {"lines_dropped", run.lines_dropped},
                   {"seconds", nlohmann::ordered_json::array()}});
  for (const RigSecond& second : run.seconds) {
    nlohmann::ordered_json one{{"time_s", second.time_s},
                               {"leader", name_of(second.leader)},
                               {"follower", name_of(second.follower)},
                               {"cause", name_of(second.cause)}};
    if (run.only != control::SiteRole::slave) {
      one["leader_health"] = name_of(second.leader_health);
      one["leader_trouble"] = json_of(second.leader_trouble, *pair.leader);
    }
    if (run.only != control::SiteRole::master) {
      one["follower_health"] = name_of(second.follower_health);
      one["follower_trouble"] = json_of(second.follower_trouble, *pair.follower);
    }
    one.update({{"gate_fault", name_of(second.fault)},
                {"gate_joint", gate_joint(second, pair)},
                {"support", json_of_support(second, pair)},
                {"probe", json_of_probe(second, pair)},
                {"most_torque", second.most_torque},
                {"farthest", second.farthest},
                {"joint", farthest_joint(second, pair).name()},
                {"too_far", second.too_far}});
    if (run.only) {
      one.update({{"round_trip_s", second.link.round_trip_s},
                  {"age_s", second.link.age_s},
                  {"loss_fraction", second.link.loss_fraction}});
    }
    document["seconds"].push_back(one);
  }
  if (run.only) document["site"] = name_of(*run.only);
  if (run.link) document.update(link_json(*run.link));
  document["servo"] = report::parse_json<nlohmann::ordered_json>(runtime::servo_json(run.servo));
  if (run.log_dropped) document["log_dropped"] = *run.log_dropped;
  return document;
}

report::Figure seconds_figure(const RigRun& run, const RigPair& pair) {
  const devices::JointWords& words = any_side(pair).joints.front().words();
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
                                 std::string_view configuration, const std::optional<report::Figure>& joints) {
  const std::string summary = summary_of(run, pair);
  std::vector<report::Figure> figures{seconds_figure(run, pair), runtime::timing_figure(run.servo)};
  report::Page page(request.name + ": " + pair.name +
                    (!run.only                                ? ", leader and follower"
                     : *run.only == control::SiteRole::master ? ", leader"
                                                              : ", follower"));
  page.paragraph(summary);
  page.figure(figures[0]);
  if (joints) page.figure(*joints);
  runtime::add_timing(page, run.servo, figures[1]);
  experiments::add_provenance(page, request, configuration);
  if (joints) figures.push_back(*joints);
  std::string text = summary + "\n";
  if (run.log_dropped) text += std::to_string(*run.log_dropped) + " records of the log dropped.\n";
  return {.text = std::move(text),
          .json = report::json_text(json_of(run, pair)),
          .html = page.to_html(),
          .figures = figures,
          .traces = {},
          .configuration = std::string(configuration)};
}

}  // namespace tactus::cli
