#include <tactus/core/version.hpp>
#include <tactus/telemetry/log_writer.hpp>
#include <tactus/telemetry/mcap_format.hpp>

#include <algorithm>
#include <cerrno>
#include <exception>
#include <limits>
#include <new>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>
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

std::string reason_of(int error_number) { return std::generic_category().message(error_number); }

struct ContextDeleter {
  void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
};
using Compressor = std::unique_ptr<ZSTD_CCtx, ContextDeleter>;
Compressor new_compressor() {
  Compressor made(ZSTD_createCCtx());
  if (!made) throw std::bad_alloc();
  return made;
}

/// The first and the last time of what was added.
struct Span {
  std::uint64_t first_ns = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t last_ns = 0;
  void add(std::uint64_t time_ns) {
    first_ns = std::min(first_ns, time_ns);
    last_ns = std::max(last_ns, time_ns);
  }
  [[nodiscard]] std::uint64_t first_or_zero() const { return std::min(first_ns, last_ns); }
};

/// The chunk that is being filled.
struct Chunk {
  struct IndexEntry {
    std::uint64_t time_ns, offset;
  };
  std::string records;
  std::map<std::uint16_t, std::vector<IndexEntry>> index;
  Span span;
};

}  // namespace

struct LogWriter::State {
  std::string path;
  int descriptor = -1;
  std::uint64_t offset = 0;    ///< end of what the system has taken
  std::uint32_t data_crc = 0;  ///< of all that, while it is the data section
  std::string pending;         ///< schemas, channels and metadata that are not in the file yet
  std::string summary;         ///< schemas and channels, for the end of the file
  std::string chunk_indexes;   ///< for the end of the file
  std::vector<std::pair<std::string, std::string>> pending_metadata;  ///< name and record
  std::string metadata_indexes;
  std::map<std::string, std::uint16_t> schemas;  ///< by type name
  std::vector<ChannelCount> counts;
  Chunk chunk;
  Span span;
  std::uint64_t newest_ns = 0;
  std::uint64_t acknowledged = 0;
  std::uint64_t lost = 0;
  std::uint32_t chunks = 0;
  std::uint32_t metadata_records = 0;
  std::optional<Error> first_error;
  Compressor compressor = new_compressor();
  std::string compressed;

  State() = default;
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (descriptor >= 0) ::close(descriptor);
  }

  Check put(std::string_view bytes);
  Check flush();
  Check close();
  [[nodiscard]] std::string chunk_record();
  [[nodiscard]] std::string statistics() const;
};

/// All of `bytes` or nothing: what was written of a failed part is cut off again.
Check LogWriter::State::put(std::string_view bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t written =
        ::pwrite(descriptor, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) {
      const std::string reason = written < 0 ? reason_of(errno) : "nothing was written";
      // A device cannot be cut; then there is nothing to keep readable either.
      const bool cut = ::ftruncate(descriptor, static_cast<off_t>(offset)) == 0;
      return Error{.code = ErrorCode::unwritable,
                   .parameter = {},
                   .message = "the log could not be written (" + reason + "): give it a place with room" +
                              (cut || done == 0 ? "" : "; it ends within a record"),
                   .place = path};
    }
    done += static_cast<std::size_t>(written);
  }
  data_crc = crc32_of(bytes, data_crc);
  offset += bytes.size();
  return std::nullopt;
}

