#pragma once

#include <tactus/control/safety_gate.hpp>

#include <concepts>
#include <memory>
#include <type_traits>
#include <utility>

/// What the two sites of a teleoperator measure, command and tell one another, and what a controller of a site is. One
/// axis each; positions and forces are positive toward the environment unless said otherwise.
namespace tactus::control {

/// What one site tells the other at a tick. Each architecture fills the members that it uses; the rest stay zero.
struct Message {
  double position_m = 0.0;
  double velocity_m_per_s = 0.0;
  double force_N = 0.0;
  double wave = 0.0;      ///< wave variable, in the square root of a watt
  double energy_J = 0.0;  ///< sent so far, a running total: a lost message then loses no energy
};

/// The newest message of the other site. A site gets one every tick; `fresh` tells whether it arrived since the last.
struct Arrival {
  Message message;
  bool fresh = false;
};

/// What the master's sensors read at a tick, and what came from the slave.
struct MasterInput {
  double motor_position_m = 0.0;
  Arrival arrival;
  double grip = 1.0;  ///< how firmly the person holds, over nominal, where a sensor tells; 1 without one
};

/// What the master commands and tells, and what its stages made of it, for the log.
struct MasterOutput {
  double motor_force_N = 0.0;  ///< positive toward the environment; a force that pushes the hand back is negative
  Message message;
  double induced_position_m = 0.0;   ///< the estimate of what the displayed force did to the motor, at this instant
  double intended_position_m = 0.0;  ///< measured less induced
};

/// What the slave's sensors read at a tick, and what came from the master.
struct SlaveInput {
  double motor_position_m = 0.0;
  double tip_force_N = 0.0;  ///< positive when the environment pushes the slave back
  Arrival arrival;
};

/// What the slave commands and tells.
struct SlaveOutput {
  double motor_force_N = 0.0;  ///< positive toward the environment
  Message message;
};

/// A controller of one site: where a user plugs in. Once a tick `respond` and then `applied` are called; both must not
/// allocate, lock or throw.
template <class Input, class Output>
class SiteController {
 public:
  virtual ~SiteController() = default;
  /// What to do about what was measured.
  virtual Output respond(const Input& input) noexcept = 0;
  /// The force in N that the safety gate really let through to the motor, until the next tick.
  virtual void applied(double motor_force_N) noexcept = 0;
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
  void applied(double motor_force_N) noexcept override {
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

/// A controller behind its safety gate. The gate stands outside of the controller, so none can leave it out. A copy is
/// a fork: it owns a clone of the controller.
template <class Input, class Output>
class Site {
 public:
  using Controller = SiteController<Input, Output>;

  Site(std::unique_ptr<Controller> controller, const SafetyGate& gate)
      : controller_(std::move(controller)), gate_(gate) {}
  Site(const Site& other) : controller_(other.controller_->clone()), gate_(other.gate_) {}
  Site(Site&&) noexcept = default;
  Site& operator=(Site other) noexcept {
    std::swap(controller_, other.controller_);
    gate_ = other.gate_;
    return *this;
  }
  ~Site() = default;

  /// One tick; the force in the output is what the gate let through. Real-time safe.
  Output step(const Input& input) noexcept {
    Output output = controller_->respond(input);
    output.motor_force_N = gate_.step(output.motor_force_N);
    controller_->applied(output.motor_force_N);
    return output;
  }
  void reset() noexcept {
    controller_->reset();
    gate_.reset();
  }
  [[nodiscard]] GateFault fault() const noexcept { return gate_.fault(); }

 private:
  std::unique_ptr<Controller> controller_;
  SafetyGate gate_;
};

using MasterSite = Site<MasterInput, MasterOutput>;
using SlaveSite = Site<SlaveInput, SlaveOutput>;

}  // namespace tactus::control
