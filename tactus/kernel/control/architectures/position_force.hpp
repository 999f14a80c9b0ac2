// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/site.hpp>
#include <tactus/kernel/control/stages/crossover.hpp>
#include <tactus/kernel/control/stages/grip_cancellation.hpp>
#include <tactus/kernel/control/stages/hand_force_compensation.hpp>
#include <tactus/kernel/control/stages/local_damping.hpp>
#include <tactus/kernel/control/stages/servo_pd.hpp>
#include <tactus/kernel/control/stages/shaping_filter.hpp>
#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>

/// Position-force control (paper A, Fig. 3): the slave follows the master's position, the master displays the force
/// measured at the slave's tip. One class for each site.
namespace tactus::control {

/// Whether cancellation of induced master motion is in the command path.
enum class CancellationMode { off, on };
constexpr auto enumerators(CancellationMode) {
  return std::array{Enumerator{CancellationMode::off, "off"}, Enumerator{CancellationMode::on, "on"}};
}

/// The stages of the master site, each as `As` has it: itself, or what stands for it where the loop is judged without
/// being run.
template <template <class> class As>
struct MasterStages {
  As<ShapingFilter> force_filter;
  As<Crossover> crossover;
  As<HandForceCompensation> hand_compensation;
  As<LocalDamping> damping;
  As<ShapingFilter> command_filter;
  As<GripCancellation> cancellation;
};

/// The master site.
///
///     measured position → cancellation → command filter → λ → to slave
///     force from slave → μ → force filter → crossover → compensation → + local damping → saturation → gate → motor
///                                               └→ saturation → safety gate → actuator on the handle
///
/// Filters, crossover and damping are the paper's rivals of cancellation (Sec. IV, eq. 4 to 6). Each is off unless
/// asked for, and what is off changes no bit. Damping acts on the measured position and counts as displayed force, so
/// it drives the model of cancellation too; so does what compensation of the path from motor to hand makes of the
/// force. That takes the force saturated, for the hand should get no more than the limit. What the actuator on the
/// handle does is no part of the model. An online estimate of the hand lessens the force before damping
/// (`AdmissibleForce`). With cancellation off the model still runs alongside the loop, so that its estimate can be
/// looked at.
class PositionForceMaster {
 public:
  struct Params {
    double position_scale = 1.0;
    double force_gain = 1.0;
    double force_limit_N = 1.0;
    double hand_compensation_Hz = 0.0;
    CancellationMode cancellation = CancellationMode::on;
    ModelFidelity cancellation_model = ModelFidelity::sixth_order;
    CancellationStep cancellation_step = CancellationStep::exact;
    ModelFriction cancellation_friction = ModelFriction::total_velocity;
    OperatorEstimate operator_estimate = OperatorEstimate::off;
    MasterModel model;
    LocalDamping::Params damping;
    ShapingFilter::Params command_filter;
    ShapingFilter::Params force_filter;
    Crossover::Params crossover;
    static constexpr auto fields() {
      return List{
          field("position_scale", &Params::position_scale, units::none, positive_up_to(1000.0),
                "Slave motion divided by master motion, lambda."),
          field("force_gain", &Params::force_gain, units::none, between(0.0, 1000.0),
                "Displayed force divided by tip force, mu."),
          field("force_limit_N", &Params::force_limit_N, units::newton, positive_up_to(100.0),
                "Limit of the displayed force; it applies to the motor and to the actuator on the handle separately."),
          field("hand_compensation_Hz", &Params::hand_compensation_Hz, units::hertz, non_negative,
                "Frequency up to which the master's dynamics between motor and hand are compensated, so that the hand "
                "receives the displayed force. Must be below half the servo rate. 0: no compensation."),
          field("cancellation", &Params::cancellation, "Cancellation of induced master motion."),
          field("cancellation_model", &Params::cancellation_model,
                "Order of the model of cancellation: one, two or three masses; only sixth-order is nonlinear."),
          field("cancellation_step", &Params::cancellation_step, "Integration method of the model of cancellation."),
          field("cancellation_friction", &Params::cancellation_friction,
                "Velocity from which the sixth-order model computes its Coulomb friction: induced motion only "
                "(at-rest), or with the intended motion (total-velocity)."),
          field("operator_estimate", &Params::operator_estimate,
                "Source of the firmness of the operator's grip that cancellation uses. off: the model's hand, which is "
                "constant. online: estimated from the motion that the displayed force causes. scheduled: measured by a "
                "grip sensor."),
          field("model", &Params::model, "The controller's model of master and hand."),
          field("damping", &Params::damping, "Local derivative damping of the master's motor."),
          field("command_filter", &Params::command_filter, "Filter of the position command."),
          field("force_filter", &Params::force_filter, "Filter of the force from the slave."),
          field("crossover", &Params::crossover, "Split of the force between motor and handle.")};
    }
  };
  using Input = MasterInput;
  using Output = MasterOutput;

  static Result<PositionForceMaster> make(const Params& params, Seconds dt);

