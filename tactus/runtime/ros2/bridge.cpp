// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/ring.hpp>
#include <tactus/runtime/ros2/bridge.hpp>
#include <tactus/runtime/ros2/participant.hpp>

#include <atomic>
#include <chrono>
#include <cmath>
#include <exception>
#include <limits>
#include <optional>
#include <thread>
#include <tuple>
#include <utility>

namespace tactus::ros2 {

namespace {

/// How long the thread waits for a command before it looks for snapshots.
constexpr Seconds look_every{0.002};
/// The state is told when it changes and this often, for those who come late.
constexpr std::int64_t state_every_ns = 100'000'000;

/// One number of each joint.
std::vector<double> each(const Snapshot& at, double JointSnapshot::*number) {
  std::vector<double> all;
  for (const JointSnapshot& joint : at.joints) all.push_back(joint.*number);
  return all;
}

WrenchStamped wrench(const Snapshot& at, const char* device, double force_N) {
  return {.stamp_ns = at.stamp_ns, .frame_id = device, .force_N = {force_N, 0.0, 0.0}, .torque_Nm = {}};
}

/// The topics of one device.
struct DeviceWriters {
  std::string device;
  std::vector<std::string> joints;
  Writer<JointState> measured_js;
  Writer<JointState> setpoint_js;
  std::optional<Writer<WrenchStamped>> measured_cf;  ///< of one axis: several joints alone know no direction

  /// Without numbers.
  [[nodiscard]] JointState joint_state(const Snapshot& at) const {
    return {.stamp_ns = at.stamp_ns, .frame_id = device, .name = joints, .position = {}, .velocity = {}, .effort = {}};
  }
};

Result<DeviceWriters> open_writers(Participant& participant, const std::string& name_space, const std::string& device,
                                   const std::vector<std::string>& joints) {
  const auto topic = [&](const char* name) { return dds_topic(name_space, device + "/" + name); };
  auto measured_js = participant.writer<JointState>(topic("measured_js"));
  if (!measured_js) return measured_js.error();
  auto setpoint_js = participant.writer<JointState>(topic("setpoint_js"));
  if (!setpoint_js) return setpoint_js.error();
  DeviceWriters writers{device, joints, *measured_js, *setpoint_js, {}};
  if (joints.empty()) {
    auto measured_cf = participant.writer<WrenchStamped>(topic("measured_cf"));
    if (!measured_cf) return measured_cf.error();
    writers.measured_cf = *measured_cf;
    writers.joints = {device};
  }
  return writers;
}

/// A snapshot that is told, and as what.
struct Told {
  Snapshot at;
  bool measured = false;  ///< as measured signals
  bool state = false;
};

/// In the place of a wish where there is none.
constexpr double nothing_m = std::numeric_limits<double>::quiet_NaN();

/// All that is open.
struct Endpoints {
  Participant participant;
  std::optional<DeviceWriters> master;
  std::optional<DeviceWriters> slave;
  std::optional<Writer<JointState>> grip;  ///< with a master of one axis
  Writer<Text> state;
  std::optional<Reader<JointState>> servo_jp;
  std::optional<Reader<Text>> request;
  std::optional<Writer<Text>> answer;
};

Result<Endpoints> open(const Bridge::Params& params) {
  auto participant = Participant::create(params.network);
  if (!participant) return participant.error();
  std::optional<DeviceWriters> master, slave;
  for (const auto& [wanted, device, writers] :
       {std::tuple{params.master, "master", &master}, std::tuple{params.slave, "slave", &slave}}) {
    if (!wanted) continue;
    auto opened = open_writers(*participant, params.name_space, device, params.joints);
    if (!opened) return opened.error();
    *writers = *std::move(opened);
  }
  std::optional<Writer<JointState>> grip;
  if (params.master && params.joints.empty()) {
    auto opened = participant->writer<JointState>(dds_topic(params.name_space, "operator/estimated_grip"));
    if (!opened) return opened.error();
    grip = *std::move(opened);
  }
  const char* const state_name = master && slave ? "state" : master ? "master/state" : "slave/state";
  auto state = participant->writer<Text>(dds_topic(params.name_space, state_name));
  if (!state) return state.error();
  std::optional<Reader<JointState>> servo_jp;
  if (params.takes_requests) {
    auto opened = participant->reader<JointState>(dds_topic(params.name_space, "operator/servo_jp"));
    if (!opened) return opened.error();
    servo_jp = *std::move(opened);
  }
  std::optional<Reader<Text>> request;
  std::optional<Writer<Text>> answer;
  if (params.ask) {
    auto reader = participant->reader<Text>(dds_topic(params.name_space, "request"));
    if (!reader) return reader.error();
    request = *std::move(reader);
    auto writer = participant->writer<Text>(dds_topic(params.name_space, "answer"));
    if (!writer) return writer.error();
    answer = *std::move(writer);
  }
  return Endpoints{
      *std::move(participant), std::move(master), std::move(slave), grip, *state, servo_jp, request, answer};
}

}  // namespace

struct Bridge::State {
  State(Endpoints opened, const Params& params)
      : period_ns(std::llround(1e9 / params.rate_Hz)), dds(std::move(opened)), ask(params.ask) {}

