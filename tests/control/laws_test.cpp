// SPDX-License-Identifier: Apache-2.0
#include "tests/laws.hpp"

#include <tactus/kernel/control/architectures/energy_tank.hpp>
#include <tactus/kernel/control/architectures/four_channel.hpp>
#include <tactus/kernel/control/architectures/position_force.hpp>
#include <tactus/kernel/control/architectures/position_position.hpp>
#include <tactus/kernel/control/architectures/projection.hpp>
#include <tactus/kernel/control/architectures/shared_compliant.hpp>
#include <tactus/kernel/control/architectures/time_domain_passivity.hpp>
#include <tactus/kernel/control/architectures/wave_variables.hpp>
#include <tactus/kernel/control/estimators/disturbance_observer.hpp>
#include <tactus/kernel/control/estimators/hand_force_observer.hpp>
#include <tactus/kernel/control/estimators/inverse_model_estimator.hpp>
#include <tactus/kernel/control/estimators/kalman_force_estimator.hpp>
#include <tactus/kernel/control/estimators/momentum_observer.hpp>
#include <tactus/kernel/control/estimators/narx_force_estimator.hpp>
#include <tactus/kernel/control/estimators/slave_force.hpp>
#include <tactus/kernel/control/model/induced_motion_model.hpp>
#include <tactus/kernel/control/stages/cancellation.hpp>
#include <tactus/kernel/control/stages/crossover.hpp>
#include <tactus/kernel/control/stages/grip_cancellation.hpp>
#include <tactus/kernel/control/stages/local_damping.hpp>
#include <tactus/kernel/control/stages/servo_pd.hpp>
#include <tactus/kernel/control/stages/shaping_filter.hpp>

#include "examples/own-architecture/soft_limit_master.hpp"

