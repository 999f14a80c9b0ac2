// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/inverse3/internal/service_connection.hpp>
#include <tactus/hardware/devices/inverse3/inverse3_link.hpp>
#include <tactus/hardware/devices/inverse3/messages.hpp>
#include <tactus/hardware/devices/off_watch.hpp>
#include <tactus/hardware/wire/talk.hpp>
#include <tactus/runtime/servo/shared_slots.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <limits>
#include <mutex>
#include <system_error>
#include <thread>
#include <utility>

namespace tactus::devices::inverse3 {

namespace {

constexpr std::int64_t longest_connecting_ns = 1'000'000'000;
/// An answer that takes longer does not come.
constexpr std::int64_t longest_answer_ns = 1'000'000'000;
constexpr std::chrono::milliseconds between_tries{100};
constexpr std::size_t axis_count = 3;
/// A service ends a force for want of messages within some milliseconds.
constexpr std::int64_t rest_ns = 150'000'000;
/// States that say `idle` under commands of force, before that is a fault.
constexpr int most_idle = 20;

Error link_error(ErrorCode code, std::string parameter, std::string message) {
  return {.code = code, .parameter = std::move(parameter), .message = std::move(message), .place = {}};
}

}  // namespace

Check check(const LinkParams& params) {
  const auto colon = params.address.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == params.address.size()) {
    return link_error(ErrorCode::syntax, "port",
                      "'" + params.address + "' is no address: write HOST:PORT, as 127.0.0.1:10001");
  }
  if (params.axes.empty() || params.axes.size() > axis_count) {
    return link_error(ErrorCode::out_of_bounds, "motors",
                      std::to_string(params.axes.size()) + " axes: an Inverse3 has 1 to 3, x, y and z");
  }
  for (std::size_t i = 0; i < params.axes.size(); ++i) {
    const std::string key = "motors[" + std::to_string(i) + "].id";
    constexpr Bounds axes = between(1.0, axis_count);
    if (const auto axis = static_cast<double>(params.axes[i]); !axes.contain(axis)) {
      return out_of_bounds(key, axis, axes, units::none);
    }
    if (std::count(params.axes.begin(), params.axes.begin() + static_cast<std::ptrdiff_t>(i), params.axes[i]) > 0) {
      return link_error(ErrorCode::inconsistent, key, "another joint has this axis: 1 is x, 2 is y, 3 is z");
    }
  }
  return std::nullopt;
}

/// The thread, and what it shares.
class Inverse3Link::Worker {
 public:
  explicit Worker(const LinkParams& params)
      : params_(params),
        host_(params.address.substr(0, params.address.rfind(':'))),
        port_(params.address.substr(params.address.rfind(':') + 1)),
        cycle_ns_(std::llround(1e9 * params.shortest_cycle_s)),
        watch_(std::llround(1e9 * params.silence_s)) {}

  Check begin() {
    try {
      thread_ = std::thread([this] { run(); });
    } catch (const std::system_error& error) {
      return link_error(ErrorCode::failed, {},
                        std::string("no thread for the service (") + error.what() + "): end other programs");
    }
    return std::nullopt;
  }
  void stop() {
    stopping_.store(true, std::memory_order_relaxed);
    if (thread_.joinable()) thread_.join();
  }

  runtime::SharedSlots<BusReadings, 8> readings{};
  runtime::SharedSlots<BusCommands, 8> commands{};
  std::atomic<bool> running{true};

  [[nodiscard]] const LinkParams& params() const { return params_; }
  /// Why there is no connection, or no such device.
  [[nodiscard]] Check problem() {
    const std::lock_guard lock(told_);
    return problem_;
  }
  /// Once it does not run.
  [[nodiscard]] const std::string& version() const { return version_; }
  [[nodiscard]] const std::optional<Device>& device() const { return device_; }
  [[nodiscard]] std::vector<PoweredMotor> powered_motors() const {
    std::vector<PoweredMotor> found;
    for (std::size_t i = 0; told_readings_.state == BusState::ready && i < params_.axes.size(); ++i) {
      if (const auto one = powered(i, told_readings_.motors[i])) found.push_back(*one);
    }
    return found;
  }

 private:
  void run() {
    while (!stopping_.load(std::memory_order_relaxed)) {
      Check ended = converse();
      {
        const std::lock_guard lock(told_);
        problem_ = std::move(ended);
      }
      for (MotorReading& axis : told_readings_.motors) axis.enabled = 0;
      for (int part = 0; part < 10 && !stopping_.load(std::memory_order_relaxed); ++part) {
        std::this_thread::sleep_for(between_tries / 10);
      }
    }
    running.store(false, std::memory_order_release);
  }

