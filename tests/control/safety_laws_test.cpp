// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/force_sensor_check.hpp>
#include <tactus/kernel/control/message_follower.hpp>
#include <tactus/kernel/control/motion_check.hpp>
#include <tactus/kernel/control/overload_check.hpp>
#include <tactus/kernel/control/pace_check.hpp>
#include <tactus/kernel/control/reversal_check.hpp>
#include <tactus/kernel/control/safety_gate.hpp>
#include <tactus/kernel/control/sign_probe.hpp>
#include <tactus/kernel/control/site_supervisor.hpp>
#include <tactus/kernel/control/thermal_limit.hpp>
#include <tactus/kernel/control/watchdog.hpp>

#include "tests/laws.hpp"

namespace tactus::laws {

/// An output that is a word or a yes.
template <class Word>
struct WordAsDouble {
  using Row = std::array<double, 1>;
  static Row to(const Word& word) { return {static_cast<double>(word)}; }
};
template <>
struct Doubles<bool> : WordAsDouble<bool> {};
template <>
struct Doubles<control::EncoderFault> : WordAsDouble<control::EncoderFault> {};
template <>
struct Doubles<control::PacketVerdict> : WordAsDouble<control::PacketVerdict> {};
template <>
struct Doubles<control::SiteState> : WordAsDouble<control::SiteState> {};

template <>
struct Doubles<control::Watchdog::Input> {
  using Row = std::array<double, 2>;
  static control::Watchdog::Input from(const Row& row) {
    return {.heard = row[0] > 0.9, .elapsed_ticks = row[1] > 0.5 ? 40 : 1};
  }
};
template <>
struct Doubles<control::OverloadCheck::Input> {
  using Row = std::array<double, 1>;
  static control::OverloadCheck::Input from(const Row& row) { return {.elapsed_ticks = row[0] > 0.5 ? 40 : 1}; }
};
template <>
struct Doubles<control::PaceCheck::Input> {
  using Row = std::array<double, 3>;
  static control::PaceCheck::Input from(const Row& row) {
    return {.following = row[0] > -0.5,
            .sequence = static_cast<std::int64_t>(std::clamp(row[1], -1e9, 1e9)),
            .elapsed_ticks = row[2] > 0.5 ? 40 : 1};
  }
};
template <>
struct Doubles<control::EncoderCheck::Input> {
  using Row = std::array<double, 4>;
  static control::EncoderCheck::Input from(const Row& row) {
    return {.position_m = row[0], .acted_N = row[1], .unbalanced_N = row[2], .elapsed_ticks = row[3] > 0.5 ? 40 : 1};
  }
};
template <>
struct Doubles<control::MotionFault> : WordAsDouble<control::MotionFault> {};
template <>
struct Doubles<control::MotionCheck::Input> {
  using Row = std::array<double, 5>;
  static control::MotionCheck::Input from(const Row& row) {
    return {.position_m = row[0],
            .tells = {.velocity_m_per_s = row[1], .force_N = row[2]},
            .acted_N = row[3],
            .force_limit_N = 1.0,
            .between_s = row[4] > 0.5 ? 0.05 : 0.002};
  }
};
template <>
struct Doubles<control::ForceSensorCheck::Input> {
  using Row = std::array<double, 3>;
  static control::ForceSensorCheck::Input from(const Row& row) {
    return {.acted_N = row[0], .tip_force_N = row[1], .elapsed_ticks = row[2] > 0.5 ? 40 : 1};
  }
};
template <>
struct Doubles<control::PassivityMonitor::Input> {
  using Row = std::array<double, 3>;
  static control::PassivityMonitor::Input from(const Row& row) {
    return {.acted_N = row[0], .position_m = row[1], .elapsed_ticks = row[2] > 0.5 ? 40 : 1};
  }
};
template <>
struct Doubles<control::ReversalCheck::Input> {
  using Row = std::array<double, 3>;
  static control::ReversalCheck::Input from(const Row& row) {
    return {.net_N = row[0], .velocity_m_per_s = row[1], .elapsed_ticks = row[2] > 0.5 ? 40 : 1};
  }
};
template <>
struct Doubles<control::ThermalLimit::Input> {
  using Row = std::array<double, 3>;
  static control::ThermalLimit::Input from(const Row& row) {
    return {.acted_N = row[0], .peak_N = std::fabs(row[1]), .elapsed_ticks = row[2] > 0.5 ? 40 : 1};
  }
};
template <>
struct Doubles<control::SignProbe::Input> {
  using Row = std::array<double, 3>;
  static control::SignProbe::Input from(const Row& row) {
    return {.probing = row[0] > -0.99, .position_m = 1e-3 * row[1], .elapsed_ticks = row[2] > 0.5 ? 40 : 1};
  }
};
template <>
struct Doubles<control::Packet> {
  using Row = std::array<double, 4>;
  static control::Packet from(const Row& row) {
    return {.session = row[0] > 0.9 ? 2 : 1,
            .sequence = row[1] > 0.0 ? 5 : 7,
            .age_s = row[2],
            .message = {.position_m = row[3]}};
  }
};
template <>
struct Doubles<control::Arrival> {
  using Row = std::array<double, 6>;
  static Row to(const control::Arrival& arrival) {
    const auto& message = arrival.message;
    return {message.position_m, message.velocity_m_per_s, message.force_N,
            message.wave,       message.energy_J,         arrival.fresh ? 1.0 : 0.0};
  }
};
template <>
struct Doubles<control::MessageFollower::Input> {
  using Row = std::array<double, 7>;
  static control::MessageFollower::Input from(const Row& row) {
    return {.arrival = {.message = {row[0], row[1], row[2], row[3], row[4]}, .fresh = row[5] > -0.5},
            .following = row[6] > -0.9};
  }
};
template <>
struct Doubles<control::SiteSupervisor::Input> {
  using Row = std::array<double, 6>;
  static control::SiteSupervisor::Input from(const Row& row) {
    return {.requests = {.align = row[0] > 0.5, .arm = row[1] > 0.5, .clear = row[1]<-0.5, .dead_man = row[2]> 0.0},
            .heard = true,
            .session = 1,
            .peer = row[3] > 0.0 ? control::SiteState::armed : control::SiteState::active,
            .peer_armings = row[4] > 0.0 ? 1 : 2,
            .silent = row[5] > 0.95,
            .fault = row[5] < -0.98};
  }
};
template <>
struct Subject<control::SiteSupervisor> {
  static constexpr double dt_s = 200e-6;
  static std::vector<control::SiteSupervisor::Params> parameters() {
    return {{control::SiteRole::master}, {control::SiteRole::slave}};
  }
  static void admit(control::SiteSupervisor::Input&) {}
};

using SafetyElements =
    ::testing::Types<control::ForceGate, control::EncoderCheck, control::MotionCheck, control::ForceSensorCheck,
                     control::PassivityMonitor, control::Watchdog, control::OverloadCheck, control::PaceCheck,
                     control::ReversalCheck, control::ThermalLimit, control::SignProbe, control::StoppingBrake,
                     control::SafetyGate, control::PacketJudge, control::MessageFollower, control::SiteSupervisor>;
INSTANTIATE_TYPED_TEST_SUITE_P(Safety, ElementLaws, SafetyElements);

}  // namespace tactus::laws
