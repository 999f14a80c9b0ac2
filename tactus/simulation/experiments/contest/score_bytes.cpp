// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/experiments/contest/score_bytes.hpp>
#include <tactus/simulation/tasks/bytes.hpp>

#include <optional>

namespace tactus::experiments {

namespace {

/// Calls `field` for each number of a piece in the order of its bytes. One list serves both directions.
template <class Field>
void for_each_number(auto& limit, Field&& field) requires requires {
  limit.beyond_search;
}
{
  field(limit.gain);
  field(limit.beyond_search);
}

template <class Field>
void for_each_number(auto& score, Field&& field) requires requires {
  score.hand_force_rms_N;
}
{
  field(score.hand_force_rms_N);
  field(score.displayed_force_rms_N);
  field(score.lag_s);
}

template <class Field>
void for_each_number(auto& score, Field&& field) requires requires {
  score.spectral_error;
}
{
  field(score.force_gain);
  field(score.force_limit_N);
  field(score.spectral_error);
  field(score.sent_force_error_N);
  auto& metrics = score.metrics;
  field(metrics.taps);
  field(metrics.settled_fraction);
  field(metrics.settling_time_median_s);
  field(metrics.settling_time_p90_s);
  field(metrics.settling_time_median_censored);
  field(metrics.settling_time_p90_censored);
  field(metrics.contacts_median);
  field(metrics.peak_force_N);
  field(metrics.residual_rms_N);
  field(metrics.stopped);
  field(metrics.verdict);
}

template <class Piece>
std::string numbers_of(const Piece& piece) {
  tasks::ByteWriter bytes;
  for_each_number(piece, [&bytes](const auto& number) { bytes.put(number); });
  return bytes.take();
}

template <class Piece>
bool read_numbers(std::string_view bytes, Piece& piece) {
  tasks::ByteReader reader(bytes);
  for_each_number(piece, [&reader](auto& number) { reader.get(number); });
  return reader.complete();
}

}  // namespace

std::string to_bytes(const GainLimit& limit) { return numbers_of(limit); }
std::string to_bytes(const FreeSpaceScore& score) { return numbers_of(score); }
bool from_bytes(std::string_view bytes, GainLimit& limit) { return read_numbers(bytes, limit); }
bool from_bytes(std::string_view bytes, FreeSpaceScore& score) { return read_numbers(bytes, score); }

// Which site stopped first is no number. Taps of the contest are not supervised, so it is written for other users.
std::string to_bytes(const GainScore& score) {
  const auto& by = score.metrics.stopped_by;
  return numbers_of(score) + tasks::ByteWriter()
                                 .put(by ? std::optional(by->site) : std::nullopt)
                                 .put(by ? std::optional(by->cause) : std::nullopt)
                                 .take();
}

bool from_bytes(std::string_view bytes, GainScore& score) {
  tasks::ByteReader reader(bytes);
  for_each_number(score, [&reader](auto& number) { reader.get(number); });
  std::optional<control::SiteRole> site;
  std::optional<control::SiteCause> cause;
  reader.get(site);
  reader.get(cause);
  score.metrics.stopped_by = {};
  if (site && cause) score.metrics.stopped_by = simulation::StoppedSite{.site = *site, .cause = *cause};
  return reader.complete();
}

}  // namespace tactus::experiments