  // All that the thread that publishes touches in a tick in which nothing is due, on one cache line.
  alignas(64) std::int64_t period_ns;
  std::int64_t due_ns = 0;
  std::int64_t state_due_ns = 0;
  OperatingState told_state = OperatingState::enabled;
  std::atomic<double> requested_m{nothing_m};  ///< the newest that was not taken

  alignas(64) Endpoints dds;
  std::function<std::string(const std::string& line)> ask;
  telemetry::Ring<Told, 1024> snapshots;
  std::atomic<std::uint64_t> published{0};
  std::atomic<std::uint64_t> lost{0};
  std::atomic<std::uint64_t> requests{0};
  std::atomic<std::uint64_t> refused{0};
  std::atomic<bool> stop{false};
  std::thread thread;

  template <class Message>
  void send(Writer<Message>& writer, const Message& message) {
    if (writer.write(message)) lost.fetch_add(1, std::memory_order_relaxed);
  }

  /// Passes on what is due; most ticks are not.
  void publish(const Snapshot& at) noexcept {
    const bool clock_was_set_back = at.stamp_ns < due_ns - period_ns;
    const bool measured = at.stamp_ns >= due_ns || clock_was_set_back;
    const bool state = at.stamp_ns >= state_due_ns || clock_was_set_back || at.state != told_state;
    if (!measured && !state) return;
    if (!snapshots.try_push({.at = at, .measured = measured, .state = state})) return;
    if (measured) {
      // Counted from when it was due, so that the mean rate is kept; a gap is not made up for.
      const bool in_time = !clock_was_set_back && at.stamp_ns < due_ns + period_ns;
      due_ns = (in_time ? due_ns : at.stamp_ns) + period_ns;
    }
    if (state) {
      state_due_ns = at.stamp_ns + state_every_ns;
      told_state = at.state;
    }
  }

  /// What a device measures; its forces as it feels them, times `sign`.
  void tell_measured(const Snapshot& at, DeviceWriters& writers, double JointSnapshot::*position,
                     double JointSnapshot::*force, double sign) {
    JointState measured = writers.joint_state(at);
    measured.position = each(at, position);
    std::vector<double> forces = each(at, force);
    for (double& one : forces) one *= sign;
    if (writers.measured_cf) {
      send(*writers.measured_cf, wrench(at, writers.device.c_str(), forces.front()));
    } else {
      measured.effort = std::move(forces);
    }
    send(writers.measured_js, measured);
  }

  void tell_master(const Snapshot& at, DeviceWriters& writers) {
    tell_measured(at, writers, &JointSnapshot::master_position_m, &JointSnapshot::hand_force_N, 1.0);
    JointState setpoint = writers.joint_state(at);
    setpoint.effort = each(at, &JointSnapshot::master_force_N);
    send(writers.setpoint_js, setpoint);
  }

  void tell_grip(const Snapshot& at, Writer<JointState>& writer) {
    const JointSnapshot& axis = at.joints[0];
    if (!(axis.estimated_grip_deviation > 0.0)) return;
    send(writer, {.stamp_ns = at.stamp_ns,
                  .frame_id = "operator",
                  .name = {"grip", "grip_deviation"},
                  .position = {axis.estimated_grip, axis.estimated_grip_deviation},
                  .velocity = {},
                  .effort = {}});
  }

