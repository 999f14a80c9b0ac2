// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/diagnosis/line.hpp>
#include <tactus/identification/diagnosis/oscillation.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

namespace tactus::diagnosis {

namespace {

/// Frames of one length look for one band.
struct Level {
  double frame_s, lower_Hz, upper_Hz;
  double fewest_periods;
  double longest_gap;   ///< periods for which the envelope may be down: a tremor's is, now and then
  double lasting;       ///< share of the time in which it must be up
  double concentrated;  ///< least share of a frame's power in the line and its harmonics
  double share;         ///< the same over the whole oscillation; reaches of a hand have up to a third in some line
};
constexpr std::array<Level, 3> levels{{{0.5, 10.0, 1e9, 20.0, 3.0, 0.8, 0.4, 0.3},
                                       {2.0, 2.5, 10.0, 12.0, 6.0, 0.6, 0.5, 0.4},
                                       {4.0, 1.25, 2.5, 4.0, 1.5, 0.6, 0.5, 0.4}}};
constexpr double envelope_floor = 0.4;
constexpr double same_line_break_s = 2.0;
constexpr double shortest_s = 1.0;
constexpr double fades = 0.6;  ///< from the first to the last quarter
constexpr std::size_t harmonics = 6;
constexpr double highest_of_a_tremor_Hz = 16.0;
constexpr std::size_t reach = 2;  ///< lines on either side that belong to one under a Hann window

struct Candidate {
  std::string signal;
  std::vector<double> values;
  double least;     ///< smallest amplitude that is more than the signal's steps
  double exponent;  ///< of the frequency by which power is weighted
};

std::vector<Candidate> candidates_of(const Signals& signals) {
  std::vector<Candidate> found;
  const auto add = [&found](std::string name, std::vector<double> values, double step, bool position) {
    // Positions fall with frequency: weighted by it, a saw-tooth still has its largest line at the bottom.
    if (step > 0.0) {
      found.push_back({std::move(name), std::move(values), (position ? 0.5 : 2.0) * step, position ? 1.0 : 0.0});
    }
  };
  for (const Role role : all_roles) {
    if (const Channel* channel = signals.find(role); channel != nullptr && role != Role::hand_force) {
      add(std::string(words_of(role)), channel->values, channel->step, is_position(role));
    }
  }
  const Channel* slave = signals.find(Role::slave_position);
  const double slave_step = slave == nullptr ? 0.0 : slave->step;
  if (auto error = following_error(signals); !error.empty()) {
    add("following error", std::move(error), slave_step, true);
  }
  return found;
}

/// Power of line `k` with its neighbours.
double power_about(const std::vector<double>& power, std::size_t k) {
  double sum = 0.0;
  for (std::size_t i = k - std::min(k, reach); i <= std::min(k + reach, power.size() - 1); ++i) sum += power[i];
  return sum;
}

/// The fundamental of the line that stands out of a frame, none if nothing does.
std::optional<std::size_t> line_of(std::vector<double> power, const std::vector<double>& frequency_Hz,
                                   const Level& level, double upper_Hz, const Candidate& candidate) {
  const auto at = [&](double f_Hz) {
    return std::min(static_cast<std::size_t>(std::llround(f_Hz / frequency_Hz[1])), power.size() - 1);
  };
  std::vector<double> plain = power;
  for (std::size_t k = 0; k < power.size(); ++k) power[k] *= std::pow(frequency_Hz[k], candidate.exponent);
  const auto first = static_cast<std::ptrdiff_t>(at(level.lower_Hz)), last = static_cast<std::ptrdiff_t>(at(upper_Hz));
  if (first >= last) return std::nullopt;
  auto k = static_cast<std::size_t>(std::max_element(power.begin() + first, power.begin() + last) - power.begin());
  if (static_cast<std::ptrdiff_t>(k) == first && k > 0 && power[k - 1] > power[k]) return std::nullopt;
  // A pulse's second or third harmonic may be its largest.
  for (const std::size_t part : {std::size_t{3}, std::size_t{2}}) {
    const std::size_t below = (k + part / 2) / part;
    if (below <= static_cast<std::size_t>(first) + reach) continue;
    if (power_about(power, below) > 0.2 * power_about(power, k)) {
      const auto from = power.begin() + static_cast<std::ptrdiff_t>(below - 1);
      k = static_cast<std::size_t>(std::max_element(from, from + 3) - power.begin());
      break;
    }
  }
  double in_lines = 0.0, all = 0.0;
  for (std::size_t h = 1; h <= harmonics && h * k + reach < power.size(); ++h) in_lines += power_about(power, h * k);
  const std::size_t end = std::min(8 * k, power.size() - 1);
  for (std::size_t i = std::max<std::size_t>(1, (6 * k) / 10); i <= end; ++i) all += power[i];
  if (in_lines < level.concentrated * all) return std::nullopt;
  if (std::sqrt(2.0 * power_about(plain, k)) < candidate.least) return std::nullopt;
  return k;
}

/// Frames in a row that show one line.
struct Track {
  double frequency_Hz, first_s, last_s;
};

std::vector<Track> tracks_of(const Spectrogram& frames, const Level& level, double upper_Hz, double hop_s,
                             const Candidate& candidate) {
  std::vector<Track> tracks;
  for (std::size_t i = 0; i < frames.power.size(); ++i) {
    const auto k = line_of(frames.power[i], frames.frequency_Hz, level, upper_Hz, candidate);
    if (!k) continue;
    const double f_Hz = frames.frequency_Hz[*k];
    const double width_Hz = std::max(0.08 * f_Hz, 1.5 * frames.frequency_Hz[1]);
    const auto same = std::find_if(tracks.rbegin(), tracks.rend(), [&](const Track& track) {
      return std::abs(track.frequency_Hz - f_Hz) <= width_Hz && frames.time_s[i] - track.last_s < 3.5 * hop_s;
    });
    if (same == tracks.rend()) {
      tracks.push_back({f_Hz, frames.time_s[i], frames.time_s[i]});
    } else {
      same->last_s = frames.time_s[i];
      same->frequency_Hz += 0.3 * (f_Hz - same->frequency_Hz);
    }
  }
  return tracks;
}

/// The longest stretch of a track in which the envelope stays up, with the frequency there; none if it does not.
std::optional<Oscillation> lasting_part(const Track& track, const Level& level, double margin_s,
                                        const Candidate& candidate, Seconds dt) {
  const auto size = candidate.values.size();
  const auto index = [&](double time_s) {
    return static_cast<std::size_t>(std::clamp(time_s / dt.value, 0.0, static_cast<double>(size)));
  };
  const std::size_t from = index(track.first_s - margin_s), to = index(track.last_s + margin_s);
  const std::span<const double> part = std::span(candidate.values).subspan(from, to - from);
  std::vector<Complex> line = demodulate(part, track.frequency_Hz, dt);
  if (line.size() < 8) return std::nullopt;
  std::vector<double> sorted(line.size());
  std::transform(line.begin(), line.end(), sorted.begin(), [](const Complex& y) { return std::abs(y); });
  const auto usual = sorted.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(sorted.size()));
  std::nth_element(sorted.begin(), usual, sorted.end());
  const double floor = envelope_floor * *usual;

