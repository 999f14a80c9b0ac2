// SPDX-License-Identifier: Apache-2.0
// bench_arms [EXPERIMENT.toml]: what a tick of both sites of two arms takes, a step of a simulated arm, and the pair
// with person and wall in virtual time; then the whole tick of a rig's pair, supervised and behind its walls, joint by
// joint and as two arms.

#include <tactus/data/configuration/document.hpp>
#include <tactus/kernel/mechanics/minimum_jerk.hpp>
#include <tactus/kernel/station/local_teleoperator.hpp>
#include <tactus/kernel/station/supervised_arms.hpp>
#include <tactus/runtime/servo/site_parts.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_pair.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <filesystem>
#include <string>
#include <vector>

namespace {

using namespace tactus;

template <class Work>
void report(const char* name, int times, double parts, Work&& work) {
  std::vector<double> taken_us;
  for (int k = 0; k < times; ++k) {
    const auto before = std::chrono::steady_clock::now();
    work(k);
    const std::chrono::duration<double, std::micro> taken = std::chrono::steady_clock::now() - before;
    taken_us.push_back(taken.count() / parts);
  }
  std::sort(taken_us.begin(), taken_us.end());
  const auto quantile = [&](double q) {
    return taken_us[static_cast<std::size_t>(q * static_cast<double>(taken_us.size()))];
  };
  std::printf("  %-28s median %6.2f us   p99 %6.2f us\n", name, quantile(0.5), quantile(0.99));
}

/// A person reaches 20 mm, through a wall half-way, and presses: how much faster than the clock that is computed.
bool report_virtual_time(const experiments::ArmPairSetup& setup) {
  constexpr double depth_m = 0.01;
  constexpr double simulated_s = 3.0;
  const mechanics::MinimumJerk reach{.start_m = 0.0, .end_m = -2.0 * depth_m, .start_time_s = 0.1, .duration_s = 0.3};
  auto pair = experiments::ArmPair::make(setup, setup.exact, -depth_m);
  if (!pair) return std::fprintf(stderr, "%s\n", describe(pair.error()).c_str()), false;
  const auto ticks = static_cast<int>(simulated_s / pair->tick_s());
  // Processor time: what others do on this machine is not counted.
  const std::clock_t before = std::clock();
  for (int k = 0; k < ticks; ++k) {
    const double now_s = k * pair->tick_s();
    pair->step(reach.position_m(now_s) * setup.outward, reach.position_m(now_s + pair->tick_s()) * setup.outward);
  }
  const double taken_s = static_cast<double>(std::clock() - before) / static_cast<double>(CLOCKS_PER_SEC);
  std::printf("  %-28s %6.2f times real time, a tick %6.2f us of processor\n", "the pair in virtual time",
              simulated_s / taken_s, 1e6 * taken_s / ticks);
  return pair->healthy();
}

bool measure(const experiments::ArmTappingParams& params, const std::filesystem::path& folder) {
  const auto setup = experiments::set_up_arm_pair(params, folder);
  if (!setup) return std::fprintf(stderr, "%s\n", describe(setup.error()).c_str()), false;
  const Seconds tick{1.0 / params.servo.rate_Hz};
  const std::size_t joints = setup->leader.arm.chain.joints.size();
  auto leader = arm_control::ArmLeader::make(params.control,
                                             {.carried = setup->leader.arm.chain,
                                              .induced = setup->exact.induced,
                                              .gains = params.control.follower.gains.of(joints)},
                                             tick);
  auto follower = arm_control::ArmFollower::make(
      params.control.follower, {.chain = setup->follower.arm.chain, .tool_m = setup->follower.arm.tool_m}, tick);
  auto arm = arm_plants::ArmPlant::make(setup->leader.arm, setup->leader.start);
  if (!leader || !follower || !arm) return false;
  arm::ArmReading reading = arm->read();
  arm_control::ArmMessage told = arm_control::ArmMessage::at_rest(setup->leader.start);
  report("a tick of both sites", 20000, 1.0, [&](int k) {
    reading.velocity.setConstant(0.1 * std::sin(0.01 * k));
    const auto output = leader->step(reading, told);
    told = follower->step(reading, setup->leader.start, output.message).message;
  });
  arm->write({.position = setup->leader.start,
              .velocity = arm::JointVector::Zero(setup->leader.start.size()),
              .stiffness = arm::JointVector::Constant(setup->leader.start.size(), 30.0),
              .damping = arm::JointVector::Constant(setup->leader.start.size(), 0.2),
              .torque = arm::JointVector::Zero(setup->leader.start.size())});
  constexpr int steps = 10;
  report("a step of a simulated arm", 3000, steps, [&](int) {
    for (int i = 0; i < steps; ++i) arm->step({});
  });
  return report_virtual_time(*setup);
}

/// Motors that tell a small motion and take everything.
class Told final : public station::JointDevice {
 public:
  explicit Told(std::size_t joints) : reading_(joints) {}
  [[nodiscard]] Joints<station::DeviceLimits> limits() const override {
    return Joints<station::DeviceLimits>(reading_.size(), {.force_N = 15.0,
                                                           .rate_N_per_s = 400.0,
                                                           .velocity_m_per_s = 7.0,
                                                           .position_m = 3.0,
                                                           .stiffness_N_per_m = 150.0,
                                                           .damping_N_s_per_m = 5.0});
  }
  Joints<station::DeviceReading> read(const station::Tick& tick) noexcept override {
    const double turned_rad = 0.1 * std::sin(0.01 * static_cast<double>(tick.number));
    for (std::size_t i = 0; i < reading_.size(); ++i) {
      reading_[i].position_m = 0.3 + turned_rad;
      reading_[i].motor_report.velocity_m_per_s = turned_rad;
    }
    return reading_;
  }
  void write(const Joints<station::DeviceCommand>&) noexcept override {}
  [[nodiscard]] station::DeviceHealth health() const noexcept override { return station::DeviceHealth::good; }

