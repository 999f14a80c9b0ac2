// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/sensorless/sensorless.hpp>

#include <utility>

namespace tactus::experiments {

Result<std::vector<SensorlessCase>> sensorless_cases(const SensorlessParams& params) {
  if (auto error = validate(params)) return *std::move(error);
  if (auto error = check(params.task)) return *std::move(error);
  std::vector<SensorlessCase> rows;
  for (const double delay_s : sensorless_delays_s) {
    const TappingParams delayed = with_delay(tapping_of(params, params.task), delay_s);
    for (std::size_t choice = 0; choice < force_choices.size(); ++choice) {
      for (const control::CancellationMode mode : sensorless_cancellation) {
        SensorlessCase row{.delay_s = delay_s, .choice = choice, .cancellation = mode, .params = delayed};
        row.params.control.cancellation = mode;
        control::SlaveForce::Params& force = row.params.control.slave_force;
        force.source = force_choices[choice].source;
        if (!force_choices[choice].predicts) {
          force.inverse_model.prediction.blocks = 0;
          force.inverse_model.declared_delay_s = 0.0;
        }
        TappingParams one_tap = row.params;
        one_tap.task.taps = 1;
        if (auto ensemble = TappingEnsemble::make(one_tap); !ensemble) return ensemble.error();
        rows.push_back(std::move(row));
      }
    }
  }
  return rows;
}

void score_part(SensorlessPart part, const SensorlessCase& row, const GainSearch& search, SensorlessScore& score) {
  switch (part) {
    case SensorlessPart::strong_display:
      score.strong_display = tapping_gain_limit(with_display(row.params, search.strong_display_N), search);
      return;
    case SensorlessPart::limit:
      score.limit = tapping_gain_limit(row.params, search);
      return;
    case SensorlessPart::taps:
      score.at_gain = score_taps(row.params);
      return;
    case SensorlessPart::free_space:
      score.free_space = score_free_space(row.params);
      return;
  }
}

}  // namespace tactus::experiments
