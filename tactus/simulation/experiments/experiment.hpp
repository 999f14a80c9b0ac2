// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/configuration/document.hpp>
#include <tactus/data/configuration/toml_writer.hpp>
#include <tactus/data/report/figure.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/simulation/tasks/task.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace tactus::experiments {

/// One key and the values that it takes in turn: `--vary control.force_gain=1,3,5`.
struct Variation {
  std::string key;
  std::vector<std::string> values;
};

/// Reads `key=a,b,c`. Errors: `syntax` without a key, without `=`, or with an empty value.
Result<Variation> parse_variation(std::string_view text);

/// One value of each varied key, in the order of the variations.
using Settings = std::vector<std::pair<std::string, std::string>>;

/// Every combination, the first key slowest. One empty combination without variations. Errors: `inconsistent` for a key
/// that is varied twice and for more than 100,000 combinations.
Result<std::vector<Settings>> combinations(const std::vector<Variation>& variations);

/// What a run needs to know.
struct Request {
  configuration::Document document;
  std::vector<Variation> variations;
  std::string name;     ///< of the experiment's file, for titles
  std::string command;  ///< that repeats the run, for the report
  /// Where a kind that `has_tasks` runs them. Others run in threads of this process.
  tasks::Place place = {};
};

/// One run that the figures show, every tick of it, for the log.
struct Trace {
  Settings settings;
  std::vector<simulation::Teleoperator::Record> records;
};

/// What came out, for every reader.
struct Outcome {
  std::string text;                     ///< tables for a terminal
  std::string json;                     ///< one document
  std::string html;                     ///< a self-contained report
  std::vector<report::Figure> figures;  ///< those of the report
  std::vector<Trace> traces = {};       ///< in the order of the table; none where an experiment has no teleoperator
  std::string configuration = {};       ///< of the first combination, as TOML
  /// Of the first combination, as a table that `tactus diagnose` reads; empty where a kind leaves traces or nothing.
  std::string recording = {};
};

/// Called now and then with the share of the work that is done, from 0 to 1.
using Progress = std::function<void(double)>;

/// One kind of experiment, chosen by `task.kind`.
class Experiment {
 public:
  virtual ~Experiment() = default;
  [[nodiscard]] virtual std::string_view kind() const = 0;
  /// JSON Schema of its files.
  [[nodiscard]] virtual std::string schema() const = 0;
  /// Reference page of its files, in Markdown.
  [[nodiscard]] virtual std::string reference() const = 0;
  /// Whether `run` does its work as tasks at `Request::place`: it continues where a killed run ended, and several
  /// processes share the work.
  [[nodiscard]] virtual bool has_tasks() const { return false; }
  /// Checks every combination before the first is run. Errors carry the place of the value that caused them. In a
  /// process that does not lead, the outcome of a kind that `has_tasks` is empty.
  [[nodiscard]] virtual Result<Outcome> run(const Request& request, const Progress& progress) const = 0;
};

/// Every kind there is, those of this library first.
std::span<const std::unique_ptr<const Experiment>> experiments();

/// Adds a kind. Call it before the command runs, from one thread. A second one of the same `kind()` takes the place of
/// the first.
void register_experiment(std::unique_ptr<const Experiment> experiment);

/// The kind that a document asks for. Errors: `missing` without `task.kind`, `out_of_bounds` for an unknown kind.
Result<const Experiment*> choose_experiment(const configuration::Document& document);

/// `inconsistent` for a request that varies keys, of a kind that has no use for that: `message` states what to do
/// instead.
Check refuse_variations(const Request& request, std::string message);

/// A combination with its content made, ready to run.
template <class Prepared>
struct Case {
  Settings settings;
  Prepared prepared;
};

/// Every combination, none of them run yet, and the whole configuration of the first as TOML.
template <class Prepared>
struct Cases {
  std::vector<Case<Prepared>> all;
  std::string first_configuration;
};

/// The error with the option that an operator wrote as its place: a varied value is tried as an override, and the
/// document calls every override `--set`.
Error blame_variation(Error error, const Settings& settings);

/// The error of a combination's run with the place where what it names was written.
Error locate_in(const Request& request, const Settings& settings, const Error& error);

/// Reads the parameters of each combination as `Params` and turns them into a `Prepared` with `prepare`, which returns
/// a `Result`, before any combination is run.
template <class Params, class Prepared, class Prepare>
Result<Cases<Prepared>> prepare_cases(const Request& request, Prepare&& prepare) {
  const auto every = combinations(request.variations);
  if (!every) return every.error();
  Cases<Prepared> cases;
  for (const Settings& settings : *every) {
    configuration::Document document = request.document;
    for (const auto& [key, value] : settings) {
      if (auto error = document.set(key + "=" + value)) return blame_variation(*std::move(error), settings);
    }
    const auto params = document.read<Params>();
    if (!params) return blame_variation(params.error(), settings);
    Result<Prepared> prepared = prepare(*params);
    if (!prepared) return blame_variation(document.locate(prepared.error()), settings);
    if (cases.all.empty()) cases.first_configuration = configuration::to_toml(*params);
    cases.all.push_back({settings, *std::move(prepared)});
  }
  return cases;
}

}  // namespace tactus::experiments
