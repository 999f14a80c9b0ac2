// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/plugin/blocking_link.hpp>
#include <tactus/hardware/wire/talk.hpp>
#include <tactus/kernel/core/joints.hpp>
#include <tactus/runtime/servo/rights.hpp>
#include <tactus/runtime/servo/shared_slots.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <string>
#include <system_error>
#include <utility>

namespace tactus::devices {

namespace {

/// As that of `BusThread`: before all that is not real time, after the servo thread.
constexpr int driver_priority = 70;
constexpr int any_core_of_driver = -1;
constexpr std::chrono::seconds longest_stop{2};
/// From the failure of a driver until it is opened again. A run looks for the reason far more often.
constexpr std::chrono::seconds before_reopening{1};

Error driver_failed(std::string message) {
  return {.code = ErrorCode::failed, .parameter = {}, .message = std::move(message), .place = {}};
}

/// What `call` returns; what it throws becomes an error.
template <class Call>
Check guarded(const char* name, const Call& call) {
  try {
    return call();
  } catch (const std::exception& error) {
    return driver_failed(std::string("the driver threw in ") + name + ": " + error.what());
  } catch (...) {
    return driver_failed(std::string("the driver threw in ") + name);
  }
}

}  // namespace

/// What both threads use.
class BlockingLink::Shared {
 public:
  Shared(std::unique_ptr<BlockingDriver> driver, std::int64_t silence_ns)
      : driver_(std::move(driver)),
        motors_(driver_->motors()),
        cycle_ns_(std::llround(driver_->cycle_s() * 1e9)),
        watch_(silence_ns) {
    for (std::size_t i = 0; i < motors_; ++i) torque_limit_Nm_[i] = driver_->ability(i).torque_Nm;
  }

  void run() noexcept {
    try {
      // Without the right to it the driver runs as it can, as the servo thread does, which reports it.
      static_cast<void>(runtime::take_thread_rights(driver_priority, any_core_of_driver));
    } catch (const std::bad_alloc&) {
      // Nothing to write down what was granted; the driver runs all the same.
    }
    Check error = open();
    told_.state = error ? BusState::refused : BusState::ready;
    publish();
    if (!error) error = cycle(true);
    while (!error && !is_stopping()) {
      error = cycle(true);
      if (error) error = reopen(*std::move(error));
    }
    const std::int64_t until_ns = wire::monotonic_ns() + farewell_ns;
    while (!error && has_power_left() && wire::monotonic_ns() < until_ns) error = cycle(false);
    close();
    {
      const std::scoped_lock lock(mutex_);
      failed_ = std::move(error);
      running_.store(false, std::memory_order_release);
    }
    changed_.notify_all();
  }

  /// Whether the thread ended in time.
  bool stop() {
    std::unique_lock lock(mutex_);
    stopping_.store(true, std::memory_order_relaxed);
    changed_.notify_all();
    return changed_.wait_for(lock, longest_stop, [this] { return !running(); });
  }

  void command(const BusCommands& commands) noexcept { commands_.publish(commands); }
  [[nodiscard]] std::optional<BusReadings> newest() const noexcept { return readings_.newest(); }
  [[nodiscard]] bool running() const noexcept { return running_.load(std::memory_order_acquire); }
  [[nodiscard]] std::size_t motors() const noexcept { return motors_; }
  [[nodiscard]] double torque_limit_Nm(std::size_t motor) const noexcept { return torque_limit_Nm_[motor]; }
  [[nodiscard]] Check problem() const {
    const std::scoped_lock lock(mutex_);
    return failed_;
  }

 private:
  [[nodiscard]] bool is_stopping() const noexcept { return stopping_.load(std::memory_order_relaxed); }

  Check open() {
    open_ = true;
    return guarded("open", [this] { return driver_->open(); });
  }

  void close() noexcept {
    if (std::exchange(open_, false)) driver_->close();
  }

  /// Closes a driver that failed, and opens it again until that and a cycle without torque succeed, or the link stops.
  /// Its commands count again once a control cycle enables nothing. Returns the last failure if the link stops.
  Check reopen(Error error) {
    while (true) {
      close();
      told_.state = BusState::asking;
      for (MotorReading& motor : told_.motors) {
        motor.enabled = 0;
        motor.off = 1;
      }
      publish();
      {
        std::unique_lock lock(mutex_);
        failed_ = error;
        if (changed_.wait_for(lock, before_reopening, [this] { return is_stopping(); })) return error;
      }
      Check again = open();
      if (!again) again = cycle(false);
      if (!again) break;
      error = *std::move(again);
    }
    watch_.distrust();
    told_.state = BusState::ready;
    const std::scoped_lock lock(mutex_);
    failed_.reset();
    return std::nullopt;
  }

