#include <tactus/arm_identification/fit.hpp>
#include <tactus/cli/arm_options.hpp>
#include <tactus/cli/identify.hpp>
#include <tactus/cli/internal/json_text.hpp>
#include <tactus/cli/outcome_files.hpp>
#include <tactus/cli/real_between.hpp>
#include <tactus/core/version.hpp>
#include <tactus/report/page.hpp>
#include <tactus/report/table.hpp>
#include <tactus/report/text.hpp>
#include <tactus/urdf/urdf.hpp>

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using arm_identification::ArmIdentification;
using arm_identification::ArmJointFit;
using arm_identification::ArmParameter;
using arm_identification::ArmRecording;

struct IdentifyArmOptions {
  ArmOptions arm;
  std::vector<std::string> files;
  std::string urdf;
  std::string tip;
  std::vector<double> gravity;
  std::optional<double> cutoff_Hz;
};

std::string json_of(const IdentifyArmOptions& options, const ArmIdentification& found) {
  using Json = nlohmann::ordered_json;
  Json document{{"recordings", options.files},
                {"urdf", options.urdf},
                {"duration_s", found.duration_s},
                {"cutoff_Hz", found.cutoff_Hz},
                {"scaled_efforts", found.scaled_efforts},
                {"base_parameters", found.base_parameters},
                {"told_combinations", found.told_combinations},
                {"joints", Json::array()}};
  for (const ArmJointFit& joint : found.joints) {
    Json parameters = Json::array();
    for (const ArmParameter& p : joint.parameters) {
      parameters.push_back({{"name", p.name},
                            {"value", p.value},
                            {"unit", p.unit},
                            {"interval_95", {p.lower, p.upper}},
                            {"determined", p.told}});
    }
    document["joints"].push_back({{"name", joint.name},
                                  {"effort_rms", joint.effort_rms},
                                  {"residual_rms", joint.residual_rms},
                                  {"relative", joint.relative},
                                  {"held_out_relative", joint.held_out_relative},
                                  {"least_squares_held_out_relative", joint.least_squares_relative},
                                  {"held_out_coverage_95", joint.held_out_coverage},
                                  {"effort_per_N_m", joint.effort_per_N_m},
                                  {"parameters", parameters}});
  }
  return json_text(document);
}

report::Table joints_table(const ArmIdentification& found, const std::string& unit) {
  report::Table table({{.title = "Joint", .align = report::Column::Align::left},
                       {.title = "Effort rms", .unit = unit},
                       {.title = "Left rms", .unit = unit},
                       {.title = "Left", .unit = "%"},
                       {.title = "Left of the half held out", .unit = "%"},
                       {.title = "by least squares", .unit = "%"},
                       {.title = "Within 95 %", .unit = "%"}});
  for (const ArmJointFit& joint : found.joints) {
    table.add_row({joint.name, report::number(joint.effort_rms, 3), report::number(joint.residual_rms, 3),
                   report::number(100.0 * joint.relative, 3), report::number(100.0 * joint.held_out_relative, 3),
                   report::number(100.0 * joint.least_squares_relative, 3),
                   report::number(100.0 * joint.held_out_coverage, 3)});
  }
  return table;
}

report::Table parameters_table(const ArmIdentification& found) {
  report::Table table({{.title = "Joint", .align = report::Column::Align::left},
                       {.title = "Parameter", .align = report::Column::Align::left},
                       {.title = "Value"},
                       {.title = "95 % from"},
                       {.title = "to"},
                       {.title = "Unit", .align = report::Column::Align::left},
                       {.title = "Told by", .align = report::Column::Align::left}});
  for (const ArmJointFit& joint : found.joints) {
    for (const ArmParameter& p : joint.parameters) {
      table.add_row({joint.name, p.name, report::number(p.value, 4), report::number(p.lower, 4),
                     report::number(p.upper, 4), p.unit, p.told ? "recording" : "URDF"});
    }
  }
  return table;
}

