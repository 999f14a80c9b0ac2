// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/data/report/json.hpp>
#include <tactus/data/report/page.hpp>
#include <tactus/data/report/table.hpp>
#include <tactus/data/report/text.hpp>
#include <tactus/identification/axis/cancellation_model.hpp>
#include <tactus/identification/axis/isolation.hpp>
#include <tactus/identification/axis/isolation_figures.hpp>
#include <tactus/identification/axis/quick.hpp>
#include <tactus/identification/axis/session.hpp>
#include <tactus/interfaces/cli/identify.hpp>
#include <tactus/interfaces/cli/outcome_files.hpp>
#include <tactus/interfaces/cli/progress_line.hpp>
#include <tactus/interfaces/cli/streams.hpp>
#include <tactus/kernel/core/version.hpp>
#include <tactus/simulation/teleoperator/simulated_rig.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

namespace tactus::cli {

namespace {

using identification::FoundParameter;
using identification::ImpactCheck;
using identification::Isolation;
using identification::SessionRig;
using simulation::SimulatedRig;

/// The verbs that put a master on a bench, apart by how they identify it.
struct Recipe {
  const char* verb;
  const char* description;
  const char* title;
  const char* explanation;
  Result<Isolation> (*identify)(identification::Rig& rig, const identification::IsolationProgress& progress);
};

constexpr Recipe by_isolation{
    "isolate", "Identify a leader on the bench part by part (successive isolation)", "Successive isolation",
    "Found from the motor outward, each stage with what the earlier ones found. The intervals hold what the residuals "
    "of a stage leave open and what the earlier stages did not know.",
    [](identification::Rig& rig, const identification::IsolationProgress& progress) {
      return identification::isolate(rig, {}, progress);
    }};
constexpr Recipe in_the_hand{
    "quick", "Identify a leader in the operator's hand within a minute, without taking it apart",
    "Quick identification",
    "Found from sweeps and bursts on the held master, the whole chain at once, each value drawn to its data sheet as "
    "much as that is trusted. What the data do not determine keeps the value of the data sheet.",
    [](identification::Rig& rig, const identification::IsolationProgress& progress) {
      return identification::identify_quickly(rig, {}, progress);
    }};

/// The largest force that teleoperation will display, and how far the model lets it move the hand.
constexpr double full_force_N = 1.0, full_deflection_m = 2e-3;

struct BenchOptions {
  std::string rig;
  std::int64_t seed = 1;
  std::optional<std::string> session;
  OutputOptions output;
};

/// `model.toml`: what `tactus run --with` loads.
struct ModelFile {
  struct Control {
    control::MasterModel model;
    static constexpr auto fields() { return List{field("model", &Control::model, "The controller's model.")}; }
  };
  Control control;
  static constexpr auto fields() { return List{field("control", &ModelFile::control, "The controllers.")}; }
};

/// Asks for the mechanical steps, one at a time: here of a rig that takes them by itself.
class AnnouncedRig final : public identification::Rig {
 public:
  explicit AnnouncedRig(Rig& rig) : rig_(rig) {}
  [[nodiscard]] std::string name() const override { return rig_.name(); }
  [[nodiscard]] double tick_s() const override { return rig_.tick_s(); }
  [[nodiscard]] identification::RigLimits limits() const override { return rig_.limits(); }
  Check assemble(identification::Assembly assembly) override {
    if (standing_ != assembly) {
      message_stream() << rig_.name() << ": " << identification::instruction(assembly) << " Done by itself.\n";
    }
    standing_ = assembly;
    return rig_.assemble(assembly);
  }
  Result<identification::RigRun> run(const identification::MotorProgram& program) override { return rig_.run(program); }

