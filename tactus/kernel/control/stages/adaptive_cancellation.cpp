// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/stages/adaptive_cancellation.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace tactus::control {

namespace {

constexpr double person_below_Hz = 40.0;
/// An encoder's step: what lies within is no evidence, and no change of estimate moves the command by more in a tick.
constexpr double step_m = 1e-5;
/// What a model leaves of a sample, as if it were white: 0.12 mm each 200 µs.
constexpr double left_m2_s = 1.2e-4 * 1.2e-4 * 200e-6;
/// Of mobility and linkage: what was identified, how far off it may be (standard deviation), and for how long an
/// estimate is remembered.
constexpr std::array identified{1.0, 0.0};
constexpr std::array deviation{2.0, 0.05};
constexpr std::array remembered_s{3.0, 20.0};
constexpr std::array least{1.0 / 6.0, -0.25};
constexpr std::array most{6.0, 0.25};
/// At which rate a tangent forgets slow motion.
constexpr double washed_per_s = 80.0;
/// W: see the class.
constexpr double kept_share = 0.1;
constexpr double person_per_s = 3.0;
constexpr double kept_below_Hz = 15.0;

}  // namespace

Result<AdaptiveCancellation> AdaptiveCancellation::make(const Cancellation::Params& params, Seconds dt) {
  if (params.model.step != CancellationStep::exact) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "model.step",
                 .message = "an online estimate has no model that is stepped by Euler: write exact, or estimate off",
                 .place = {}};
  }
  Cancellation::Params own = params;
  own.model.master.hand.quintic_stiffness_N_per_m5 = 0.0;
  own.model.master.linear_hand_stiffening = 1.0;
  const auto fixed = Cancellation::make(own, dt);
  if (!fixed) return fixed.error();
  const auto intended_velocity = signal::FilteredDerivative::make(own.intended_velocity, dt);
  if (!intended_velocity) return under("intended_velocity", intended_velocity.error());
  const auto high_pass = signal::SecondOrderFilter::make(
      {.kind = signal::FilterKind::high_pass, .frequency_Hz = person_below_Hz, .notch_width_Hz = 1.0}, dt);
  if (!high_pass) return high_pass.error();
  return AdaptiveCancellation(fixed->model(), own.model.master, *intended_velocity, *high_pass, dt);
}

AdaptiveCancellation::AdaptiveCancellation(const InducedMotionModel& model, const MasterModel& master,
                                           const signal::FilteredDerivative& intended_velocity,
                                           const signal::SecondOrderFilter& high_pass, Seconds dt)
    : model_(model.exact_step()),
      hysteretic_(model.hysteretic()),
      hand_stiffness_N_per_m_(master.hand.stiffness_N_per_m),
      hand_damping_N_s_per_m_(master.hand.damping_N_s_per_m),
      average_linkage_N_per_m_(master.linkage.stiffness_N_per_m),
      variance_m2_(left_m2_s / dt.value),
      forgotten_share_{dt.value / remembered_s[mobility], dt.value / remembered_s[linkage]},
      kept_{.mobility = 1.0 - 2.0 * forgotten_share_[mobility],
            .both = 1.0 - forgotten_share_[mobility] - forgotten_share_[linkage],
            .linkage = 1.0 - 2.0 * forgotten_share_[linkage]},
      regained_{.mobility = 2.0 * forgotten_share_[mobility] * deviation[mobility] * deviation[mobility],
                .both = 0.0,
                .linkage = 2.0 * forgotten_share_[linkage] * deviation[linkage] * deviation[linkage]},
      washed_share_(-std::expm1(-dt.value * washed_per_s)),
      person_share_(-std::expm1(-dt.value * person_per_s)),
      passed_share_(-std::expm1(-dt.value * 2.0 * std::numbers::pi * kept_below_Hz)),
      intended_velocity_(intended_velocity),
      residual_{high_pass.section()},
      slope_{residual_, residual_},
      force_(dt.value) {
  reset();
}

inline void AdaptiveCancellation::weigh(double unexplained_m, const Each<double>& slope_m) noexcept {
  Covariance& c = covariance_;
  const Each<double> shared{c.mobility * slope_m[mobility] + c.both * slope_m[linkage],
                            c.both * slope_m[mobility] + c.linkage * slope_m[linkage]};
  const double per_variance =
      1.0 / (variance_m2_ + slope_m[mobility] * shared[mobility] + slope_m[linkage] * shared[linkage]);
  const Each<double> gain{shared[mobility] * per_variance, shared[linkage] * per_variance};
  // What the sample told, and then what a tick forgets.
  c.mobility = kept_.mobility * (c.mobility - gain[mobility] * shared[mobility]) + regained_.mobility;
  c.both = kept_.both * (c.both - gain[mobility] * shared[linkage]);
  c.linkage = kept_.linkage * (c.linkage - gain[linkage] * shared[linkage]) + regained_.linkage;
  for (std::size_t i = 0; i < parameters; ++i) {
    const double found = estimate_[i] + (pending_[i] + gain[i] * unexplained_m);
    const double drawn = found + forgotten_share_[i] * (identified[i] - found);
    pending_[i] = std::clamp(drawn, least[i], most[i]) - estimate_[i];
  }
}

