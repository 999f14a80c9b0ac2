// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/estimators/inverse_model_estimator.hpp>
#include <tactus/kernel/core/result.hpp>

#include <complex>
#include <cstdint>
#include <functional>
#include <span>

/// The time constant of prediction blocks in an inverse model (paper B, eqs. 5 and 6), three ways.
namespace tactus::identification {

/// Closed form of the limit s → 0 (docs/theory/signal-prediction.md): the lead n·Tp of the blocks makes up for all
/// delays and first-order lags between command and measured position, and for the lag of the derivative's filter, which
/// the command does not pass: Tp = (delays + lags + T_d) / n. T_f drops out, command and model share it.
///
/// Errors: `out_of_bounds` for fewer than one block or more than 4.
Result<double> prediction_time_closed_form(double delays_and_lags_s, double derivative_filter_s, std::int64_t blocks);

/// Laplace transform at a real, positive s in 1/s.
using TransferFunction = std::function<double(double)>;

/// The same limit by numbers, for any model. `plant` is measured position over command as it really is, delays
/// included; `model` is the estimator, whose own blocks are ignored. Tp(s) = (ρ − 1)/(s·(2 − ρ)), ρ the n-th root of
/// what the blocks have to make up for, is extrapolated to s = 0 (Neville on s, s/2, …, s/16).
///
/// Errors: `out_of_bounds` for a wrong number of blocks; `inconsistent` when plant and inverse model do not cancel at
/// rest (a wrong gain, or a wrong viscous damping: no lead repairs that), or when Tp would not be positive.
Result<double> prediction_time_limit(const TransferFunction& plant, const control::InverseModelEstimator::Params& model,
                                     std::int64_t blocks);

/// Free motion as recorded: one command and one measured position for each tick.
struct FreeMotion {
  std::span<const double> command;
  std::span<const double> position;
  double sample_time_s;
};

/// RMS in N of the force that `model` feels in free motion, where it should feel none.
Result<double> free_motion_error(const FreeMotion& motion, const control::InverseModelEstimator::Params& model);

struct PredictionFromData {
  double time_constant_s;
  double error_rms_N;  ///< with it
};

/// The time constant that minimises the free-motion error: a logarithmic scan from one sample time to 0.1 s, then
/// golden section to 1e-5 of the value. Its optimum is that of the limit only where the data's band is low.
///
/// Errors: those of the estimator's `make`; `inconsistent` for no data, or an optimum at an end of the scan.
Result<PredictionFromData> prediction_time_from_data(const FreeMotion& motion,
                                                     control::InverseModelEstimator::Params model, std::int64_t blocks);

}  // namespace tactus::identification
