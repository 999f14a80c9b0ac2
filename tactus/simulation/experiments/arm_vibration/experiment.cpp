// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/arm_vibration/coupled_arms.hpp>
#include <tactus/simulation/experiments/experiment_of.hpp>
#include <tactus/simulation/teleoperator/parallel.hpp>

#include <cstdio>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>

namespace tactus::experiments {

namespace {

constexpr std::string_view arm_vibration_title = "Two arms coupled by position";

/// Two simulated arms in position-position control: one row for each combination of the varied keys.
class ArmVibrationExperiment final : public ExperimentOf<ArmVibrationParams> {
  Result<Outcome> run(const Request& request, const Progress& progress) const override;
};

struct ArmVibrationRun {
  Settings settings;
  std::int64_t joint = 0;
  CoupledArmsResult found;
  CoupledArmsTheory theory;
};

double or_none(const std::optional<arm_control::DelayLimit>& limit, double arm_control::DelayLimit::*number) {
  return limit ? (*limit).*number : std::numeric_limits<double>::infinity();
}

std::string milliseconds(const std::optional<arm_control::DelayLimit>& limit) {
  return limit ? report::number(1e3 * limit->delay_s, 3) : "any";
}

/// What nothing holds has a pole at 0, which comes out as anything near it.
std::string growth_text(double growth_per_s) {
  constexpr double none_per_s = 1e-3;
  return growth_per_s > none_per_s ? report::number(growth_per_s, 2) : "none";
}

std::string words_of(const ShakingArms& arms) {
  return "joint " + std::to_string(arms.worst_joint + 1) + " at " + report::number(arms.worst.frequency_Hz, 3) +
         " Hz, " + report::number(arms.worst.rms_rad_per_s, 2) + " rad/s rms, " +
         report::number(1e3 * arms.worst.amplitude_rad, 2) + " mrad to either side";
}

std::string sentence(const ArmVibrationRun& run) {
  const CoupledArmsResult& found = run.found;
  if (found.diverged) {
    return "Runs away: a joint left its place by 2 rad; joint " + std::to_string(found.resting.worst_joint + 1) +
           " is the fastest in the end.";
  }
  if (!found.vibrates()) return "Does not vibrate.";
  if (!found.moving.vibrates()) return "Vibrates at rest: " + words_of(found.resting) + ".";
  return "Vibrates in motion: " + words_of(found.moving) +
         (found.resting.vibrates() ? "; at rest " + words_of(found.resting) + "." : "; at rest it dies out.");
}

std::string_view verdict_of(const CoupledArmsResult& found) {
  if (found.diverged) return "runs away";
  if (!found.vibrates()) return "still";
  if (!found.resting.vibrates()) return "in motion";
  return found.moving.vibrates() ? "always" : "at rest";
}

report::Table vibration_table(const std::vector<ArmVibrationRun>& runs) {
  report::Table table = table_of_runs(runs.front().settings,
                                      {{"vibrates"},
                                       {"joint"},
                                       {"frequency", "Hz"},
                                       {"rms", "rad/s"},
                                       {"amplitude", "mrad"},
                                       {"rms at rest", "rad/s"},
                                       {"age", "ms"},
                                       {"limit", "ms"},
                                       {"in play", "ms"},
                                       {"growth", "1/s"}},
                                      std::string(arm_vibration_title));
  for (const ArmVibrationRun& run : runs) {
    const CoupledArmsResult& found = run.found;
    const ShakingArms& shown = found.moving.vibrates() ? found.moving : found.resting;
    const bool shakes = found.vibrates();
    add_row(
        table, run.settings,
        {std::string(verdict_of(found)), shakes ? std::to_string(shown.worst_joint + 1) : "",
         shakes ? report::number(shown.worst.frequency_Hz, 3) : "", report::number(found.moving.worst.rms_rad_per_s, 2),
         report::number(1e3 * found.moving.worst.amplitude_rad, 2),
         report::number(found.resting.worst.rms_rad_per_s, 2), report::number(1e3 * found.delay_s, 3),
         milliseconds(run.theory.arms), milliseconds(run.theory.motor), growth_text(run.theory.growth_per_s)});
  }
  return table;
}

using Metrics = std::vector<std::pair<std::string, double>>;

void add_metrics(Metrics& metrics, const std::string& when, const ShakingArms& arms) {
  const auto add = [&](const std::string& which, const Shaking& shaking) {
    metrics.emplace_back(which + "frequency_Hz" + when, shaking.frequency_Hz);
    metrics.emplace_back(which + "rms_velocity_rad_per_s" + when, shaking.rms_rad_per_s);
    metrics.emplace_back(which + "amplitude_rad" + when, shaking.amplitude_rad);
  };
  add("", arms.joint);
  metrics.emplace_back("worst_joint" + when, static_cast<double>(arms.worst_joint + 1));
  add("worst_", arms.worst);
}

std::string vibration_json(const Request& request, const std::vector<ArmVibrationRun>& runs) {
  using arm_control::DelayLimit;
  return runs_json(request, runs, [](const ArmVibrationRun& run) {
    const CoupledArmsResult& found = run.found;
    const auto& limit = run.theory.arms;
    Metrics metrics{{"vibrates", found.vibrates() ? 1.0 : 0.0},
                    {"dies_out", !found.diverged && !found.resting.vibrates() ? 1.0 : 0.0},
                    {"diverged", found.diverged ? 1.0 : 0.0}};
    add_metrics(metrics, "", found.moving);
    add_metrics(metrics, "_at_rest", found.resting);
    metrics.insert(metrics.end(),
                   {{"weight_N_m", found.weight_N_m},
                    {"delay_s", found.delay_s},
                    {"delay_limit_s", or_none(limit, &DelayLimit::delay_s)},
                    {"delay_limit_frequency_Hz", or_none(limit, &DelayLimit::frequency_Hz)},
                    {"delay_limit_joint", limit ? limit->joint + 1.0 : std::numeric_limits<double>::infinity()},
                    {"delay_limit_in_play_s", or_none(run.theory.motor, &DelayLimit::delay_s)},
                    {"delay_limit_in_play_frequency_Hz", or_none(run.theory.motor, &DelayLimit::frequency_Hz)},
                    {"growth_per_s", run.theory.growth_per_s}});
    return metrics_json(metrics);
  });
}

report::Figure vibration_figure(const ArmVibrationRun& run) {
  const report::Axis time{.label = "time", .unit = "s"};
  report::Line leader{.name = "leader", .x = {}, .y = {}, .colour = 1};
  report::Line follower{.name = "follower", .x = {}, .y = {}, .colour = 0};
  report::Line apart{.name = "leader less follower", .x = {}, .y = {}, .colour = 2};
  for (std::size_t k = 0; k < run.found.records.size(); ++k) {
    const CoupledArmsRecord& record = run.found.records[k];
    for (report::Line* line : {&leader, &follower, &apart}) line->x.push_back(1e-3 * static_cast<double>(k));
    leader.y.push_back(1e3 * record.leader_rad);
    follower.y.push_back(1e3 * record.follower_rad);
    apart.y.push_back(1e3 * (record.leader_rad - record.follower_rad));
  }
  report::Panel positions{.title = "",
                          .x = time,
                          .y = {.label = "joint " + std::to_string(run.joint), .unit = "mrad"},
                          .lines = {leader, follower},
                          .rules = {}};
  report::Panel difference{
      .title = "", .x = time, .y = {.label = "difference", .unit = "mrad"}, .lines = {apart}, .rules = {}};
  return {.title = "The joint in both arms",
          .caption = sentence(run) + " " + settings_caption(run.settings),
          .columns = 2,
          .panels = {positions, difference}};
}

/// As `tactus diagnose` reads it: positive toward the environment, what is displayed pushes back.
std::string recording_of(const ArmVibrationRun& run) {
  std::string text =
      "# Made by tactus' simulator (arm-vibration), not measured: one joint of two arms that are coupled by position.\n"
      "# Torques are the motors' without gravity compensation; nothing touches the follower.\n"
      "time_s,leader_position_rad,follower_position_rad,displayed_torque_N_m,tip_torque_N_m,slave_torque_N_m,"
      "leader_velocity_rad_per_s,follower_velocity_rad_per_s\n";
  for (std::size_t k = 0; k < run.found.records.size(); ++k) {
    const CoupledArmsRecord& record = run.found.records[k];
    std::array<char, 160> line{};
    const int length =
        std::snprintf(line.data(), line.size(), "%.3f,%.7f,%.7f,%.5f,0,%.5f,%.5f,%.5f\n", 1e-3 * static_cast<double>(k),
                      record.leader_rad, record.follower_rad, -record.leader_N_m, record.follower_N_m,
                      record.leader_rad_per_s, record.follower_rad_per_s);
    text.append(line.data(), static_cast<std::size_t>(length));
  }
  return text;
}

report::Page vibration_page(const Request& request, const std::string& verdict, const report::Table& table,
                            const std::vector<report::Figure>& figures) {
  report::Page page(request.name + ": " + std::string(arm_vibration_title));
  page.paragraph(verdict);
  page.paragraph(
      "Drives pull each of two arms to the other's position, as a host with three loops commands them. The leader is "
      "moved "
      "or pushed once; a second of that motion and the last second are judged. Simulated.");
  page.table(table);
  page.definitions(
      {{"vibrates",
        "Some joint of some arm shakes by more than 0.2 rad/s, root mean square, about a moving mean of a quarter of "
        "a "
        "second: in motion, at rest or always."},
       {"joint, frequency, rms, amplitude",
        "Of the joint that shakes most, in motion; amplitude is half of its range."},
       {"rms at rest", "The same in the last second."},
       {"age", "How old what a drive goes by is, from reading the other's joint on; the mean of both ways."},
       {"limit", "The age with which the linear loop oscillates, all joints, at the pose of the beginning."},
       {"in play", "The same for the joint's motors alone, as they move within the play of their gears."},
       {"growth", "How fast motion of the linear loop grows without any age, by a wrong scale of velocity."}});
  for (const report::Figure& figure : figures) page.figure(figure);
  return page;
}

Result<Outcome> ArmVibrationExperiment::run(const Request& request, const Progress& progress) const {
  const std::filesystem::path folder = std::filesystem::path(request.document.name()).parent_path();
  const auto cases = prepare_cases<ArmVibrationParams, CoupledArmsSetup>(
      request, [&](const ArmVibrationParams& params) { return set_up_coupled_arms(params, folder); });
  if (!cases) return cases.error();
  std::vector<Result<CoupledArmsResult>> results(cases->all.size(), CoupledArmsResult());
  simulation::for_each_in_parallel(
      results.size(), [&](std::size_t i) { results[i] = run_coupled_arms(cases->all[i].prepared); }, progress);

  std::vector<ArmVibrationRun> runs;
  std::vector<report::Figure> figures;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const auto& [settings, setup] = cases->all[i];
    if (!results[i]) return locate_in(request, settings, results[i].error());
    const auto theory = theory_of(setup);
    if (!theory) return locate_in(request, settings, theory.error());
    runs.push_back({settings, setup.params.task.joint, *std::move(results[i]), *theory});
    figures.push_back(vibration_figure(runs.back()));
  }
  const report::Table table = vibration_table(runs);
  const std::string verdict = verdict_of_each(runs, sentence);
  report::Page page = vibration_page(request, verdict, table, figures);
  Outcome outcome = outcome_of({.text = verdict + "\n\n" + table.to_text(),
                                .json = vibration_json(request, runs),
                                .page = std::move(page),
                                .figures = std::move(figures)},
                               request, cases->first_configuration);
  outcome.recording = recording_of(runs.front());
  return outcome;
}

}  // namespace

std::unique_ptr<const Experiment> arm_vibration_experiment() { return std::make_unique<ArmVibrationExperiment>(); }

}  // namespace tactus::experiments