inline void AdaptiveCancellation::apply() noexcept {
  double move_m = 0.0;
  for (std::size_t i = 0; i < parameters; ++i) move_m += tangent_[i][0] * pending_[i];
  const double share = std::fabs(move_m) > step_m ? step_m / std::fabs(move_m) : 1.0;
  for (std::size_t i = 0; i < parameters; ++i) {
    const double change = share * pending_[i];
    estimate_[i] += change;
    pending_[i] -= change;
    for (std::size_t row = 0; row < model_.state.size(); ++row) model_.state[row] += tangent_[i][row] * change;
    residual_.section.state_1 -= slope_[i].section.state_1 * change;
    residual_.section.state_2 -= slope_[i].section.state_2 * change;
  }
  grip_ = 1.0 / estimate_[mobility];
}

inline double AdaptiveCancellation::slow_part_m(double induced_m) noexcept {
  person_m_ += person_share_ * (induced_m - person_m_);
  passed_m_ += passed_share_ * (kept_share * induced_m + (1.0 - kept_share) * person_m_ - passed_m_);
  return passed_m_;
}

inline InducedMotionStep<double>::Difference AdaptiveCancellation::difference() const noexcept {
  const double firmer = grip_ - 1.0;
  return {.hand_stiffness_N_per_m = firmer * hand_stiffness_N_per_m_,
          .hand_damping_N_s_per_m = firmer * hand_damping_N_s_per_m_,
          .linkage_share = estimate_[linkage],
          .yielding = model_.yielding_of(firmer * hand_damping_N_s_per_m_)};
}

double AdaptiveCancellation::intended(double measured_position_m) noexcept {
  // A start far from zero must be no transient.
  if (!primed_) residual_.settle(measured_position_m - model_.state[0]);
  primed_ = true;
  double unexplained_m = residual_.step(measured_position_m - model_.state[0]);
  Each<double> slope_m{};
  for (std::size_t i = 0; i < parameters; ++i) {
    slope_m[i] = slope_[i].step(tangent_[i][0]);
    unexplained_m -= slope_m[i] * pending_[i];
  }
  force_.observe(unexplained_m);
  // What was found at the last tick, so that nothing here waits for what is found at this one.
  apply();
  weigh(unexplained_m - std::clamp(unexplained_m, -step_m, step_m), slope_m);

  intended_velocity_m_per_s_ = intended_velocity_.step(measured_position_m - model_.state[0]);
  induced_m_ = model_.state[0] - slow_part_m(model_.state[0]);
  return measured_position_m - induced_m_;
}

HandEstimate AdaptiveCancellation::hand() const noexcept {
  // Rounding can take a variance that is nearly nothing below it.
  const double of_mobility = std::sqrt(std::max(0.0, covariance_.mobility));
  return {.estimated_grip = grip_,
          .estimated_grip_deviation = of_mobility * grip_ * grip_,
          .linkage_excess = estimate_[linkage]};
}

void AdaptiveCancellation::advance(double motor_force_N) noexcept {
  const Step::Difference other = difference();
  // What a unit more of mobility sets free of the hand's mean force in the tick: 1/θ² of it.
  const double freed_share = 0.5 * (grip_ * grip_) * other.yielding;
  const double damping = freed_share * hand_damping_N_s_per_m_, stiffness = freed_share * hand_stiffness_N_per_m_;
  const double freed_before_N = damping * model_.state[5] + stiffness * model_.state[2];
  const double linkage_N = model_.advance_in_another_hand(
      other, motor_force_N, model_.friction_range(intended_velocity_m_per_s_), hysteretic_);
  const double freed_N = freed_before_N + (damping * model_.state[5] + stiffness * model_.state[2]);
  const double softer_N_per_m =
      model_.linkage_stiffness_N_per_m - (1.0 + estimate_[linkage]) * average_linkage_N_per_m_;
  model_.advance_tangents(tangent_[mobility], tangent_[linkage], other,
                          {.hand_N = freed_N, .linkage_N = linkage_N, .softer_N_per_m = softer_N_per_m});
  for (Step::State& tangent : tangent_) {
    const double washed_m = washed_share_ * tangent[2];
    for (std::size_t mass = 0; mass < 3; ++mass) tangent[mass] -= washed_m;
  }
}

void AdaptiveCancellation::reset() noexcept {
  model_.state = {};
  model_.linkage.deflection_m = 0.0;
  model_.linkage.elastic_m = 0.0;
  intended_velocity_.reset();
  tangent_ = {};
  residual_.settle(0.0);
  for (HighPass& slope : slope_) slope.settle(0.0);
  estimate_ = identified;
  grip_ = 1.0 / identified[mobility];
  pending_ = {};
  covariance_ = {.mobility = deviation[mobility] * deviation[mobility],
                 .both = 0.0,
                 .linkage = deviation[linkage] * deviation[linkage]};
  person_m_ = passed_m_ = 0.0;
  force_.reset();
  primed_ = false;
  induced_m_ = 0.0;
  intended_velocity_m_per_s_ = 0.0;
}

}  // namespace tactus::control
