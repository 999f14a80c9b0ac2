// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/inbound.hpp>

#include <limits>

namespace tactus::link {

void Inbound::take_up(std::int64_t session, std::int64_t sequence) noexcept {
  sessions_.take_up(session);
  answered_session_ = session;
  window_ = {};
  clock_.reset();
  first_sequence_ = static_cast<std::uint64_t>(sequence);
  arrived_ = 0;
  ++counters_.sessions;
}

template <class Payload>
Inbound::Verdict Inbound::judge(DatagramOf<Payload>& datagram, std::int64_t now_ns) noexcept {
  control::PacketOf<Payload>& packet = datagram.packet;
  if (datagram.site == own_site_) return Verdict::reflected;
  const bool answers = datagram.peer_session == own_session_;
  if ((!answers && datagram.peer_session != 0) || sessions_.was_left(packet.session)) return Verdict::foreign;
  if (!answers) {
    // One of the session that is taken up is from before it heard the own one.
    if (packet.session == sessions_.current()) return Verdict::greeting;
    answered_session_ = packet.session;
    echo_sent_ns_ = datagram.sent_ns;
    echo_received_ns_ = now_ns;
    return Verdict::greeting;
  }
  if (packet.session != sessions_.current()) take_up(packet.session, packet.sequence);
  const auto seen = window_.judge(static_cast<std::uint64_t>(packet.sequence));
  if (seen == ReplayWindow::Verdict::repeated) return Verdict::repeated;
  ++arrived_;
  received_ns_ = now_ns;
  if (datagram.echo_sent_ns != 0) {
    clock_.observe(datagram.echo_sent_ns, datagram.echo_hold_ns, datagram.sent_ns, now_ns);
  }
  if (seen == ReplayWindow::Verdict::newest) {
    echo_sent_ns_ = datagram.sent_ns;
    echo_received_ns_ = now_ns;
  }
  packet.age_s = clock_.known() ? static_cast<double>(clock_.age_ns(datagram.sent_ns, now_ns)) * 1e-9
                                : std::numeric_limits<double>::infinity();
  return Verdict::counted;
}

template <class Payload>
Inbound::Verdict Inbound::take(DatagramOf<Payload>& datagram, std::int64_t now_ns) noexcept {
  const Verdict verdict = judge(datagram, now_ns);
  switch (verdict) {
    case Verdict::counted:
      ++counters_.counted;
      break;
    case Verdict::greeting:
      ++counters_.greeting;
      break;
    case Verdict::repeated:
      ++counters_.repeated;
      break;
    case Verdict::reflected:
      ++counters_.reflected;
      break;
    case Verdict::foreign:
      ++counters_.foreign;
      break;
  }
  return verdict;
}
template Inbound::Verdict Inbound::take(Datagram&, std::int64_t) noexcept;
template Inbound::Verdict Inbound::take(JointDatagram&, std::int64_t) noexcept;

}  // namespace tactus::link
