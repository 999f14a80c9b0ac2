#include <tactus/link/inbound.hpp>

#include <algorithm>

namespace tactus::link {

bool Inbound::was_left(std::uint64_t session) const noexcept {
  return std::find(left_.begin(), left_.end(), session) != left_.end();
}

void Inbound::take_up(const Datagram& datagram) noexcept {
  left_[next_left_] = session_;
  next_left_ = (next_left_ + 1) % remembered;
  session_ = answered_session_ = datagram.session;
  window_ = {};
  clock_.reset();
  first_sequence_ = datagram.sequence;
  arrived_ = 0;
  ++counters_.sessions;
}

Inbound::Verdict Inbound::judge(const Datagram& datagram, std::int64_t now_ns) noexcept {
  if (datagram.site == own_site_) return Verdict::reflected;
  if (datagram.peer_session != own_session_) {
    if (datagram.peer_session != 0 || was_left(datagram.session)) return Verdict::foreign;
    if (datagram.session == session_) return Verdict::late;  // from before it heard the own session
    answered_session_ = datagram.session;
    echo_sent_ns_ = datagram.sent_ns;
    echo_heard_ns_ = now_ns;
    return Verdict::greeting;
  }
  if (datagram.session != session_) {
    if (was_left(datagram.session)) return Verdict::foreign;
    take_up(datagram);
  }
  const auto verdict = window_.judge(datagram.sequence);
  if (verdict == ReplayWindow::Verdict::repeated) return Verdict::repeated;
  ++arrived_;
  if (datagram.echo_sent_ns != 0) {
    clock_.observe(datagram.echo_sent_ns, datagram.echo_hold_ns, datagram.sent_ns, now_ns);
  }
  if (verdict == ReplayWindow::Verdict::late) return Verdict::late;
  echo_sent_ns_ = datagram.sent_ns;
  echo_heard_ns_ = now_ns;
  if (!clock_.known() || clock_.age_ns(datagram.sent_ns, now_ns) > longest_age_ns_) return Verdict::stale;
  newest_ = datagram;
  heard_ns_ = now_ns;
  return Verdict::applied;
}

Inbound::Verdict Inbound::take(const Datagram& datagram, std::int64_t now_ns) noexcept {
  const Verdict verdict = judge(datagram, now_ns);
  switch (verdict) {
    case Verdict::applied:
      ++counters_.applied;
      break;
    case Verdict::greeting:
      ++counters_.greeting;
      break;
    case Verdict::late:
      ++counters_.late;
      break;
    case Verdict::repeated:
      ++counters_.repeated;
      break;
    case Verdict::stale:
      ++counters_.stale;
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

}  // namespace tactus::link