/// Chunk and message indexes of the open chunk; leaves the chunk's index record in `chunk_indexes`.
std::string LogWriter::State::chunk_record() {
  compressed.resize(ZSTD_compressBound(chunk.records.size()));
  const std::size_t size = ZSTD_compressCCtx(compressor.get(), compressed.data(), compressed.size(),
                                             chunk.records.data(), chunk.records.size(), fastest_compression);
  const bool smaller = ZSTD_isError(size) == 0;
  const std::string_view compression = smaller ? "zstd" : "";
  const std::string_view records = smaller ? std::string_view(compressed).substr(0, size) : chunk.records;

  std::string content;
  append(content, chunk.span.first_or_zero());
  append(content, chunk.span.last_ns);
  append(content, std::uint64_t{chunk.records.size()});
  append(content, crc32_of(chunk.records));
  append_text(content, compression);
  append(content, std::uint64_t{records.size()});
  content += records;
  std::string bytes;
  append_record(bytes, Opcode::chunk, content);

  const std::uint64_t chunk_length = bytes.size();
  std::string places;
  for (const auto& [channel, entries] : chunk.index) {
    append(places, channel);
    append(places, std::uint64_t{offset + bytes.size()});
    std::string index;
    append(index, channel);
    append(index, static_cast<std::uint32_t>(16 * entries.size()));
    for (const auto& [time_ns, at] : entries) {
      append(index, time_ns);
      append(index, at);
    }
    append_record(bytes, Opcode::message_index, index);
  }

  std::string summary_of_chunk;
  append(summary_of_chunk, chunk.span.first_or_zero());
  append(summary_of_chunk, chunk.span.last_ns);
  append(summary_of_chunk, offset);
  append(summary_of_chunk, chunk_length);
  append_text(summary_of_chunk, places);
  append(summary_of_chunk, std::uint64_t{bytes.size() - chunk_length});
  append_text(summary_of_chunk, compression);
  append(summary_of_chunk, std::uint64_t{records.size()});
  append(summary_of_chunk, std::uint64_t{chunk.records.size()});
  append_record(chunk_indexes, Opcode::chunk_index, summary_of_chunk);
  return bytes;
}

Check LogWriter::State::flush() {
  Check error = pending.empty() ? std::nullopt : put(pending);
  if (!error) pending.clear();
  while (!error && !pending_metadata.empty()) {
    const auto& [name, record] = pending_metadata.front();
    std::string index;
    append(index, offset);
    append(index, std::uint64_t{record.size()});
    append_text(index, name);
    error = put(record);
    if (error) break;
    append_record(metadata_indexes, Opcode::metadata_index, index);
    ++metadata_records;
    pending_metadata.erase(pending_metadata.begin());
  }
  if (!chunk.records.empty()) {
    std::uint64_t messages = 0;
    for (const auto& [channel, entries] : chunk.index) messages += entries.size();
    if (!error) {
      const std::size_t indexed = chunk_indexes.size();
      error = put(chunk_record());
      if (error) chunk_indexes.resize(indexed);
    }
    for (const auto& [channel, entries] : chunk.index) {
      (error ? counts[channel].lost : counts[channel].written) += entries.size();
    }
    if (error) {
      lost += messages;
      error->message += "; " + std::to_string(messages) + " messages are lost";
    } else {
      acknowledged += messages;
      ++chunks;
      span.add(chunk.span.first_ns);
      span.add(chunk.span.last_ns);
    }
    chunk.records.clear();
    chunk.index.clear();
    chunk.span = {};
  }
  if (error && !first_error) first_error = error;
  return error;
}

std::string LogWriter::State::statistics() const {
  std::string content;
  append(content, acknowledged);
  append(content, static_cast<std::uint16_t>(schemas.size()));
  append(content, static_cast<std::uint32_t>(counts.size()));
  append(content, std::uint32_t{0});  // attachments
  append(content, metadata_records);
  append(content, chunks);
  append(content, span.first_or_zero());
  append(content, span.last_ns);
  std::string written;
  for (std::size_t channel = 0; channel < counts.size(); ++channel) {
    append(written, static_cast<std::uint16_t>(channel));
    append(written, counts[channel].written);
  }
  append_text(content, written);
  return content;
}

