#pragma once

#include <tactus/control/safety_gate.hpp>
#include <tactus/core/joints.hpp>
#include <tactus/core/signals.hpp>

#include <cmath>
#include <concepts>
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>

/// What the two sites of a teleoperator measure, command and tell one another, and what a controller of a site is. Of
/// one axis each, or, as `Joints` of the same, of a device of several; positions and forces are positive toward the
/// environment unless said otherwise.
namespace tactus::control {

/// What one site tells the other at a tick. Each architecture fills the members that it uses; the rest stay zero.
///
/// Its one description: what is checked, mended and sent over a network follows from it, in this order.
struct Message {
  double position_m = 0.0;
  double velocity_m_per_s = 0.0;
  double force_N = 0.0;
  double wave = 0.0;
  double energy_J = 0.0;
  static constexpr auto signals() {
    return List{
        observed("position_m", &Message::position_m, units::metre, "", "slave", "toward the environment",
                 "Where the other site shall be, or where this one is."),
        observed("velocity_m_per_s", &Message::velocity_m_per_s, units::metre_per_second, "", "slave",
                 "toward the environment", "Of that position."),
        observed("force_N", &Message::force_N, units::newton, "", "slave", "the slave is pushed back",
                 "Tip force, or what the architecture makes of it."),
        observed("wave", &Message::wave, units::none, "", "", "", "Wave variable, in the square root of a watt."),
        observed("energy_J", &Message::energy_J, units::joule, "", "", "",
                 "Sent so far, a running total: a lost message then loses no energy.")};
  }
};

/// The newest message of the other site. A site gets one every tick; `fresh` tells whether it arrived since the last.
struct Arrival {
  Message message;
  bool fresh = false;
};

/// What the master's sensors read at a tick, and what came from the slave.
struct MasterInput {
  double motor_position_m = 0.0;
  double hand_force_N = 0.0;  ///< of the hand on the handle, positive when it pushes toward the environment
  Arrival arrival;
  double grip = 1.0;         ///< how firmly the person holds, over nominal, where a sensor tells; 1 without one
  double motor_age_s = 0.0;  ///< of the position at this tick; negative where it is younger
};

/// How firmly the person holds the handle and what else differs from the model that was identified, as the master's
/// controller believes it. Where nothing is estimated, as identified and without deviation.
struct HandEstimate {
  double estimated_grip = 1.0;
  double estimated_grip_deviation = 0.0;
  double linkage_excess = 0.0;
  static constexpr auto signals() {
    using R = HandEstimate;
    return List{observed("estimated_grip", &R::estimated_grip, units::none, "master", "hand", "",
                         "How firmly the person holds, over identified."),
                observed("estimated_grip_deviation", &R::estimated_grip_deviation, units::none, "master", "hand", "",
                         "Standard deviation of that; 0 where nothing is estimated."),
                observed("linkage_excess", &R::linkage_excess, units::none, "master", "hand", "",
                         "By which share the linkage is estimated to be stiffer than identified.")};
  }
};

/// What the master commands and tells, and what its stages made of it, for the log.
struct MasterOutput {
  double motor_force_N = 0.0;   ///< positive toward the environment; a force that pushes the hand back is negative
  double handle_force_N = 0.0;  ///< of a second, vibrotactile actuator on the handle, same sign; zero without one
  Message message;
  double induced_position_m = 0.0;   ///< the estimate of what the displayed force did to the motor, at this instant
  double intended_position_m = 0.0;  ///< measured less induced
  HandEstimate hand = {};
};

/// What the slave's sensors read at a tick, and what came from the master.
struct SlaveInput {
  double motor_position_m = 0.0;
  double tip_force_N = 0.0;  ///< positive when the environment pushes the slave back
  Arrival arrival;
  double motor_age_s = 0.0;  ///< of the position at this tick; negative where it is younger
};

/// What the slave commands and tells.
struct SlaveOutput {
  double motor_force_N = 0.0;  ///< positive toward the environment
  Message message;
};

/// Whether every number that a site reads is one. Real-time safe.
inline bool is_finite(const Message& message) noexcept {
  bool finite = true;
  for_each_signal<Message>([&](const auto& each) { finite = finite && std::isfinite(message.*each.member); });
  return finite;
}
inline bool is_finite(const MasterInput& input) noexcept {
  return std::isfinite(input.motor_position_m) && std::isfinite(input.motor_age_s) &&
         std::isfinite(input.hand_force_N) && std::isfinite(input.grip) && is_finite(input.arrival.message);
}
inline bool is_finite(const SlaveInput& input) noexcept {
  return std::isfinite(input.motor_position_m) && std::isfinite(input.motor_age_s) &&
         std::isfinite(input.tip_force_N) && is_finite(input.arrival.message);
}

template <class T>
bool is_finite(const Joints<T>& joints) noexcept {
  bool finite = true;
  for (const T& each : joints) finite = finite && is_finite(each);
  return finite;
}

/// What the force sensor says that pushes back against the motor, in N: the hand, or what is at the tip. Real-time
/// safe.
inline double resisting_N(const MasterInput& input) noexcept { return -input.hand_force_N; }
inline double resisting_N(const SlaveInput& input) noexcept { return input.tip_force_N; }

/// Puts what was read last in the place of each number that is none. Real-time safe.
inline void mend(double& value, double last) noexcept {
  if (!std::isfinite(value)) value = last;
}
inline void mend(Message& message, const Message& last) noexcept {
  for_each_signal<Message>([&](const auto& each) { mend(message.*each.member, last.*each.member); });
}
inline void mend(MasterInput& input, const MasterInput& last) noexcept {
  mend(input.motor_position_m, last.motor_position_m);
  mend(input.motor_age_s, last.motor_age_s);
  mend(input.hand_force_N, last.hand_force_N);
  mend(input.grip, last.grip);
  mend(input.arrival.message, last.arrival.message);
}
inline void mend(SlaveInput& input, const SlaveInput& last) noexcept {
  mend(input.motor_position_m, last.motor_position_m);
  mend(input.motor_age_s, last.motor_age_s);
  mend(input.tip_force_N, last.tip_force_N);
  mend(input.arrival.message, last.arrival.message);
}

/// A controller of one site: where a user plugs in. Once a tick `respond` and then `applied` are called; both must not
/// allocate, lock or throw.
template <class Input, class Output>
class SiteController {
 public:
  virtual ~SiteController() = default;
  /// What to do about what was measured.
  virtual Output respond(const Input& input) noexcept = 0;
  /// The force in N that the safety gate really let through to the motor, until the next tick; that of each joint.
  virtual void applied(Each<Input, double> motor_force_N) noexcept = 0;
  /// Back to the state in which it was made.
  virtual void reset() noexcept = 0;
  [[nodiscard]] virtual std::unique_ptr<SiteController> clone() const = 0;
};

using MasterController = SiteController<MasterInput, MasterOutput>;
using SlaveController = SiteController<SlaveInput, SlaveOutput>;

/// A value type that can control a site: `respond`, `reset` and, where it needs to know, `applied`.
template <class E, class Input, class Output>
concept SiteElement = std::is_trivially_copyable_v<E> && requires(E element, const Input& input) {
  { element.respond(input) }
  noexcept->std::same_as<Output>;
  { element.reset() }
  noexcept;
};

/// A site element as a controller.
template <class Input, class Output, SiteElement<Input, Output> E>
class ControllerOf final : public SiteController<Input, Output> {
 public:
  explicit ControllerOf(const E& element) : element_(element) {}
  Output respond(const Input& input) noexcept override { return element_.respond(input); }
  void applied(Each<Input, double> motor_force_N) noexcept override {
    if constexpr (requires { element_.applied(motor_force_N); }) element_.applied(motor_force_N);
  }
  void reset() noexcept override { element_.reset(); }
  [[nodiscard]] std::unique_ptr<SiteController<Input, Output>> clone() const override {
    return std::make_unique<ControllerOf>(*this);
  }