  const auto longest_gap = static_cast<std::size_t>(level.longest_gap / (track.frequency_Hz * dt.value));
  std::size_t best_first = 0, best_end = 0, first = 0, end = 0, above = 0, best_above = 0;
  bool open = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    if (std::abs(line[i]) < floor) continue;
    if (!open || i - end > longest_gap) first = i, above = 0, open = true;
    end = i + 1;
    ++above;
    if (end - first > best_end - best_first) best_first = first, best_end = end, best_above = above;
  }
  const double length_s = static_cast<double>(best_end - best_first) * dt.value;
  if (length_s * track.frequency_Hz < level.fewest_periods || length_s < shortest_s) return std::nullopt;
  if (static_cast<double>(best_above) < level.lasting * static_cast<double>(best_end - best_first)) return std::nullopt;

  const auto mean_size = [&](std::size_t begin, std::size_t finish) {
    double sum = 0.0;
    for (std::size_t i = begin; i < finish; ++i) sum += std::abs(line[i]);
    return sum / static_cast<double>(finish - begin);
  };
  const std::size_t quarter = (best_end - best_first) / 4;
  const bool short_lived = length_s * track.frequency_Hz < 2.0 * level.fewest_periods;
  if (short_lived && mean_size(best_end - quarter, best_end) < fades * mean_size(best_first, best_first + quarter))
    return std::nullopt;
  Complex turn{};
  double line_power = 0.0, power = 0.0;
  const std::vector<double> fast = without_slow(part, track.frequency_Hz, dt);
  for (std::size_t i = best_first; i < best_end; ++i) {
    if (i > best_first) turn += line[i] * std::conj(line[i - 1]);
    line_power += 0.5 * std::norm(line[i]);
    power += fast[i] * fast[i];
  }
  // A force in pulses has most of its power in harmonics.
  if (level.upper_Hz > highest_of_a_tremor_Hz) {
    for (double h = 2.0; h <= 4.0 && h * track.frequency_Hz < 0.45 / dt.value; h += 1.0) {
      const std::vector<Complex> harmonic = demodulate(part, h * track.frequency_Hz, dt);
      for (std::size_t i = best_first; i < best_end; ++i) line_power += 0.5 * std::norm(harmonic[i]);
    }
  }
  if (line_power < level.share * power) return std::nullopt;
  const double off_Hz = std::arg(turn) / (2.0 * std::numbers::pi * dt.value);
  const double begins_s = static_cast<double>(from) * dt.value;
  return Oscillation{.frequency_Hz = track.frequency_Hz + off_Hz,
                     .from_s = begins_s + static_cast<double>(best_first) * dt.value,
                     .to_s = begins_s + static_cast<double>(best_end) * dt.value,
                     .share = power > 0.0 ? std::min(1.0, line_power / power) : 0.0,
                     .signal = candidate.signal};
}

