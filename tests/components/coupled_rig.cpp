// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/hardware/devices/damiao/damiao_bus.hpp>
#include <tactus/hardware/devices/motor_bus_device.hpp>
#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/hardware/devices/rig/rig_loop.hpp>
#include <tactus/hardware/emulation/damiao/damiao_peer.hpp>
#include <tactus/hardware/wire/join.hpp>
#include <tactus/kernel/station/teleoperator_params.hpp>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>

/// coupled_rig JOINTS.toml: couples two arms of emulated motors in virtual time, with the components kernel, data,
/// runtime and hardware alone. Ends with 0 if the follower stands where its leader does.
namespace {

using namespace tactus;

constexpr std::int64_t ms = 1'000'000, tick_ns = 2 * ms;
constexpr std::size_t joints = 2;
constexpr double apart_rad = 0.2;

template <class T>
T of(Result<T> made) {
  if (made) return *std::move(made);
  std::fprintf(stderr, "coupled_rig: %s\n", describe(made.error()).c_str());
  std::exit(1);
}

/// A bus and its emulated motors, driven in virtual time in place of a thread's.
class VirtualLink final : public devices::MotorLink {
 public:
  explicit VirtualLink(double start_rad) {
    devices::damiao::DamiaoBusParams params{
        .framing = devices::damiao::Framing::socketcan_fd, .watchdog_s = 0.05, .motors = {}};
    emulation::damiao::PeerSettings peers{
        .adapter = emulation::damiao::AdapterType::socketcan_fd, .motors = {}, .faults = {}};
    for (std::uint32_t id = 1; id <= joints; ++id) {
      params.motors.push_back({.id = id, .feedback_id = id + 0x10, .model = devices::damiao::Model::dm4310});
      peers.motors.push_back({.id = id, .feedback_id = id + 0x10, .type = emulation::damiao::MotorType::dm4310});
      peers.motors.back().joint.position_rad = start_rad;
    }
    bus_ = of(devices::damiao::DamiaoBus::make(params));
    peer_ = of(emulation::damiao::DamiaoPeer::make(peers));
  }
  void run_for(std::int64_t duration_ns) {
    for (const std::int64_t until_ns = now_ns + duration_ns; now_ns < until_ns; now_ns += ms / 2) {
      for (std::size_t i = 0; i < joints; ++i) bus_->command(i, wanted_.motors[i]);
      wire::join(*bus_, *peer_, now_ns, now_ns + ms / 2);
      for (std::size_t i = 0; i < joints; ++i) told_.motors[i] = bus_->reading(i);
      told_.state = bus_->state();
      told_.cycles = bus_->cycles();
      told_.time_ns = now_ns + ms / 2;
    }
  }
  [[nodiscard]] double position_rad(std::size_t motor) const { return peer_->motor(motor).position_rad(); }

  [[nodiscard]] std::size_t motors() const noexcept override { return joints; }
  void command(const devices::BusCommands& commands) noexcept override { wanted_ = commands; }
  [[nodiscard]] std::optional<devices::BusReadings> newest() const noexcept override { return told_; }
  [[nodiscard]] bool running() const noexcept override { return true; }
  void stop() override {}
  Check wait_until_asked(Seconds) override { return std::nullopt; }
  [[nodiscard]] devices::MotorSheet sheet(std::size_t motor) const override { return bus_->sheet(motor); }
  [[nodiscard]] std::vector<devices::PoweredMotor> powered_motors() const override { return {}; }

  std::int64_t now_ns = 0;

 private:
  std::unique_ptr<devices::damiao::DamiaoBus> bus_;
  std::unique_ptr<emulation::damiao::DamiaoPeer> peer_;
  devices::BusCommands wanted_;
  devices::BusReadings told_;
};

/// The sections that drive motors; and that of the experiment, which is another component's.
struct Params : station::TeleoperatorParams {
  struct Task {
    std::string kind;
    static constexpr auto fields() { return List{field("kind", &Task::kind, "Kind of the experiment.")}; }
  } task;
  static constexpr auto fields() {
    return joined(station::TeleoperatorParams::fields(), List{field("task", &Params::task, "The experiment.")});
  }
};

devices::RigSide side(const std::string& name) {
  std::string text = "[arm." + name + "]\nbus = \"damiao\"\nport = \"none\"\n";
  for (std::size_t i = 1; i <= joints; ++i) {
    const std::string number = std::to_string(i);
    text += "[arm." + name + ".joint_" + number + "]\nmotor = " + number +
            "\nmodel = \"DM4310\"\nlower_rad = -3.0\nupper_rad = 3.0\nvelocity_limit_rad_per_s = 8.0\n"
            "torque_limit_Nm = 1.5\ntorque_rate_limit_Nm_per_s = 500.0\n";
  }
  const devices::RigPair pair = of(devices::Rig::parse(text, "rig.toml")).pairs().front();
  return name == "leader" ? *pair.leader : *pair.follower;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("use: coupled_rig JOINTS.toml\n", stderr), 2;
  const auto params = of(of(configuration::Document::load(argv[1])).read<Params>());
  VirtualLink leader_link(apart_rad), follower_link(0.0);
  const auto advance = [&](std::int64_t duration_ns) {
    leader_link.run_for(duration_ns);
    follower_link.run_for(duration_ns);
  };
  const auto leader =
      of(devices::MotorBusDevice::make(leader_link, {.joints = side("leader").motor_joints(), .silence_s = 0.05}));
  const auto follower =
      of(devices::MotorBusDevice::make(follower_link, {.joints = side("follower").motor_joints(), .silence_s = 0.05}));
  advance(400 * ms);  // motors are asked before the first control cycle
  runtime::SiteExchange exchange;
  auto loop = of(devices::RigLoop::make(Joints<control::ControlParams>(joints, params.control), params.channel,
                                        Seconds{1e-9 * tick_ns}, {.listen_before_arming_s = 0.1, .arm_at_once = true},
                                        exchange, *leader, *follower));
  devices::RigSecond last;
  constexpr std::int64_t ticks = 6'000 * ms / tick_ns;
  for (std::int64_t number = 0; number < ticks; ++number) {
    const std::int64_t now_ns = leader_link.now_ns;
    loop({.number = number, .deadline_ns = now_ns, .began_ns = now_ns});
    while (const auto second = loop.next_second()) last = *second;
    advance(tick_ns);
  }
  double farthest_rad = 0.0;
  for (std::size_t i = 0; i < joints; ++i) {
    farthest_rad = std::fmax(farthest_rad, std::fabs(leader_link.position_rad(i) - follower_link.position_rad(i)));
  }
  std::printf("leader %s, follower %s, %.3f rad apart of %.3f rad at the start; armed %lld times\n",
              name_of(last.leader), name_of(last.follower), farthest_rad, apart_rad,
              static_cast<long long>(loop.totals().armings));
  // What is left holds against the friction of the joints: less than 0.02 rad at 4 N m/rad.
  return last.follower == control::SiteState::active && farthest_rad < 0.02 ? 0 : 1;
}