 private:
  E element_;
};

template <class E>
std::unique_ptr<MasterController> master_controller(const E& element) {
  return std::make_unique<ControllerOf<MasterInput, MasterOutput, E>>(element);
}
template <class E>
std::unique_ptr<SlaveController> slave_controller(const E& element) {
  return std::make_unique<ControllerOf<SlaveInput, SlaveOutput, E>>(element);
}

/// The safety gates of the master: one for its motor, one for the actuator on its handle, which nobody measures. A
/// command that is not finite for either of them, and any other fault, releases both: a controller that lost one number
/// is not trusted with the other.
class MasterGates {
 public:
  MasterGates(const SafetyGate& motor, const ForceGate& handle) : motor_(motor), handle_(handle) {}
  /// The same force and rate for both. Implicit, because one gate says all where nobody asked for a second actuator.
  MasterGates(const SafetyGate& both) : MasterGates(both, both.force_gate()) {}

  /// The gate that reads the motor's position.
  [[nodiscard]] SafetyGate& motor() noexcept { return motor_; }
  [[nodiscard]] const SafetyGate& motor() const noexcept { return motor_; }
  /// The position in m to believe, as `SafetyGate` says. Real-time safe.
  double believe(const MasterInput& read, std::int64_t elapsed_ticks) noexcept {
    return motor_.believe(read.motor_position_m, elapsed_ticks, resisting_N(read), read.motor_age_s);
  }
  /// Puts what may reach the actuators in place of what was commanded. Real-time safe.
  void pass(MasterOutput& output) noexcept {
    constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
    const bool finite = std::isfinite(output.motor_force_N) && std::isfinite(output.handle_force_N);
    output.motor_force_N = motor_.pass(finite ? output.motor_force_N : not_a_number);
    output.handle_force_N = handle_.step(motor_.fault() == GateFault::none ? output.handle_force_N : not_a_number);
  }
  void reset() noexcept {
    motor_.reset();
    handle_.reset();
  }
  void rearm() noexcept {
    motor_.rearm();
    handle_.rearm();
  }
  /// Whether a force passes to any actuator.
  [[nodiscard]] bool pass_a_force() const noexcept { return motor_.passed_N() != 0.0 || handle_.passed_N() != 0.0; }

