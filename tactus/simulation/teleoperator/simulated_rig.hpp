// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/axis/rig.hpp>
#include <tactus/kernel/mechanics/cable_driven_master.hpp>
#include <tactus/kernel/mechanics/operator.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

/// A master on a simulated bench, its parameters hidden from whoever identifies it.
namespace tactus::simulation {

/// The device and the operator of a bench as an experiment's file states them: what `tactus run --with` loads.
struct BenchedMaster {
  /// What a bench can determine of the device.
  struct Device {
    mechanics::CableChain::Params mechanism;
    mechanics::CurrentAmplifier::Params amplifier;
    static constexpr auto fields() {
      return List{field("mechanism", &Device::mechanism, "Motor, cable, drum, linkage and handle."),
                  field("amplifier", &Device::amplifier, "Current amplifier of the motor.")};
    }
  };
  /// What it can determine of the operator.
  struct Operator {
    mechanics::LinearSpring::Params grip{.stiffness_N_per_m = 40.0, .damping_N_s_per_m = 23.0};
    mechanics::Operator::Correction correction;
    static constexpr auto fields() {
      return List{field("grip", &Operator::grip, "Passive impedance of hand and arm."),
                  field("correction", &Operator::correction, "Slow correction of the handle's position.")};
    }
  };
  Device master;
  Operator person;
  static constexpr auto fields() {
    return List{field("master", &BenchedMaster::master, "The master device."),
                field("operator", &BenchedMaster::person, "The operator at the master.")};
  }
};

/// Everything about a simulated rig. The defaults of the disturbances are the "realistic noise" of
/// docs/theory/successive-isolation.md.
struct SimulatedRigParams {
  BenchedMaster benched;
  double amplifier_offset_N = 0.0;     ///< applied force without a command
  double current_noise_rms_N = 0.01;   ///< of the current monitor, white, independent from tick to tick
  double encoder_resolution_m = 1e-5;  ///< a plain counter: no interpolation between its counts
  double ripple_N = 0.0;               ///< amplitude of the motor's cogging
  double ripple_period_m = 0.004;      ///< travel over which it repeats
  double ripple_phase_cycles = 0.0;    ///< where on its period the rig's zero lies
  double wander_rms_m = 1e-4;          ///< of where the hand wants to be, below about 0.5 Hz
  double tremor_amplitude_m = 5e-5;
  double tremor_frequency_Hz = 10.0;
  std::int64_t seed = 1;  ///< of all noise
  identification::RigLimits limits;
};

/// A rig drawn around paper A's Table I: masses, stiffnesses, damping and friction up to 30 % off, the hand up to 40 %;
/// hysteretic share 0.2 to 0.4, slip deflection 70 to 140 µm; amplifier gain 0.95 to 1.05, bandwidth 1.5 to 5 kHz,
/// offset up to 10 mN. Equal seeds give equal rigs.
SimulatedRigParams draw_rig(std::int64_t seed);

/// The rig: `mechanics::CableChain` behind amplifier and encoder, cogging on the motor, in the hand of a
/// `mechanics::Operator` where one holds it.
///
/// A link that is taken apart has neither stiffness nor damping. A drum is locked by friction that nothing overcomes,
/// which holds it exactly, and a handle by a vice, a grip of 1e9 N s/m, which lets it creep by less than 10 nm per N
/// in 10 s. Every run starts at rest at 0. Its noise follows from the seed, the assembly and the program, so a run does
/// not depend on those before it, and the same program twice gives the same record.
class SimulatedRig final : public identification::Rig {
 public:
  /// Errors: a parameter out of its bounds, or a device that plant steps of 10 µs cannot follow.
  static Result<SimulatedRig> make(const SimulatedRigParams& params);

  [[nodiscard]] std::string name() const override;
  [[nodiscard]] double tick_s() const override;
  [[nodiscard]] identification::RigLimits limits() const override { return params_.limits; }
  Check assemble(identification::Assembly assembly) override;
  Result<identification::RigRun> run(const identification::MotorProgram& program) override;

  /// What is hidden behind the interface.
  [[nodiscard]] const SimulatedRigParams& truth() const { return params_; }
  /// The true value of a parameter by the name that identification gives it, `motor.mass_kg`; nothing where the rig's
  /// own laws know no such parameter.
  [[nodiscard]] std::optional<double> truth(std::string_view name) const;

 private:
  explicit SimulatedRig(const SimulatedRigParams& params) : params_(params) {}
  SimulatedRigParams params_;
  identification::Assembly assembly_ = identification::Assembly::held;
};

/// Energy in J that a closed loop of amplitude `amplitude_m` loses in an elasto-slip spring: Σ 4 kᵢ uᵢ max(0, A − uᵢ).
double loop_area_J(const mechanics::ElastoSlipSpring::Params& spring, double amplitude_m);

}  // namespace tactus::simulation
