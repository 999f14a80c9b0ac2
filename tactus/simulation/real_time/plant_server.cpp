// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/real_time/plant_server.hpp>

namespace tactus::real_time {

Result<std::unique_ptr<PlantServer>> PlantServer::make(const std::string& name,
                                                       const experiments::TappingParams& params, Seconds silence) {
  if (!station::silence_bounds.contain(silence.value)) {
    Error error = out_of_bounds({}, silence.value, station::silence_bounds, units::second);
    error.place = "--silence-s";
    return error;
  }
  auto ensemble = experiments::TappingEnsemble::make(params);
  if (!ensemble) return ensemble.error();
  auto first = SimulatedPlant::make(ensemble->tap(0));
  if (!first) return first.error();
  auto segment = PlantSegment::create(name, {.master = first->master().limits(),
                                             .slave = first->slave().limits(),
                                             .simulated = true,
                                             .taps = params.task.taps,
                                             .configuration = plant_configuration(params)});
  if (!segment) return segment.error();
  return std::unique_ptr<PlantServer>(new PlantServer(*std::move(ensemble), *first, *std::move(segment), silence));
}

PlantServer::PlantServer(experiments::TappingEnsemble ensemble, const SimulatedPlant& first, PlantSegment segment,
                         Seconds silence)
    : ensemble_(std::move(ensemble)),
      plants_{first, first},
      segment_(std::move(segment)),
      silence_(silence),
      master_(segment_->master, silence, plants_[0].master().limits()),
      slave_(segment_->slave, silence, plants_[0].slave().limits()) {
  read();
}

void PlantServer::serve() {
  if (made_.load(std::memory_order_acquire) != 0) return;
  const PlantRequest request = segment_.request();
  if (!request.tap || *request.tap >= ensemble_.size() || request.session == served_) return;
  const auto plant = SimulatedPlant::make(ensemble_.tap(*request.tap));
  if (!plant) return;
  served_ = request.session;
  plants_[1 - current_] = *plant;
  made_.store(request.session, std::memory_order_release);
}

void PlantServer::begin(const PlantRequest& request) noexcept {
  session_ = request.session;
  running_ = false;
  if (request.tap) {
    // Devices at rest, under which no force is left.
    master_ = runtime::DeviceServer(segment_->master, silence_, plants_[current_].master().limits());
    slave_ = runtime::DeviceServer(segment_->slave, silence_, plants_[current_].slave().limits());
  }
  master_.begin(session_);
  slave_.begin(session_);
  if (!request.tap) return;
  taps_.fetch_add(1, std::memory_order_relaxed);
  segment_->simulated_truth.publish(plants_[current_].truth());
  read();
}

void PlantServer::read() noexcept {
  SimulatedPlant& plant = plants_[current_];
  const station::Tick now{.number = plant.ticks()};
  master_reading_ = plant.master().read(now);
  slave_reading_ = plant.slave().read(now);
}

void PlantServer::step(const station::Tick& tick) noexcept {
  const PlantRequest request = segment_.request();
  if (!request.tap && request.session != session_) begin(request);
  if (const std::uint64_t made = made_.load(std::memory_order_acquire); made != 0) {
    if (made == request.session) {
      current_ = 1 - current_;
      begin(request);
    }
    made_.store(0, std::memory_order_release);
  }

  const bool gave_up = master_.gave_up() || slave_.gave_up();
  const auto held_back = [this] { return master_.guard().held_back() + slave_.guard().held_back(); };
  const std::int64_t held_back_before = held_back();
  SimulatedPlant& plant = plants_[current_];
  plant.master().write(master_.command(tick));
  plant.slave().write(slave_.command(tick));
  held_back_.fetch_add(held_back() - held_back_before, std::memory_order_relaxed);

  if (!running_ && master_.obeyed() && slave_.obeyed()) {
    running_ = true;
    start_tick_ = tick.number - 1;
  }
  station::Tick own = tick;
  own.number = running_ ? tick.number - start_tick_ : 0;
  const std::int64_t before = plant.ticks();
  while (const auto truth = plant.next(own)) segment_->simulated_truth.publish(*truth);
  // Once for each instant of the plant: a sample draws noise.
  if (plant.ticks() > before) read();
  master_.publish(tick, plant.ticks(), master_reading_);
  slave_.publish(tick, plant.ticks(), slave_reading_);
  if (!gave_up && (master_.gave_up() || slave_.gave_up())) {
    released_.fetch_add(1, std::memory_order_relaxed);
    cause_.store(master_.gave_up() ? master_.guard().cause() : slave_.guard().cause(), std::memory_order_relaxed);
  }
  missed_.fetch_add(tick.missed, std::memory_order_relaxed);
  segment_->answer.store(session_, std::memory_order_release);
}

PlantStatus PlantServer::status() const {
  return {.readings = segment_->master.readings.published(),
          .commands = segment_->master.commands.published(),
          .missed = missed_.load(std::memory_order_relaxed),
          .taps = taps_.load(std::memory_order_relaxed),
          .released = released_.load(std::memory_order_relaxed),
          .cause = cause_.load(std::memory_order_relaxed),
          .held_back = held_back_.load(std::memory_order_relaxed),
          .cut = segment_.is_cut(),
          .controller = segment_.living_controller()};
}

}  // namespace tactus::real_time
