// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/recorder.hpp>

#include <algorithm>
#include <chrono>
#include <exception>

namespace tactus::telemetry {

namespace {

/// How long the writer sleeps between two looks into the streams: a small part of what they hold, and seldom enough
/// that it hardly disturbs who shares its core.
constexpr std::chrono::milliseconds look_every{10};

}  // namespace

struct Recorder::State {
  struct Told {
    std::uint64_t dropped = 0;
    std::uint64_t lost = 0;
  };

  LogWriter log;
  std::vector<std::unique_ptr<Stream>> streams;
  std::vector<std::shared_ptr<void>> kept;
  std::vector<Told> told;
  std::uint16_t gaps = 0;
  std::uint32_t gap_sequence = 0;
  std::atomic<bool> stop{false};
  bool out_of_memory = false;  ///< the thread has ended early
  std::thread thread;

  explicit State(LogWriter writer) : log(std::move(writer)) {}

  void drain() {
    for (const auto& stream : streams) stream->drain(log);
    for (std::size_t i = 0; i < streams.size(); ++i) {
      const Told now{.dropped = streams[i]->dropped(), .lost = log.counts()[i].lost};
      if (now.dropped == told[i].dropped && now.lost == told[i].lost) continue;
      told[i] = now;
      const Gap gap{.channel = static_cast<std::int64_t>(i),
                    .dropped = static_cast<std::int64_t>(now.dropped),
                    .lost = static_cast<std::int64_t>(now.lost)};
      log.write(gaps, gap_sequence++, log.newest_time_ns(), to_cdr(gap));
    }
  }

  void run(std::chrono::duration<double> flush_every) noexcept {
    try {
      write_until_stopped(flush_every);
    } catch (const std::exception&) {
      out_of_memory = true;
    }
  }

  void write_until_stopped(std::chrono::duration<double> flush_every) {
    auto flushed = std::chrono::steady_clock::now();
    while (!stop.load(std::memory_order_acquire)) {
      std::this_thread::sleep_for(look_every);
      drain();
      const auto now = std::chrono::steady_clock::now();
      if (now - flushed < flush_every) continue;
      flushed = now;
      (void)log.flush();  // a failure is counted and told by `stop`
    }
  }
};

Recorder::Recorder(std::unique_ptr<State> state) : state_(std::move(state)) {}
Recorder::Recorder(Recorder&&) noexcept = default;
Recorder::~Recorder() {
  if (!state_) return;
  try {
    (void)stop();
  } catch (const std::exception&) {
    // The log is closed without what was waiting.
  }
}

Result<Recorder> Recorder::create(const std::filesystem::path& file, std::uint64_t most_bytes) {
  auto log = LogWriter::create(file, most_bytes);
  if (!log) return log.error();
  return Recorder(std::make_unique<State>(*std::move(log)));
}

std::uint16_t Recorder::add_channel(const ChannelDescription& channel) { return state_->log.add_channel(channel); }

void Recorder::add_stream(std::unique_ptr<Stream> stream) {
  state_->streams.push_back(std::move(stream));
  state_->told.emplace_back();
}

void Recorder::keep(std::shared_ptr<void> stream) { state_->kept.push_back(std::move(stream)); }

void Recorder::add_metadata(const std::string& name, const std::map<std::string, std::string>& content) {
  state_->log.add_metadata(name, content);
}

void Recorder::start_at(std::int64_t unix_ns) { state_->log.start_at(unix_ns); }

void Recorder::start(Seconds flush_every) {
  state_->gaps =
      add_channel({.topic = "/tactus/gaps", .type_name = "tactus_msgs/msg/Gap", .columns = columns_of<Gap>()});
  state_->thread = std::thread(
      [state = state_.get(), flush_every] { state->run(std::chrono::duration<double>(flush_every.value)); });
}

Check Recorder::stop() {
  if (!state_->thread.joinable()) return state_->log.close();
  state_->stop.store(true, std::memory_order_release);
  state_->thread.join();
  if (state_->out_of_memory) {
    (void)state_->log.close();
    return Error{.code = ErrorCode::failed,
                 .parameter = {},
                 .message = "memory ran out while the log was written: it ends there, and all that came later is lost",
                 .place = {}};
  }
  state_->drain();
  (void)state_->log.flush();  // what it loses is told in the gaps below
  state_->drain();
  return state_->log.close();
}

std::vector<std::uint64_t> Recorder::dropped() const {
  std::vector<std::uint64_t> counts;
  for (const auto& stream : state_->streams) counts.push_back(stream->dropped());
  return counts;
}

const LogWriter& Recorder::log() const { return state_->log; }

}  // namespace tactus::telemetry
