// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/identification/arm/fit.hpp>
#include <tactus/interfaces/cli/arm_options.hpp>
#include <tactus/interfaces/cli/identify.hpp>
#include <tactus/interfaces/cli/internal/parameters_json.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/progress_line.hpp>
#include <tactus/interfaces/cli/real_between.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/version.hpp>

#include <algorithm>
#include <cmath>
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
  ArmUrdfOptions urdf;
  std::optional<double> cutoff_Hz;
  bool free_scales = false;
};

std::string json_of(const IdentifyArmOptions& options, const ArmIdentification& found) {
  using Json = nlohmann::ordered_json;
  Json document{
      {"recordings", options.files},
      {"urdf", options.urdf.file},
      {"duration_s", found.duration_s},
      {"cutoff_Hz", found.cutoff_Hz},
      {"scaled_efforts", found.scaled_efforts},
      {"base_parameters", found.base_parameters},
      {"determined_combinations", found.determined_combinations},
      {"gravity_m_per_s2",
       {found.model.head.gravity.x_m_per_s2, found.model.head.gravity.y_m_per_s2, found.model.head.gravity.z_m_per_s2}},
      {"payload_kg", found.payload ? Json(found.payload->mass_kg) : Json(nullptr)},
      {"payload_centre_m",
       found.payload ? Json({found.payload->centre_m.x(), found.payload->centre_m.y(), found.payload->centre_m.z()})
                     : Json(nullptr)},
      {"warnings", found.warnings},
      {"joints", Json::array()}};
  for (const ArmJointFit& joint : found.joints) {
    document["joints"].push_back({{"name", joint.name},
                                  {"effort_rms", joint.effort_rms},
                                  {"residual_rms", joint.residual_rms},
                                  {"relative", joint.relative},
                                  {"held_out_relative", joint.held_out_relative},
                                  {"least_squares_held_out_relative", joint.least_squares_relative},
                                  {"held_out_coverage_95", joint.held_out_coverage},
                                  {"effort_per_N_m", joint.effort_per_N_m},
                                  {"scale_determined", joint.scale_determined},
                                  {"parameters", parameters_json(joint.parameters)}});
  }
  return report::json_text(document);
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
                       {.title = "Determined by", .align = report::Column::Align::left}});
  for (const ArmJointFit& joint : found.joints) {
    for (const ArmParameter& p : joint.parameters) {
      table.add_row({joint.name, p.name, report::number(p.value, 4), report::number(p.lower, 4),
                     report::number(p.upper, 4), p.unit, p.determined ? "recording" : "URDF"});
    }
  }
  return table;
}

/// What the recordings do not tell of each joint.
report::Table untold_table(const ArmIdentification& found) {
  report::Table table({{.title = "Joint", .align = report::Column::Align::left},
                       {.title = "Not determined, so as in the URDF", .align = report::Column::Align::left}});
  for (const ArmJointFit& joint : found.joints) {
    std::string names;
    for (const ArmParameter& p : joint.parameters) {
      if (!p.determined) names += (names.empty() ? "" : ", ") + p.name;
    }
    table.add_row({joint.name, names.empty() ? "nothing" : names});
  }
  return table;
}

std::string words_of(const ArmIdentification& found, bool free_gravity) {
  int told = 0;
  int all = 0;
  for (const ArmJointFit& joint : found.joints) {
    for (const ArmParameter& p : joint.parameters) {
      ++all;
      told += p.determined ? 1 : 0;
    }
  }
  std::string text = report::number(found.duration_s, 3) + " s of free motion below " +
                     report::number(found.cutoff_Hz, 3) + " Hz. Torques depend on " +
                     std::to_string(found.base_parameters) +
                     " combinations of bodies and armatures; with friction the "
                     "recordings determine " +
                     std::to_string(found.determined_combinations) + " combinations better than the URDF, and " +
                     std::to_string(told) + " of " + std::to_string(all) +
                     " single parameters. The others stay near the URDF: other values would give the same torques. "
                     "`identify excitation` designs a motion that determines more.";
  if (found.scaled_efforts) {
    std::string scaled;
    for (const ArmJointFit& joint : found.joints) {
      if (std::fabs(joint.effort_per_N_m - 1.0) < 1e-6) continue;  // known
      scaled += (scaled.empty() ? "" : ", ") + joint.name + " " + report::number(joint.effort_per_N_m, 3) +
                (joint.scale_determined ? "" : " (not identifiable: assumed near the others')");
    }
    text +=
        " Efforts have scales of their own, for which the masses of the URDF are taken: for 1 N m at " + scaled + ".";
  }
  if (found.payload) {
    const arm_identification::Payload& payload = *found.payload;
    const auto mm = [](double metres) { return report::number(1e3 * metres, 2); };
    text += " A mass of " + report::number(payload.mass_kg, 2) +
            " kg that the URDF lacks would explain the efforts, at " + mm(payload.centre_m.x()) + ", " +
            mm(payload.centre_m.y()) + ", " + mm(payload.centre_m.z()) +
            " mm in the frame of the last link: the URDF's bodies leave " + report::number(100.0 * payload.left, 2) +
            " % of the effort at the worst joint with it, and " + report::number(100.0 * payload.left_without, 2) +
            " % without it. The identified body of the last link includes it.";
  }
  if (free_gravity) {
    text +=
        " Gravity found: " + arm_identification::text_of(found.model.head.gravity) + " m/s^2 in the frame of the base.";
  }
  for (const std::string& warning : found.warnings) text += "\nWarning: " + warning + ".";
  return text;
}

