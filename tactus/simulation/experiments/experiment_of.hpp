// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/configuration/json_schema.hpp>
#include <tactus/kernel/core/binding.hpp>
#include <tactus/simulation/experiments/experiment.hpp>
#include <tactus/simulation/experiments/presentation.hpp>

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// What every kind of experiment has in common, so that a kind states its parameters, what one run finds, and how that
/// is shown.
namespace tactus::experiments {

/// Described parameters whose member `task` has a member `kind`: an enum of one word, by which files choose the kind.
template <class P>
concept ExperimentParams = Described<P> && NamedEnum<decltype(P{}.task.kind)>;

/// The reference page of a kind. Keys that `tapping` has with equal words, bounds and default are left to its page.
std::string reference_page(std::span<const Binding> bindings, std::string_view kind);

/// A kind of experiment whose files are read as `P`: its word, its schema and its reference page.
template <ExperimentParams P>
class ExperimentOf : public Experiment {
 public:
  [[nodiscard]] std::string_view kind() const final { return name_of(P{}.task.kind); }
  [[nodiscard]] std::string schema() const final {
    return configuration::json_schema<P>("tactus experiment: " + std::string(kind()));
  }
  [[nodiscard]] std::string reference() const final {
    P defaults{};
    return reference_page(bind(defaults), kind());
  }
};

/// A kind that runs each combination of the varied keys by itself, one after the other. `Found` is what one run finds.
template <ExperimentParams P, class Found>
class SweepOf : public ExperimentOf<P> {
 public:
  struct Run {
    Settings settings;  ///< of the varied keys
    P params;
    Found found;
  };
  using Runs = std::vector<Run>;  ///< one at least, the first key slowest

  [[nodiscard]] Result<Outcome> run(const Request& request, const Progress& progress) const final {
    const auto cases = prepare_cases<P, P>(request, [this](const P& params) -> Result<P> {
      if (Check error = check(params)) return *std::move(error);
      return params;
    });
    if (!cases) return cases.error();
    Runs runs;
    for (const auto& [settings, params] : cases->all) {
      Result<Found> found = run_one(params);
      if (!found) return locate_in(request, settings, found.error());
      runs.push_back({settings, params, *std::move(found)});
      progress(static_cast<double>(runs.size()) / static_cast<double>(cases->all.size()));
    }
    return outcome_of(present(request, runs), request, cases->first_configuration);
  }

 private:
  /// What is wrong with parameters that are each within its bounds. Every combination is checked before the first is
  /// run, so a mistake costs no computing time. An error's `parameter` is the path of a key, such as `wall.damping`.
  [[nodiscard]] virtual Check check(const P&) const { return std::nullopt; }
  /// Runs one combination, whose parameters have been checked. Equal parameters must give equal results.
  [[nodiscard]] virtual Result<Found> run_one(const P& params) const = 0;
  /// The runs for every reader. What repeats them is added to the page.
  [[nodiscard]] virtual Presentation present(const Request& request, const Runs& runs) const = 0;
};

}  // namespace tactus::experiments
