#pragma once

#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/mechanics/cable_driven_master.hpp>
#include <tactus/kernel/mechanics/operator.hpp>
#include <tactus/kernel/signal/filtered_derivative.hpp>
#include <tactus/simulation/experiments/gain_limit.hpp>
#include <tactus/simulation/teleoperator/clock.hpp>

#include <array>
#include <vector>

/// The word that chooses this experiment in a file: task.kind = "virtual-wall".
enum class VirtualWallKind { virtual_wall };
constexpr auto enumerators(VirtualWallKind) {
  return std::array{tactus::Enumerator{VirtualWallKind::virtual_wall, "virtual-wall"}};
}

/// The person's press and the search.
struct VirtualWallTask {
  VirtualWallKind kind = VirtualWallKind::virtual_wall;
  double press_m = 0.02;
  double observation_s = 0.5;
  double softest_N_per_m = 100.0;
  double stiffest_N_per_m = 100e3;
  static constexpr auto fields() {
    using T = VirtualWallTask;
    using namespace tactus;
    return List{
        field("kind", &T::kind, "Which experiment this is."),
        field("press_m", &T::press_m, units::metre, between(0.001, 0.1), "How far beyond the wall the operator aims."),
        field("observation_s", &T::observation_s, units::second, between(0.2, 10.0),
              "How long the press is observed from the first touch."),
        field("softest_N_per_m", &T::softest_N_per_m, units::newton_per_metre, between(1.0, 1e7),
              "Where the search begins."),
        field("stiffest_N_per_m", &T::stiffest_N_per_m, units::newton_per_metre, between(1.0, 1e7), "Where it ends.")};
  }
};

/// The damper beside the wall's spring, on a velocity that the servo takes from the encoder.
struct WallDamper {
  double damping_N_s_per_m = 0.0;
  tactus::signal::FilteredDerivative::Params velocity;
  static constexpr auto fields() {
    using namespace tactus;
    return List{field("damping_N_s_per_m", &WallDamper::damping_N_s_per_m, units::newton_second_per_metre, non_negative,
                      "Force against motion within the wall."),
                field("velocity", &WallDamper::velocity, "The filter of the velocity.")};
  }
};

/// A file of this kind. Sections that also exist in `tapping` have the same meaning here.
struct VirtualWallParams {
  tactus::mechanics::CableDrivenMaster::Params master;
  tactus::mechanics::Operator::Params person;
  tactus::simulation::ServoParams servo;
  tactus::simulation::PlantClockParams plant;
  WallDamper wall;
  VirtualWallTask task;
  static constexpr auto fields() {
    using P = VirtualWallParams;
    using namespace tactus;
    return List{field("master", &P::master, "The device that renders the wall."),
                field("operator", &P::person, "The operator who holds it."),
                field("servo", &P::servo, "The servo clock."),
                field("plant", &P::plant, "The clock of the simulated device."),
                field("wall", &P::wall, "What the wall is besides stiff."),
                field("task", &P::task, "The press and the search.")};
  }
};

/// One press onto the wall.
struct Press {
  bool settles = false;          ///< the force above 15 Hz falls below a tenth of its peak and stays there
  double settling_time_s = 0.0;  ///< from the first touch
  double pressed_in_m = 0.0;     ///< how deep the motor is in the wall at the end
  std::vector<double> time_s;    ///< of each tick
  std::vector<double> force_N;   ///< of the wall on the master, 0 in front of the wall
};

struct VirtualWallResult {
  tactus::experiments::GainLimit limit_N_per_m;  ///< the largest stiffness up to which every one that was tried settled
  Press settled;                                 ///< at the limit
  Press stiffer;                                 ///< at twice the limit
};

/// What is wrong with parameters that are each within their bounds.
tactus::Check check_virtual_wall(const VirtualWallParams& params);

/// Searches the stiffest wall, in steps of the root of 2 and then to 2 %. Errors: those of `check_virtual_wall`.
tactus::Result<VirtualWallResult> stiffest_wall(const VirtualWallParams& params);
