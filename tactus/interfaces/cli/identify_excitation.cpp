// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/identification/arm/excitation.hpp>
#include <tactus/interfaces/cli/arm_options.hpp>
#include <tactus/interfaces/cli/identify.hpp>
#include <tactus/interfaces/cli/internal/parameters_json.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/progress_line.hpp>
#include <tactus/interfaces/cli/real_between.hpp>
#include <tactus/interfaces/cli/streams.hpp>
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

using arm_identification::ArmExcitation;
using arm_identification::ArmParameter;
using arm_identification::ExcitationRequest;
using arm_identification::ExcitedJoint;
using arm_identification::FourierMotion;
using arm_identification::MotionWorth;

constexpr double usual_noise = 0.01;  ///< of the limit of a joint's effort

struct ExcitationOptions {
  ArmUrdfOptions urdf;
  ExcitationRequest request;
  double rate_Hz = 100.0;
  std::vector<double> noise_N_m;
  std::optional<double> above_m;
  std::vector<double> box;
  std::vector<double> tool;
  OutputOptions output;
};

nlohmann::ordered_json worth_json(const MotionWorth& worth) {
  return {{"condition", worth.condition},
          {"information_nats", worth.information_nats},
          {"determined_combinations", worth.determined_combinations}};
}

std::string json_of(const ExcitationOptions& options, const ArmExcitation& found) {
  using Json = nlohmann::ordered_json;
  Json document{{"urdf", options.urdf.file},
                {"duration_s", options.request.duration_s},
                {"highest_Hz", options.request.highest_Hz},
                {"rate_Hz", options.rate_Hz},
                {"share", options.request.share},
                {"clearance_m", std::isfinite(found.clearance_m) ? Json(found.clearance_m) : Json(nullptr)},
                {"base_parameters", found.base_parameters},
                {"designed", worth_json(found.worth)},
                {"random", worth_json(found.random)},
                {"joints", Json::array()}};
  for (const ExcitedJoint& joint : found.joints) {
    document["joints"].push_back({{"name", joint.name},
                                  {"least_rad", joint.least},
                                  {"greatest_rad", joint.greatest},
                                  {"lower_limit_rad", joint.limits.lower_rad},
                                  {"upper_limit_rad", joint.limits.upper_rad},
                                  {"peak_velocity_rad_per_s", joint.velocity_rad_per_s},
                                  {"velocity_limit_rad_per_s", joint.limits.velocity_rad_per_s},
                                  {"peak_effort_N_m", joint.effort_N_m},
                                  {"effort_limit_N_m", joint.limits.effort_N_m},
                                  {"noise_N_m", joint.noise_N_m},
                                  {"parameters", parameters_json(joint.parameters)}});
  }
  return report::json_text(document);
}

/// A row for each instant, the start again at the end.
std::string csv_of(const ExcitationOptions& options, const std::vector<std::string>& joints,
                   const arm::Chain::Params& arm, const FourierMotion& motion) {
  std::string text = "time_s";
  for (const char* order : {"", "_per_s", "_per_s2"}) {
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const bool slides = arm.joints[j].kind == arm::JointKind::prismatic;
      text += ",\"" + joints[j] + (slides ? "_m" : "_rad") + order + "\"";
    }
  }
  text += "\n";
  const auto rows = std::lround(options.request.duration_s * options.rate_Hz);
  for (long i = 0; i <= rows; ++i) {
    const double time_s = static_cast<double>(i) / options.rate_Hz;
    text += report::fixed(time_s, 6);
    const FourierMotion::State state = motion.at(time_s);
    for (const arm::JointVector* values : {&state.position, &state.velocity, &state.acceleration}) {
      for (const double value : *values) text += "," + report::fixed(value, 9);
    }
    text += "\n";
  }
  return text;
}

std::string from_to(double from, double to) { return report::number(from, 3) + " to " + report::number(to, 3); }

std::string width_of(const ExcitedJoint& joint, const std::string& name) {
  const auto found = std::find_if(joint.parameters.begin(), joint.parameters.end(),
                                  [&](const ArmParameter& p) { return p.name == name; });
  return found == joint.parameters.end() ? std::string("-") : report::number(0.5 * (found->upper - found->lower), 2);
}