  /// From connecting until the connection ends.
  Check converse() {
    auto connection = ServiceConnection::open(host_, port_, longest_connecting_ns);
    if (!connection) return connection.error();
    version_ = connection->version();
    const auto dialect = dialect_of(version_);
    if (!dialect) return dialect.error();
    // All that is there, before anything was asked.
    Devices devices;
    const auto snapshot = connection->receive(longest_connecting_ns);
    if (!snapshot) return snapshot.error();
    if (Check error = devices.take(**snapshot)) return error;
    const Device* device = find(devices);
    if (device == nullptr) return unknown_device(devices);
    note(*device, true);
    std::int64_t leave_ns = wire::never_ns;
    for (std::int64_t due_ns = wire::monotonic_ns();; due_ns = std::max(due_ns + cycle_ns_, wire::monotonic_ns())) {
      wait_until(due_ns);
      const bool leaving = stopping_.load(std::memory_order_relaxed);
      const std::int64_t now_ns = wire::monotonic_ns();
      if (leaving && leave_ns == wire::never_ns) leave_ns = now_ns + farewell_ns;
      if (leaving && (off_.confirmed() || now_ns > leave_ns)) return std::nullopt;
      if (leaving) {
        gives_.fill(false);
        pushes_ = false;
      }
      std::string question = leaving ? probe_message(device->id) : next_message(*device, *dialect);
      if (gives_force()) {
        off_.start_over();
      } else if (!off_.due(now_ns, rest_ns)) {
        continue;
      } else if (!off_.confirmed()) {
        off_.told(now_ns);
      }
      if (Check error = connection->send(question, longest_answer_ns)) return error;
      const auto heard = connection->receive(longest_answer_ns);
      if (!heard) return heard.error();
      const bool whole = !devices.take(**heard);
      device = find(devices);
      note(*device, whole);
    }
  }

  [[nodiscard]] const Device* find(const Devices& devices) const {
    for (const Device& one : devices.all()) {
      if (params_.device.empty() || one.id == params_.device) return &one;
    }
    return nullptr;
  }
  [[nodiscard]] Error unknown_device(const Devices& devices) const {
    std::string all;
    for (const Device& one : devices.all()) all += (all.empty() ? "" : ", ") + one.id;
    return {.code = ErrorCode::missing,
            .parameter = "device",
            .message = all.empty() ? "the service has no Inverse3: plug it in and switch it on"
                                   : "the service has no '" + params_.device + "' but " + all + ": state one of them",
            .place = {}};
  }

  std::string next_message(const Device& device, Dialect dialect) {
    pushes_ = false;
    if (const auto newest = commands.newest()) wanted_ = *newest;
    const bool heard = watch_.trusts(wanted_, wire::monotonic_ns());
    told_readings_.unheard = heard ? 0 : 1;
    bool wanted = false;
    for (std::size_t i = 0; i < params_.axes.size(); ++i) wanted = wanted || wanted_.motors[i].enabled != 0;
    if (!wanted) refuses_ = false;
    if (!heard || !device.calibrated || refuses_ || stays_on_) {
      gives_.fill(false);
      return probe_message(device.id);
    }
    Vector force_N{};
    bool any = false;
    constexpr double felt_N = 0.01;
    for (std::size_t i = 0; i < params_.axes.size(); ++i) {
      gives_[i] = wanted_.motors[i].enabled != 0 && !wanted_.motors[i].law.acts();
      if (gives_[i]) force_N[static_cast<std::size_t>(params_.axes[i] - 1)] = wanted_.motors[i].torque_Nm;
      any = any || gives_[i];
      pushes_ = pushes_ || (gives_[i] && std::fabs(wanted_.motors[i].torque_Nm) > felt_N);
    }
    return any ? force_message(device.id, force_N, dialect) : probe_message(device.id);
  }

  [[nodiscard]] bool gives_force() const {
    return std::ranges::any_of(gives_, [](bool gives) { return gives; });
  }

  void note(const Device& device, bool whole) {
    device_ = device;
    if (!whole) return;
    const bool off = reports_off(device);
    off_.reported(off);
    stays_on_ = stays_on_ || off_.stays_on(wire::monotonic_ns());
    judge_idle(pushes_ && device.mode == "idle", wire::monotonic_ns());
    const MotorFault fault = stays_on_            ? MotorFault::stays_on
                             : !device.calibrated ? MotorFault::encoder
                             : !device.supplied   ? MotorFault::voltage
                             : refuses_           ? MotorFault::refused
                                                  : MotorFault::none;
    told_readings_.time_ns = wire::monotonic_ns();
    told_readings_.state = BusState::ready;
    ++told_readings_.cycles;
    for (std::size_t i = 0; i < params_.axes.size(); ++i) {
      const auto axis = static_cast<std::size_t>(params_.axes[i] - 1);
      MotorReading& reading = told_readings_.motors[i];
      reading.position_rad = device.position_m[axis];
      reading.velocity_rad_per_s = device.velocity_m_per_s[axis];
      reading.torque_Nm = device.force_N[axis];
      reading.fault = fault;
      reading.status = status_of(device);
      reading.off = off_.confirmed() ? 1 : 0;
      reading.enabled = gives_[i] && device.calibrated ? 1 : 0;
      reading.received_ns = told_readings_.time_ns;
      ++reading.answers;
    }
    readings.publish(told_readings_);
  }

