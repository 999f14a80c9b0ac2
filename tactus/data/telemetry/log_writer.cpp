// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/log_part.hpp>
#include <tactus/data/telemetry/log_writer.hpp>
#include <tactus/data/telemetry/mcap_format.hpp>
#include <tactus/kernel/core/version.hpp>

#include <algorithm>
#include <array>
#include <ctime>
#include <exception>
#include <new>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <zstd.h>

namespace tactus::telemetry {

namespace {

using mcap::append;
using mcap::append_map;
using mcap::append_record;
using mcap::append_text;
using mcap::crc32_of;
using mcap::Opcode;

constexpr int fastest_compression = 1;

/// Of a log with a limit; one of them is being written.
constexpr std::size_t most_parts = 4;
constexpr std::uint64_t bytes_for_bag_metadata = std::uint64_t{64} * 1024;

struct ContextDeleter {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
};
using Compressor = std::unique_ptr<ZSTD_CCtx, ContextDeleter>;
Compressor new_compressor() {
  Compressor made(ZSTD_createCCtx());
  if (!made) throw std::bad_alloc();
  return made;
}

/// `2026-11-30T05:45:00.123456Z`
std::string utc_text(std::uint64_t unix_ns) {
  const auto seconds = static_cast<std::time_t>(unix_ns / 1'000'000'000);
  std::tm date{};
  gmtime_r(&seconds, &date);
  std::array<char, 40> day{};
  std::strftime(day.data(), day.size(), "%Y-%m-%dT%H:%M:%S", &date);
  // Behind a leading 1, so that zeros stay.
  const std::string microseconds = std::to_string(1'000'000 + unix_ns % 1'000'000'000 / 1000);
  return day.data() + ("." + microseconds.substr(1) + "Z");
}

/// The chunk that is being filled.
struct Chunk {
  struct IndexEntry {
    std::uint64_t time_ns, offset;
  };
  std::string records;
  std::map<std::uint16_t, std::vector<IndexEntry>> index;
  TimeSpan span;
};

}  // namespace

struct LogWriter::State {
  struct Metadata {
    std::string name, record;
  };

  std::filesystem::path file;
  std::uint64_t most_part_bytes = 0;  ///< 0: one file without a limit
  std::unique_ptr<LogPart> part;
  std::vector<std::unique_ptr<LogPart>> ended;  ///< earlier parts that are still there
  std::uint64_t parts = 0;                      ///< that were begun
  std::uint64_t removed = 0;                    ///< messages, with the oldest parts
  std::string pending;                          ///< head, schemas and channels that are not in the file yet
  std::string declarations;                     ///< all schemas and channels
  std::vector<Metadata> metadata;
  std::size_t metadata_written = 0;
  std::map<std::string, std::uint16_t> schemas;  ///< by type name
  std::vector<ChannelCount> counts;
  Chunk chunk;
  std::uint64_t newest_ns = 0;
  std::uint64_t start_unix_ns = 0;
  std::uint64_t acknowledged = 0;
  std::uint64_t lost = 0;
  std::optional<Error> first_error;
  Compressor compressor = new_compressor();
  std::string compressed;
  bool closed = false;

  /// A chunk and its message indexes as they stand in the file, and what its end says of them.
  struct Records {
    std::string bytes, index;
  };

  Check begin_part();
  Check next_part();
  Check declare();
  void compress_chunk();
  [[nodiscard]] Records chunk_records() const;
  Check put_chunk(const std::vector<std::uint64_t>& messages);
  Check flush();
  Check close();
};

Check LogWriter::State::begin_part() {
  std::filesystem::path name = file;
  if (most_part_bytes != 0) {
    name.replace_filename(file.stem().string() + "_" + std::to_string(parts) + file.extension().string());
  }
  auto made = LogPart::create(name);
  if (!made) return made.error();
  ++parts;
  part = *std::move(made);
  part->declare(counts.size());
  pending = mcap::magic;
  std::string header;
  append_text(header, "ros2");
  append_text(header, "tactus " + std::string(version()));
  append_record(pending, Opcode::header, header);
  pending += declarations;
  metadata_written = 0;
  return std::nullopt;
}

/// Ends the open part, begins another and removes the oldest where there would be too many.
Check LogWriter::State::next_part() {
  Check error = part->end(declarations, schemas.size());
  ended.push_back(std::move(part));
  if (ended.size() == most_parts) {
    const LogPart& oldest = *ended.front();
    std::error_code failed;
    std::filesystem::remove(oldest.path(), failed);
    if (failed && !error) {
      error = Error{.code = ErrorCode::unwritable,
                    .parameter = {},
                    .message = "the oldest part of the log could not be removed (" + failed.message() +
                               "): the log may grow beyond its limit",
                    .place = oldest.path().string()};
    }
    for (const std::uint64_t messages : oldest.written()) removed += messages;
    ended.erase(ended.begin());
  }
  if (error && !first_error) first_error = error;
  return begin_part();
}

/// Writes what stands before the first message that needs it.
Check LogWriter::State::declare() {
  if (!part) {
    if (auto error = begin_part()) return error;  // the last one could not be begun
  }
  if (!pending.empty()) {
    if (auto error = part->put(pending)) return error;
    pending.clear();
  }
  for (; metadata_written < metadata.size(); ++metadata_written) {
    const Metadata& next = metadata[metadata_written];
    if (auto error = part->put_metadata(next.name, next.record)) return error;
  }
  return std::nullopt;
}

void LogWriter::State::compress_chunk() {
  compressed.resize(ZSTD_compressBound(chunk.records.size()));
  const std::size_t size = ZSTD_compressCCtx(compressor.get(), compressed.data(), compressed.size(),
                                             chunk.records.data(), chunk.records.size(), fastest_compression);
  compressed.resize(ZSTD_isError(size) == 0 ? size : 0);
}

LogWriter::State::Records LogWriter::State::chunk_records() const {
  const bool smaller = !compressed.empty();
  const std::string_view compression = smaller ? "zstd" : "";
  const std::string_view records = smaller ? compressed : chunk.records;

  std::string content;
  append(content, chunk.span.first_or_zero());
  append(content, chunk.span.last_ns);
  append(content, std::uint64_t{chunk.records.size()});
  append(content, crc32_of(chunk.records));
  append_text(content, compression);
  append(content, std::uint64_t{records.size()});
  content += records;
  Records made;
  append_record(made.bytes, Opcode::chunk, content);

  const std::uint64_t chunk_length = made.bytes.size();
  std::string places;
  for (const auto& [channel, entries] : chunk.index) {
    append(places, channel);
    append(places, std::uint64_t{part->offset() + made.bytes.size()});
    std::string index;
    append(index, channel);
    append(index, static_cast<std::uint32_t>(16 * entries.size()));
    for (const auto& [time_ns, at] : entries) {
      append(index, time_ns);
      append(index, at);
    }
    append_record(made.bytes, Opcode::message_index, index);
  }

  std::string summary;
  append(summary, chunk.span.first_or_zero());
  append(summary, chunk.span.last_ns);
  append(summary, part->offset());
  append(summary, chunk_length);
  append_text(summary, places);
  append(summary, std::uint64_t{made.bytes.size() - chunk_length});
  append_text(summary, compression);
  append(summary, std::uint64_t{records.size()});
  append(summary, std::uint64_t{chunk.records.size()});
  append_record(made.index, Opcode::chunk_index, summary);
  return made;
}

/// Writes the chunk into the open part, or into another one where it does not fit any more.
Check LogWriter::State::put_chunk(const std::vector<std::uint64_t>& messages) {
  if (auto error = declare()) return error;
  compress_chunk();
  Records made = chunk_records();
  const auto too_large = [&] {
    return most_part_bytes != 0 &&
           part->size_with(made.bytes.size(), made.index.size(), declarations.size()) > most_part_bytes;
  };
  if (too_large() && part->chunks() > 0) {
    if (auto error = next_part()) return error;
    if (auto error = declare()) return error;
    made = chunk_records();
  }
  if (too_large()) {
    return Error{.code = ErrorCode::unwritable,
                 .parameter = {},
                 .message = "a part of the log may take " + std::to_string(most_part_bytes) +
                            " bytes, in which not one chunk fits with its description: allow the log more",
                 .place = part->path().string()};
  }
  return part->put_chunk(made.bytes, made.index, chunk.span, messages);
}

Check LogWriter::State::flush() {
  if (closed) return first_error;
  Check error;
  if (chunk.records.empty()) {
    error = declare();
  } else {
    std::vector<std::uint64_t> messages(counts.size());
    std::uint64_t all = 0;
    for (const auto& [channel, entries] : chunk.index) {
      messages[channel] = entries.size();
      all += entries.size();
    }
    error = put_chunk(messages);
    for (std::size_t channel = 0; channel < counts.size(); ++channel) {
      (error ? counts[channel].lost : counts[channel].written) += messages[channel];
    }
    if (error) {
      lost += all;
      error->message += "; " + std::to_string(all) + " messages are lost";
    } else {
      acknowledged += all;
    }
    chunk.records.clear();
    chunk.index.clear();
    chunk.span = {};
  }
  if (error && !first_error) first_error = error;
  return error;
}

Check LogWriter::State::close() {
  if (closed) return first_error;
  Check error = flush();
  closed = true;
  if (!error) error = part->end(declarations, schemas.size());
  if (part) ended.push_back(std::move(part));
  if (error && !first_error) first_error = error;
  return first_error;
}

LogWriter::LogWriter(std::unique_ptr<State> state) : state_(std::move(state)) {}
LogWriter::LogWriter(LogWriter&&) noexcept = default;
LogWriter& LogWriter::operator=(LogWriter&&) noexcept = default;
LogWriter::~LogWriter() {
  if (!state_) return;
  try {
    (void)state_->close();
  } catch (const std::exception&) {
    // Without memory for its end it is a log that was cut off.
  }
}

Result<LogWriter> LogWriter::create(const std::filesystem::path& file, std::uint64_t most_bytes) {
  if (most_bytes != 0 && most_bytes < least_limit_bytes) {
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = {},
                 .message = "a log of at most " + std::to_string(most_bytes) + " bytes holds too little: allow it " +
                            std::to_string(least_limit_bytes >> 20U) + " MiB or more",
                 .place = file.string()};
  }
  auto state = std::make_unique<State>();
  state->file = file;
  if (most_bytes != 0) state->most_part_bytes = (most_bytes - bytes_for_bag_metadata) / most_parts;
  if (auto error = state->begin_part()) return *std::move(error);
  return LogWriter(std::move(state));
}

std::uint16_t LogWriter::add_channel(const ChannelDescription& channel) {
  State& state = *state_;
  std::string records;
  auto [schema, is_new] =
      state.schemas.try_emplace(channel.type_name, static_cast<std::uint16_t>(state.schemas.size() + 1));
  if (is_new) {
    std::string content;
    append(content, schema->second);
    append_text(content, channel.type_name);
    append_text(content, "ros2msg");
    append_text(content, ros2msg(channel.columns));
    append_record(records, Opcode::schema, content);
  }
  const auto id = static_cast<std::uint16_t>(state.counts.size());
  state.counts.push_back({.topic = channel.topic, .type_name = channel.type_name});
  std::string content;
  append(content, id);
  append(content, schema->second);
  append_text(content, channel.topic);
  append_text(content, "cdr");
  auto metadata = column_metadata(channel.columns);
  metadata.insert(channel.about.begin(), channel.about.end());
  append_map(content, metadata);
  append_record(records, Opcode::channel, content);
  state.pending += records;
  state.declarations += records;
  if (state.part) state.part->declare(state.counts.size());
  return id;
}

void LogWriter::add_metadata(const std::string& name, const std::map<std::string, std::string>& content) {
  std::string bytes;
  append_text(bytes, name);
  append_map(bytes, content);
  std::string record;
  append_record(record, Opcode::metadata, bytes);
  state_->metadata.push_back({name, std::move(record)});
}

void LogWriter::start_at(std::int64_t unix_ns) {
  state_->start_unix_ns = static_cast<std::uint64_t>(std::max<std::int64_t>(0, unix_ns));
  add_metadata(log_clock, {{log_start_key, std::to_string(state_->start_unix_ns)},
                           {"start_utc", utc_text(state_->start_unix_ns)}});
}

void LogWriter::write(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns,
                      std::span<const unsigned char> cdr) {
  Chunk& chunk = state_->chunk;
  // All memory first: a message that is half there would spoil the chunk.
  constexpr std::size_t head_bytes = 1 + 8 + 2 + 4 + 8 + 8;
  const std::size_t needed = chunk.records.size() + head_bytes + cdr.size();
  if (needed > chunk.records.capacity()) chunk.records.reserve(std::max(needed, 2 * chunk.records.capacity()));
  const std::uint64_t logged_ns = state_->start_unix_ns + time_ns;
  chunk.index[channel].push_back({logged_ns, chunk.records.size()});
  chunk.span.add(logged_ns);
  state_->newest_ns = std::max(state_->newest_ns, time_ns);
  chunk.records += static_cast<char>(Opcode::message);
  append(chunk.records, std::uint64_t{2 + 4 + 8 + 8 + cdr.size()});
  append(chunk.records, channel);
  append(chunk.records, sequence);
  append(chunk.records, logged_ns);  // logged
  append(chunk.records, logged_ns);  // published
  chunk.records.append(cdr.begin(), cdr.end());
  if (chunk.records.size() >= chunk_bytes) (void)state_->flush();  // a failure is counted and kept for `close`
}

Check LogWriter::flush() { return state_->flush(); }
Check LogWriter::close() { return state_->close(); }
const std::vector<ChannelCount>& LogWriter::counts() const { return state_->counts; }
std::uint64_t LogWriter::acknowledged() const { return state_->acknowledged; }
std::uint64_t LogWriter::lost() const { return state_->lost; }
std::uint64_t LogWriter::removed() const { return state_->removed; }

std::vector<LogPartSummary> LogWriter::parts() const {
  std::vector<LogPartSummary> summaries;
  const auto add = [&summaries](const LogPart& part) {
    summaries.push_back({.file = part.path(),
                         .first_time_ns = part.span().first_or_zero(),
                         .last_time_ns = part.span().last_ns,
                         .messages = part.written()});
  };
  for (const auto& part : state_->ended) add(*part);
  if (state_->part) add(*state_->part);
  return summaries;
}

std::uint64_t LogWriter::newest_time_ns() const { return state_->newest_ns; }

}  // namespace tactus::telemetry
