// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/safety_gate.hpp>
#include <tactus/kernel/control/site_signals.hpp>
#include <tactus/kernel/control/tare_report.hpp>

#include <cmath>
#include <concepts>
#include <limits>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

/// What a controller of a site is, and what is between it and a motor.
namespace tactus::control {

/// A controller of one site: where a user plugs in. Once a tick `respond` and then `applied` are called; both must not
/// allocate, lock or throw.
template <class Input, class Output>
class SiteController {
 public:
  virtual ~SiteController() = default;
  /// What to do about what was measured.
  virtual Output respond(const Input& input) noexcept = 0;
  /// The force in N that the safety gate really let through to the motor, until the next tick; that of each joint.
  /// Without what a drive's law gives, and with what of the support is still to come in: what a controller displays is
  /// what exceeds its support.
  virtual void applied(Each<Input, double> motor_force_N) noexcept = 0;
  /// Back to the state in which it was made, but for its force gain and the result of its tare.
  virtual void reset() noexcept = 0;
  [[nodiscard]] virtual std::unique_ptr<SiteController> clone() const = 0;

  /// Displayed force over the force that the other site sends; none if the controller has no such gain, or one that
  /// cannot change while it runs.
  [[nodiscard]] virtual std::optional<double> force_gain() const noexcept { return std::nullopt; }
  /// That gain from the next tick on. Without effect where `force_gain` is nullopt. Real-time safe.
  virtual void set_force_gain(double) noexcept {}

