// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/real_time/shared_plant.hpp>

#include <chrono>
#include <sstream>
#include <thread>

namespace tactus::real_time {

namespace {

Error plant_error(ErrorCode code, std::string message) {
  return {.code = code, .parameter = {}, .message = std::move(message), .place = "--plant"};
}

/// The first line in which two TOML texts of the same keys differ, with its section, and what the other has.
struct TomlDifference {
  std::string key;
  std::string one;
  std::string other;
};
TomlDifference first_difference(const std::string& one, const std::string& other) {
  std::istringstream ones(one), others(other);
  std::string section, left, right;
  while (std::getline(ones, left) && std::getline(others, right) && left == right) {
    if (left.starts_with('[')) section = left.substr(1, left.size() - 2) + ".";
  }
  const auto split = [](const std::string& line, bool value) {
    const auto equals = line.find(" = ");
    if (equals == std::string::npos) return line;
    return value ? line.substr(equals + 3) : line.substr(0, equals);
  };
  return {.key = section + split(left, false), .one = split(left, true), .other = split(right, true)};
}

}  // namespace

Result<std::unique_ptr<SharedPlant>> SharedPlant::attach(const std::string& name, Seconds silence) {
  if (!station::silence_bounds.contain(silence.value)) {
    Error error = out_of_bounds({}, silence.value, station::silence_bounds, units::second);
    error.place = "--plant-silence-s";
    return error;
  }
  auto segment = PlantSegment::attach(name);
  if (!segment) return segment.error();
  return std::unique_ptr<SharedPlant>(new SharedPlant(*std::move(segment), silence));
}

SharedPlant::SharedPlant(PlantSegment segment, Seconds silence)
    : segment_(std::move(segment)),
      silence_(silence),
      master_(segment_->master, segment_.facts().master, silence, segment_.facts().simulated),
      slave_(segment_->slave, segment_.facts().slave, silence, segment_.facts().simulated) {}

SharedPlant::~SharedPlant() { end(); }

Check SharedPlant::check(const experiments::TappingParams& params) const {
  const PlantFacts facts = segment_.facts();
  const std::string wanted = plant_configuration(params);
  if (wanted != facts.configuration) {
    const TomlDifference found = first_difference(wanted, facts.configuration);
    return plant_error(ErrorCode::inconsistent, "the plant '" + segment_.name() + "' is another one: " + found.key +
                                                    " is " + found.one + " in this run and " + found.other +
                                                    " there: start both with the same experiment and --set");
  }
  if (params.task.taps <= facts.taps) return std::nullopt;
  return plant_error(ErrorCode::inconsistent, "the plant '" + segment_.name() + "' has " + std::to_string(facts.taps) +
                                                  " taps and this run asks for " + std::to_string(params.task.taps) +
                                                  ": start the plant with --set task.taps=" +
                                                  std::to_string(params.task.taps) + ", or ask for fewer");
}

Check SharedPlant::begin(std::size_t tap) {
  using namespace std::chrono_literals;
  const std::uint64_t session = segment_.ask(tap);
  // Devices are made for it on the other side, by a thread that may have to wait for the processor.
  const auto last = std::chrono::steady_clock::now() + 5s;
  while (segment_->answer.load(std::memory_order_acquire) != session) {
    if (segment_.is_cut() || !segment_.living_owner()) return why_lost();
    if (std::chrono::steady_clock::now() > last) {
      return plant_error(ErrorCode::failed, "the plant '" + segment_.name() + "' did not begin tap " +
                                                std::to_string(tap) + " within 5 s: stop it and start it again");
    }
    std::this_thread::sleep_for(1ms);
  }
  master_.begin(session);
  slave_.begin(session);
  next_truth_ = segment_->simulated_truth.published();
  const auto start = segment_->simulated_truth.newest();
  tip_position_m_ = start ? start->tip_position_m : 0.0;
  fell_behind_ = false;
  return std::nullopt;
}

void SharedPlant::end() noexcept { segment_.ask(std::nullopt); }

std::optional<SimulatedTruth> SharedPlant::next(const station::Tick&) noexcept {
  if (segment_.is_cut()) {
    master_.lose();
    slave_.lose();
    return std::nullopt;
  }
  if (next_truth_ == segment_->simulated_truth.published()) return std::nullopt;
  const auto truth = segment_->simulated_truth.at(next_truth_);
  if (!truth) {
    fell_behind_ = true;
    master_.lose();
    slave_.lose();
    return std::nullopt;
  }
  ++next_truth_;
  tip_position_m_ = truth->tip_position_m;
  return truth;
}

bool SharedPlant::lost() const noexcept {
  return master_.health() == station::DeviceHealth::lost || slave_.health() == station::DeviceHealth::lost;
}

Error SharedPlant::why_lost() const {
  const std::string plant = "the plant '" + segment_.name() + "' ";
  const std::string bound = rounded_number(silence_.value) + " s";
  if (segment_.is_cut()) {
    return plant_error(
        ErrorCode::failed,
        plant +
            "is cut off: another process has shortened its shared memory; both sides release their force; start "
            "it again, and find out what writes to /dev/shm");
  }
  if (!segment_.living_owner()) {
    return plant_error(ErrorCode::failed, plant + "died in the run: both sites release their force; start it again");
  }
  for (const runtime::SharedDevice* device : {&master_, &slave_}) {
    if (!device->given_up_by_owner()) continue;
    const std::string whose = device == &master_ ? "released at the master: " : "released at the slave: ";
    if (device->owners_cause() != station::ReleaseCause::timed_out) {
      return plant_error(ErrorCode::failed,
                         plant + whose + station::in_words(device->owners_cause()) +
                             ": both sites release their force; compare the gates of this run with the limits "
                             "of the device");
    }
    return plant_error(ErrorCode::failed, plant + whose +
                                              "the commands of this run came too late for it: see `tactus doctor`, "
                                              "or start it with a longer --silence-s");
  }
  if (fell_behind_) {
    return plant_error(ErrorCode::failed, plant + "continued for more than " +
                                              std::to_string(PlantLayout::truth_ticks) +
                                              " control cycles while this run was stopped: see `tactus doctor`");
  }
  return plant_error(
      ErrorCode::failed,
      plant + "did not respond for more than " + bound +
          ", or sent what is not a number: both sites release their force; see `tactus doctor`, or write a longer "
          "--plant-silence-s");
}

}  // namespace tactus::real_time
