// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/identification/arm/external_torque.hpp>
#include <tactus/interfaces/cli/arm_options.hpp>
#include <tactus/interfaces/cli/estimate.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/kernel/core/version.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using arm_identification::ArmContact;
using arm_identification::ArmContactTorque;
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
                {"false_contacts_per_hour", arm_identification::false_contacts_per_hour(model)},
                {"stretches", found.stretches.size()},
                {"left_out_s", found.left_out_s},
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
    Json names = Json::array(), torques = Json::array();
    for (const ArmContactTorque& joint : contact.joints) {
      names.push_back(joint.joint);
      torques.push_back({{"joint", joint.joint}, {"mean_N_m", joint.mean_N_m}, {"within_N_m", joint.within_N_m}});
    }
    document["contacts"].push_back(
        {{"from_s", contact.from_s}, {"to_s", contact.to_s}, {"joints", names}, {"torques", torques}});
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
                       {.title = "Joints: mean torque", .unit = "N m", .align = report::Column::Align::left}});
  for (const ArmContact& contact : found.contacts) {
    std::string joints;
    for (const ArmContactTorque& joint : contact.joints) {
      joints += (joints.empty() ? "" : ", ") + joint.joint + " " + report::number(joint.mean_N_m, 3) + " ± " +
                report::number(joint.within_N_m, 2);
    }
    table.add_row({report::number(contact.from_s, 4), report::number(contact.to_s, 4), joints});
  }
  return table;
}

/// How often nothing is taken for a contact, and what was left out.
std::string rate_text(const ArmModel& model, const ExternalTorque& found) {
  std::string text =
      "If what the model leaves is Gaussian noise, less than " +
      report::number(arm_identification::false_contacts_per_hour(model), 2) +
      " contacts an hour are false. Dry friction may hide the torque on a joint at rest, so the threshold "
      "of such a joint is higher by its dry friction.";
  if (found.stretches.size() > 1) {
    text += " The arm followed in " + std::to_string(found.stretches.size()) + " stretches, one after the other.";
  }
  if (found.left_out_s > 0.0) {
    text += " Stretches of " + report::number(found.left_out_s, 3) +
            " s in all are too short for the filter and were left out.";
  }
  return text;
}

/// A panel for each stretch, so that no line crosses the pause between two. Of very many, the first.
std::vector<report::Panel> panels_of(const ExternalTorque& found, const std::vector<std::string>& names) {
  constexpr std::size_t most_panels = 8;
  std::vector<report::Panel> panels;
  for (std::size_t i = 0; i < std::min(most_panels, found.stretches.size()); ++i) {
    const std::size_t first = found.stretches[i];
    const std::size_t end = i + 1 < found.stretches.size() ? found.stretches[i + 1] : found.time_s.size();
    report::Panel panel{.title = found.stretches.size() == 1 ? "Torque of the environment on the arm"
                                                             : "Stretch " + std::to_string(i + 1),
                        .x = {.label = "time", .unit = "s"},
                        .y = {.label = "torque", .unit = "N m"},
                        .lines = {},
                        .rules = {}};
    for (std::size_t j = 0; j < names.size(); ++j) {
      const auto column = found.torque_N_m.col(static_cast<Eigen::Index>(j))
                              .segment(static_cast<Eigen::Index>(first), static_cast<Eigen::Index>(end - first));
      panel.lines.push_back({.name = names[j],
                             .x = {found.time_s.begin() + static_cast<std::ptrdiff_t>(first),
                                   found.time_s.begin() + static_cast<std::ptrdiff_t>(end)},
                             .y = std::vector<double>(column.begin(), column.end()),
                             .colour = static_cast<int>(j)});
    }
    panels.push_back(std::move(panel));
  }
  return panels;
}

Check estimate_torque(const EstimateTorqueOptions& options, const std::string& command) {
  if (const auto output = OutputFolder::open(options.arm.output); !output) return output.error();
  const auto model = arm_identification::load_arm_model(options.model);
  if (!model) return model.error();
  std::vector<std::string> names;
  for (const auto& joint : model->joints) names.push_back(joint.name);
  const auto recordings = read_recordings(options.file, options.arm, names);
  if (!recordings) return recordings.error();
  const auto found = arm_identification::estimate_external_torque(*model, *recordings);
  if (!found) return found.error();

  report::Table joints({{.title = "Joint", .align = report::Column::Align::left},
                        {.title = "Effort rms", .unit = recordings->front().effort_unit},
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
  const std::string rate = rate_text(*model, *found);
  report::Page page("External torque, " + options.file);
  page.paragraph(verdict);
  page.paragraph(rate);
  page.table(joints);
  if (!found->contacts.empty()) page.table(contacts);
  page.figure({.title = "External torque",
               .caption = "Torque of the environment on the arm: zero-phase, below the cutoff.",
               .panels = panels_of(*found, names)});
  page.footer("tactus " + std::string(version()), command);
  const std::string text = verdict + "\n" + rate + "\n\n" + joints.to_text() +
                           (found->contacts.empty() ? std::string() : contacts.to_text());
  return write_outcome(options.arm.output,
                       {.text = text, .json = json_of(options, *model, *found), .html = page.to_html(), .figures = {}},
                       {{"external_torque.csv", csv_of(*found)}});
}

}  // namespace

void add_estimate_torque(CLI::App& estimate, const std::string& name, const std::string& command, int& status) {
  auto options = std::make_shared<EstimateTorqueOptions>();
  CLI::App* verb = estimate.add_subcommand("torque", "Estimate the external torques on the joints of an arm");
  options->arm.output.own_files = {"external_torque.csv"};
  verb->add_option("RECORDING", options->file,
                   "Recording: .csv, .tsv, .txt, with or without header, or .mat; "
                   "or the log of a rig (the follower, while it follows)")
      ->required();
  verb->add_option("--model", options->model, "Model file, written by `identify arm --out`")
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