 private:
  Rig& rig_;
  std::optional<identification::Assembly> standing_;
};

std::string json_of(const Isolation& isolation, const ImpactCheck& check, const SimulatedRig& rig) {
  using Json = nlohmann::ordered_json;
  Json document{{"rig", rig.name()}, {"parameters", Json::array()}};
  for (const FoundParameter& parameter : isolation.parameters) {
    Json entry{{"name", parameter.name},
               {"value", parameter.value},
               {"unit", parameter.unit},
               {"interval_95", parameter.interval_95},
               {"determined", parameter.determined}};
    if (const auto truth = rig.truth(parameter.name)) entry["truth"] = *truth;
    document["parameters"].push_back(std::move(entry));
  }
  document["correlation"] = Json::array();
  for (std::size_t i = 0; i < isolation.parameters.size(); ++i) {
    const auto row = isolation.correlation.begin() + static_cast<std::ptrdiff_t>(i * isolation.parameters.size());
    document["correlation"].push_back(
        std::vector<double>(row, row + static_cast<std::ptrdiff_t>(isolation.parameters.size())));
  }
  document["stages"] = Json::array();
  for (const auto& stage : isolation.stages) {
    document["stages"].push_back({{"name", stage.title}, {"residual_rms_m", stage.residual_rms_m}});
  }
  document["impact_residual"] = check.residual;
  return report::json_text(document);
}

report::Table table_of(const Isolation& isolation, const SimulatedRig& rig) {
  using Align = report::Column::Align;
  report::Table table({{"parameter", "", Align::left},
                       {"value"},
                       {"95 % from"},
                       {"to"},
                       {"unit", "", Align::left},
                       {"", "", Align::left},
                       {"truth"}},
                      "Master of " + rig.name());
  for (const FoundParameter& parameter : isolation.parameters) {
    const auto truth = rig.truth(parameter.name);
    table.add_row({parameter.name, report::number(parameter.value, 4), report::number(parameter.interval_95[0], 4),
                   report::number(parameter.interval_95[1], 4), parameter.unit,
                   parameter.determined ? "" : "not determined by the data", truth ? report::number(*truth, 4) : "–"});
  }
  return table;
}

report::Page page_of(const Recipe& recipe, const Isolation& isolation, const ImpactCheck& check, const std::string& rig,
                     const std::string& verdict, const std::string& model, const report::Table& table,
                     const std::string& command) {
  report::Page page(std::string(recipe.title) + " of " + rig);
  page.paragraph(verdict);
  page.table(table);
  page.paragraph(recipe.explanation);
  for (const report::Figure& figure : figures(isolation)) page.figure(figure);
  page.figure(figure(check));
  page.code(model, "model.toml, for tactus run --with");
  page.footer("tactus " + std::string(version()), command);
  return page;
}

Check identify(const Recipe& recipe, const BenchOptions& options, const std::string& command) {
  if (options.rig != "simulated") {
    return Error{ErrorCode::out_of_bounds, {}, "'" + options.rig + "' is no rig: there is simulated", "--rig"};
  }
  auto rig = SimulatedRig::make(simulation::draw_rig(options.seed));
  if (!rig) return rig.error();
  auto output = OutputFolder::open(options.output);
  if (!output) return output.error();
  AnnouncedRig announced(*rig);
  identification::Rig* bench = &announced;
  std::optional<SessionRig> session;
  if (options.session) {
    auto opened = SessionRig::open(announced, *options.session);
    if (!opened) return opened.error();
    bench = &session.emplace(*std::move(opened));
  }

  ProgressLine line(recipe.verb);
  const auto isolation = recipe.identify(*bench, [&line](const std::string&, double done) { line.update(done); });
  if (!isolation) return isolation.error();
  ModelFile model;
  model.control.model = identification::model_for_cancellation(isolation->found, full_force_N, full_deflection_m);
  const auto check = identification::check_on_impacts(*bench, model.control.model, full_force_N);
  if (!check) return check.error();

  const report::Table table = table_of(*isolation, *rig);
  const std::string verdict =
      "Of what impacts induce above 20 Hz, the model leaves " + report::number(100.0 * check->residual, 2) + " %.";
  const std::string model_text = "# " + command + "\n" + configuration::to_toml(model);
  return write_outcome(
      *output,
      {.text = verdict + "\n\n" + table.to_text(),
       .json = json_of(*isolation, *check, *rig),
       .html = page_of(recipe, *isolation, *check, rig->name(), verdict, model_text, table, command).to_html(),
       .figures = {}},
      {{"model.toml", model_text},
       {"rig.toml", "# The truth behind " + rig->name() + "\n" + configuration::to_toml(rig->truth().benched)}});
}

void add_bench_command(CLI::App& identify_command, const Recipe& recipe, const std::string& name,
                       const std::string& command, int& status) {
  auto options = std::make_shared<BenchOptions>();
  CLI::App* verb = identify_command.add_subcommand(recipe.verb, recipe.description);
  verb->add_option("--rig", options->rig, "Rig on the bench: simulated")->required()->type_name("RIG");
  verb->add_option("--seed", options->seed, "Number of the simulated rig")->check(CLI::NonNegativeNumber);
  verb->add_option("--session", options->session,
                   "Folder that keeps every run, so that you can stop and continue later")
      ->type_name("DIR");
  options->output.own_files = {"model.toml", "rig.toml"};
  add_output_options(*verb, options->output, command, "Folder for report.html, results.json, model.toml and rig.toml");
  verb->callback([&recipe, options, name, &command, &status] {
    if (const auto error = identify(recipe, *options, command)) {
      status = report_error(name, *error);
    }
  });
}

}  // namespace

void add_identify_bench(CLI::App& identify_command, const std::string& name, const std::string& command, int& status) {
  add_bench_command(identify_command, by_isolation, name, command, status);
  add_bench_command(identify_command, in_the_hand, name, command, status);
}

}  // namespace tactus::cli