  /// Starts to identify what the model of gravity lacks, from the next tick on. Whoever calls it holds the device free
  /// of all else. False if the controller has no tare. Real-time safe.
  virtual bool begin_tare() noexcept { return false; }
  /// Ends a tare that is under way; what acted before it continues to. Real-time safe.
  virtual void stop_tare() noexcept {}
  /// Of the latest tare. Real-time safe.
  [[nodiscard]] virtual TareReport tare() const noexcept { return {}; }
  /// What is added to gravity compensation by the latest tare that succeeded, in N, for each of `joints` joints.
  /// Real-time safe.
  [[nodiscard]] virtual Each<Input, double> tared_N(const Each<Input, double>& joints) const noexcept {
    return same_for_each(joints, 0.0);
  }
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
  [[nodiscard]] std::optional<double> force_gain() const noexcept override {
    if constexpr (requires { element_.force_gain(); }) {
      return element_.force_gain();
    } else {
      return std::nullopt;
    }
  }
  void set_force_gain(double gain) noexcept override {
    if constexpr (requires { element_.set_force_gain(gain); }) element_.set_force_gain(gain);
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

/// Passes a motor's command, the law of its drive included, whose force is that at what was read. What is let through
/// is cut from the whole command (`keep_part`); a gate that has released its force leaves the drive no law. `stops` as
/// in `SafetyGate::pass`. Real-time safe.
template <class Input, class Output>
void pass_command(SafetyGate& gate, const Input& read, Output& output, bool stops) noexcept {
  if (!output.law.acts()) {
    output.law = {};
    output.motor_force_N = gate.pass(output.motor_force_N, stops);
    return;
  }
  const double wanted_N =
      output.motor_force_N + output.law.force_N(read.motor_position_m, read.motor_report.velocity_m_per_s);
  const double passed_N = gate.pass(wanted_N, stops);
  if (gate.has_released()) {
    output.law = {};
    output.motor_force_N = passed_N;
  } else if (passed_N != wanted_N) {
    keep_part(output.motor_force_N, output.law, wanted_N, passed_N);
  }
}

/// The safety gates of the master: one for its motor, one for the actuator on its handle, which nobody measures. A
/// command that is not finite for either of them, and any other fault, releases both: a controller that lost one number
/// is not trusted with the other.
class MasterGates {
 public:
  MasterGates(const SafetyGate& motor, const ForceGate& handle) : motor_(motor), handle_(handle) {}
  /// The same force and rate for both. Implicit, because one gate states all where nobody asked for a second actuator.
  MasterGates(const SafetyGate& both) : MasterGates(both, both.force_gate()) {}

  /// The gate that reads the motor's position.
  [[nodiscard]] SafetyGate& motor() noexcept { return motor_; }
  [[nodiscard]] const SafetyGate& motor() const noexcept { return motor_; }
  /// The position in m to assume, as `SafetyGate` states. Real-time safe.
  double believe(const MasterInput& read, std::int64_t elapsed_ticks) noexcept {
    elapsed_ticks_ = elapsed_ticks;
    return motor_.believe(read.motor_position_m, elapsed_ticks, resisting_N(read), read.motor_age_s, read.motor_report);
  }
  /// Puts what may reach the actuators in place of what was commanded; `stops` as in `SafetyGate::pass`. Real-time
  /// safe.
  void pass(MasterOutput& output, const MasterInput& read, bool stops = false) noexcept {
    constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
    if (!std::isfinite(output.handle_force_N)) output.motor_force_N = not_a_number;
    pass_command(motor_, read, output, stops);
    output.handle_force_N =
        handle_.step(motor_.fault() == GateFault::none ? output.handle_force_N : not_a_number, stops, elapsed_ticks_);
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
  std::int64_t elapsed_ticks_ = 1;
};

/// The safety gate of the slave's motor.
class SlaveGates {
 public:
  SlaveGates(const SafetyGate& motor) : motor_(motor) {}

  [[nodiscard]] SafetyGate& motor() noexcept { return motor_; }
  [[nodiscard]] const SafetyGate& motor() const noexcept { return motor_; }
  /// The position in m to assume, as `SafetyGate` states. Real-time safe.
  double believe(const SlaveInput& read, std::int64_t elapsed_ticks) noexcept {
    return motor_.believe(read.motor_position_m, elapsed_ticks, resisting_N(read), read.motor_age_s, read.motor_report);
  }
  /// Puts what may reach the motor in place of what was commanded. Real-time safe.
  void pass(SlaveOutput& output, const SlaveInput& read, bool stops = false) noexcept {
    pass_command(motor_, read, output, stops);
  }
  void reset() noexcept { motor_.reset(); }
  void rearm() noexcept { motor_.rearm(); }
  /// Whether a force passes to the motor.
  [[nodiscard]] bool pass_a_force() const noexcept { return motor_.passed_N() != 0.0; }

 private:
  SafetyGate motor_;
};

/// What is wanted of what a controller commands: of its force and of the law of its drives, and of what of that force
/// carries the device.
struct Shares {
  double force = 1.0;
  double support = 1.0;
  bool stops = false;  ///< the site gives its force up, as `SafetyGate::pass` states
};

/// A controller behind its safety gates, one for each actuator. They are outside of the controller, so none can leave
/// them out. Of several joints each has gates of its own, and a fault of one releases all. A copy is a fork: it owns a
/// clone of the controller.
template <class In, class Out, class JointGates>
class Site {
 public:
  using Sensors = In;
  using Output = Out;
  using Request = double;  ///< what share of the controller's force is wanted
  using Controller = SiteController<Sensors, Output>;
  using Gates = Each<In, JointGates>;
  using Forces = Each<In, double>;  ///< in N
  using Laws = Each<In, HoldingLaw>;

  Site(std::unique_ptr<Controller> controller, const Gates& gates)
      : controller_(std::move(controller)), gates_(gates), believed_(nothing()), weight_N_(same_for_each(gates, 0.0)) {}
  Site(const Site& other)
      : controller_(other.controller_->clone()),
        gates_(other.gates_),
        believed_(other.believed_),
        weight_N_(other.weight_N_),
        pushes_(other.pushes_),
        carried_(other.carried_) {}
  Site(Site&&) noexcept = default;
  Site& operator=(Site other) noexcept {
    std::swap(controller_, other.controller_);
    gates_ = other.gates_;
    believed_ = other.believed_;
    weight_N_ = other.weight_N_;
    pushes_ = other.pushes_;
    carried_ = other.carried_;
    return *this;
  }
  ~Site() = default;

  /// One tick; the forces in the output are what the gates let through. What the controller wants is scaled by `share`
  /// before it, which brings a force in and out. `elapsed_ticks` is more than 1 after a stall. Real-time safe.
  Output step(const Sensors& input, double share = 1.0, std::int64_t elapsed_ticks = 1) noexcept {
    return step(input, {.force = share, .support = share}, elapsed_ticks, same_for_each(gates_, 0.0));
  }
  /// The same with a share of its own for what carries the device, and `added_N` comes to it at the motor.
  Output step(const Sensors& input, const Shares& shares, std::int64_t elapsed_ticks, const Forces& added_N) noexcept {
    return step(input, shares, elapsed_ticks, added_N, same_for_each(gates_, HoldingLaw{}));
  }
  /// The same with a law that `holds` the device.
  Output step(const Sensors& input, const Shares& shares, std::int64_t elapsed_ticks, const Forces& added_N,
              const Laws& holds) noexcept {
    // A site that reads nonsense releases its force until it is re-armed, even where the nonsense would not have
    // reached a force, and its controller continues with what was read last: no invalid number gets into its state.
    for_each_joint(
        [elapsed_ticks](JointGates& gates, JointOf<In>& believed, const JointOf<In>& read) noexcept {
          if (!take_over(believed, read)) gates.motor().refuse();
          believed.motor_position_m = gates.believe(believed, elapsed_ticks);
        },
        gates_, believed_, input);
    Output output = controller_->respond(believed_);
    Forces passed = added_N;
    pushes_ = carried_ = false;
    for_each_joint(
        [this, &shares](JointGates& gates, JointOf<Out>& joint, const JointOf<In>& believed, double added,
                        const HoldingLaw& hold, double& weight_N, double& force) noexcept {
          const double wanted_support_N = weight_N = joint.support_N;
          carried_ = carried_ || wanted_support_N != 0.0;
          scale(joint, shares);
          if (added != 0.0) joint.motor_force_N += added;
          if (hold.acts()) {
            pushes_ = pushes_ || pushes(joint);
            hold.add_to(joint.motor_force_N, joint.law);
            gates.pass(joint, believed, shares.stops);
          } else {
            gates.pass(joint, believed, shares.stops);
            pushes_ = pushes_ || pushes(joint);
          }
          // The controller knows of its own command alone.
          force = joint.motor_force_N - hold.force_N;
          if (shares.support != 1.0) force += wanted_support_N - joint.support_N;
        },
        gates_, output, believed_, added_N, holds, weight_N_, passed);
    if constexpr (has_joints<In>) {
      if (const GateFault found = fault(); found != GateFault::none && found != GateFault::energy) release();
    }
    controller_->applied(passed);
    return output;
  }
  /// As made.
  void reset() noexcept {
    controller_->reset();
    for_each_joint([](JointGates& gates) noexcept { gates.reset(); }, gates_);
    believed_ = nothing();
    pushes_ = carried_ = false;
  }
  /// The controller as made and no fault any more; the forces continue from where they are, within the rate limit.
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
  /// The forces go to zero within `stop_time_s` and stay there until `rearm`, but for that of a second actuator, which
  /// follows its share. Real-time safe.
  void release() noexcept {
    for_each_joint([](JointGates& gates) noexcept { gates.motor().release(); }, gates_);
  }
  /// The same, but the motor first brings the device to rest where it can (`StoppingBrake`). Real-time safe.
  void brake() noexcept {
    for_each_joint([](JointGates& gates) noexcept { gates.motor().brake(); }, gates_);
  }
  /// Whether a force passes to any actuator.
  [[nodiscard]] bool passes_a_force() const noexcept {
    bool passes = false;
    for_each_joint([&passes](const JointGates& gates) noexcept { passes = passes || gates.pass_a_force(); }, gates_);
    return passes;
  }
  /// Whether a force passes, or a drive has a law, beyond what carries the device.
  [[nodiscard]] bool works() const noexcept { return pushes_; }
  /// Whether the controller carries the device (`support_N`), at the latest tick.
  [[nodiscard]] bool is_carried() const noexcept { return carried_; }
  /// What the controller takes each joint to weigh where it is, in N, whatever share of it is given: its support at the
  /// latest tick.
  [[nodiscard]] const Forces& weight_N() const noexcept { return weight_N_; }
  /// To look at.
  [[nodiscard]] const Gates& gates() const noexcept { return gates_; }

  /// As of its controller; all real-time safe.
  [[nodiscard]] std::optional<double> force_gain() const noexcept { return controller_->force_gain(); }
  void set_force_gain(double gain) noexcept { controller_->set_force_gain(gain); }
  bool begin_tare() noexcept { return controller_->begin_tare(); }
  void stop_tare() noexcept { controller_->stop_tare(); }
  [[nodiscard]] TareReport tare() const noexcept { return controller_->tare(); }
  [[nodiscard]] Forces tared_N() const noexcept { return controller_->tared_N(weight_N_); }

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
  static void scale(JointOf<Out>& output, const Shares& shares) noexcept {
    if (shares.force == 1.0 && shares.support == 1.0) return;
    if (output.support_N != 0.0) {
      const double support_N = shares.support * output.support_N;
      output.motor_force_N = support_N + shares.force * (output.motor_force_N - output.support_N);
      output.support_N = support_N;
    } else {
      output.motor_force_N *= shares.force;
    }
    output.law = output.law.times(shares.force);
    if constexpr (requires { output.handle_force_N; }) output.handle_force_N *= shares.force;
  }
  static bool pushes(const JointOf<Out>& passed) noexcept {
    bool pushes = passed.motor_force_N != passed.support_N || passed.law.acts();
    if constexpr (requires { passed.handle_force_N; }) pushes = pushes || passed.handle_force_N != 0.0;
    return pushes;
  }
  [[nodiscard]] Sensors nothing() const noexcept { return same_for_each(gates_, JointOf<In>{}); }

  std::unique_ptr<Controller> controller_;
  Gates gates_;
  Sensors believed_;
  Forces weight_N_;
  bool pushes_ = false;   ///< beyond the support, at the latest tick
  bool carried_ = false;  ///< by the controller's support, at the latest tick
};

using MasterSite = Site<MasterInput, MasterOutput, MasterGates>;
using SlaveSite = Site<SlaveInput, SlaveOutput, SlaveGates>;
using JointMasterSite = Site<Joints<MasterInput>, Joints<MasterOutput>, MasterGates>;
using JointSlaveSite = Site<Joints<SlaveInput>, Joints<SlaveOutput>, SlaveGates>;

}  // namespace tactus::control
