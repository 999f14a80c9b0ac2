#include <tactus/arm_identification/external_torque.hpp>
#include <tactus/cli/arm_options.hpp>
#include <tactus/cli/estimate.hpp>
#include <tactus/cli/outcome_files.hpp>
#include <tactus/cli/streams.hpp>
#include <tactus/core/version.hpp>
#include <tactus/report/json.hpp>
#include <tactus/report/page.hpp>
#include <tactus/report/table.hpp>
#include <tactus/report/text.hpp>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using arm_identification::ArmContact;
using arm_identification::ArmJointResidual;
using arm_identification::ArmModel;
using arm_identification::ExternalTorque;

struct EstimateTorqueOptions {
  ArmOptions arm;
  std::string file;
  std::string model;
};

std::string json_of(const EstimateTorqueOptions& options, const ArmModel& model, const ExternalTorque& found) {
  using Json = nlohmann::ordered_json;
  Json document{{"recording", options.file},
                {"model", options.model},
                {"cutoff_Hz", model.head.cutoff_Hz},
                {"causal", false},
                {"sign", "torque of the environment on the arm, positive toward +position"},
                {"joints", Json::array()},
                {"contacts", Json::array()}};
  for (std::size_t j = 0; j < found.joints.size(); ++j) {
    const ArmJointResidual& joint = found.joints[j];
    document["joints"].push_back({{"name", joint.name},
                                  {"effort_rms", joint.effort_rms},
                                  {"residual_rms", joint.residual_rms},
                                  {"relative", joint.relative},
                                  {"peak_external_N_m", joint.peak_external_N_m},
                                  {"contact_threshold_N_m", model.joints[j].contact_threshold_N_m}});
  }
  for (const ArmContact& contact : found.contacts) {
    document["contacts"].push_back({{"from_s", contact.from_s}, {"to_s", contact.to_s}, {"joints", contact.joints}});
  }
  return report::json_text(document);
}

/// A column for each joint.
std::string csv_of(const ExternalTorque& found) {
  std::string text = "time_s";
  for (const ArmJointResidual& joint : found.joints) text += ",\"" + joint.name + "_N_m\"";
  text += "\n";
  char buffer[40];
  for (std::size_t i = 0; i < found.time_s.size(); ++i) {
    std::snprintf(buffer, sizeof buffer, "%.6f", found.time_s[i]);
    text += buffer;
    for (Eigen::Index j = 0; j < found.torque_N_m.cols(); ++j) {
      std::snprintf(buffer, sizeof buffer, ",%.9g", found.torque_N_m(static_cast<Eigen::Index>(i), j));
      text += buffer;
    }
    text += "\n";
  }
  return text;
}

report::Table contacts_table(const ExternalTorque& found) {
  report::Table table({{.title = "Contact from", .unit = "s"},
                       {.title = "to", .unit = "s"},
                       {.title = "Joints", .align = report::Column::Align::left}});
  for (const ArmContact& contact : found.contacts) {
    std::string joints;
    for (const std::string& joint : contact.joints) joints += (joints.empty() ? "" : ", ") + joint;
    table.add_row({report::number(contact.from_s, 4), report::number(contact.to_s, 4), joints});
  }
  return table;
}

Check estimate_torque(const EstimateTorqueOptions& options, const std::string& command) {
  if (const auto output = OutputFolder::open(options.arm.output); !output) return output.error();
  const auto model = arm_identification::load_arm_model(options.model);
  if (!model) return model.error();
  std::vector<std::string> names;
  for (const auto& joint : model->joints) names.push_back(joint.name);
  const auto recordings = read_recordings(options.file, options.arm, names);
  if (!recordings) return recordings.error();
  if (recordings->size() > 1) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = {},
                 .message = "the follower followed in " + std::to_string(recordings->size()) +
                            " stretches, and one is taken: arm once, and record it anew",
                 .place = options.file};
  }
  const arm_identification::ArmRecording* const recording = &recordings->front();
  const auto found = arm_identification::estimate_external_torque(*model, *recording);
  if (!found) return found.error();

  report::Table joints({{.title = "Joint", .align = report::Column::Align::left},
                        {.title = "Effort rms", .unit = recording->effort_unit},
                        {.title = "Left in free motion", .unit = "%"},
                        {.title = "Peak external", .unit = "N m"},
                        {.title = "Threshold", .unit = "N m"}});
  for (std::size_t j = 0; j < names.size(); ++j) {
    const ArmJointResidual& joint = found->joints[j];
    joints.add_row({joint.name, report::number(joint.effort_rms, 3), report::number(100.0 * joint.relative, 3),
                    report::number(joint.peak_external_N_m, 3),
                    report::number(model->joints[j].contact_threshold_N_m, 3)});
  }
  const report::Table contacts = contacts_table(*found);
  const std::size_t count = found->contacts.size();
  const std::string verdict = count == 0   ? std::string("No contact found.")
                              : count == 1 ? std::string("One contact found.")
                                           : std::to_string(count) + " contacts found.";
  report::Page page("External torque, " + options.file);
  page.paragraph(verdict);
  page.table(joints);
  if (!found->contacts.empty()) page.table(contacts);
  report::Panel panel{.title = "Torque of the environment on the arm",
                      .x = {.label = "time", .unit = "s"},
                      .y = {.label = "torque", .unit = "N m"},
                      .lines = {},
                      .rules = {}};
  for (std::size_t j = 0; j < names.size(); ++j) {
    const auto column = found->torque_N_m.col(static_cast<Eigen::Index>(j));
    panel.lines.push_back({.name = names[j],
                           .x = found->time_s,
                           .y = std::vector<double>(column.begin(), column.end()),
                           .colour = static_cast<int>(j)});
  }
  page.figure({.title = "External torque", .caption = "Zero-phase, below the cutoff.", .panels = {panel}});
  page.footer("tactus " + std::string(version()), command);
  const std::string text =
      verdict + "\n\n" + joints.to_text() + (found->contacts.empty() ? std::string() : contacts.to_text());
  return write_outcome(options.arm.output,
                       {.text = text, .json = json_of(options, *model, *found), .html = page.to_html(), .figures = {}},
                       {{"external_torque.csv", csv_of(*found)}});
}

}  // namespace

void add_estimate_torque(CLI::App& estimate, const std::string& name, const std::string& command, int& status) {
  auto options = std::make_shared<EstimateTorqueOptions>();
  CLI::App* verb = estimate.add_subcommand("torque", "What pushes on the joints of an arm, and when");
  options->arm.output.own_files = {"external_torque.csv"};
  verb->add_option("RECORDING", options->file,
                   "Recording: .csv, .tsv, .txt, with or without header, or .mat; "
                   "or the log of a rig, whose follower is taken while it follows")
      ->required();
  verb->add_option("--model", options->model, "Model file, as `identify arm --out` leaves it")
      ->required()
      ->type_name("FILE");
  add_arm_options(*verb, options->arm, command, "Folder for external_torque.csv, report.html and results.json");
  verb->callback([options, name, &command, &status] {
    if (const auto error = estimate_torque(*options, command)) {
      status = report_error(name, *error);
    }
  });
}

}  // namespace tactus::cli