Check LogWriter::State::close() {
  if (descriptor < 0) return first_error;
  Check error = flush();
  if (!error) {
    std::string end;
    std::string crc_of_data;
    append(crc_of_data, data_crc);
    append_record(end, Opcode::data_end, crc_of_data);
    const std::size_t summary_at = end.size();
    end += summary;
    append_record(end, Opcode::statistics, statistics());
    end += chunk_indexes + metadata_indexes;
    // The footer's CRC covers the summary and the footer up to the CRC itself.
    end += static_cast<char>(Opcode::footer);
    append(end, std::uint64_t{20});
    append(end, std::uint64_t{offset + summary_at});
    append(end, std::uint64_t{0});  // no section of summary offsets
    append(end, crc32_of(std::string_view(end).substr(summary_at)));
    end += mcap::magic;
    error = put(end);
  }
  if (::close(std::exchange(descriptor, -1)) != 0 && !error) {
    error = Error{.code = ErrorCode::unwritable,
                  .parameter = {},
                  .message = "the log could not be closed (" + reason_of(errno) + "): look whether its disk is full",
                  .place = path};
  }
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

Result<LogWriter> LogWriter::create(const std::filesystem::path& file) {
  auto state = std::make_unique<State>();
  state->path = file.string();
  state->descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (state->descriptor < 0) {
    return Error{
        .code = ErrorCode::unwritable,
        .parameter = {},
        .message = "the log could not be made (" + reason_of(errno) + "): name a place where files can be written",
        .place = file.string()};
  }
  state->pending = mcap::magic;
  std::string header;
  append_text(header, "ros2");
  append_text(header, "tactus " + std::string(version()));
  append_record(state->pending, Opcode::header, header);
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
  append_map(content, column_metadata(channel.columns));
  append_record(records, Opcode::channel, content);
  state.pending += records;
  state.summary += records;
  return id;
}

void LogWriter::add_metadata(const std::string& name, const std::map<std::string, std::string>& content) {
  std::string bytes;
  append_text(bytes, name);
  append_map(bytes, content);
  std::string record;
  append_record(record, Opcode::metadata, bytes);
  state_->pending_metadata.emplace_back(name, std::move(record));
}

void LogWriter::write(std::uint16_t channel, std::uint32_t sequence, std::uint64_t time_ns,
                      std::span<const unsigned char> cdr) {
  Chunk& chunk = state_->chunk;
  // All memory first: a message that is half there would spoil the chunk.
  constexpr std::size_t head_bytes = 1 + 8 + 2 + 4 + 8 + 8;
  const std::size_t needed = chunk.records.size() + head_bytes + cdr.size();
  if (needed > chunk.records.capacity()) chunk.records.reserve(std::max(needed, 2 * chunk.records.capacity()));
  chunk.index[channel].push_back({time_ns, chunk.records.size()});
  chunk.span.add(time_ns);
  state_->newest_ns = std::max(state_->newest_ns, time_ns);
  chunk.records += static_cast<char>(Opcode::message);
  append(chunk.records, std::uint64_t{2 + 4 + 8 + 8 + cdr.size()});
  append(chunk.records, channel);
  append(chunk.records, sequence);
  append(chunk.records, time_ns);  // logged
  append(chunk.records, time_ns);  // published
  chunk.records.append(cdr.begin(), cdr.end());
  if (chunk.records.size() >= chunk_bytes) (void)state_->flush();  // a failure is counted and kept for `close`
}

Check LogWriter::flush() { return state_->flush(); }
Check LogWriter::close() { return state_->close(); }
const std::vector<ChannelCount>& LogWriter::counts() const { return state_->counts; }
std::uint64_t LogWriter::acknowledged() const { return state_->acknowledged; }
std::uint64_t LogWriter::lost() const { return state_->lost; }
std::uint64_t LogWriter::first_time_ns() const { return state_->span.first_or_zero(); }
std::uint64_t LogWriter::last_time_ns() const { return state_->span.last_ns; }
std::uint64_t LogWriter::newest_time_ns() const { return state_->newest_ns; }

}  // namespace tactus::telemetry
