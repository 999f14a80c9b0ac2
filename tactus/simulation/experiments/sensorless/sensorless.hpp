// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/experiments/contest/contest.hpp>

#include <array>
#include <string_view>
#include <vector>

/// Tapping without a force sensor: sources of the slave's force, cancellation and link delays against one another, on
/// the same hand, devices, wall and taps.
namespace tactus::experiments {

/// The word that selects an experiment in a file.
enum class SensorlessKind { sensorless };
constexpr auto enumerators(SensorlessKind) { return std::array{Enumerator{SensorlessKind::sensorless, "sensorless"}}; }

struct SensorlessTask : GainSearch {
  SensorlessKind kind = SensorlessKind::sensorless;
  static constexpr auto fields() {
    return joined(List{field("kind", &SensorlessTask::kind, "Kind of the experiment.")}, GainSearch::fields());
  }
};

struct SensorlessParams : simulation::Teleoperator::Params {
  SensorlessTask task;
  static constexpr auto fields() {
    return joined(simulation::Teleoperator::Params::fields(),
                  List{field("task", &SensorlessParams::task,
                             "The taps and the search. For each source of the slave's force, the experiment determines "
                             "the largest force gain at which at least 95 % of the taps settle, half of them within "
                             "0.1 s plus two round trips of the link.")});
  }
};

/// A source of the slave's force, as it is compared.
struct ForceChoice {
  std::string_view name;
  control::SlaveForceSource source;
  bool predicts = true;  ///< false: without the blocks of the file
};
inline constexpr std::array force_choices{
    ForceChoice{"force sensor", control::SlaveForceSource::sensor},
    ForceChoice{"inverse model, no prediction", control::SlaveForceSource::inverse_model, false},
    ForceChoice{"inverse model, prediction", control::SlaveForceSource::inverse_model},
    ForceChoice{"disturbance observer", control::SlaveForceSource::disturbance_observer},
    ForceChoice{"momentum observer", control::SlaveForceSource::momentum_observer},
    ForceChoice{"Kalman filter", control::SlaveForceSource::kalman}};

inline constexpr std::array sensorless_delays_s{0.0, 0.005, 0.02};  ///< each way, on top of the file's architecture
inline constexpr std::array sensorless_cancellation{control::CancellationMode::off, control::CancellationMode::on};

/// One row: what it stands for, and its parameters.
struct SensorlessCase {
  double delay_s = 0.0;
  std::size_t choice = 0;  ///< of `force_choices`
  control::CancellationMode cancellation = control::CancellationMode::off;
  TappingParams params;
};

struct SensorlessScore {
  GainLimit limit;           ///< with the file's display
  GainLimit strong_display;  ///< with `strong_display_N`
  GainScore at_gain;         ///< at the file's force gain and display
  FreeSpaceScore free_space;
};

/// Every delay, source and cancellation, in this order, the last fastest. Errors: a value out of bounds, a search that
/// ends where it begins, and whatever the teleoperator refuses.
Result<std::vector<SensorlessCase>> sensorless_cases(const SensorlessParams& params);

/// Pieces into which a score is cut, the longest first. They are independent.
enum class SensorlessPart { strong_display, limit, taps, free_space };
inline constexpr std::array sensorless_parts{SensorlessPart::strong_display, SensorlessPart::limit,
                                             SensorlessPart::taps, SensorlessPart::free_space};

/// Computes one piece and writes it to its place in `score`.
void score_part(SensorlessPart part, const SensorlessCase& row, const GainSearch& search, SensorlessScore& score);

}  // namespace tactus::experiments
