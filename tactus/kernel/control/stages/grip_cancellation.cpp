// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/stages/grip_cancellation.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::control {

namespace {

constexpr double weight_s = 0.01;

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
  const InducedMotionModel& model = fixed->model();
  Each<InducedMotionModel> models{model, model, model, model, model};
  if (params.estimate == OperatorEstimate::scheduled) {
    for (std::size_t i = 0; i < models.size(); ++i) {
      InducedMotionModel::Params changed = params.cancellation.model;
      changed.master = held(changed.master, grips[i]);
      const auto made = InducedMotionModel::make(changed, dt);
      if (!made) return under("cancellation.model", made.error());
      models[i] = *made;
    }
  }
  // Only an online estimate asks more of the model than the fixed one did.
  Cancellation::Params adapting = params.cancellation;
  if (params.estimate != OperatorEstimate::online) adapting.model.step = CancellationStep::exact;
  const auto adaptive = AdaptiveCancellation::make(adapting, dt);
  if (!adaptive) {
    if (adaptive.error().parameter == "dt") return adaptive.error();
    return under("cancellation", adaptive.error());
  }
  return GripCancellation(params.estimate, models, *intended_velocity, *adaptive, dt);
}

GripCancellation::GripCancellation(OperatorEstimate estimate, const Each<InducedMotionModel>& models,
                                   const signal::FilteredDerivative& intended_velocity,
                                   const AdaptiveCancellation& adaptive, Seconds dt)
    : estimate_(estimate),
      models_(models),
      intended_velocity_(intended_velocity),
      adaptive_(adaptive),
      weight_share_(-std::expm1(-dt.value / weight_s)) {}

double GripCancellation::intended(double measured_position_m, double grip) noexcept {
  if (estimate_ == OperatorEstimate::online) {
    const double intended_m = adaptive_.intended(measured_position_m);
    induced_m_ = adaptive_.induced_position_m();
    return intended_m;
  }
  induced_m_ = models_[nominal].motor_position_m();
  if (estimate_ == OperatorEstimate::scheduled) {
    schedule(grip);
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
  switch (estimate_) {
    case OperatorEstimate::off:
      models_[nominal].step(input);
      break;
    case OperatorEstimate::online:
      adaptive_.advance(motor_force_N);
      break;
    case OperatorEstimate::scheduled:
      for (InducedMotionModel& model : models_) model.step(input);
      break;
  }
}

void GripCancellation::schedule(double grip) noexcept {
  // Also for a NaN.
  if (!(grip > 0.0)) grip = 1.0;
  const double step = std::clamp(std::log2(grip / grips.front()), 0.0, static_cast<double>(grips.size() - 1));
  const auto below = std::min(static_cast<std::size_t>(step), grips.size() - 2);
  Each<double> target{};
  target[below + 1] = step - static_cast<double>(below);
  target[below] = 1.0 - target[below + 1];
  for (std::size_t i = 0; i < weights_.size(); ++i) weights_[i] += weight_share_ * (target[i] - weights_[i]);
}

double GripCancellation::grip() const noexcept {
  if (estimate_ == OperatorEstimate::online) return adaptive_.grip();
  double logarithm = 0.0;
  for (std::size_t i = 0; i < weights_.size(); ++i) logarithm += weights_[i] * std::log2(grips[i]);
  return std::exp2(logarithm);
}

void GripCancellation::reset() noexcept {
  for (InducedMotionModel& model : models_) model.reset();
  intended_velocity_.reset();
  adaptive_.reset();
  weights_ = {};
  weights_[nominal] = 1.0;
  induced_m_ = 0.0;
  intended_velocity_m_per_s_ = 0.0;
}

}  // namespace tactus::control
