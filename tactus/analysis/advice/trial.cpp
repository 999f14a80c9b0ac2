// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/advice/trial.hpp>
#include <tactus/simulation/experiments/contest/contest.hpp>

#include <algorithm>
#include <utility>

namespace tactus::advice {

namespace {

using experiments::TappingEnsemble;
using experiments::TappingParams;

constexpr double coarse_step_s = 2e-5;
constexpr std::size_t draws_a_rig = 4;

Check can_be(TappingParams rig) {
  rig.task.taps = 1;
  const auto ensemble = TappingEnsemble::make(rig);
  if (!ensemble) return ensemble.error();
  return {};
}

}  // namespace

Result<Trial> Trial::make(const Knowledge& knowledge, const TappingParams& believed, const Draws& draws,
                          std::span<const double> grips) {
  Trial trial;
  const std::size_t most = draws_a_rig * draws.rigs + 1;
  for (std::uint64_t draw = draws.first; trial.rigs_.size() < draws.rigs * grips.size(); ++draw) {
    TappingParams rig = knowledge.drawn(believed, draw, draws.known);
    rig.task.taps = draws.taps;
    if (draws.coarse && rig.plant.longest_step_s < coarse_step_s) {
      const double step_s = std::exchange(rig.plant.longest_step_s, coarse_step_s);
      if (can_be(rig)) rig.plant.longest_step_s = step_s;
    }
    if (auto error = can_be(rig)) {
      if (draw == 0 || draw - draws.first >= most) return *std::move(error);
      continue;
    }
    for (const double grip : grips) {
      trial.rigs_.push_back(grip == 1.0 ? rig : experiments::with_grip(rig, grip));
    }
  }
  return trial;
}

bool Trial::settles(double gain) {
  for (auto rig = rigs_.begin(); rig != rigs_.end(); ++rig) {
    rig->control.force_gain = gain;
    if (experiments::taps_settle(*rig)) continue;
    std::rotate(rigs_.begin(), rig, rig + 1);
    return false;
  }
  return true;
}

experiments::GainLimit Trial::limit(double lowest, double highest, double resolution) {
  return experiments::find_gain_limit(
      lowest, highest, [this](double gain) { return settles(gain); }, resolution);
}

experiments::TappingMetrics Trial::metrics(double gain) const {
  std::vector<experiments::TapResult> taps;
  for (TappingParams rig : rigs_) {
    rig.control.force_gain = gain;
    const auto ensemble = TappingEnsemble::make(rig);
    for (std::size_t tap = 0; tap < ensemble->size(); ++tap) taps.push_back(ensemble->run(tap));
  }
  return experiments::summarise(taps);
}

}  // namespace tactus::advice
