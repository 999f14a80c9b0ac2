#include "tests/laws.hpp"

#include <tactus/control/cancellation.hpp>
#include <tactus/control/induced_motion_model.hpp>
#include <tactus/control/position_force.hpp>
#include <tactus/control/safety_gate.hpp>
#include <tactus/control/servo_pd.hpp>

namespace tactus::laws {

using control::CancellationMode;
using control::CancellationStep;
using control::ModelFidelity;
using control::ModelFriction;

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

/// What arrives is doubles and one flag, and always fresh here.
template <>
struct Doubles<control::MasterInput> {
  using Row = std::array<double, 6>;
  static control::MasterInput from(const Row& row) {
    return {.motor_position_m = row[0],
            .arrival = {.message = {row[1], row[2], row[3], row[4], row[5]}, .fresh = true}};
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
    return {{}, strong, plain};
  }
  static void admit(control::PositionForceMaster::Input&) {}
};

using ControlElements =
    ::testing::Types<control::InducedMotionModel, control::Cancellation, control::PositionForceMaster,
                     control::PositionForceSlave, control::SafetyGate, control::ServoPd>;
INSTANTIATE_TYPED_TEST_SUITE_P(Control, ElementLaws, ControlElements);

}  // namespace tactus::laws
