#include <tactus/stability/linear_element.hpp>
#include <tactus/stability/loop.hpp>

#include <cmath>
#include <optional>
#include <utility>

namespace tactus::stability {

namespace {

Error unsupported(std::string parameter, const char* message) {
  return {.code = ErrorCode::inconsistent, .parameter = std::move(parameter), .message = message, .place = {}};
}

Check check_supported(const control::ControlParams& control) {
  if (control.architecture != "position-force") {
    return unsupported(
        "control.architecture",
        "the loop of induced motion is that of position-force: choose it, or judge others by tactus run");
  }
  if (control.slave_force.source != control::SlaveForceSource::sensor) {
    return unsupported("control.slave_force.source",
                       "linear analysis has no model of the estimators, whose friction is not linear: choose sensor");
  }
  if (control.operator_estimate == control::OperatorEstimate::online) {
    return unsupported(
        "control.operator_estimate",
        "an estimate that adapts to the loop is not linear: choose off, and try hands with operator.grip");
  }
  return std::nullopt;
}

/// A system of one input and one output that is stepped within another tick.
struct Part {
  const StateSpace& system;
  Eigen::Index at;  ///< of its first state among those of the whole

  [[nodiscard]] double output(const Eigen::VectorXd& state, double input) const {
    return (system.c * state.segment(at, system.states()))(0) + system.d(0, 0) * input;
  }
  void advance(const Eigen::VectorXd& state, double input, Eigen::VectorXd& next) const {
    auto mine = next.segment(at, system.states());
    mine.noalias() = system.a * state.segment(at, system.states());
    mine += system.b.col(0) * input;
  }
};

double output_of(double output) { return output; }
/// What goes to the handle is the rest.
double output_of(const control::Crossover::Output& parts) { return parts.below_N; }

template <class Element>
Result<StateSpace> probe_element(int order, const typename Element::Params& params, Seconds dt) {
  auto element = Element::make(params, dt);
  if (!element) return element.error();
  return probe(order, [&element](double input) { return output_of(element->step(input)); });
}

}  // namespace

Eigen::Index ticks_of(const station::Channel::Params& channel, double tick_s) {
  return static_cast<Eigen::Index>(std::lround(channel.delay_s / tick_s));
}

Result<LinearSites> linear_sites(const simulation::Teleoperator::Params& params, const Linearisation& linearisation) {
  // What cannot be simulated is not analysed either, so that both refuse alike.
  if (const auto teleoperator = simulation::Teleoperator::make(params, 0.0); !teleoperator) return teleoperator.error();
  const control::ControlParams& control = params.control;
  if (auto error = check_supported(control)) return *std::move(error);
  const Seconds tick{simulation::Clock::make(params.servo, params.plant)->tick_s};

  const auto model = probe_model({.master = control.model,
                                  .fidelity = control.cancellation_model,
                                  .step = control.cancellation_step,
                                  .friction = control.cancellation_friction},
                                 tick, linearisation);
  if (!model) return model.error();
  const auto force_filter = probe_element<control::ShapingFilter>(2, control.force_filter, tick);
  if (!force_filter) return force_filter.error();
  const auto command_filter = probe_element<control::ShapingFilter>(2, control.command_filter, tick);
  if (!command_filter) return command_filter.error();
  const auto crossover = probe_element<control::Crossover>(2, control.crossover, tick);
  if (!crossover) return crossover.error();
  const auto compensation = probe_element<control::HandForceCompensation>(
      2, {.master = control.model, .band_Hz = control.hand_compensation_Hz}, tick);
  if (!compensation) return compensation.error();
  const auto damping = probe_element<control::LocalDamping>(1, control.damping, tick);
  if (!damping) return damping.error();
  auto servo = probe_element<control::ServoPd>(1, control.slave, tick);
  if (!servo) return servo.error();

  const bool cancels = control.cancellation == control::CancellationMode::on;
  const Part force{*force_filter, 0};
  const Part below{*crossover, force.at + force.system.states()};
  const Part compensated{*compensation, below.at + below.system.states()};
  const Part rate{*damping, compensated.at + compensated.system.states()};
  const Part command{*command_filter, rate.at + rate.system.states()};
  const Part belief{*model, command.at + command.system.states()};
  const Eigen::Index states = belief.at + (cancels ? belief.system.states() : 0);
  LinearSites sites;
  sites.master =
      assemble(states, site_inputs, site_outputs, [&](const auto& state, const auto& input, auto& next, auto& output) {
        // Damping's force counts as displayed, so it drives the model too.
        const double wanted_N = force.output(state, input[arrived_force_in]);
        const double below_N = below.output(state, wanted_N);
        const double motor_N = rate.output(state, input[measured_in]) - compensated.output(state, below_N);
        const double induced_m = cancels ? belief.output(state, 0.0) : 0.0;
        const double intended_m = input[measured_in] - induced_m;
        output[motor_force_out] = motor_N;
        output[message_out] = control.position_scale * command.output(state, intended_m);
        output[handle_force_out] = below_N - wanted_N;
        force.advance(state, input[arrived_force_in], next);
        below.advance(state, wanted_N, next);
        compensated.advance(state, below_N, next);
        rate.advance(state, input[measured_in], next);
        command.advance(state, intended_m, next);
        if (cancels) belief.advance(state, motor_N, next);
      });
  sites.slave = *std::move(servo);
  sites.modelled = *model;
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
  const Part feedback{sites->slave, slave_plant.states()};
  loop.slave = assemble(slave_plant.states() + feedback.system.states(), 1, 1,
                        [&](const auto& state, const auto& input, auto& next, auto& output) {
                          const Eigen::VectorXd plant = state.head(slave_plant.states());
                          const Eigen::VectorXd measured = slave_plant.c * plant;
                          const double error_m = input[0] - measured[motor_out];
                          output[0] = measured[sensor_out];
                          next.head(slave_plant.states()) =
                              slave_plant.a * plant + slave_plant.b.col(0) * feedback.output(state, error_m);
                          feedback.advance(state, error_m, next);
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
