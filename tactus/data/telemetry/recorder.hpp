// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/telemetry/broadcast.hpp>
#include <tactus/data/telemetry/cdr.hpp>
#include <tactus/data/telemetry/log_writer.hpp>

#include <atomic>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace tactus::telemetry {

/// What a log reports about its own gaps, on the topic `/tactus/gaps`: written whenever one of the counts has grown.
struct Gap {
  std::int64_t channel = 0;  ///< in the order in which the channels were added
  std::int64_t dropped = 0;
  std::int64_t lost = 0;
  static constexpr auto signals() {
    return List{observed("channel", &Gap::channel, units::none, "", "", "", "Number of the channel that has the gap."),
                observed("dropped", &Gap::dropped, units::none, "", "", "",
                         "Records of it that came faster than they were written, since the start."),
                observed("lost", &Gap::lost, units::none, "", "", "",
                         "Records of it in chunks that could not be written, since the start.")};
  }
};

/// One channel as the writer thread sees it.
class Stream {
 public:
  Stream() = default;
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  virtual ~Stream() = default;
  /// Moves what is waiting into the log. Writer thread only.
  virtual void drain(LogWriter& log) = 0;
  /// Records that were lost before they reached the log. Any thread.
  [[nodiscard]] virtual std::uint64_t dropped() const noexcept = 0;
};

/// One channel as the servo thread sees it: one copy of each record, for the log and all other observers. By
/// default it holds 0.8 s at 5 kHz.
template <Recordable Record, std::size_t Capacity = 4096>
class RecordStream {
 public:
  struct Entry {
    std::uint64_t time_ns = 0;
    std::uint64_t number = 0;  ///< of the records of this stream, from 0
    Record record;
  };
  using Reader = typename Broadcast<Entry, Capacity>::Reader;

  RecordStream() : RecordStream(columns_of<Record>()) {}
  /// With columns that are called otherwise than the record's, as those of a joint that turns, and what else is known
  /// of them.
  explicit RecordStream(std::vector<Column> columns, std::map<std::string, std::string> about = {})
      : columns_(std::move(columns)), about_(std::move(about)) {}
  [[nodiscard]] const std::vector<Column>& columns() const noexcept { return columns_; }
  [[nodiscard]] const std::map<std::string, std::string>& about() const noexcept { return about_; }

  /// One thread only. Real-time safe: wait-free, no allocation, no system call, with observers and without.
  void push(std::uint64_t time_ns, const Record& record) noexcept { entries_->push({time_ns, next_++, record}); }
  /// Sees what is pushed from now on. Who falls behind by more than the capacity loses the oldest, and counts it.
  [[nodiscard]] Reader watch() const { return Reader(entries_); }

 private:
  std::vector<Column> columns_;
  std::map<std::string, std::string> about_;
  std::shared_ptr<Broadcast<Entry, Capacity>> entries_ = std::make_shared<Broadcast<Entry, Capacity>>();
  std::uint64_t next_ = 0;
};

/// A record stream on its way into a log. The number of a record is its place in the sequence.
template <Recordable Record, std::size_t Capacity>
class LoggedStream final : public Stream {
 public:
  LoggedStream(const RecordStream<Record, Capacity>& stream, std::uint16_t channel)
      : entries_(stream.watch()), channel_(channel) {}

  void drain(LogWriter& log) override {
    typename RecordStream<Record, Capacity>::Entry entry;
    // No more than was there at the start or so: the other channels want their turn.
    for (std::size_t i = 0; i < Capacity && entries_.next(entry); ++i) {
      log.write(channel_, static_cast<std::uint32_t>(entry.number), entry.time_ns, to_cdr(entry.record));
    }
    dropped_.store(entries_.lost(), std::memory_order_relaxed);
  }

  [[nodiscard]] std::uint64_t dropped() const noexcept override { return dropped_.load(std::memory_order_relaxed); }

 private:
  typename RecordStream<Record, Capacity>::Reader entries_;
  std::uint16_t channel_;
  std::atomic<std::uint64_t> dropped_{0};
};

/// Records at full rate while a servo thread runs: streams on one side, a thread of its own that writes the log on the
/// other.
///
/// Order of use: `create`, `add` for each channel, `start`, pushes, `stop`. What goes wrong on the disk reaches the
/// counts and the result of `stop`, and never the thread that pushes.
class Recorder {
 public:
  /// As `LogWriter::create`.
  static Result<Recorder> create(const std::filesystem::path& file, std::uint64_t most_bytes = 0);
  Recorder(Recorder&&) noexcept;
  Recorder& operator=(Recorder&&) = delete;
  ~Recorder();  ///< stops

  /// Logs what is pushed into the stream from now on. Before `start` only.
  template <Recordable Record, std::size_t Capacity>
  void add(const std::string& topic, const std::string& type_name, const RecordStream<Record, Capacity>& stream) {
    add({.topic = topic, .type_name = type_name, .columns = stream.columns(), .about = stream.about()},
        [&stream](std::uint16_t channel) { return std::make_unique<LoggedStream<Record, Capacity>>(stream, channel); });
  }
  /// The same for a stream of its own, which lives as long as the recorder.
  template <Recordable Record, std::size_t Capacity = 4096>
  RecordStream<Record, Capacity>& add(const std::string& topic, const std::string& type_name) {
    auto stream = std::make_shared<RecordStream<Record, Capacity>>();
    add(topic, type_name, *stream);
    keep(stream);
    return *stream;
  }
  /// The same for records that come another way: `make` is given the number of the channel.
  void add(const ChannelDescription& channel,
           const std::function<std::unique_ptr<Stream>(std::uint16_t channel)>& make) {
    add_stream(make(add_channel(channel)));
  }
  void add_metadata(const std::string& name, const std::map<std::string, std::string>& content);
  /// As `LogWriter::start_at`. Before `start` only.
  void start_at(std::int64_t unix_ns);

  /// A chunk is written at least every `flush_every_s`, so a killed process loses no more than that.
  void start(Seconds flush_every = Seconds{0.1});
  /// Ends the thread, writes what is waiting, closes the file. Errors: `unwritable` where anything was lost on the
  /// disk, `failed` if memory ran out meanwhile.
  Check stop();

  /// For each channel in the order of adding, what was overwritten before it was written down. Any thread.
  [[nodiscard]] std::vector<std::uint64_t> dropped() const;
  /// The log itself; while the thread runs it belongs to that.
  [[nodiscard]] const LogWriter& log() const;

 private:
  struct State;
  explicit Recorder(std::unique_ptr<State> state);
  std::uint16_t add_channel(const ChannelDescription& channel);
  void add_stream(std::unique_ptr<Stream> stream);
  void keep(std::shared_ptr<void> stream);
  std::unique_ptr<State> state_;
};

}  // namespace tactus::telemetry