  Check cycle(bool with_torque) noexcept {
    const std::int64_t start_ns = wire::monotonic_ns();
    if (const auto newest = commands_.newest()) wanted_ = *newest;
    const bool counts = watch_.trusts(wanted_, start_ns) && with_torque;
    told_.unheard = counts || !with_torque ? 0 : 1;
    std::array<MotorCommand, most_joints> commands{};
    for (std::size_t i = 0; counts && i < motors_; ++i) {
      // A torque that is not a number removes the torque, and one beyond the limit is reduced to it.
      const MotorCommand& wanted = wanted_.motors[i];
      if (!std::isfinite(wanted.torque_Nm)) continue;
      commands[i] = wanted;
      commands[i].torque_Nm = std::clamp(wanted.torque_Nm, -torque_limit_Nm_[i], torque_limit_Nm_[i]);
    }
    Check error = guarded("exchange", [&] {
      return driver_->exchange(std::span(commands).first(motors_), std::span(told_.motors).first(motors_));
    });
    if (error) return error;
    const std::int64_t end_ns = wire::monotonic_ns();
    for (std::size_t i = 0; i < motors_; ++i) {
      told_.motors[i].off = told_.motors[i].enabled == 0 && commands[i].enabled == 0 ? 1 : 0;
      told_.motors[i].received_ns = end_ns;
      ++told_.motors[i].answers;
    }
    ++told_.cycles;
    publish();
    const std::int64_t rest_ns = start_ns + cycle_ns_ - end_ns;
    if (rest_ns > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(rest_ns));
    return std::nullopt;
  }

  void publish() noexcept {
    told_.time_ns = wire::monotonic_ns();
    readings_.publish(told_);
  }

  [[nodiscard]] bool has_power_left() const noexcept {
    for (std::size_t i = 0; i < motors_; ++i) {
      if (told_.motors[i].off == 0) return true;
    }
    return false;
  }

  std::unique_ptr<BlockingDriver> driver_;
  std::size_t motors_;
  std::int64_t cycle_ns_;
  std::array<double, most_joints> torque_limit_Nm_{};
  CommandWatch watch_;
  BusCommands wanted_;
  BusReadings told_{};
  runtime::SharedSlots<BusReadings, 8> readings_{};
  runtime::SharedSlots<BusCommands, 8> commands_{};
  std::atomic<bool> stopping_{false}, running_{true};
  bool open_ = false;
  mutable std::mutex mutex_;  ///< of `failed_`, of the request to stop and of the end
  std::condition_variable changed_;
  Check failed_;
};

Result<std::unique_ptr<BlockingLink>> BlockingLink::start(std::unique_ptr<BlockingDriver> driver, double silence_s) {
  constexpr Bounds counts = between(1.0, static_cast<double>(most_joints)), silences = between(0.001, 10.0);
  constexpr Bounds cycles = between(1e-5, 1.0);
  const auto count = static_cast<double>(driver->motors());
  if (!counts.contain(count)) return out_of_bounds("motors", count, counts, units::none);
  if (!cycles.contain(driver->cycle_s())) return out_of_bounds("cycle_s", driver->cycle_s(), cycles, units::second);
  if (!silences.contain(silence_s)) return out_of_bounds("silence_s", silence_s, silences, units::second);
  std::unique_ptr<BlockingLink> made(
      new BlockingLink(std::make_shared<Shared>(std::move(driver), std::llround(silence_s * 1e9))));
  try {
    made->thread_ = std::thread([shared = made->shared_] { shared->run(); });
  } catch (const std::system_error& error) {
    return driver_failed(std::string("no thread for the driver (") + error.what() + "): end other programs");
  }
  return made;
}

BlockingLink::BlockingLink(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {}
BlockingLink::~BlockingLink() { stop(); }

std::size_t BlockingLink::motors() const noexcept { return shared_->motors(); }
void BlockingLink::command(const BusCommands& commands) noexcept { shared_->command(commands); }
std::optional<BusReadings> BlockingLink::newest() const noexcept { return shared_->newest(); }
bool BlockingLink::running() const noexcept { return shared_->running(); }

void BlockingLink::stop() {
  if (!thread_.joinable()) return;
  if (shared_->stop()) {
    thread_.join();
  } else {
    thread_.detach();
  }
}

Check BlockingLink::wait_until_asked(Seconds longest) {
  bool ready = false;
  wait_while_running(longest, [&] {
    const auto now = newest();
    ready = now && now->state == BusState::ready && now->cycles > 0;
    return ready;
  });
  if (ready) return std::nullopt;
  stop();
  if (Check problem = shared_->problem()) return problem;
  return driver_failed("the driver did not complete a cycle within " + rounded_number(longest.value) +
                       " s: check that the device is on and reachable");
}

std::vector<PoweredMotor> BlockingLink::powered_motors() const {
  std::vector<PoweredMotor> found;
  const auto last = newest();
  for (std::size_t motor = 0; last && last->state == BusState::ready && motor < motors(); ++motor) {
    if (const auto one = powered(motor, last->motors[motor])) found.push_back(*one);
  }
  return found;
}

Check BlockingLink::problem() const { return shared_->problem(); }

MotorSheet BlockingLink::sheet(std::size_t motor) const {
  return {.model = {}, .scales = {}, .firmware = {}, .torque_limit_Nm = shared_->torque_limit_Nm(motor), .problem = {}};
}

}  // namespace tactus::devices