namespace tactus::laws {

using control::CancellationMode;
using control::CancellationStep;
using control::ModelFidelity;
using control::ModelFriction;
using control::Shaping;

inline control::InducedMotionModel::Params model(CancellationStep step, ModelFriction friction) {
  control::InducedMotionModel::Params params;
  params.step = step;
  params.friction = friction;
  return params;
}

template <>
struct Subject<control::InducedMotionModel> {
  static constexpr double dt_s = 200e-6;
  static std::vector<control::InducedMotionModel::Params> parameters() {
    auto second = model(CancellationStep::exact, ModelFriction::total_velocity);
    second.fidelity = ModelFidelity::second_order;
    auto fourth = model(CancellationStep::euler, ModelFriction::total_velocity);
    fourth.fidelity = ModelFidelity::fourth_order;
    return {second,
            fourth,
            model(CancellationStep::exact, ModelFriction::total_velocity),
            model(CancellationStep::exact, ModelFriction::at_rest),
            model(CancellationStep::euler, ModelFriction::total_velocity),
            model(CancellationStep::euler, ModelFriction::at_rest)};
  }
  static void admit(control::InducedMotionModel::Input&) {}
};

template <>
struct Subject<control::Cancellation> {
  static constexpr double dt_s = 200e-6;
  static std::vector<control::Cancellation::Params> parameters() {
    control::Cancellation::Params euler;
    euler.model = model(CancellationStep::euler, ModelFriction::total_velocity);
    return {{}, euler};
  }
  static void admit(control::Cancellation::Input&) {}
};

template <>
struct Subject<control::GripCancellation> {
  static constexpr double dt_s = 200e-6;
  static std::vector<control::GripCancellation::Params> parameters() {
    return {{},
            {.cancellation = {}, .estimate = control::OperatorEstimate::online},
            {.cancellation = {}, .estimate = control::OperatorEstimate::scheduled}};
  }
  static void admit(control::GripCancellation::Input&) {}
};

/// What arrives is doubles and one flag, and always fresh here.
template <>
struct Doubles<control::MasterInput> {
  using Row = std::array<double, 7>;
  static control::MasterInput from(const Row& row) {
    return {.motor_position_m = row[0],
            .hand_force_N = row[1],
            .arrival = {.message = {row[2], row[3], row[4], row[5], row[6]}, .fresh = true}};
  }
};
template <>
struct Doubles<control::SlaveInput> {
  using Row = std::array<double, 7>;
  static control::SlaveInput from(const Row& row) {
    return {.motor_position_m = row[0],
            .tip_force_N = row[1],
            .arrival = {.message = {row[2], row[3], row[4], row[5], row[6]}, .fresh = true}};
  }
};

template <>
struct Subject<control::PositionForceMaster> {
  static constexpr double dt_s = 200e-6;
  static std::vector<control::PositionForceMaster::Params> parameters() {
    control::PositionForceMaster::Params strong;
    strong.position_scale = 0.1;
    strong.force_gain = 15.0;
    control::PositionForceMaster::Params plain;
    plain.cancellation = CancellationMode::off;
    plain.cancellation_step = CancellationStep::euler;
    control::PositionForceMaster::Params rivals = strong;
    rivals.damping.damping_N_s_per_m = 10.0;
    rivals.command_filter.kind = Shaping::low_pass;
    rivals.force_filter.kind = Shaping::notch;
    rivals.crossover.frequency_Hz = 40.0;
    rivals.hand_compensation_Hz = 200.0;
    return {{}, strong, plain, rivals};
  }
  static void admit(control::PositionForceMaster::Input&) {}
};

template <>
struct Subject<control::ShapingFilter> {
  static constexpr double dt_s = 200e-6;
  static std::vector<control::ShapingFilter::Params> parameters() {
    return {{}, {.kind = Shaping::low_pass}, {.kind = Shaping::notch, .frequency_Hz = 200.0, .notch_width_Hz = 1.0}};
  }
  static void admit(double&) {}
};

template <>
struct Subject<control::LocalDamping> {
  static constexpr double dt_s = 200e-6;
  static std::vector<control::LocalDamping::Params> parameters() { return {{}, {.damping_N_s_per_m = 10.0}}; }
  static void admit(double&) {}
};

inline control::SlaveModel rubbing_slave() {
  return {.viscous_damping_N_s_per_m = 0.5,
          .friction = {.law = control::FrictionLaw::smooth_coulomb, .force_N = 0.03},
          .actuator_gain = 2.0};
}

template <class Observer>
struct ObserverSubject {
  static constexpr double dt_s = 200e-6;
  static std::vector<typename Observer::Params> parameters() { return {{}, {.model = rubbing_slave()}}; }
  static void admit(typename Observer::Input&) {}
};
template <>
struct Subject<control::DisturbanceObserver> : ObserverSubject<control::DisturbanceObserver> {};
template <>
struct Subject<control::MomentumObserver> : ObserverSubject<control::MomentumObserver> {};
template <>
struct Subject<control::KalmanForceEstimator> : ObserverSubject<control::KalmanForceEstimator> {};

/// No term, then recursions that would run away: linear and of third degree.
template <>
struct Subject<control::NarxForceEstimator> {
  static constexpr double dt_s = 200e-6;
  static std::vector<control::NarxForceEstimator::Params> parameters() {
    control::NarxForceEstimator::Params unstable{.actuator_gain = 2.0};
    unstable.scales.lag_s = dt_s;
    unstable.terms.term_0 = {.coefficient_N = 50.0, .variable_1 = 7};
    unstable.terms.term_1 = {.coefficient_N = -1e9, .variable_1 = 7, .variable_2 = 1, .variable_3 = 6};
    unstable.terms.term_11 = {.coefficient_N = 1e9, .variable_1 = 1, .variable_2 = 1, .variable_3 = 1};
    return {{}, unstable};
  }
  static void admit(control::NarxForceEstimator::Input&) {}
};

template <>
struct Subject<control::SlaveForce> {
  static constexpr double dt_s = 200e-6;
  static std::vector<control::SlaveForce::Params> parameters() {
    std::vector<control::SlaveForce::Params> all;
    for (const auto& word : enumerators(control::SlaveForceSource{})) {
      control::SlaveForce::Params params;
      params.source = word.value;
      all.push_back(params);
    }
    return all;
  }
  static void admit(control::SlaveForce::Input&) {}
};

template <>
struct Subject<control::HandForceCompensation> {
  static constexpr double dt_s = 200e-6;
  static std::vector<control::HandForceCompensation::Params> parameters() {
    return {{}, {.master = {}, .band_Hz = 200.0}};
  }
  static void admit(double&) {}
};

template <>
struct Subject<control::Crossover> {
  static constexpr double dt_s = 200e-6;
  static std::vector<control::Crossover::Params> parameters() { return {{}, {.frequency_Hz = 40.0}}; }
  static void admit(double&) {}
};

inline control::FourChannelParams all_channels() {
  return {.environment_force_gain = 1.5,
          .hand_force_gain = 0.7,
          .slave_force_loop_gain = 0.3,
          .master_force_loop_gain = 0.5,
          .master_feedforward_kg = 0.03,
          .slave_feedforward_kg = 0.04};
}

template <>
struct Subject<control::FourChannelMaster> {
  static constexpr double dt_s = 200e-6;
  static std::vector<control::FourChannelMaster::Params> parameters() {
    return {{}, {.position_scale = 0.1, .force_gain = 15.0, .force_limit_N = 5.0, .four_channel = all_channels()}};
  }
  static void admit(control::FourChannelMaster::Input&) {}
};

template <>
struct Subject<control::FourChannelSlave> {
  static constexpr double dt_s = 200e-6;
  static std::vector<control::FourChannelSlave::Params> parameters() {
    return {{}, {.force_gain = 15.0, .four_channel = all_channels()}};
  }
  static void admit(control::FourChannelSlave::Input&) {}
};

template <>
struct Subject<control::CancellingSlave> {
  static constexpr double dt_s = 200e-6;
  static std::vector<control::CancellingSlave::Params> parameters() {
    control::CancellingSlave::Params strong;
    strong.master.position_scale = 0.1;
    strong.master.force_gain = 15.0;
    return {{}, strong};
  }
  static void admit(control::CancellingSlave::Input&) {}
};

template <>
struct Subject<control::PassivitySlave> {
  static constexpr double dt_s = 200e-6;
  static std::vector<control::PassivitySlave::Params> parameters() {
    control::PassivitySlave::Params servo;
    servo.passivity.reflected_force = control::ReflectedForce::servo;
    return {{}, servo};
  }
  static void admit(control::PassivitySlave::Input&) {}
};

using ControlElements = ::testing::Types<
    control::InducedMotionModel, control::InverseModelEstimator, control::DisturbanceObserver,
    control::MomentumObserver, control::KalmanForceEstimator, control::NarxForceEstimator, control::Cancellation,
    control::GripCancellation, control::PositionForceMaster, control::PositionForceSlave, control::ServoPd,
    control::LocalDamping, control::ShapingFilter, control::Crossover, control::HandForceCompensation,
    control::HandForceObserver, control::PositionPositionMaster, control::PositionPositionSlave,
    control::ProjectionMaster, control::SharedCompliantSlave, control::SlaveForce, control::FourChannelMaster,
    control::FourChannelSlave, control::CancellingSlave, control::WaveMaster, control::WaveSlave,
    control::PassivityMaster, control::PassivitySlave, control::TankMaster, control::TankSlave, SoftLimitMaster>;
INSTANTIATE_TYPED_TEST_SUITE_P(Control, ElementLaws, ControlElements);

}  // namespace tactus::laws
