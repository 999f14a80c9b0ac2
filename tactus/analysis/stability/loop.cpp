// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/declared.hpp>
#include <tactus/analysis/stability/linear_element.hpp>
#include <tactus/analysis/stability/loop.hpp>

#include <cmath>
#include <limits>
#include <type_traits>
#include <utility>

namespace tactus::stability {

namespace {

/// The tick of a whole system that is being worked out.
struct Instant {
  const Eigen::VectorXd* state = nullptr;
  Eigen::VectorXd* next = nullptr;
};

/// A system of one input and one output that is stepped within the tick of the whole.
class Part {
 public:
  Part(StateSpace system, Eigen::Index at, const Instant& now) : system_(std::move(system)), at_(at), now_(&now) {}

  [[nodiscard]] Eigen::Index states() const { return system_.states(); }
  [[nodiscard]] double output(double input) const {
    return (system_.c * now_->state->segment(at_, states()))(0) + system_.d(0, 0) * input;
  }
  void advance(double input) const {
    auto mine = now_->next->segment(at_, states());
    mine.noalias() = system_.a * now_->state->segment(at_, states());
    mine += system_.b.col(0) * input;
  }
  [[nodiscard]] double step(double input) const {
    const double stepped = output(input);
    advance(input);
    return stepped;
  }