/// By how much two are apart in time, less than 0 where they overlap.
double gap_s(const Oscillation& a, const Oscillation& b) {
  return std::max(a.from_s, b.from_s) - std::min(a.to_s, b.to_s);
}

bool of_one_frequency(const Oscillation& a, const Oscillation& b) {
  return std::abs(b.frequency_Hz / a.frequency_Hz - 1.0) < 0.1 && gap_s(a, b) < same_line_break_s;
}

/// Is `b` a multiple of `a`, for at least a third of its time?
bool is_multiple(const Oscillation& a, const Oscillation& b) {
  const double ratio = b.frequency_Hz / a.frequency_Hz;
  const double whole = std::round(ratio);
  return whole >= 2.0 && whole <= 8.0 && std::abs(ratio - whole) < 0.03 * whole &&
         -gap_s(a, b) > (b.to_s - b.from_s) / 3.0;
}

}  // namespace

double position_scale(const Signals& signals) {
  constexpr double slow_Hz = 2.0, together = 0.95;
  const Channel* master = signals.find(Role::master_position);
  const Channel* slave = signals.find(Role::slave_position);
  if (master == nullptr || slave == nullptr || master->constant() || slave->constant()) return 1.0;
  // Slow motion alone: an oscillation has a phase between the two.
  const auto fast_master = without_slow(master->values, slow_Hz, signals.sample_time);
  const auto fast_slave = without_slow(slave->values, slow_Hz, signals.sample_time);
  double m = 0.0, s = 0.0, mm = 0.0, ms = 0.0, ss = 0.0;
  const auto n = static_cast<double>(signals.samples);
  for (std::size_t i = 0; i < signals.samples; ++i) {
    const double x = master->values[i] - fast_master[i] - master->values[0];
    const double y = slave->values[i] - fast_slave[i] - slave->values[0];
    m += x, s += y, mm += x * x, ms += x * y, ss += y * y;
  }
  mm -= m * m / n, ms -= m * s / n, ss -= s * s / n;
  const bool tells = std::sqrt(mm / n) > 12.0 * master->step && ms * ms > together * together * mm * ss;
  return tells ? ms / mm : 1.0;
}

std::vector<double> following_error(const Signals& signals) {
  const Channel* master = signals.find(Role::master_position);
  const Channel* slave = signals.find(Role::slave_position);
  if (master == nullptr || slave == nullptr) return {};
  const double scale = position_scale(signals);
  std::vector<double> error(signals.samples);
  for (std::size_t i = 0; i < signals.samples; ++i) error[i] = slave->values[i] - scale * master->values[i];
  return error;
}

std::vector<Oscillation> find_oscillations(const Signals& signals) {
  const Seconds dt = signals.sample_time;
  const double highest_Hz = 0.45 / dt.value;
  std::vector<Oscillation> all;
  for (const Candidate& candidate : candidates_of(signals)) {
    for (const Level& level : levels) {
      std::size_t frame = std::bit_floor(static_cast<std::size_t>(1.2 * level.frame_s / dt.value));
      if (frame < 16 || frame > signals.samples) continue;
      const std::size_t hop = frame / 8;
      const double upper_Hz = std::min(level.upper_Hz, highest_Hz);
      const Spectrogram frames = spectrogram(candidate.values, frame, hop, dt);
      const double margin_s = 0.5 * static_cast<double>(frame) * dt.value;
      const double hop_s = static_cast<double>(hop) * dt.value;
      for (const Track& track : tracks_of(frames, level, upper_Hz, hop_s, candidate)) {
        if (auto found = lasting_part(track, level, margin_s, candidate, dt)) all.push_back(*std::move(found));
      }
    }
  }
  const auto weight = [](const Oscillation& o) { return o.share * (o.to_s - o.from_s); };
  std::sort(all.begin(), all.end(), [&](const Oscillation& a, const Oscillation& b) { return weight(a) > weight(b); });
  // What the strongest shows of it counts; others may show it for longer.
  std::vector<Oscillation> kept;
  for (const Oscillation& one : all) {
    const auto same =
        std::find_if(kept.begin(), kept.end(), [&](const Oscillation& k) { return of_one_frequency(k, one); });
    if (same == kept.end()) {
      kept.push_back(one);
    } else if (one.signal == same->signal) {
      same->from_s = std::min(same->from_s, one.from_s);
      same->to_s = std::max(same->to_s, one.to_s);
    }
  }
  std::erase_if(kept, [&](const Oscillation& one) {
    return std::any_of(kept.begin(), kept.end(), [&](const Oscillation& base) {
      return is_multiple(base, one) && weight(base) > 0.5 * weight(one);
    });
  });
  std::sort(kept.begin(), kept.end(), [](const Oscillation& a, const Oscillation& b) {
    return a.share * (a.to_s - a.from_s) > b.share * (b.to_s - b.from_s);
  });
  return kept;
}

}  // namespace tactus::diagnosis
