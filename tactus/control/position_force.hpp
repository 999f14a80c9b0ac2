#pragma once

#include <tactus/control/cancellation.hpp>
#include <tactus/control/safety_gate.hpp>
#include <tactus/control/site.hpp>
#include <tactus/core/element.hpp>
#include <tactus/core/parameters.hpp>
#include <tactus/signal/filtered_derivative.hpp>

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
    CancellationStep cancellation_step = CancellationStep::exact;
    ModelFriction cancellation_friction = ModelFriction::total_velocity;
    MasterModel model;
    SafetyGate::Params gate;
    static constexpr auto fields() {
      return std::tuple{
          field("position_scale", &Params::position_scale, units::none, positive_up_to(1000.0),
                "Slave motion over master motion, lambda."),
          field("force_gain", &Params::force_gain, units::none, between(0.0, 1000.0),
                "Displayed force over tip force, mu."),
          field("force_limit_N", &Params::force_limit_N, units::newton, positive_up_to(100.0),
                "Where the displayed force saturates."),
          field("cancellation", &Params::cancellation, "Cancellation of induced master motion."),
          field("cancellation_step", &Params::cancellation_step, "How the model of cancellation is advanced."),
          field("cancellation_friction", &Params::cancellation_friction,
                "On which velocity the model's Coulomb friction acts."),
          field("model", &Params::model, "The controller's model of master and hand."),
          field("gate", &Params::gate, "Last limits before the master's motor.")};
    }
  };
  struct Input {
    MasterMeasurement measurement;
    SlaveMessage message;
  };
  /// Command and message, and what the stages in between made, for the log.
  struct Output {
    double motor_force_N = 0.0;  ///< command to the amplifier, positive toward the environment
    MasterMessage message;
    double displayed_force_N = 0.0;    ///< what the person is to feel, positive when it pushes the hand back
    double induced_position_m = 0.0;   ///< the model's estimate at this instant
    double intended_position_m = 0.0;  ///< measured less induced
  };

  static Result<PositionForceMaster> make(const Params& params, Seconds dt);
  Output step(const Input& input) noexcept;
  void reset() noexcept;

  [[nodiscard]] GateFault fault() const noexcept { return gate_.fault(); }

 private:
  PositionForceMaster(const Params& params, const Cancellation& cancellation, const SafetyGate& gate)
      : position_scale_(params.position_scale),
        force_gain_(params.force_gain),
        force_limit_N_(params.force_limit_N),
        mode_(params.cancellation),
        cancellation_(cancellation),
        gate_(gate) {}

  double position_scale_;
  double force_gain_;
  double force_limit_N_;
  CancellationMode mode_;
  Cancellation cancellation_;
  SafetyGate gate_;
};

/// The slave site: proportional and derivative feedback of the error on the motor, through the safety gate; the tip
/// force goes back as it is measured.
class PositionForceSlave {
 public:
  struct Params {
    double proportional_N_per_m = 100.0;
    double derivative_N_s_per_m = 0.5;
    signal::FilteredDerivative::Params velocity{.cutoff_Hz = 300.0};
    SafetyGate::Params gate;
    static constexpr auto fields() {
      return std::tuple{field("proportional_N_per_m", &Params::proportional_N_per_m, units::newton_per_metre,
                              between(0.0, 1e5), "Force per position error."),
                        field("derivative_N_s_per_m", &Params::derivative_N_s_per_m, units::newton_second_per_metre,
                              between(0.0, 1e3), "Force per rate of the position error."),
                        field("velocity", &Params::velocity, "Filter of the rate of the position error."),
                        field("gate", &Params::gate, "Last limits before the slave's motor.")};
    }
  };
  struct Input {
    SlaveMeasurement measurement;
    MasterMessage message;
  };
  struct Output {
    double motor_force_N = 0.0;  ///< command to the amplifier, positive toward the environment
    SlaveMessage message;
  };

  static Result<PositionForceSlave> make(const Params& params, Seconds dt);
  Output step(const Input& input) noexcept;
  void reset() noexcept;

  [[nodiscard]] GateFault fault() const noexcept { return gate_.fault(); }

 private:
  PositionForceSlave(const Params& params, const signal::FilteredDerivative& error_rate, const SafetyGate& gate)
      : proportional_N_per_m_(params.proportional_N_per_m),
        derivative_N_s_per_m_(params.derivative_N_s_per_m),
        error_rate_(error_rate),
        gate_(gate) {}

  double proportional_N_per_m_;
  double derivative_N_s_per_m_;
  signal::FilteredDerivative error_rate_;
  SafetyGate gate_;
};

/// Both sites, as one section of a file describes them.
struct PositionForce : PositionForceMaster::Params {
  PositionForceSlave::Params slave;
  static constexpr auto fields() {
    return std::tuple_cat(PositionForceMaster::Params::fields(),
                          std::tuple{field("slave", &PositionForce::slave, "The slave's position controller.")});
  }
};

}  // namespace tactus::control
