// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/experiment.hpp>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

/// The kinds of this library, in the order in which they are listed: a line here and a folder each. A line names the
/// function that makes the kind, which stands in the folder.
#define TACTUS_EXPERIMENTS(KIND)           \
  KIND(tapping_experiment)                 \
  KIND(force_display_experiment)           \
  KIND(contest_experiment)                 \
  KIND(inverse_model_chirp_experiment)     \
  KIND(prediction_block_experiment)        \
  KIND(force_estimators_experiment)        \
  KIND(hydraulic_chirp_experiment)         \
  KIND(hydraulic_rigid_contact_experiment) \
  KIND(sensorless_experiment)              \
  KIND(faults_experiment)                  \
  KIND(arm_tapping_experiment)             \
  KIND(arm_vibration_experiment)           \
  KIND(arm_contest_experiment)

namespace tactus::experiments {

#define TACTUS_DECLARE(name) std::unique_ptr<const Experiment> name();
TACTUS_EXPERIMENTS(TACTUS_DECLARE)

namespace {

std::vector<std::unique_ptr<const Experiment>> made() {
  std::vector<std::unique_ptr<const Experiment>> all;
#define TACTUS_ADD(name) all.push_back(name());
  TACTUS_EXPERIMENTS(TACTUS_ADD)
  return all;
}

std::vector<std::unique_ptr<const Experiment>>& registry() {
  static std::vector<std::unique_ptr<const Experiment>> all = made();
  return all;
}

auto place_of(std::string_view kind) {
  return std::find_if(registry().begin(), registry().end(), [&](const auto& other) { return other->kind() == kind; });
}

}  // namespace

std::span<const std::unique_ptr<const Experiment>> experiments() { return registry(); }

void register_experiment(std::unique_ptr<const Experiment> experiment) {
  const auto same = place_of(experiment->kind());
  if (same != registry().end()) {
    *same = std::move(experiment);
  } else {
    registry().push_back(std::move(experiment));
  }
}

Result<const Experiment*> choose_experiment(const configuration::Document& document) {
  const auto kind = document.text_at("task.kind");
  if (!kind) return kind.error();
  if (const auto place = place_of(*kind); place != registry().end()) return place->get();
  std::string known;
  for (const auto& experiment : experiments()) {
    known += (known.empty() ? "" : ", ") + std::string(experiment->kind());
  }
  return document.locate({.code = ErrorCode::out_of_bounds,
                          .parameter = "task.kind",
                          .message = "'" + *kind + "' is no kind of experiment: write one of " + known,
                          .place = {}});
}

}  // namespace tactus::experiments
