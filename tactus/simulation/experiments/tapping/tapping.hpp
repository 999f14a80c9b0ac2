// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/simulation/experiments/model_mismatch.hpp>
#include <tactus/simulation/experiments/tapping/tap_observer.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

/// The main experiment: an operator taps a stiff wall through the teleoperator (paper A, Fig. 13).
namespace tactus::experiments {

/// Taps that differ. A single tap near the boundary of stability is decided by accident, so each tap draws its approach
/// speed, its depth and its tremor, and its own error of the controller's model.
struct TapSeries {
  std::int64_t taps = 32;
  std::int64_t seed = 1;
  double slowest_m_per_s = 0.04;
  double fastest_m_per_s = 0.08;
  double shallowest_m = 0.004;
  double deepest_m = 0.010;
  double observation_s = 0.35;
  double model_error = 0.0;
  ModelMismatch mismatch;
  static constexpr auto fields() {
    return List{field("taps", &TapSeries::taps, between(1, 100000), "Number of taps in the ensemble."),
                field("seed", &TapSeries::seed, non_negative, "Seed from which the ensemble and the noise are drawn."),
                field("slowest_m_per_s", &TapSeries::slowest_m_per_s, units::metre_per_second, between(0.001, 2.0),
                      "Slowest approach: intended speed at the wall."),
                field("fastest_m_per_s", &TapSeries::fastest_m_per_s, units::metre_per_second, between(0.001, 2.0),
                      "Fastest approach."),
                field("shallowest_m", &TapSeries::shallowest_m, units::metre, between(1e-4, 0.1),
                      "Smallest depth: how far beyond the wall the operator aims."),
                field("deepest_m", &TapSeries::deepest_m, units::metre, between(1e-4, 0.1), "Largest depth."),
                field("observation_s", &TapSeries::observation_s, units::second, between(0.15, 10.0),
                      "Time for which a tap is observed from the first touch, while the operator keeps pressing."),
                field("model_error", &TapSeries::model_error, units::none, between(0.0, 0.5),
                      "Largest error of the model's masses, linkage stiffness and operator damping, as a share. Each "
                      "tap draws each error uniformly from minus to plus this share."),
                field("mismatch", &TapSeries::mismatch, "Fixed errors of the model, in addition to the drawn ones.")};
  }
};

/// The word that selects an experiment in a file.
enum class TappingKind { tapping };
constexpr auto enumerators(TappingKind) { return std::array{Enumerator{TappingKind::tapping, "tapping"}}; }

struct TappingTask : TapSeries {
  TappingKind kind = TappingKind::tapping;
  bool supervised = true;
  static constexpr auto fields() {
    return joined(List{field("kind", &TappingTask::kind, "Kind of the experiment."),
                       field("supervised", &TappingTask::supervised,
                             "true: the sites are supervised and armed before each tap, as on hardware; false: they "
                             "are active from the first control cycle on, as in the papers.")},
                  TapSeries::fields());
  }
};

struct TappingParams : simulation::Teleoperator::Params {
  TappingTask task;
  static constexpr auto fields() {
    return joined(simulation::Teleoperator::Params::fields(), List{field("task", &TappingParams::task, "The taps.")});
  }
};

/// What its sites compute with: `task.mismatch` is in the controllers' model. A `TappingParams` is a
/// `station::TeleoperatorParams` too, without it.
station::TeleoperatorParams sites_of(const TappingParams& params);

/// For what runs these sites without supervision, which `who` names, as "the live page": refuses others.
Check refuse_supervised(const TappingParams& params, const std::string& who);

enum class Verdict { settled, ringing, limit_cycle, diverged, stopped };
constexpr auto enumerators(Verdict) {
  return std::array{Enumerator{Verdict::settled, "settled"}, Enumerator{Verdict::ringing, "ringing"},
                    Enumerator{Verdict::limit_cycle, "limit-cycle"}, Enumerator{Verdict::diverged, "diverged"},
                    Enumerator{Verdict::stopped, "stopped"}};
}

/// The longest median settling time of an ensemble that counts as settled.
inline constexpr double settled_within_s = 0.1;

/// An ensemble in a few numbers. A tap that did not settle enters the quantiles of the settling time with its whole
/// observation window, a lower bound.
struct TappingMetrics {
  std::size_t taps = 0;
  double settled_fraction = 0.0;
  double settling_time_median_s = 0.0;
  double settling_time_p90_s = 0.0;
  /// Whether the observation window cut these off: a tap that did not settle is in them, so they are lower bounds.
  bool settling_time_median_censored = false;
  bool settling_time_p90_censored = false;
  double contacts_median = 0.0;
  double peak_force_N = 0.0;                          ///< median over the taps
  double residual_rms_N = 0.0;                        ///< median over the taps
  std::size_t stopped = 0;                            ///< taps that supervision ended
  std::optional<simulation::StoppedSite> stopped_by;  ///< of the first of them
  /// `diverged`: any tap did. `stopped`: supervision ended any. `limit-cycle`: fewer than half of the taps settled.
  /// `settled`: at least 95 % settled, the median within 100 ms. `ringing`: all else.
  Verdict verdict = Verdict::settled;
};

/// The ensemble's parameters, already checked: one teleoperator and one intended path for each tap.
class TappingEnsemble {
 public:
  /// Draws the ensemble. Fails where any tap of it could not be made.
  static Result<TappingEnsemble> make(const TappingParams& params);

  [[nodiscard]] std::size_t size() const { return taps_.size(); }
  /// Runs one tap; with `trace`, appends every tick to it. Taps are independent of one another.
  TapResult run(std::size_t tap, std::vector<simulation::Teleoperator::Record>* trace = nullptr) const;
  /// What a tap is made of, for other clocks.
  [[nodiscard]] const Tap& tap(std::size_t tap) const { return taps_[tap]; }
  [[nodiscard]] TapObserver observer(std::size_t tap) const { return {taps_[tap], observation_s_}; }
  [[nodiscard]] bool supervised() const { return supervised_; }

 private:
  explicit TappingEnsemble(std::vector<Tap> taps, double observation_s, bool supervised)
      : taps_(std::move(taps)), observation_s_(observation_s), supervised_(supervised) {}

  std::vector<Tap> taps_;
  double observation_s_;
  bool supervised_;
};

TappingMetrics summarise(const std::vector<TapResult>& taps);

/// The tap whose settling time is the median, the lower of two: the one to show.
std::size_t median_tap(const std::vector<TapResult>& taps);

}  // namespace tactus::experiments