  /// A device that is idle though it is to give a force.
  void judge_idle(bool idle, std::int64_t now_ns) {
    idle_ = idle ? idle_ + 1 : 0;
    if (idle_ == 1) idle_since_ns_ = now_ns;
    refuses_ = refuses_ || (idle_ > most_idle && now_ns - idle_since_ns_ > off_within_ns);
  }

  static void wait_until(std::int64_t due_ns) {
    const std::int64_t wait_ns = due_ns - wire::monotonic_ns();
    if (wait_ns > 0) std::this_thread::sleep_for(std::chrono::nanoseconds(wait_ns));
  }

  LinkParams params_;
  std::string host_, port_;
  std::int64_t cycle_ns_;
  CommandWatch watch_;
  BusCommands wanted_;
  BusReadings told_readings_;
  std::array<bool, axis_count> gives_{};
  OffWatch off_;
  bool stays_on_ = false, refuses_ = false;
  bool pushes_ = false;  ///< the last message has a force
  int idle_ = 0;         ///< states in a row that say so under commands of force
  std::int64_t idle_since_ns_ = 0;
  std::string version_;
  std::optional<Device> device_;
  std::mutex told_;
  Check problem_;
  std::atomic<bool> stopping_{false};
  std::thread thread_;
};

Result<std::unique_ptr<Inverse3Link>> Inverse3Link::start(const LinkParams& params) {
  if (Check error = check(params)) return *std::move(error);
  auto worker = std::make_unique<Worker>(params);
  if (Check error = worker->begin()) return *std::move(error);
  return std::unique_ptr<Inverse3Link>(new Inverse3Link(std::move(worker)));
}

Inverse3Link::Inverse3Link(std::unique_ptr<Worker> worker) : worker_(std::move(worker)) {}
Inverse3Link::~Inverse3Link() { worker_->stop(); }

std::size_t Inverse3Link::motors() const noexcept { return worker_->params().axes.size(); }
void Inverse3Link::command(const BusCommands& commands) noexcept { worker_->commands.publish(commands); }
std::optional<BusReadings> Inverse3Link::newest() const noexcept { return worker_->readings.newest(); }
bool Inverse3Link::running() const noexcept { return worker_->running.load(std::memory_order_acquire); }
void Inverse3Link::stop() { worker_->stop(); }

Check Inverse3Link::wait_until_asked(Seconds longest) {
  bool answered = false;
  Check wrong;
  wait_while_running(longest, [&] {
    answered = newest().has_value();
    if (!answered) wrong = worker_->problem();
    return answered || wrong;
  });
  if (answered) return std::nullopt;
  stop();
  if (!wrong) wrong = Error{ErrorCode::failed, {}, "the service did not answer in time", {}};
  if (wrong->place.empty()) wrong->place = worker_->params().address;
  return wrong;
}

std::vector<PoweredMotor> Inverse3Link::powered_motors() const { return worker_->powered_motors(); }

MotorSheet Inverse3Link::sheet(std::size_t) const {
  const auto& device = worker_->device();
  if (!device) return {};
  MotorSheet sheet{.model = {},
                   .scales = {},
                   .firmware = {},
                   .torque_limit_Nm = std::numeric_limits<double>::infinity(),
                   .problem = {}};
  if (device->force_gate) sheet.scales = "force gate " + format_number(*device->force_gate);
  if (device->damping) sheet.scales += ", damping " + format_number(*device->damping);
  const std::string& version = worker_->version();
  const auto digit = std::ranges::find_if(version, [](char c) { return c >= '0' && c <= '9'; });
  const auto end = std::find_if_not(digit, version.end(), [](char c) { return (c >= '0' && c <= '9') || c == '.'; });
  sheet.firmware.assign(digit, end);
  if (!device->calibrated) {
    sheet.problem = link_error(
        ErrorCode::inconsistent, {},
        "device " + device->id + " is not calibrated and gives no force: put its handle where Haply Hub shows it");
  }
  return sheet;
}

}  // namespace tactus::devices::inverse3