 private:
  SafetyGate motor_;
  ForceGate handle_;
};

/// The safety gate of the slave's motor.
class SlaveGates {
 public:
  SlaveGates(const SafetyGate& motor) : motor_(motor) {}

  [[nodiscard]] SafetyGate& motor() noexcept { return motor_; }
  [[nodiscard]] const SafetyGate& motor() const noexcept { return motor_; }
  /// The position in m to believe, as `SafetyGate` says. Real-time safe.
  double believe(const SlaveInput& read, std::int64_t elapsed_ticks) noexcept {
    return motor_.believe(read.motor_position_m, elapsed_ticks, resisting_N(read), read.motor_age_s);
  }
  /// Puts what may reach the motor in place of what was commanded. Real-time safe.
  void pass(SlaveOutput& output) noexcept { output.motor_force_N = motor_.pass(output.motor_force_N); }
  void reset() noexcept { motor_.reset(); }
  void rearm() noexcept { motor_.rearm(); }
  /// Whether a force passes to the motor.
  [[nodiscard]] bool pass_a_force() const noexcept { return motor_.passed_N() != 0.0; }

 private:
  SafetyGate motor_;
};

/// A controller behind its safety gates, one for each actuator. They stand outside of the controller, so none can leave
/// them out. Of several joints each has gates of its own, and a fault of one lets all go. A copy is a fork: it owns a
/// clone of the controller.
template <class In, class Out, class JointGates>
class Site {
 public:
  using Sensors = In;
  using Output = Out;
  using Wish = double;  ///< what share of the controller's force is wanted
  using Controller = SiteController<Sensors, Output>;
  using Gates = Each<In, JointGates>;
  using Forces = Each<In, double>;  ///< in N

  Site(std::unique_ptr<Controller> controller, const Gates& gates)
      : controller_(std::move(controller)), gates_(gates), believed_(nothing()) {}
  Site(const Site& other) : controller_(other.controller_->clone()), gates_(other.gates_), believed_(other.believed_) {}
  Site(Site&&) noexcept = default;
  Site& operator=(Site other) noexcept {
    std::swap(controller_, other.controller_);
    gates_ = other.gates_;
    believed_ = other.believed_;
    return *this;
  }
  ~Site() = default;

