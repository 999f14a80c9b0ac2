#pragma once

#include <tactus/control/cancellation.hpp>
#include <tactus/control/servo_pd.hpp>
#include <tactus/control/site.hpp>
#include <tactus/core/element.hpp>
#include <tactus/core/parameters.hpp>

/// Position-force control (paper A, Fig. 3): the slave follows the master's position, the master displays the force
/// measured at the slave's tip. One class for each site.
namespace tactus::control {

/// Whether cancellation of induced master motion stands in the command path.
enum class CancellationMode { off, on };
constexpr auto enumerators(CancellationMode) {
  return std::array{Enumerator{CancellationMode::off, "off"}, Enumerator{CancellationMode::on, "on"}};
}

/// The master site.
///
///     measured position → cancellation → λ → to slave
///     force from slave → μ → saturation → safety gate → motor
///
/// With cancellation off the model still runs beside the loop, so that its estimate can be looked at.
class PositionForceMaster {
 public:
  struct Params {
    double position_scale = 1.0;
    double force_gain = 1.0;
    double force_limit_N = 1.0;
    CancellationMode cancellation = CancellationMode::on;
    ModelFidelity cancellation_model = ModelFidelity::sixth_order;
    CancellationStep cancellation_step = CancellationStep::exact;
    ModelFriction cancellation_friction = ModelFriction::total_velocity;
    MasterModel model;
    static constexpr auto fields() {
      return std::tuple{
          field("position_scale", &Params::position_scale, units::none, positive_up_to(1000.0),
                "Slave motion over master motion, lambda."),
          field("force_gain", &Params::force_gain, units::none, between(0.0, 1000.0),
                "Displayed force over tip force, mu."),
          field("force_limit_N", &Params::force_limit_N, units::newton, positive_up_to(100.0),
                "Where the displayed force saturates."),
          field("cancellation", &Params::cancellation, "Cancellation of induced master motion."),
          field("cancellation_model", &Params::cancellation_model,
                "How much of master and hand the model of cancellation tells apart."),
          field("cancellation_step", &Params::cancellation_step, "How the model of cancellation is advanced."),
          field("cancellation_friction", &Params::cancellation_friction,
                "On which velocity the Coulomb friction of the sixth-order model acts."),
          field("model", &Params::model, "The controller's model of master and hand.")};
    }
  };
  using Input = MasterInput;
  using Output = MasterOutput;

  static Result<PositionForceMaster> make(const Params& params, Seconds dt);

  /// Force and command for this tick. Real-time safe.
  Output respond(const Input& input) noexcept;
  /// Drives the model with the force that is really displayed until the next tick. Real-time safe.
  void applied(double motor_force_N) noexcept { cancellation_.advance(motor_force_N); }
  /// Both at once, for use without a gate.
  Output step(const Input& input) noexcept {
    const Output output = respond(input);
    applied(output.motor_force_N);
    return output;
  }
  void reset() noexcept { cancellation_.reset(); }

 private:
  PositionForceMaster(const Params& params, const Cancellation& cancellation)
      : position_scale_(params.position_scale),
        force_gain_(params.force_gain),
        force_limit_N_(params.force_limit_N),
        mode_(params.cancellation),
        cancellation_(cancellation) {}

  double position_scale_;
  double force_gain_;
  double force_limit_N_;
  CancellationMode mode_;
  Cancellation cancellation_;
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
