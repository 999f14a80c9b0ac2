// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/real_time/real_time_tap.hpp>

#include <cmath>
#include <utility>

namespace tactus::real_time {

using simulation::Teleoperator;

Result<std::unique_ptr<RealTimeTap>> RealTimeTap::make(const experiments::Tap& tap, double observation_s,
                                                       const runtime::RealTimeStreams& streams) {
  auto plant = SimulatedPlant::make(tap);
  if (!plant) return plant.error();
  auto own = std::make_unique<SimulatedPlant>(*std::move(plant));
  auto made = make(tap, observation_s, *own, streams);
  if (made) (*made)->own_ = std::move(own);
  return made;
}

Result<std::unique_ptr<RealTimeTap>> RealTimeTap::make(const experiments::Tap& tap, double observation_s,
                                                       TapPlant& plant, const runtime::RealTimeStreams& streams) {
  const Teleoperator::Params& params = tap.params;
  const auto clock = simulation::Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  auto loop =
      station::BareTeleoperator::make(params.control, params.channel, Seconds{clock->tick_s},
                                      params.control.position_scale * tap.path.start_m, plant.master(), plant.slave());
  if (!loop) return loop.error();
  return std::unique_ptr<RealTimeTap>(new RealTimeTap(tap, observation_s, streams, *clock, plant, *std::move(loop)));
}

RealTimeTap::RealTimeTap(const experiments::Tap& tap, double observation_s, const runtime::RealTimeStreams& streams,
                         const simulation::Clock& clock, TapPlant& plant, station::BareTeleoperator loop)
    : clock_(clock), plant_(&plant), loop_(std::move(loop)), observer_(tap, observation_s), streams_(streams) {
  // Filled and emptied, so that every page of it is there.
  trace_.resize(observer_.most_ticks());
  trace_.clear();
}

bool RealTimeTap::complete(const SimulatedTruth& truth) noexcept {
  Teleoperator::add_contact(record_,
                            {.sum_N = truth.contact_sum_N,
                             .peak_N = truth.contact_peak_N,
                             .touched = truth.touched != 0,
                             .touched_substep = static_cast<int>(truth.touched_substep),
                             .touched_after_s = truth.touched_after_s},
                            clock_);
  trace_.push_back(record_);
  if (streams_.teleoperator != nullptr) {
    const auto since_start_ns = static_cast<std::int64_t>(std::llround(1e9 * record_.time_s));
    streams_.teleoperator->push(static_cast<std::uint64_t>(start_ns_ + since_start_ns), record_);
  }
  ++plant_ticks_;
  return observer_.observe(record_, loop_.healthy());
}

bool RealTimeTap::step(const station::Tick& tick) noexcept {
  if (first_tick_ < 0) {
    first_tick_ = tick.number;
    start_ns_ = tick.deadline_ns - streams_.origin_ns;
  }
  // Time counts from the first step, as the devices' does.
  station::Tick own = tick;
  own.number -= first_tick_;
  while (!over_) {
    const auto truth = plant_->next(own);
    if (!truth) break;
    over_ = !complete(*truth);
    record_.time_s = static_cast<double>(plant_ticks_) * clock_.tick_s;
    record_.tip_position_m = truth->tip_position_m;
  }
  if (over_) return step_to_rest(own);
  const station::BarePair::Output output = loop_.step(own, 1.0);
  record_ = Teleoperator::recorded(static_cast<double>(plant_ticks_) * clock_.tick_s, output);
  record_.tip_position_m = plant_->tip_position_m();
  const auto due_ns = static_cast<std::uint64_t>(tick.deadline_ns - streams_.origin_ns);
  if (streams_.sites != nullptr) streams_.sites->push(due_ns, runtime::recorded(streams_.tap, own, output));
  if (streams_.servo != nullptr) streams_.servo->push(due_ns, runtime::recorded(own));
  return !(plant_->lost() && loop_.at_rest());
}

bool RealTimeTap::step_to_rest(const station::Tick& own) noexcept {
  loop_.step_to_rest(own);
  letting_go_s_ += static_cast<double>(own.missed + 1) * clock_.tick_s;
  if (!loop_.at_rest() && letting_go_s_ < runtime::longest_ramp_s) return true;
  loop_.release();
  return false;
}

}  // namespace tactus::real_time
