// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/agreement.hpp>
#include <tactus/kernel/control/site.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <cstdint>

/// What one site sends the other besides the message of the architecture, and what becomes of it.
namespace tactus::control {

/// What a site does. In `configure` its motor is free; in `align`, `armed` and `hold` a slave is where it is and a
/// master gives no force; in `active` it follows; in `fault` the safety gate has released its force.
enum class SiteState { configure, align, armed, active, hold, fault };
constexpr auto enumerators(SiteState) {
  return std::array{Enumerator{SiteState::configure, "configure"}, Enumerator{SiteState::align, "align"},
                    Enumerator{SiteState::armed, "armed"},         Enumerator{SiteState::active, "active"},
                    Enumerator{SiteState::hold, "hold"},           Enumerator{SiteState::fault, "fault"}};
}

/// One message, of one axis or of several joints, with all that its receiver needs to judge it, without a clock.
template <class Payload>
struct PacketOf {
  std::int64_t session = 0;   ///< drawn by the sender at its start, never 0
  std::int64_t sequence = 0;  ///< from 1, one more for each packet of a session
  double age_s = 0.0;         ///< since it was sent, as well as the receiver knows
  SiteState state = SiteState::configure;
  std::int64_t armings = 0;  ///< how often the master was armed; a slave repeats the one that it follows
  Payload message{};
  AgreementExcerpt agreement{};
};
using Packet = PacketOf<Message>;
using JointPacket = PacketOf<Joints<Message>>;

/// Which session of the other site counts: the one that was taken up last. One that was left is never taken up again;
/// the last 16 are remembered. Real-time safe.
class Sessions {
 public:
  /// The one that counts; 0 before any.
  [[nodiscard]] std::int64_t current() const noexcept { return current_; }
  /// Whether `session` counted once and does not any more. 0 is no session and counts as left.
  [[nodiscard]] bool was_left(std::int64_t session) const noexcept {
    if (session == 0) return true;
    for (const std::int64_t left : left_) {
      if (session == left) return true;
    }
    return false;
  }
  /// `session` counts from now on; it must not have been left.
  void take_up(std::int64_t session) noexcept {
    left_[next_left_] = current_;
    next_left_ = (next_left_ + 1) % left_.size();
    current_ = session;
  }

 private:
  std::int64_t current_ = 0;
  std::array<std::int64_t, 16> left_{};  ///< 0: none
  std::size_t next_left_ = 0;
};

/// What becomes of a packet.
enum class PacketVerdict { applied, late, stale, left_session, not_finite, implausible };
constexpr auto enumerators(PacketVerdict) {
  return std::array{
      Enumerator{PacketVerdict::applied, "applied"},       Enumerator{PacketVerdict::late, "late"},
      Enumerator{PacketVerdict::stale, "stale"},           Enumerator{PacketVerdict::left_session, "left-session"},
      Enumerator{PacketVerdict::not_finite, "not-finite"}, Enumerator{PacketVerdict::implausible, "implausible"}};
}

/// Which packets a site takes.
struct PacketJudgeParams {
  double longest_age_s = 0.2;
  double position_limit_m = 10.0;
  double force_limit_N = 1000.0;
  static constexpr auto fields() {
    using P = PacketJudgeParams;
    return List{field("longest_age_s", &P::longest_age_s, units::second, positive_up_to(10.0),
                      "Age above which a message is not applied, even if it is the newest."),
                field("position_limit_m", &P::position_limit_m, units::metre, positive_up_to(1000.0),
                      "A received position beyond this is refused."),
                field("force_limit_N", &P::force_limit_N, units::newton, positive_up_to(1e5),
                      "A received force beyond this is refused.")};
  }
};

/// Decides which packets count: of a session the newest wins, a late or repeated one changes nothing, one that is too
/// old is not applied at all, and a session that was left is never taken up again. A message with a number that is
/// none, or one that no site could mean, is refused; of several joints, where that holds of any, or where there are not
/// as many. Of the energy what was added since the packet before is judged: a running total has no bound.
template <class Payload>
class PacketJudgeOf {
 public:
  using Params = Each<Payload, PacketJudgeParams>;  ///< the longest age is that of the first joint
  using Input = PacketOf<Payload>;
  using Output = PacketVerdict;

  /// Velocities and waves beyond this are refused, in their units.
  static constexpr double largest_other = 1e6;
  /// No gate lets a device move faster, so no more energy is sent in a tick than the force limit does at this speed.
  static constexpr double fastest_m_per_s = 100.0;
  /// No operator arms a master more often.
  static constexpr std::int64_t most_armings = 1'000'000'000;

  static Result<PacketJudgeOf> make(const Params& params, Seconds dt) {
    for (std::size_t joint = 0; joint < joints_of(params); ++joint) {
      if (auto error = signal::check(joint_of(params, joint), dt))
        return under_joint<Payload>(joint, *std::move(error));
    }
    return PacketJudgeOf(params, dt);
  }

  /// Judges one packet; what it states counts only where this is `applied`. Real-time safe.
  PacketVerdict step(const Input& packet) noexcept {
    if (sessions_.was_left(packet.session)) return PacketVerdict::left_session;
    if (packet.session == sessions_.current() && packet.sequence <= sequence_) return PacketVerdict::late;
    if (!(packet.age_s <= joint_of(params_, 0).longest_age_s)) return PacketVerdict::stale;
    if (!is_finite(packet.message)) return PacketVerdict::not_finite;
    if (!is_plausible(packet)) return PacketVerdict::implausible;
    if (packet.session != sessions_.current()) sessions_.take_up(packet.session);
    sequence_ = packet.sequence;
    energy_J_ = member_of_each(packet.message, &Message::energy_J);
    return PacketVerdict::applied;
  }
  /// As made: no session.
  void reset() noexcept { *this = PacketJudgeOf(params_, Seconds{dt_s_}); }

 private:
  PacketJudgeOf(const Params& params, Seconds dt)
      : params_(params), dt_s_(dt.value), energy_J_(same_for_each(params, 0.0)) {}

  [[nodiscard]] bool is_plausible(const Input& packet) const noexcept {
    if (packet.armings < 0 || packet.armings > most_armings) return false;
    if (joints_of(packet.message) != joints_of(params_)) return false;
    bool plausible = true;
    for_each_joint(
        [&](const PacketJudgeParams& params, const Message& message, double before_J) noexcept {
          plausible = plausible && std::fabs(message.position_m) <= params.position_limit_m &&
                      std::fabs(message.force_N) <= params.force_limit_N &&
                      std::fabs(message.velocity_m_per_s) <= largest_other &&
                      std::fabs(message.wave) <= largest_other &&
                      could_have_sent(packet, message.energy_J, before_J, params.force_limit_N);
        },
        params_, packet.message, energy_J_);
    return plausible;
  }
  /// Whether the sender can have added so much energy since the packet that was applied before, or since its session
  /// began.
  [[nodiscard]] bool could_have_sent(const Input& packet, double energy_J, double before_J,
                                     double force_limit_N) const noexcept {
    const bool same = packet.session == sessions_.current();
    const double elapsed_s = static_cast<double>(packet.sequence - (same ? sequence_ : 0)) * dt_s_;
    const double added_J = energy_J - (same ? before_J : 0.0);
    return std::fabs(added_J) <= force_limit_N * fastest_m_per_s * elapsed_s;
  }

  Params params_;
  double dt_s_;
  Sessions sessions_;
  std::int64_t sequence_ = 0;
  Each<Payload, double> energy_J_;
};
using PacketJudge = PacketJudgeOf<Message>;

}  // namespace tactus::control
