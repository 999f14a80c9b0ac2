#include <tactus/runtime/real_time_tap.hpp>

#include <cmath>
#include <utility>

namespace tactus::runtime {

using simulation::Teleoperator;

Result<std::unique_ptr<RealTimeTap>> RealTimeTap::make(const simulation::Tap& tap, double observation_s,
                                                       const RealTimeStreams& streams) {
  const Teleoperator::Params& params = tap.params;
  const auto clock = simulation::Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  const double slave_start_m = params.control.position_scale * tap.path.start_m;
  auto master = simulation::MasterPlant::make(params.master, params.person, *clock, tap.path.start_m);
  if (!master) return master.error();
  auto slave = simulation::SlavePlant::make(params.slave, params.environment, *clock, slave_start_m);
  if (!slave) return slave.error();
  std::unique_ptr<RealTimeTap> made(new RealTimeTap(tap, observation_s, streams, *clock, *master, *slave));
  auto loop = LocalTeleoperator::make(params.control, params.channel, Seconds{clock->tick_s}, slave_start_m,
                                      made->master_, made->slave_);
  if (!loop) return loop.error();
  made->loop_ = std::make_unique<LocalTeleoperator>(*std::move(loop));
  return made;
}

RealTimeTap::RealTimeTap(const simulation::Tap& tap, double observation_s, const RealTimeStreams& streams,
                         const simulation::Clock& clock, const simulation::MasterPlant& master,
                         const simulation::SlavePlant& slave)
    : clock_(clock),
      master_(master, clock, tap.path,
              {.force_N = tap.params.master.amplifier.limit_N,
               .handle_force_N = tap.params.master.handle_actuator.limit_N}),
      slave_(slave, clock, {.force_N = tap.params.slave.amplifier.limit_N}),
      observer_(tap, observation_s),
      streams_(streams) {
  // Filled and emptied, so that every page of it is there.
  trace_.resize(observer_.most_ticks());
  trace_.clear();
}

bool RealTimeTap::complete() noexcept {
  Teleoperator::add_contact(record_, slave_.plant().contact(), clock_);
  trace_.push_back(record_);
  if (streams_.teleoperator != nullptr) {
    const auto since_start_ns = static_cast<std::int64_t>(std::llround(1e9 * record_.time_s));
    streams_.teleoperator->push(static_cast<std::uint64_t>(start_ns_ + since_start_ns), record_);
  }
  return observer_.observe(record_, loop_->healthy());
}

bool RealTimeTap::step(const Tick& tick) noexcept {
  if (first_tick_ < 0) {
    first_tick_ = tick.number;
    start_ns_ = tick.deadline_ns - streams_.origin_ns;
  }
  // Time counts from the first step, as the devices' does.
  Tick own = tick;
  own.number -= first_tick_;
  while (master_.ticks() < own.number) {
    master_.advance();
    slave_.advance();
    if (!complete()) {
      loop_->release();
      return false;
    }
    record_.time_s = static_cast<double>(master_.ticks()) * clock_.tick_s;
    record_.tip_position_m = slave_.plant().tip_position_m();
  }
  const LocalTeleoperator::Output output = loop_->step(own);
  const double time_s = static_cast<double>(own.number) * clock_.tick_s;
  record_ = Teleoperator::recorded(
      time_s,
      {.motor_position_m = output.master.position_m, .hand_force_N = output.master.force_N, .grip = output.master.grip},
      {.motor_position_m = output.slave.position_m, .tip_force_N = output.slave.force_N}, output.sites);
  record_.tip_position_m = slave_.plant().tip_position_m();
  const auto due_ns = static_cast<std::uint64_t>(tick.deadline_ns - streams_.origin_ns);
  if (streams_.sites != nullptr) streams_.sites->push(due_ns, recorded(streams_.tap, own, output));
  if (streams_.servo != nullptr) streams_.servo->push(due_ns, recorded(own));
  return true;
}

}  // namespace tactus::runtime
