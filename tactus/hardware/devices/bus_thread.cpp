// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/bus_thread.hpp>
#include <tactus/hardware/wire/talk.hpp>
#include <tactus/runtime/servo/rights.hpp>

#include <chrono>
#include <cmath>
#include <new>
#include <system_error>
#include <utility>

namespace tactus::devices {

namespace {

/// Before all that is not real time, so that no other program makes a motor look silent; after the servo thread.
constexpr int priority = 70;
constexpr int any_core = -1;
/// For what a bus that is not ready has to say.
constexpr std::int64_t unready_farewell_ns = 50'000'000;

}  // namespace

/// The bus, with the tick's commands put in and its readings taken out on the way. It lives on the thread.
class BusThread::Exchange final : public wire::WireEnd {
 public:
  explicit Exchange(BusThread& owner) : owner_(&owner), bus_(owner.bus_.get()), watch_(owner.silence_ns_) {}

  void hear(std::span<const std::uint8_t> bytes, std::int64_t now_ns) noexcept override { bus_->hear(bytes, now_ns); }
  std::span<const std::uint8_t> say(std::int64_t now_ns) noexcept override {
    take_commands(now_ns);
    const auto said = bus_->say(now_ns);
    if (bus_->cycles() != told_.cycles || bus_->state() != told_.state) tell(now_ns);
    return said;
  }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override { return bus_->wakes_ns(); }

  /// All motors without power, for good.
  void leave() noexcept { leaving_ = true; }
  /// Whether all motors have reported that they are off, or the bus has nothing more to tell them.
  [[nodiscard]] bool is_done() const noexcept {
    if (bus_->state() != BusState::ready) return bus_->wakes_ns() == wire::never_ns;
    for (std::size_t motor = 0; motor < owner_->motors_; ++motor) {
      if (bus_->reading(motor).off == 0) return false;
    }
    return true;
  }

 private:
  void take_commands(std::int64_t now_ns) noexcept {
    if (const auto newest = owner_->commands_.newest()) commands_ = *newest;
    const bool heard = watch_.trusts(commands_, now_ns);
    told_.unheard = heard ? 0 : 1;
    const bool counts = heard && !leaving_;
    for (std::size_t motor = 0; motor < owner_->motors_; ++motor) {
      bus_->command(motor, counts ? commands_.motors[motor] : MotorCommand{});
    }
  }
  void tell(std::int64_t now_ns) noexcept {
    for (std::size_t motor = 0; motor < owner_->motors_; ++motor) told_.motors[motor] = bus_->reading(motor);
    told_.state = bus_->state();
    told_.cycles = bus_->cycles();
    told_.time_ns = now_ns;
    owner_->readings_.publish(told_);
  }

  BusThread* owner_;
  MotorBus* bus_;
  CommandWatch watch_;
  BusCommands commands_;
  BusReadings told_{.motors = {}, .state = BusState::asking, .cycles = -1, .time_ns = 0};
  bool leaving_ = false;
};

Result<std::unique_ptr<BusThread>> BusThread::start(std::unique_ptr<MotorBus> bus, wire::Port port,
                                                    const Params& params) {
  if (Check error = validate(params)) return *std::move(error);
  constexpr Bounds counts = between(1.0, static_cast<double>(most_joints));
  const auto count = static_cast<double>(bus->motors());
  if (!counts.contain(count)) return out_of_bounds("motors", count, counts, units::none);
  std::unique_ptr<BusThread> made(new BusThread(std::move(bus), std::move(port), params));
  try {
    made->thread_ = std::thread([self = made.get()] { self->run(); });
  } catch (const std::system_error& error) {
    return Error{.code = ErrorCode::failed,
                 .parameter = {},
                 .message = std::string("no thread for the bus (") + error.what() + "): end other programs",
                 .place = {}};
  }
  return made;
}

BusThread::BusThread(std::unique_ptr<MotorBus> bus, wire::Port port, const Params& params)
    : bus_(std::move(bus)),
      port_(std::move(port)),
      silence_ns_(std::llround(params.silence_s * 1e9)),
      motors_(bus_->motors()) {}

BusThread::~BusThread() { stop(); }

void BusThread::run() noexcept {
  try {
    // Without the right to it the bus runs as it can, as the servo thread does, which tells of it.
    static_cast<void>(runtime::take_thread_rights(priority, any_core));
  } catch (const std::bad_alloc&) {
    // Nothing to write down what was granted; the bus runs all the same.
  }
  Exchange exchange(*this);
  failed_ = wire::talk(exchange, port_, [this] { return stopping_.load(std::memory_order_relaxed); });
  if (!failed_) {
    exchange.leave();
    // A bus that still asks who is there has given nobody power, and has told those that it knows to switch off.
    const std::int64_t longest_ns = bus_->state() == BusState::ready ? farewell_ns : unready_farewell_ns;
    const std::int64_t until_ns = wire::monotonic_ns() + longest_ns;
    failed_ = wire::talk(exchange, port_, [&] { return exchange.is_done() || wire::monotonic_ns() > until_ns; });
  }
  running_.store(false, std::memory_order_release);
}

void BusThread::stop() {
  stopping_.store(true, std::memory_order_relaxed);
  if (thread_.joinable()) thread_.join();
}

std::vector<PoweredMotor> BusThread::powered_motors() const {
  std::vector<PoweredMotor> found;
  for (std::size_t motor = 0; bus_->state() == BusState::ready && motor < motors_; ++motor) {
    if (const auto one = powered(motor, bus_->reading(motor))) found.push_back(*one);
  }
  return found;
}

Check BusThread::wait_until_asked(Seconds longest) {
  bool ready = false;
  wait_while_running(longest, [&] {
    const auto now = newest();
    ready = now && now->state == BusState::ready;
    return ready || (now && now->state == BusState::refused);
  });
  if (ready) return std::nullopt;
  // Nobody may look at the bus while its thread lives.
  stop();
  Check wrong = failed_ ? failed_ : bus_->problem();
  if (!wrong) {
    wrong = Error{.code = ErrorCode::failed,
                  .parameter = {},
                  .message = "the motors were not done answering in time: look at the bit rate and the wiring",
                  .place = {}};
  }
  if (wrong->place.empty()) wrong->place = port_.path();
  return wrong;
}

}  // namespace tactus::devices
