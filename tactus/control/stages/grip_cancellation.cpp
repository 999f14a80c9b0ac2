#include <tactus/control/stages/grip_cancellation.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::control {

namespace {

constexpr double high_pass_Hz = 40.0;
constexpr double mean_s = 0.02;
constexpr double weight_s = 0.01;
constexpr double forget_s = 2.0;
/// Residuals within this are the encoder's steps and tremor: they tell no two grips apart.
constexpr double indistinct_m = 2e-5;
/// Of the mean square of the model chosen so far, what another has to stay below.
constexpr double clearly_better = 0.5;

}  // namespace

MasterModel held(MasterModel model, double grip) noexcept {
  model.hand.stiffness_N_per_m *= grip;
  model.hand.damping_N_s_per_m *= grip;
  const double light = std::min(grip, 1.0);
  model.hand.quintic_stiffness_N_per_m5 *= std::pow(light, 10.0);
  model.hand.guard_m /= light * light;
  return model;
}

Result<GripCancellation> GripCancellation::make(const Params& params, Seconds dt) {
  const auto fixed = Cancellation::make(params.cancellation, dt);
  if (!fixed) {
    if (fixed.error().parameter == "dt") return fixed.error();
    return under("cancellation", fixed.error());
  }
  const auto intended_velocity = signal::FilteredDerivative::make(params.cancellation.intended_velocity, dt);
  if (!intended_velocity) return under("cancellation.intended_velocity", intended_velocity.error());
  const auto low_pass = signal::LowPass::make({.cutoff_Hz = high_pass_Hz}, dt);
  if (!low_pass) return low_pass.error();
  const InducedMotionModel& model = fixed->model();
  Each<InducedMotionModel> models{model, model, model, model, model};
  if (params.estimate != OperatorEstimate::off) {
    for (std::size_t i = 0; i < models.size(); ++i) {
      InducedMotionModel::Params changed = params.cancellation.model;
      changed.master = held(changed.master, grips[i]);
      const auto made = InducedMotionModel::make(changed, dt);
      if (!made) return under("cancellation.model", made.error());
      models[i] = *made;
    }
  }
  return GripCancellation(params.estimate, models, *intended_velocity, *low_pass, dt);
}

GripCancellation::GripCancellation(OperatorEstimate estimate, const Each<InducedMotionModel>& models,
                                   const signal::FilteredDerivative& intended_velocity, const signal::LowPass& low_pass,
                                   Seconds dt)
    : estimate_(estimate),
      models_(models),
      intended_velocity_(intended_velocity),
      residual_{HighPass{low_pass, low_pass}, HighPass{low_pass, low_pass}, HighPass{low_pass, low_pass},
                HighPass{low_pass, low_pass}, HighPass{low_pass, low_pass}},
      excitation_{low_pass, low_pass},
      mean_share_(-std::expm1(-dt.value / mean_s)),
      weight_share_(-std::expm1(-dt.value / weight_s)),
      forget_share_(-std::expm1(-dt.value / forget_s)) {}

double GripCancellation::intended(double measured_position_m, double grip) noexcept {
  if (estimate_ == OperatorEstimate::online) compare(measured_position_m);
  if (estimate_ == OperatorEstimate::scheduled) schedule(grip);
  induced_m_ = models_[nominal].motor_position_m();
  if (estimate_ != OperatorEstimate::off) {
    induced_m_ = 0.0;
    for (std::size_t i = 0; i < models_.size(); ++i) induced_m_ += weights_[i] * models_[i].motor_position_m();
  }
  const double intended_m = measured_position_m - induced_m_;
  intended_velocity_m_per_s_ = intended_velocity_.step(intended_m);
  return intended_m;
}

void GripCancellation::advance(double motor_force_N) noexcept {
  const InducedMotionModel::Input input{.motor_force_N = motor_force_N,
                                        .intended_velocity_m_per_s = intended_velocity_m_per_s_};
  if (estimate_ == OperatorEstimate::off) {
    models_[nominal].step(input);
  } else {
    for (InducedMotionModel& model : models_) model.step(input);
  }
}

void GripCancellation::compare(double measured_position_m) noexcept {
  // A start far from zero must be no transient.
  if (!primed_) {
    for (HighPass& filter : residual_) filter.settle(measured_position_m);
    primed_ = true;
  }
  for (std::size_t i = 0; i < models_.size(); ++i) {
    const double fast_m = residual_[i].step(measured_position_m - models_[i].motor_position_m());
    mean_square_m2_[i] += mean_share_ * (fast_m * fast_m - mean_square_m2_[i]);
  }
  const double moved_m = excitation_.step(models_[nominal].motor_position_m());
  excitation_m2_ += mean_share_ * (moved_m * moved_m - excitation_m2_);

  constexpr double indistinct_m2 = indistinct_m * indistinct_m;
  Each<double> target{};
  if (excitation_m2_ < indistinct_m2) {
    target[nominal] = 1.0;
    move_weights(target, forget_share_);
    if (weights_[nominal] > 0.5) chosen_ = nominal;
    return;
  }
  const auto best = static_cast<std::size_t>(std::min_element(mean_square_m2_.begin(), mean_square_m2_.end()) -
                                             mean_square_m2_.begin());
  if (mean_square_m2_[best] + indistinct_m2 < clearly_better * mean_square_m2_[chosen_]) chosen_ = best;
  target[chosen_] = 1.0;
  move_weights(target, weight_share_);
}

void GripCancellation::schedule(double grip) noexcept {
  // Also for a NaN.
  if (!(grip > 0.0)) grip = 1.0;
  const double step = std::clamp(std::log2(grip / grips.front()), 0.0, static_cast<double>(grips.size() - 1));
  const auto below = std::min(static_cast<std::size_t>(step), grips.size() - 2);
  Each<double> target{};
  target[below + 1] = step - static_cast<double>(below);
  target[below] = 1.0 - target[below + 1];
  move_weights(target, weight_share_);
}

void GripCancellation::move_weights(const Each<double>& target, double share) noexcept {
  for (std::size_t i = 0; i < weights_.size(); ++i) weights_[i] += share * (target[i] - weights_[i]);
}

double GripCancellation::grip() const noexcept {
  double logarithm = 0.0;
  for (std::size_t i = 0; i < weights_.size(); ++i) logarithm += weights_[i] * std::log2(grips[i]);
  return std::exp2(logarithm);
}

void GripCancellation::reset() noexcept {
  for (InducedMotionModel& model : models_) model.reset();
  intended_velocity_.reset();
  excitation_.settle(0.0);
  mean_square_m2_ = {};
  excitation_m2_ = 0.0;
  weights_ = {};
  weights_[nominal] = 1.0;
  chosen_ = nominal;
  primed_ = false;
  induced_m_ = 0.0;
  intended_velocity_m_per_s_ = 0.0;
}

}  // namespace tactus::control
