#include <tactus/interfaces/cli/command.hpp>
#include <tactus/simulation/experiments/experiment_of.hpp>

#include <memory>

#include "virtual_wall.hpp"

namespace {

using namespace tactus;

/// The stiffest virtual wall that a master can render: one row for each combination of the varied keys.
class VirtualWallExperiment final : public experiments::SweepOf<VirtualWallParams, VirtualWallResult> {
  Check check(const VirtualWallParams& params) const override { return check_virtual_wall(params); }
  Result<VirtualWallResult> run_one(const VirtualWallParams& params) const override { return stiffest_wall(params); }
  experiments::Presentation present(const experiments::Request& request, const Runs& runs) const override;
};

/// Two presses: onto the stiffest wall that settled, and onto one twice as stiff.
report::Figure figure_of(const VirtualWallExperiment::Run& run) {
  const report::Axis time{.label = "time", .unit = "s"};
  const report::Axis force{.label = "force of the wall", .unit = "N"};
  report::Panel settled{.title = "stiffest that settled", .x = time, .y = force, .lines = {}, .rules = {}};
  report::Panel stiffer{.title = "twice as stiff", .x = time, .y = force, .lines = {}, .rules = {}};
  settled.lines.push_back({.name = "", .x = run.found.settled.time_s, .y = run.found.settled.force_N});
  stiffer.lines.push_back({.name = "", .x = run.found.stiffer.time_s, .y = run.found.stiffer.force_N});
  return {.title = "A press onto the virtual wall",
          .caption = "The force of the wall on the hand over time. " + experiments::settings_caption(run.settings),
          .columns = 2,
          .panels = {settled, stiffer}};
}

experiments::Presentation VirtualWallExperiment::present(const experiments::Request& request, const Runs& runs) const {
  const std::string title = "The stiffest virtual wall";
  report::Table table = experiments::table_of_runs(
      runs.front().settings, {{"stiffest", "N/m"}, {"settling", "ms"}, {"pressed in", "mm"}}, title);
  report::Page page(request.name + ": " + title);
  page.paragraph(
      "An operator holds the master's handle and presses onto a spring and damper that exist in the servo loop only. "
      "The "
      "wall is made stiffer until the handle no longer comes to rest on it.");
  std::vector<report::Figure> figures;
  for (const Run& run : runs) {
    const VirtualWallResult& found = run.found;
    experiments::add_row(
        table, run.settings,
        {experiments::gain_limit_text(found.limit_N_per_m, run.params.task.softest_N_per_m),
         report::number(1e3 * found.settled.settling_time_s, 3), report::number(1e3 * found.settled.pressed_in_m, 3)});
    figures.push_back(figure_of(run));
  }
  page.table(table);
  for (const report::Figure& figure : figures) page.figure(figure);
  std::string json = experiments::runs_json(request, runs, [](const Run& run) {
    return experiments::metrics_json({{"stiffness_limit_N_per_m", run.found.limit_N_per_m.gain},
                                      {"settling_time_s", run.found.settled.settling_time_s},
                                      {"pressed_in_m", run.found.settled.pressed_in_m}});
  });
  return {.text = table.to_text(), .json = std::move(json), .page = std::move(page), .figures = std::move(figures)};
}

}  // namespace

int main(int argc, char** argv) {
  experiments::register_experiment(std::make_unique<VirtualWallExperiment>());
  return cli::run_command(argc, argv);
}