report::Table use_table(const ArmExcitation& found) {
  report::Table table({{.title = "Joint", .align = report::Column::Align::left},
                       {.title = "Moves", .unit = "rad"},
                       {.title = "Limits", .unit = "rad"},
                       {.title = "Speed", .unit = "rad/s"},
                       {.title = "Limit"},
                       {.title = "Torque", .unit = "N m"},
                       {.title = "Limit"},
                       {.title = "Noise", .unit = "N m"},
                       {.title = "Coulomb ±", .unit = "N m"},
                       {.title = "Viscous ±", .unit = "N m s/rad"},
                       {.title = "Armature ±", .unit = "kg m²"}});
  for (const ExcitedJoint& joint : found.joints) {
    table.add_row({joint.name, from_to(joint.least, joint.greatest),
                   from_to(joint.limits.lower_rad, joint.limits.upper_rad), report::number(joint.velocity_rad_per_s, 3),
                   report::number(joint.limits.velocity_rad_per_s, 3), report::number(joint.effort_N_m, 3),
                   report::number(joint.limits.effort_N_m, 3), report::number(joint.noise_N_m, 2),
                   width_of(joint, "coulomb"), width_of(joint, "viscous"), width_of(joint, "armature")});
  }
  return table;
}

report::Table promises_table(const ArmExcitation& found) {
  report::Table table({{.title = "Joint", .align = report::Column::Align::left},
                       {.title = "Parameter", .align = report::Column::Align::left},
                       {.title = "Believed"},
                       {.title = "95 % from"},
                       {.title = "to"},
                       {.title = "Unit", .align = report::Column::Align::left},
                       {.title = "Will be determined", .align = report::Column::Align::left}});
  for (const ExcitedJoint& joint : found.joints) {
    for (const ArmParameter& p : joint.parameters) {
      table.add_row({joint.name, p.name, report::number(p.value, 4), report::number(p.lower, 4),
                     report::number(p.upper, 4), p.unit, p.determined ? "yes" : "no"});
    }
  }
  return table;
}

std::string words_of(const ExcitationOptions& options, const ArmExcitation& found) {
  const int all = found.base_parameters + 3 * static_cast<int>(found.joints.size());
  std::string text =
      report::number(options.request.duration_s, 3) + " s from rest to rest, below " +
      report::number(options.request.highest_Hz, 3) + " Hz, within " +
      report::number(100.0 * options.request.share, 3) + " % of every limit. With this noise it will determine " +
      std::to_string(found.worth.determined_combinations) + " of " + std::to_string(all) +
      " combinations of bodies, armatures and friction better than the URDF does; a random motion "
      "within the same limits " +
      std::to_string(found.random.determined_combinations) + ". Condition number " +
      report::number(found.worth.condition, 3) + " (random: " + report::number(found.random.condition, 3) + ").";
  if (!found.searched) {
    text +=
        " No search ended within the limits, so this is the best of the random motions: another --seed, or a smaller "
        "--share, may find more.";
  }
  if (std::isfinite(found.clearance_m)) {
    text += " The frames of links and tool stay " + report::number(1e3 * found.clearance_m, 3) +
            " mm or more within the box.";
  }
  text +=
      " Bodies are not known, only their frames: see that the arm cannot touch itself or anything, go to the first row "
      "slowly, and play it at a quarter of its speed first.";
  return text;
}