std::string words_of(const ArmIdentification& found) {
  int told = 0;
  int all = 0;
  for (const ArmJointFit& joint : found.joints) {
    for (const ArmParameter& p : joint.parameters) {
      ++all;
      told += p.told ? 1 : 0;
    }
  }
  std::string text = report::number(found.duration_s, 3) + " s of free motion below " +
                     report::number(found.cutoff_Hz, 3) + " Hz. Torques depend on " +
                     std::to_string(found.base_parameters) +
                     " combinations of bodies and armatures; with friction the "
                     "recordings tell " +
                     std::to_string(found.told_combinations) + " combinations better than the URDF, and " +
                     std::to_string(told) + " of " + std::to_string(all) +
                     " single parameters. The others stay near the URDF: other values would give the same torques.";
  if (found.scaled_efforts) {
    double least = found.joints.front().effort_per_N_m;
    double most = least;
    for (const ArmJointFit& joint : found.joints) {
      least = std::min(least, joint.effort_per_N_m);
      most = std::max(most, joint.effort_per_N_m);
    }
    text += " Each joint's effort has a scale of its own, " + report::number(least, 3) + " to " +
            report::number(most, 3) + " for 1 N m, for which the masses of the URDF are taken.";
  }
  return text;
}

/// The three numbers of --gravity, or those of the URDF's world.
Result<arm::Gravity> gravity_of(const std::vector<double>& given) {
  if (given.empty()) return arm::Gravity{};
  const arm::Gravity gravity{given[0], given[1], given[2]};
  if (Check wrong = validate(gravity)) {
    Error error = *std::move(wrong);
    error.place = "--gravity";
    return error;
  }
  return gravity;
}

Check identify_arm(const IdentifyArmOptions& options, const std::string& command) {
  if (const auto output = OutputFolder::open(options.arm.output); !output) return output.error();
  const auto gravity = gravity_of(options.gravity);
  if (!gravity) return gravity.error();
  auto urdf = urdf::read(options.urdf, options.tip);
  if (!urdf) return urdf.error();
  urdf->params.gravity = *gravity;
  std::vector<ArmRecording> recordings;
  for (const std::string& file : options.files) {
    auto read = read_recordings(file, options.arm, urdf->joints);
    if (!read) return read.error();
    for (ArmRecording& recording : *read) recordings.push_back(std::move(recording));
  }
  const auto found = arm_identification::identify_arm(recordings, urdf->joints, urdf->params, options.cutoff_Hz);
  if (!found) return found.error();

  const report::Table joints = joints_table(*found, recordings.front().effort_unit);
  report::Page page("Dynamics of " + (urdf->name.empty() ? options.urdf : urdf->name));
  page.paragraph(words_of(*found));
  page.table(joints);
  page.table(parameters_table(*found));
  page.footer("tactus " + std::string(version()), command);
  return write_outcome(options.arm.output,
                       {.text = words_of(*found) + "\n\n" + joints.to_text(),
                        .json = json_of(options, *found),
                        .html = page.to_html(),
                        .figures = {}},
                       {{"model.toml", to_toml(found->model, command)}});
}

}  // namespace

void add_identify_arm(CLI::App& identify, const std::string& name, const std::string& command, int& status) {
  auto options = std::make_shared<IdentifyArmOptions>();
  CLI::App* verb = identify.add_subcommand("arm", "Dynamics of an arm from recordings of free motion of all joints");
  options->arm.output.own_files = {"model.toml"};
  verb->add_option("RECORDING", options->files,
                   "Recordings: .csv, .tsv, .txt, with or without header, or .mat; "
                   "or the log of a rig, whose follower is taken while it follows")
      ->required();
  verb->add_option("--urdf", options->urdf, "URDF of the arm")->required()->type_name("FILE");
  verb->add_option("--tip", options->tip, "Link at which the arm ends, where the URDF goes on or branches")
      ->type_name("LINK");
  verb->add_option("--gravity", options->gravity, "Free fall in the base's frame in m/s^2; 0,0,-9.81 if not given")
      ->type_name("X,Y,Z")
      ->delimiter(',')
      ->expected(3);
  add_arm_options(*verb, options->arm, command, "Folder for model.toml, report.html and results.json");
  verb->add_option("--cutoff-Hz", options->cutoff_Hz, "Cutoff of the zero-phase filter")
      ->type_name("HZ")
      ->check(real_between(0.1, 500.0));
  verb->callback([options, name, &command, &status] {
    if (const auto error = identify_arm(*options, command)) {
      std::cerr << name << ": " << describe(*error) << "\n";
      status = exit_status(*error);
    }
  });
}

}  // namespace tactus::cli
