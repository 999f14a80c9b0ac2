// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/episodes.hpp>

#include <algorithm>
#include <array>
#include <string_view>

namespace tactus::telemetry {

namespace {

/// A column of codes with its words.
struct CodedColumn {
  const std::vector<double>* values = nullptr;
  CodeWords words = {};
  [[nodiscard]] std::string_view at(std::size_t row) const { return words.of((*values)[row]); }
};

CodedColumn coded_column(const LogTable& table, std::string_view name) {
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (table.columns[i].name == name) return {.values = &table.values[i], .words = code_words(table.columns[i])};
  }
  return {};
}

/// Episodes while the log is walked through.
class EpisodeWalk {
 public:
  void mark(std::string_view mark, std::uint64_t time_ns) {
    if (mark == "start") {
      end(time_ns);
      if (active_) begin(time_ns);
    } else if (mark == "keep") {
      end(time_ns);
    } else if (mark == "discard") {
      end(time_ns);
      if (!found_.empty()) found_.back().discarded = true;
    }
  }
  void state(bool active, std::uint64_t time_ns) {
    if (active && !active_) begin(time_ns);
    if (!active) end(last_active_ns_);
    if (active) last_active_ns_ = time_ns;
    active_ = active;
  }
  std::vector<Episode> finish() && {
    end(last_active_ns_);
    return std::move(found_);
  }

 private:
  void begin(std::uint64_t time_ns) {
    found_.push_back({.number = found_.size() + 1, .from_ns = time_ns, .to_ns = time_ns});
    runs_ = true;
  }
  void end(std::uint64_t time_ns) {
    if (runs_) found_.back().to_ns = std::max(found_.back().from_ns, time_ns);
    runs_ = false;
  }

  std::vector<Episode> found_;
  std::uint64_t last_active_ns_ = 0;
  bool active_ = false;
  bool runs_ = false;
};

}  // namespace

const LogTable* site_that_follows(const LogContent& content) {
  constexpr std::array topics{"/slave/site", "/master/site", "/site"};
  for (const char* topic : topics) {
    if (const LogTable* site = content.find(topic); site != nullptr && site->find("state") != nullptr) return site;
  }
  return nullptr;
}

std::vector<Episode> episodes_of(const LogContent& content) {
  const LogTable* site = site_that_follows(content);
  if (site == nullptr) return {};
  const CodedColumn state = coded_column(*site, "state");
  const LogTable* marks = content.find(episodes_topic);
  const CodedColumn mark = marks == nullptr ? CodedColumn{} : coded_column(*marks, episode_mark);
  std::size_t next = 0;
  EpisodeWalk walk;
  const auto take_marks = [&](std::uint64_t until_ns) {
    for (; mark.values != nullptr && next < mark.values->size() && marks->times_ns[next] <= until_ns; ++next) {
      walk.mark(mark.at(next), marks->times_ns[next]);
    }
  };
  for (std::size_t row = 0; row < state.values->size(); ++row) {
    walk.state(state.at(row) == "active", site->times_ns[row]);
    take_marks(site->times_ns[row]);
  }
  take_marks(~std::uint64_t{0});
  return std::move(walk).finish();
}

}  // namespace tactus::telemetry