/// What a URDF has no place for, as `run --with` takes it.
std::string armatures_of(const arm_identification::ArmModel& model, const std::string& command) {
  std::string text =
      "# " + command +
      "\n# For `tactus run --with`: the inertia of each motor, in addition to arm.urdf.\n\n[arm.joints]\n";
  for (std::size_t j = 0; j < model.joints.size(); ++j) {
    text += "joint_" + std::to_string(j + 1) +
            " = { armature_kg_m2 = " + format_number(model.joints[j].arm.drive.armature_kg_m2) + " }\n";
  }
  return text;
}

Check identify_arm(const IdentifyArmOptions& options, const std::string& command) {
  if (const auto output = OutputFolder::open(options.arm.output); !output) return output.error();
  const auto urdf = read_arm_urdf(options.urdf);
  if (!urdf) return urdf.error();
  std::vector<ArmRecording> recordings;
  for (const std::string& file : options.files) {
    auto read = read_recordings(file, options.arm, urdf->joints);
    if (!read) return read.error();
    for (ArmRecording& recording : *read) recordings.push_back(std::move(recording));
  }
  const auto found = [&] {
    ProgressLine line("identify arm");
    return arm_identification::identify_arm(recordings, urdf->joints, urdf->params,
                                            {.cutoff_Hz = options.cutoff_Hz,
                                             .free_scales = options.free_scales,
                                             .free_gravity = options.urdf.gravity_is_free(),
                                             .progress = [&](double done) { line.update(done); }});
  }();
  if (!found) return found.error();

  urdf::Arm identified = *urdf;
  identified.params = found->model.chain();
  const auto described = urdf::with_dynamics(options.urdf.file, identified,
                                             "Bodies, damping and friction as tactus identified them; bodies include "
                                             "all that is fixed to a link. Armatures, offsets and other parts of "
                                             "friction are in model.toml.");
  if (!described) return described.error();

  const report::Table joints = joints_table(*found, recordings.front().effort_unit);
  const report::Table untold = untold_table(*found);
  const std::string words = words_of(*found, options.urdf.gravity_is_free());
  report::Page page("Dynamics of " + (urdf->name.empty() ? options.urdf.file : urdf->name));
  page.paragraph(words);
  page.table(joints);
  page.table(untold);
  page.table(parameters_table(*found));
  page.footer("tactus " + std::string(version()), command);
  return write_outcome(options.arm.output,
                       {.text = words + "\n\n" + joints.to_text() + "\n" + untold.to_text(),
                        .json = json_of(options, *found),
                        .html = page.to_html(),
                        .figures = {}},
                       {{"model.toml", to_toml(found->model, command)},
                        {"arm.urdf", *described},
                        {"armatures.toml", armatures_of(found->model, command)}});
}

}  // namespace

void add_identify_arm(CLI::App& identify, const std::string& name, const std::string& command, int& status) {
  auto options = std::make_shared<IdentifyArmOptions>();
  CLI::App* verb =
      identify.add_subcommand("arm", "Identify the dynamics of an arm from recordings of free motion of all joints");
  options->arm.output.own_files = {"model.toml", "arm.urdf", "armatures.toml"};
  verb->add_option("RECORDING", options->files,
                   "Recordings: .csv, .tsv, .txt, with or without header, or .mat; or a rig's log, of which the "
                   "follower's data while it follows the leader are used")
      ->required();
  add_arm_urdf_options(*verb, options->urdf, true);
  add_arm_options(*verb, options->arm, command,
                  "Folder for model.toml, arm.urdf, armatures.toml, report.html and results.json");
  verb->add_flag("--free-scales", options->free_scales,
                 "Identify the scale between effort and N m of each joint, even if the file states torques");
  verb->add_option("--cutoff-Hz", options->cutoff_Hz, "Cutoff of the zero-phase filter")
      ->type_name("HZ")
      ->check(real_between(0.1, 500.0));
  verb->callback([options, name, &command, &status] {
    if (const auto error = identify_arm(*options, command)) {
      status = report_error(name, *error);
    }
  });
}

}  // namespace tactus::cli