 private:
  Joints<station::DeviceReading> reading_;
};

void report_pair(const char* name, Result<station::JointLocalTeleoperator> pair) {
  if (!pair) return static_cast<void>(std::fprintf(stderr, "%s\n", describe(pair.error()).c_str()));
  report(name, 20000, 1.0, [&](int k) {
    const std::int64_t now_ns = 2'000'000 * (k + std::int64_t{1});
    pair->step({.number = k, .deadline_ns = now_ns, .began_ns = now_ns}, {.align = k > 10});
  });
}

void measure_pairs() {
  const auto joint_file = configuration::Document::load("examples/rigs/joints.toml");
  const auto arm_file = configuration::Document::load("examples/rigs/arms.toml");
  if (!joint_file || !arm_file) return static_cast<void>(std::fprintf(stderr, "no examples/rigs here\n"));
  const auto by_joint = joint_file->read<experiments::TappingParams>();
  const auto by_arm = arm_file->read<experiments::ArmTappingParams>();
  if (!by_joint || !by_arm) return;
  const auto setup = experiments::set_up_arm_pair(*by_arm, "examples/rigs");
  if (!setup) return;
  const std::size_t joints = setup->leader.joints.size();
  const Seconds tick{1.0 / by_arm->servo.rate_Hz};
  std::printf("A rig's pair of %zu joints\n", joints);
  Told leader(joints), follower(joints);
  const Joints<control::ControlParams> control(joints, experiments::sites_of(*by_joint).control);
  report_pair("a tick, joint by joint",
              station::JointLocalTeleoperator::make(control, {}, tick, Joints<double>(joints, 0.0), leader, follower));
  auto sites = station::arm_sites(*by_arm, *setup, leader.limits(), follower.limits());
  if (!sites) return static_cast<void>(std::fprintf(stderr, "%s\n", describe(sites.error()).c_str()));
  report_pair("a tick, as two arms", station::JointLocalTeleoperator::around(*std::move(sites), leader, follower));
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path file = argc > 1 ? argv[1] : "experiments/arm-tapping.toml";
  const auto document = configuration::Document::load(file);
  const auto read = document ? document->read<experiments::ArmTappingParams>()
                             : Result<experiments::ArmTappingParams>(document.error());
  if (!read) return std::fprintf(stderr, "%s\n", describe(read.error()).c_str()), 1;
  experiments::ArmTappingParams params = *read;
  std::printf("Joints taken for rigid, rigid arms\n");
  if (!measure(params, file.parent_path())) return 1;
  params.control.model.joints = arm_control::JointModel::elastic;
  params.arm.joint_stiffness_N_m_per_rad = 3000.0;
  std::printf("Joints taken for elastic, elastic arms\n");
  if (!measure(params, file.parent_path())) return 1;
  measure_pairs();
  return 0;
}