 private:
  StateSpace system_;
  Eigen::Index at_;  ///< of its first state among those of the whole
  const Instant* now_;
};

/// What stands for a stage in the chain of its site.
template <class Stage>
struct Linear {
  Part part;
  [[nodiscard]] bool on() const { return part.states() > 0; }
  [[nodiscard]] double step(double input) const { return part.step(input); }
};

template <>
struct Linear<control::Crossover> {
  Part part;
  [[nodiscard]] control::Crossover::Output step(double input) const {
    const double below = part.step(input);
    return {.below_N = below, .above_N = input - below};
  }
};

template <>
struct Linear<control::GripCancellation> {
  Part part;
  bool cancels;
  [[nodiscard]] double induced_position_m() const { return cancels ? part.output(0.0) : 0.0; }
  [[nodiscard]] double intended(double measured_m, double) const { return measured_m - induced_position_m(); }
  [[nodiscard]] static control::HandEstimate hand() { return {}; }
  [[nodiscard]] double admissible_N(double wanted_N, double) const { return wanted_N; }
  void advance(double motor_N) const {
    if (cancels) part.advance(motor_N);
  }
};

double output_of(double output) { return output; }
/// What goes to the handle is the rest.
double output_of(const control::Crossover::Output& parts) { return parts.below_N; }

template <class Element>
Result<StateSpace> probe_element(const typename Element::Params& params, Seconds dt) {
  auto element = Element::make(params, dt);
  if (!element) return element.error();
  return probe(Element::linear_states, [&element](double input) { return output_of(element->step(input)); });
}

}  // namespace

Eigen::Index ticks_of(const station::Channel::Params& channel, double tick_s) {
  return static_cast<Eigen::Index>(std::lround(channel.delay_s / tick_s));
}

Result<LinearSites> linear_sites(const simulation::Teleoperator::Params& params, const Linearisation& linearisation) {
  // What cannot be simulated is not analysed either, so that both refuse alike.
  if (const auto teleoperator = simulation::Teleoperator::make(params, 0.0); !teleoperator) return teleoperator.error();
  const control::ControlParams& control = params.control;
  if (auto error = check_declared(control, Analysis::linear)) return *std::move(error);
  const Seconds tick{simulation::Clock::make(params.servo, params.plant)->tick_s};
  const bool cancels = control.cancellation == control::CancellationMode::on;

  Instant now;
  Eigen::Index states = 0;
  Check failed;
  LinearSites sites;
  const auto linear = [&]<class Stage>(const char*, const typename Stage::Params& own) -> Linear<Stage> {
    constexpr bool model = std::is_same_v<Stage, control::GripCancellation>;
    auto system = [&] {
      if constexpr (model) return probe_model(own.cancellation.model, tick, linearisation);
      if constexpr (!model) return probe_element<Stage>(own, tick);
    }();
    if (!system && !failed) failed = system.error();
    Part part(system ? *std::move(system) : StateSpace{}, states, now);
    if constexpr (model) {
      if (system) sites.modelled = *system;
      if (cancels) states += part.states();
      return {.part = std::move(part), .cancels = cancels};
    } else {
      states += part.states();
      return {.part = std::move(part)};
    }
  };
  const auto stages = control::PositionForceMaster::each_stage<Linear>(control, linear);
  if (failed) return *std::move(failed);
  auto servo = probe_element<control::ServoPd>(control.slave, tick);
  if (!servo) return servo.error();

  // The force arrives times μ, and nothing saturates.
  const control::PositionForceMaster::Gains gains{.position_scale = control.position_scale,
                                                  .force_gain = 1.0,
                                                  .force_limit_N = std::numeric_limits<double>::infinity(),
                                                  .cancels = cancels};
  sites.master =
      assemble(states, site_inputs, site_outputs, [&](const auto& state, const auto& input, auto& next, auto& output) {
        now = {.state = &state, .next = &next};
        const auto said = control::PositionForceMaster::chain(
            stages, gains,
            {.motor_position_m = input[measured_in], .arrival = {.message = {.force_N = input[arrived_force_in]}}});
        stages.cancellation.advance(said.motor_force_N);
        // A force of none is +0 whichever its sign in the chain.
        output[motor_force_out] = said.motor_force_N + 0.0;
        output[message_out] = said.message.position_m;
        output[handle_force_out] = said.handle_force_N + 0.0;
      });
  sites.slave = *std::move(servo);
  return sites;
}

Result<Loop> make_loop(const simulation::Teleoperator::Params& params, const Linearisation& linearisation) {
  if (auto error = validate(linearisation)) return *std::move(error);
  const auto sites = linear_sites(params, linearisation);
  if (!sites) return sites.error();
  const auto clock = simulation::Clock::make(params.servo, params.plant);
  const double late_s = clock->late_substeps * clock->substep_s;

  const StateSpace master = linear_master(params.master, params.person.grip, linearisation);
  const StateSpace slave =
      linear_device(params.slave.mechanism, params.slave.amplifier, params.slave.force_sensor.bandwidth_Hz,
                    wall_load(params.environment, linearisation.preload_N), linearisation);
  const StateSpace master_plant = sampled(driven(master), clock->tick_s, late_s);
  const StateSpace slave_plant = sampled(
      {.a = slave.a, .b = slave.b.col(command_in), .c = slave.c, .d = slave.d.col(command_in)}, clock->tick_s, late_s);

  Loop loop;
  loop.tick_s = clock->tick_s;
  loop.force_gain = params.control.force_gain;
  loop.position_scale = params.control.position_scale;
  loop.delay_ticks =
      ticks_of(params.channel.to_slave, loop.tick_s) + ticks_of(params.channel.to_master, loop.tick_s) + 1;

  // No plant answers within its tick, so each is read first.
  const Eigen::Index motors = master_plant.states(), sited = sites->master.states();
  loop.master = assemble(motors + sited, 1, 1, [&](const auto& state, const auto& input, auto& next, auto& output) {
    const Eigen::VectorXd plant = state.head(motors), site = state.tail(sited);
    const Eigen::Vector2d seen{(master_plant.c * plant)(0), input[0]};
    const Eigen::VectorXd said = sites->master.c * site + sites->master.d * seen;
    output[0] = said[message_out];
    next.head(motors) =
        master_plant.a * plant + master_plant.b * Eigen::Vector2d{said[motor_force_out], said[handle_force_out]};
    next.tail(sited) = sites->master.a * site + sites->master.b * seen;
  });
  Instant now;
  const Part feedback(sites->slave, slave_plant.states(), now);
  loop.slave = assemble(slave_plant.states() + feedback.states(), 1, 1,
                        [&](const auto& state, const auto& input, auto& next, auto& output) {
                          now = {.state = &state, .next = &next};
                          const Eigen::VectorXd plant = state.head(slave_plant.states());
                          const Eigen::VectorXd measured = slave_plant.c * plant;
                          const double error_m = input[0] - measured[motor_out];
                          output[0] = measured[sensor_out];
                          next.head(slave_plant.states()) =
                              slave_plant.a * plant + slave_plant.b.col(0) * feedback.output(error_m);
                          feedback.advance(error_m);
                        });
  loop.induced = one_channel(master_plant, 0, 0);
  loop.modelled = sites->modelled;
  return loop;
}

std::complex<double> Loop::at(double frequency_rad_per_s) const {
  const double angle = frequency_rad_per_s * tick_s;
  const std::complex<double> z = std::polar(1.0, angle);
  // The master gives way to the force, so its response is negative and the feedback that it closes is too.
  return -force_gain * response(master, z)(0, 0) * response(slave, z)(0, 0) *
         std::polar(1.0, -angle * static_cast<double>(delay_ticks));
}

StateSpace Loop::closed(double gain) const {
  const Eigen::Index masters = master.states(), slaves = slave.states();
  const Eigen::Index states = masters + slaves + delay_ticks;
  return assemble(states, 0, 0, [&](const auto& state, const auto&, auto& next, auto&) {
    const Eigen::VectorXd q = state.head(masters), s = state.segment(masters, slaves);
    // The oldest force in the delay, which stands last, arrives.
    const double arrived_N = gain * state[states - 1];
    const double command_m = (master.c * q)(0) + master.d(0, 0) * arrived_N;
    next.head(masters) = master.a * q + master.b.col(0) * arrived_N;
    next.segment(masters, slaves) = slave.a * s + slave.b.col(0) * command_m;
    next[masters + slaves] = (slave.c * s)(0) + slave.d(0, 0) * command_m;
    for (Eigen::Index i = masters + slaves + 1; i < states; ++i) next[i] = state[i - 1];
  });
}

double mass_ratio(const simulation::Teleoperator::Params& params) {
  const auto moving_kg = [](const mechanics::CableChain::Params& chain) {
    return chain.motor.mass_kg + chain.drum.mass_kg + chain.tip.mass_kg;
  };
  return moving_kg(params.master.mechanism) / moving_kg(params.slave.mechanism);
}

}  // namespace tactus::stability