Check identify_excitation(ExcitationOptions options, const std::string& name, const std::string& command) {
  if (const auto output = OutputFolder::open(options.output); !output) return output.error();
  const auto urdf = read_arm_urdf(options.urdf);
  if (!urdf) return urdf.error();
  ExcitationRequest& request = options.request;
  const std::size_t count = urdf->joints.size();
  for (std::size_t j = 0; j < count; ++j) {
    constexpr double no_range_rad = 1e6;
    const arm::JointParams& joint = urdf->params.joints[j];
    if (joint.kind != arm::JointKind::revolute || joint.limits.upper_rad < no_range_rad) continue;
    message_stream() << "Note: joint '" << urdf->joints[j] << "' states no range: -180° to 180° are assumed\n";
  }
  for (std::size_t j = 0; j < count; ++j) {
    request.noise_N_m.push_back(options.noise_N_m.empty()
                                    ? usual_noise * urdf->params.joints[j].limits.effort_N_m
                                    : options.noise_N_m[std::min(j, options.noise_N_m.size() - 1)]);
  }
  if (options.noise_N_m.size() > 1 && options.noise_N_m.size() != count) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = {},
                 .message = std::to_string(options.noise_N_m.size()) + " numbers, but the arm has " +
                            std::to_string(count) + " joints; give one for all or one for each",
                 .place = "--noise-N-m"};
  }
  for (const std::vector<urdf::LinkFrame>& body : urdf->frames) {
    std::vector<arm::Vector3>& points = request.points.emplace_back();
    for (const urdf::LinkFrame& frame : body) points.push_back(frame.origin_m);
  }
  if (!options.tool.empty()) request.points.back().emplace_back(options.tool[0], options.tool[1], options.tool[2]);
  for (Eigen::Index i = 0; i < 3 && !options.box.empty(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    request.box_lower_m[i] = std::min(options.box[at], options.box[at + 3]);
    request.box_upper_m[i] = std::max(options.box[at], options.box[at + 3]);
  }
  if (options.above_m) request.box_lower_m.z() = std::max(request.box_lower_m.z(), *options.above_m);
  ProgressLine line(name + " identify excitation");
  auto found = arm_identification::design_excitation(urdf->joints, urdf->params, request,
                                                     [&](double done) { line.update(done); });
  if (!found) {
    Error error = found.error();
    error.place = options.urdf.file;
    return error;
  }
  const std::string words = words_of(options, *found);
  const report::Table use = use_table(*found);
  report::Page page("Motion that determines most of " + (urdf->name.empty() ? options.urdf.file : urdf->name));
  page.paragraph(words);
  page.table(use);
  page.table(promises_table(*found));
  page.footer("tactus " + std::string(version()), command);
  return write_outcome(
      options.output,
      {.text = words + "\n\n" + use.to_text(), .json = json_of(options, *found), .html = page.to_html(), .figures = {}},
      {{"trajectory.csv", csv_of(options, urdf->joints, urdf->params, found->motion)}});
}

}  // namespace

void add_identify_excitation(CLI::App& identify, const std::string& name, const std::string& command, int& status) {
  auto options = std::make_shared<ExcitationOptions>();
  CLI::App* verb = identify.add_subcommand(
      "excitation", "Design the motion to record for `identify arm`, within the limits of the arm");
  options->output.own_files = {"trajectory.csv"};
  add_arm_urdf_options(*verb, options->urdf, false);
  verb->add_option("--duration-s", options->request.duration_s, "Duration of the motion, from rest to rest")
      ->type_name("S")
      ->check(real_between(1.0, 600.0))
      ->capture_default_str();
  verb->add_option("--highest-Hz", options->request.highest_Hz, "Highest frequency of the positions")
      ->type_name("HZ")
      ->check(real_between(0.01, 5.0))
      ->capture_default_str();
  verb->add_option("--rate-Hz", options->rate_Hz, "Rows of trajectory.csv per second")
      ->type_name("HZ")
      ->check(real_between(1.0, 4000.0))
      ->capture_default_str();
  verb->add_option("--share", options->request.share, "Share of the range, velocity and effort of each joint to use")
      ->type_name("SHARE")
      ->check(real_between(0.05, 1.0))
      ->capture_default_str();
  verb->add_option("--noise-N-m", options->noise_N_m,
                   "Expected RMS error of the efforts, one for all joints or one for each; 1 % of the limits if "
                   "not given")
      ->type_name("N_M")
      ->delimiter(',')
      ->check(real_between(1e-9, 1e6));
  verb->add_option("--above-m", options->above_m, "Keep links and tool above this height along z of the base")
      ->type_name("Z")
      ->check(real_between(-100.0, 100.0));
  verb->add_option("--box-m", options->box, "Keep them in this box of the base's frame, given by two corners")
      ->type_name("X,Y,Z,X,Y,Z")
      ->delimiter(',')
      ->expected(6)
      ->check(real_between(-100.0, 100.0));
  verb->add_option("--tool-m", options->tool, "A further point, in the frame of the last link, to keep there")
      ->type_name("X,Y,Z")
      ->delimiter(',')
      ->expected(3)
      ->check(real_between(-100.0, 100.0));
  verb->add_option("--seed", options->request.seed, "Seed of the search")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  add_output_options(*verb, options->output, command, "Folder for trajectory.csv, report.html and results.json");
  verb->callback([options, name, &command, &status] {
    if (const auto error = identify_excitation(*options, name, command)) {
      status = report_error(name, *error);
    }
  });
}

}  // namespace tactus::cli