  void tell_slave(const Snapshot& at, DeviceWriters& writers) {
    tell_measured(at, writers, &JointSnapshot::slave_position_m, &JointSnapshot::environment_force_N, -1.0);
    JointState setpoint = writers.joint_state(at);
    setpoint.position = each(at, &JointSnapshot::slave_command_m);
    send(writers.setpoint_js, setpoint);
  }

  void tell(const Told& told) {
    const Snapshot& at = told.at;
    if (told.measured) {
      if (dds.master) tell_master(at, *dds.master);
      if (dds.slave) tell_slave(at, *dds.slave);
      if (dds.grip) tell_grip(at, *dds.grip);
      published.fetch_add(1, std::memory_order_relaxed);
    }
    if (told.state) send(dds.state, {name_of(at.state)});
  }

  void drain() {
    Told told;
    while (snapshots.try_pop(told)) tell(told);
  }

  void answer_requests() {
    if (!dds.request) return;
    for (const Text& line : dds.request->take()) send(*dds.answer, {ask(line.data)});
  }

  void listen() {
    answer_requests();
    if (!dds.servo_jp) return;
    for (const JointState& command : dds.servo_jp->take()) {
      if (command.position.size() == 1 && std::isfinite(command.position.front())) {
        requests.fetch_add(1, std::memory_order_relaxed);
        requested_m.store(command.position.front(), std::memory_order_relaxed);
      } else {
        refused.fetch_add(1, std::memory_order_relaxed);
      }
    }
  }

  void run() noexcept {
    while (!stop.load(std::memory_order_acquire)) {
      if (dds.servo_jp) {
        dds.servo_jp->wait(look_every);
      } else {
        std::this_thread::sleep_for(std::chrono::duration<double>(look_every.value));
      }
      without_memory_lost([this] {
        listen();
        drain();
      });
    }
    without_memory_lost([this] {
      drain();
      send(dds.state, {name_of(OperatingState::disabled)});
    });
  }

  /// What cannot be made for lack of memory is lost, and the thread goes on.
  void without_memory_lost(const auto& body) noexcept {
    try {
      body();
    } catch (const std::exception&) {
      lost.fetch_add(1, std::memory_order_relaxed);
    }
  }
};

Bridge::Bridge(std::unique_ptr<State> state) : state_(std::move(state)) {}
Bridge::Bridge(Bridge&&) noexcept = default;
Bridge::~Bridge() {
  if (state_) close();
}

Result<Bridge> Bridge::create(const Params& params) {
  if (auto error = check_namespace(params.name_space)) return *std::move(error);
  if (!(params.rate_Hz > 0.0) || params.rate_Hz > 1e4) {
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = "rate_Hz",
                 .message = std::to_string(params.rate_Hz) + " Hz is out of bounds: write one above 0, up to 10000 Hz",
                 .place = {}};
  }
  if (params.joints.size() > most_joints) {
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = "joints",
                 .message = std::to_string(params.joints.size()) + " joints are too many: name " +
                            std::to_string(most_joints) + " at most",
                 .place = {}};
  }
  auto opened = open(params);
  if (!opened) return opened.error();
  // Its rings are large and stay where they are.
  auto state = std::make_unique<State>(*std::move(opened), params);
  state->thread = std::thread([self = state.get()] { self->run(); });
  return Bridge(std::move(state));
}

void Bridge::publish(const Snapshot& snapshot) noexcept { state_->publish(snapshot); }

std::optional<double> Bridge::take_request() noexcept {
  // Looked at before it is exchanged, for that takes the cache line from the other thread.
  if (std::isnan(state_->requested_m.load(std::memory_order_relaxed))) return std::nullopt;
  return state_->requested_m.exchange(nothing_m, std::memory_order_relaxed);
}

void Bridge::close() {
  if (!state_->thread.joinable()) return;
  state_->stop.store(true, std::memory_order_release);
  state_->thread.join();
}

Bridge::Counts Bridge::counts() const {
  return {.published = state_->published.load(std::memory_order_relaxed),
          .lost = state_->lost.load(std::memory_order_relaxed),
          .dropped = state_->snapshots.dropped(),
          .requests = state_->requests.load(std::memory_order_relaxed),
          .refused = state_->refused.load(std::memory_order_relaxed)};
}

}  // namespace tactus::ros2