  /// One tick; the forces in the output are what the gates let through. What the controller wants is scaled by `share`
  /// before it, which brings a force in and out. `elapsed_ticks` is more than 1 after a stall. Real-time safe.
  Output step(const Sensors& input, double share = 1.0, std::int64_t elapsed_ticks = 1) noexcept {
    return step(input, share, elapsed_ticks, same_for_each(gates_, 0.0));
  }
  /// The same, and `added_N` comes to it at the motor.
  Output step(const Sensors& input, double share, std::int64_t elapsed_ticks, const Forces& added_N) noexcept {
    // A site that reads nonsense lets go until it is re-armed, even where the nonsense would not have reached a force,
    // and its controller goes on with what was read last: no number that is none gets into its state.
    Sensors read = input;
    for_each_joint(
        [elapsed_ticks](JointGates& gates, JointOf<In>& joint, const JointOf<In>& believed) noexcept {
          if (!is_finite(joint)) {
            gates.motor().refuse();
            mend(joint, believed);
          }
          joint.motor_position_m = gates.believe(joint, elapsed_ticks);
        },
        gates_, read, believed_);
    believed_ = read;
    Output output = controller_->respond(believed_);
    Forces passed = added_N;
    for_each_joint(
        [share](JointGates& gates, JointOf<Out>& joint, double added, double& force) noexcept {
          if (share != 1.0) scale(joint, share);
          if (added != 0.0) joint.motor_force_N += added;
          gates.pass(joint);
          force = joint.motor_force_N;
        },
        gates_, output, added_N, passed);
    if constexpr (has_joints<In>) {
      if (const GateFault found = fault(); found != GateFault::none && found != GateFault::energy) let_go();
    }
    controller_->applied(passed);
    return output;
  }
  /// As made.
  void reset() noexcept {
    controller_->reset();
    for_each_joint([](JointGates& gates) noexcept { gates.reset(); }, gates_);
    believed_ = nothing();
  }
  /// The controller as made and no fault any more; the forces go on from where they are, within the rate limit.
  void rearm() noexcept {
    controller_->reset();
    for_each_joint([](JointGates& gates) noexcept { gates.rearm(); }, gates_);
    believed_ = nothing();
  }
  /// Of the first joint that has one; one of energy counts last.
  [[nodiscard]] GateFault fault() const noexcept {
    GateFault found = GateFault::none;
    for_each_joint(
        [&found](const JointGates& gates) noexcept {
          const bool counts = found == GateFault::none || found == GateFault::energy;
          if (counts && gates.motor().fault() != GateFault::none) found = gates.motor().fault();
        },
        gates_);
    return found;
  }
  /// Of the first joint that has one.
  [[nodiscard]] ActiveLimit limit() const noexcept {
    ActiveLimit found = ActiveLimit::none;
    for_each_joint(
        [&found](const JointGates& gates) noexcept {
          if (found == ActiveLimit::none) found = gates.motor().limit();
        },
        gates_);
    return found;
  }
  /// The forces go to zero at the rate limit and stay there until `rearm`, but for that of a second actuator, which
  /// follows its share. Real-time safe.
  void let_go() noexcept {
    for_each_joint([](JointGates& gates) noexcept { gates.motor().let_go(); }, gates_);
  }
  /// The same, but the motor first brings the device to a stand where it can (`StoppingBrake`). Real-time safe.
  void brake() noexcept {
    for_each_joint([](JointGates& gates) noexcept { gates.motor().brake(); }, gates_);
  }
  /// Whether a force passes to any actuator.
  [[nodiscard]] bool passes_a_force() const noexcept {
    bool passes = false;
    for_each_joint([&passes](const JointGates& gates) noexcept { passes = passes || gates.pass_a_force(); }, gates_);
    return passes;
  }
  /// To look at.
  [[nodiscard]] const Gates& gates() const noexcept { return gates_; }

  /// Exchanges the controller for that of `other` and keeps the gates, so that no limit is lost. The new one first
  /// lives through `ticks` ticks of what was read last and of the force that the motor has now: its filters and models
  /// are then where a long rest at this very instant would have brought them. Does not allocate.
  void exchange_controller(Site& other, int ticks) noexcept {
    std::swap(controller_, other.controller_);
    Forces passed = same_for_each(gates_, 0.0);
    for_each_joint([](const JointGates& gates, double& force) noexcept { force = gates.motor().passed_N(); }, gates_,
                   passed);
    for (int i = 0; i < ticks; ++i) {
      controller_->respond(believed_);
      controller_->applied(passed);
    }
  }

 private:
  static void scale(JointOf<Out>& output, double share) noexcept {
    output.motor_force_N *= share;
    if constexpr (requires { output.handle_force_N; }) output.handle_force_N *= share;
  }
  [[nodiscard]] Sensors nothing() const noexcept { return same_for_each(gates_, JointOf<In>{}); }

  std::unique_ptr<Controller> controller_;
  Gates gates_;
  Sensors believed_;
};

using MasterSite = Site<MasterInput, MasterOutput, MasterGates>;
using SlaveSite = Site<SlaveInput, SlaveOutput, SlaveGates>;
using JointMasterSite = Site<Joints<MasterInput>, Joints<MasterOutput>, MasterGates>;
using JointSlaveSite = Site<Joints<SlaveInput>, Joints<SlaveOutput>, SlaveGates>;

}  // namespace tactus::control