  /// Each stage as `make.operator()<Stage>(name, own)` has it, with its own parameters `own`, in the order of
  /// `MasterStages`. `site_key` has their keys by `name`.
  template <template <class> class As, class Make>
  static MasterStages<As> each_stage(const Params& params, const Make& make) {
    auto force_filter = make.template operator()<ShapingFilter>("force_filter", params.force_filter);
    auto crossover = make.template operator()<Crossover>("crossover", params.crossover);
    auto hand_compensation = make.template operator()<HandForceCompensation>(
        "hand_compensation", {.master = params.model, .band_Hz = params.hand_compensation_Hz});
    auto damping = make.template operator()<LocalDamping>("damping", params.damping);
    auto command_filter = make.template operator()<ShapingFilter>("command_filter", params.command_filter);
    auto cancellation = make.template operator()<GripCancellation>(
        "cancellation", {.cancellation = {.model = {.master = params.model,
                                                    .fidelity = params.cancellation_model,
                                                    .step = params.cancellation_step,
                                                    .friction = params.cancellation_friction}},
                         .estimate = params.operator_estimate});
    return {.force_filter = std::move(force_filter),
            .crossover = std::move(crossover),
            .hand_compensation = std::move(hand_compensation),
            .damping = std::move(damping),
            .command_filter = std::move(command_filter),
            .cancellation = std::move(cancellation)};
  }
  /// The key of `Params` that the key `own` of the stage `name` is: they are flatter here. Cold.
  static std::string site_key(std::string_view name, std::string_view own);

  /// What is the site's own.
  struct Gains {
    double position_scale = 1.0;
    double force_gain = 1.0;
    double force_limit_N = 1.0;
    bool cancels = true;
  };
  /// The one description of the chain: this tick's output by these stages, or by what stands for them.
  template <class Stages>
  static Output chain(Stages& stages, const Gains& gains, const Input& input) {
    const double limit_N = gains.force_limit_N;
    const auto [below_N, above_N] =
        stages.crossover.step(stages.force_filter.step(gains.force_gain * input.arrival.message.force_N));
    const double wanted_N =
        stages.hand_compensation.on() ? stages.hand_compensation.step(std::clamp(below_N, -limit_N, limit_N)) : below_N;
    const double damping_N = stages.damping.step(input.motor_position_m);
    // A NaN passes through clamp, so it reaches the gate, which catches and latches it.
    const double displayed_N =
        std::clamp(stages.cancellation.admissible_N(wanted_N, limit_N) - damping_N, -limit_N, limit_N);
    const double handle_N = std::clamp(above_N, -limit_N, limit_N);
    const double intended_m = stages.cancellation.intended(input.motor_position_m, input.grip);
    const double command_m = stages.command_filter.step(gains.cancels ? intended_m : input.motor_position_m);
    return {.motor_force_N = -displayed_N,
            .handle_force_N = -handle_N,
            .message = {.position_m = gains.position_scale * command_m},
            .induced_position_m = stages.cancellation.induced_position_m(),
            .intended_position_m = intended_m,
            .hand = stages.cancellation.hand()};
  }

  /// Forces and command for this tick. Real-time safe.
  Output respond(const Input& input) noexcept { return chain(stages_, gains_, input); }
  /// Drives the model with the force that is really displayed until the next tick. Real-time safe.
  void applied(double motor_force_N) noexcept { stages_.cancellation.advance(motor_force_N); }
  /// Both at once, for use without a gate.
  Output step(const Input& input) noexcept {
    const Output output = respond(input);
    applied(output.motor_force_N);
    return output;
  }
  [[nodiscard]] double force_gain() const noexcept { return gains_.force_gain; }
  /// From the next tick on. Real-time safe.
  void set_force_gain(double gain) noexcept { gains_.force_gain = gain; }
  void reset() noexcept {
    stages_.cancellation.reset();
    stages_.damping.reset();
    stages_.command_filter.reset();
    stages_.force_filter.reset();
    stages_.crossover.reset();
    stages_.hand_compensation.reset();
  }

 private:
  template <class Stage>
  using Itself = Stage;
  using Stages = MasterStages<Itself>;

  PositionForceMaster(const Params& params, const Stages& stages)
      : gains_{.position_scale = params.position_scale,
               .force_gain = params.force_gain,
               .force_limit_N = params.force_limit_N,
               .cancels = params.cancellation == CancellationMode::on},
        stages_(stages) {}

  Gains gains_;
  Stages stages_;
};

/// The slave site: proportional and derivative feedback of the error on the motor; the tip force goes back as it is
/// measured.
class PositionForceSlave {
 public:
  using Params = ServoPd::Params;
  using Input = SlaveInput;
  using Output = SlaveOutput;

  static Result<PositionForceSlave> make(const Params& params, Seconds dt);

  /// Real-time safe.
  Output respond(const Input& input) noexcept {
    return {.motor_force_N = servo_.step(input.arrival.message.position_m - input.motor_position_m),
            .message = {.force_N = input.tip_force_N}};
  }
  Output step(const Input& input) noexcept { return respond(input); }
  void reset() noexcept { servo_.reset(); }

 private:
  explicit PositionForceSlave(const ServoPd& servo) : servo_(servo) {}
  ServoPd servo_;
};

}  // namespace tactus::control
