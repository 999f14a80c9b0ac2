// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/data/telemetry/lz4.hpp>
#include <tactus/data/telemetry/mcap_format.hpp>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <memory>
#include <new>
#include <string_view>
#include <system_error>

#include <zstd.h>
#include <zstd_errors.h>

namespace tactus::telemetry {

namespace {

using mcap::crc32_of;
using mcap::Cursor;
using mcap::Opcode;

constexpr std::uint64_t largest_record_bytes = std::uint64_t{64} * 1024 * 1024;
/// Of what a file declares: schemas, channels and metadata.
constexpr std::uint64_t most_declared_bytes = std::uint64_t{16} * 1024 * 1024;
/// Read and unpacked, which bounds the time that a file can take.
constexpr std::uint64_t most_unpacked_bytes = std::uint64_t{4} << 30U;

struct Closer {
  void operator()(std::FILE* file) const { (void)std::fclose(file); }
};

Error unreadable(ErrorCode code, const std::filesystem::path& file, std::string message) {
  return Error{.code = code, .parameter = {}, .message = std::move(message), .place = file.string()};
}

class Scan {
 public:
  Scan(std::FILE* file, std::uint64_t size, const std::function<Check(const LogChannel&, const LogMessage&)>& visit)
      : file_(file), left_(size), visit_(visit) {}

  Check begin() {
    crc_ = crc32_of(mcap::magic);
    if ((read(mcap::magic.size(), buffer_) && buffer_ == mcap::magic) || error_) return error_;
    return Error{.code = ErrorCode::syntax,
                 .parameter = {},
                 .message = "this is no MCAP file: name a log that tactus or a ROS 2 tool has written",
                 .place = {}};
  }

  Check run() {
    std::string head;
    while (!stop_ && !error_ && read(mcap::record_head_bytes, head)) {
      Cursor cursor(head);
      const auto opcode = static_cast<Opcode>(cursor.take<unsigned char>());
      const auto length = cursor.take<std::uint64_t>();
      if (length > left_) break;  // cut off here
      if (!may_unpack(length)) break;
      // The checksum of the data section covers all before the record that holds it, that of the summary all up to
      // itself in the footer.
      const std::uint32_t crc_before = crc_;
      crc_ = crc32_of(head, crc_);
      if (length > largest_record_bytes) {
        if (opcode == Opcode::chunk) {
          ++summary_.damaged_chunks;
        } else {
          summary_.damaged_elsewhere = true;
        }
        if (!skip(length)) break;
        continue;
      }
      if (!read(length, buffer_)) break;
      constexpr std::size_t before_crc_of_footer = 16;
      crc_ = crc32_of(
          std::string_view(buffer_).substr(0, opcode == Opcode::footer ? before_crc_of_footer : buffer_.size()), crc_);
      take(opcode, buffer_, crc_before);
    }
    return error_;
  }

  /// A file none of whose chunks can be read is no empty log.
  Check check_content() const {
    if (summary_.messages > 0 || summary_.damaged_chunks == 0) return std::nullopt;
    return Error{.code = ErrorCode::syntax,
                 .parameter = {},
                 .message = "not one of its " + std::to_string(summary_.damaged_chunks) + " chunks can be read, for " +
                            (unknown_compression_.empty()
                                 ? "their bytes or their checksums are wrong: copy the log again"
                                 : "they are compressed as '" + unknown_compression_ +
                                       "', and only zstd, lz4 and no compression are read: compress the log again"),
                 .place = {}};
  }

  LogSummary summary() && { return std::move(summary_); }

 private:
  bool read(std::uint64_t count, std::string& into) {
    if (count > left_) return false;
    into.resize(static_cast<std::size_t>(count));
    left_ -= count;
    if (std::fread(into.data(), 1, into.size(), file_) == into.size()) return true;
    // What ends early is a cut off log; what cannot be read is none that could be told about.
    if (std::feof(file_) == 0) {
      error_ = Error{.code = ErrorCode::failed,
                     .parameter = {},
                     .message = "the log could not be read to its end (" + std::generic_category().message(errno) +
                                "): check the disk, or copy the file from it",
                     .place = {}};
    }
    return false;
  }

  bool skip(std::uint64_t count) {
    constexpr std::uint64_t piece = 65536;
    for (; count > 0; count -= std::min(count, piece)) {
      if (!read(std::min(count, piece), buffer_)) return false;
      crc_ = crc32_of(buffer_, crc_);
    }
    return true;
  }

  void take(Opcode opcode, std::string_view content, std::uint32_t crc_before) {
    switch (opcode) {
      case Opcode::schema:
      case Opcode::channel:
      case Opcode::message:
        if (!in_summary_) take_small(opcode, content);
        break;
      case Opcode::chunk:
        take_chunk(content);
        break;
      case Opcode::metadata: {
        Cursor cursor(content);
        const std::string name(cursor.take_text());
        const auto map = cursor.take_map();
        if (cursor.ok() && may_remember(content.size())) {
          summary_.metadata[name] = map;
        } else {
          summary_.damaged_elsewhere = true;
        }
        break;
      }
      case Opcode::data_end: {
        const auto stated = Cursor(content).take<std::uint32_t>();
        if (stated != 0 && stated != crc_before) summary_.damaged_elsewhere = true;
        in_summary_ = true;
        crc_ = 0;
        break;
      }
      case Opcode::footer: {
        Cursor cursor(content);
        cursor.take_bytes(16);
        const auto stated = cursor.take<std::uint32_t>();
        if (!cursor.ok() || (stated != 0 && stated != crc_)) summary_.damaged_elsewhere = true;
        summary_.complete = in_summary_ && read(mcap::magic.size(), buffer_) && buffer_ == mcap::magic;
        stop_ = true;
        break;
      }
      default:
        break;  // indexes, which are not needed, and records that later versions may add
    }
  }

  bool may_unpack(std::uint64_t bytes) {
    if (bytes <= work_left_) {
      work_left_ -= bytes;
      return true;
    }
    error_ = Error{.code = ErrorCode::out_of_bounds,
                   .parameter = {},
                   .message = "the log takes more than " + std::to_string(most_unpacked_bytes >> 30U) +
                              " GiB unpacked: cut it, or record in parts with a limit",
                   .place = {}};
    return false;
  }

  /// What a file declares is kept, so there is a limit to how much of it there may be.
  bool may_remember(std::size_t bytes) {
    const bool fits = bytes <= memory_left_;
    if (fits) memory_left_ -= bytes;
    return fits;
  }

  /// A record that may stand in a chunk.
  void take_small(Opcode opcode, std::string_view content) {
    Cursor cursor(content);
    const auto id = cursor.take<std::uint16_t>();
    if (opcode != Opcode::message && !may_remember(content.size())) {
      summary_.damaged_elsewhere = true;
      return;
    }
    if (opcode == Opcode::schema) {
      Schema schema;
      schema.name = cursor.take_text();
      schema.encoding = cursor.take_text();
      schema.definition = cursor.take_text();
      if (cursor.ok()) schemas_[id] = std::move(schema);
    } else if (opcode == Opcode::channel) {
      const Schema& schema = schemas_[cursor.take<std::uint16_t>()];
      if (!may_remember(schema.definition.size())) return;
      LogChannel channel;
      channel.topic = cursor.take_text();
      channel.encoding = cursor.take_text();
      channel.metadata = cursor.take_map();
      channel.type_name = schema.name;
      channel.schema_encoding = schema.encoding;
      channel.definition = schema.definition;
      if (cursor.ok()) channels_.emplace(id, std::move(channel));
    } else {
      LogMessage message;
      message.channel = id;
      message.sequence = cursor.take<std::uint32_t>();
      message.time_ns = cursor.take<std::uint64_t>();
      cursor.take<std::uint64_t>();
      const auto channel = channels_.find(id);
      if (cursor.ok() && channel != channels_.end()) {
        const std::string_view bytes = cursor.rest();
        message.bytes = {reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()};  // NOLINT: bytes
        ++summary_.messages;
        error_ = visit_(channel->second, message);
        return;
      }
    }
    if (!cursor.ok() || opcode == Opcode::message) summary_.damaged_elsewhere = true;
  }

  void take_chunk(std::string_view content) {
    Cursor cursor(content);
    cursor.take_bytes(16);  // times
    const auto size = cursor.take<std::uint64_t>();
    const auto stated_crc = cursor.take<std::uint32_t>();
    const std::string_view compression = cursor.take_text();
    std::string_view records = cursor.take_bytes(cursor.take<std::uint64_t>());
    bool sound = cursor.ok() && size <= largest_record_bytes;
    if (sound && compression == "zstd") {
      // The frame must not promise more than the chunk does, so that nothing large is asked for in vain.
      sound = ZSTD_getFrameContentSize(records.data(), records.size()) == size;
      if (sound) {
        if (!may_unpack(size)) return;
        chunk_.resize(static_cast<std::size_t>(size));
        const std::size_t got = ZSTD_decompress(chunk_.data(), chunk_.size(), records.data(), records.size());
        if (ZSTD_getErrorCode(got) == ZSTD_error_memory_allocation) throw std::bad_alloc();
        sound = got == size;
        records = chunk_;
      }
    } else if (sound && compression == "lz4") {
      if (!may_unpack(size)) return;
      chunk_.resize(static_cast<std::size_t>(size));
      sound = unpack_lz4(records, chunk_);
      records = chunk_;
    } else {
      sound = sound && compression.empty() && records.size() == size;
    }
    if (cursor.ok() && compression != "zstd" && compression != "lz4" && !compression.empty()) {
      unknown_compression_ = compression.substr(0, 32);
    }
    if (!sound || (stated_crc != 0 && crc32_of(records) != stated_crc)) {
      ++summary_.damaged_chunks;
      return;
    }
    Cursor chunk(records);
    while (!chunk.rest().empty() && !error_) {
      const auto opcode = static_cast<Opcode>(chunk.take<unsigned char>());
      const std::string_view record = chunk.take_bytes(chunk.take<std::uint64_t>());
      if (!chunk.ok()) {
        summary_.damaged_elsewhere = true;
        return;
      }
      if (opcode == Opcode::schema || opcode == Opcode::channel || opcode == Opcode::message) {
        take_small(opcode, record);
      }
    }
  }

  struct Schema {
    std::string name, encoding, definition;
  };

  std::FILE* file_;
  std::uint64_t left_;  ///< bytes of the file that were not read yet
  const std::function<Check(const LogChannel&, const LogMessage&)>& visit_;
  std::uint32_t crc_ = 0;
  bool in_summary_ = false;
  bool stop_ = false;
  std::uint64_t memory_left_ = most_declared_bytes;
  std::uint64_t work_left_ = most_unpacked_bytes;
  std::string buffer_;
  std::string chunk_;
  std::string unknown_compression_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, LogChannel> channels_;
  LogSummary summary_;
  Check error_;
};

}  // namespace

Result<LogSummary> scan_log(const std::filesystem::path& file,
                            const std::function<Check(const LogChannel&, const LogMessage&)>& visit) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(file, failed)) {
    return unreadable(ErrorCode::missing, file, "there is no such file: name a log or the folder of one");
  }
  const std::uint64_t size = std::filesystem::file_size(file, failed);
  const std::unique_ptr<std::FILE, Closer> stream(std::fopen(file.c_str(), "rbe"));
  if (failed || !stream) {
    return unreadable(ErrorCode::missing, file, "the file cannot be read: look at its permissions");
  }
  Scan scan(stream.get(), size, visit);
  auto error = scan.begin();
  if (!error) error = scan.run();
  if (!error) error = scan.check_content();
  if (error) {
    if (error->place.empty()) error->place = file.string();
    return *std::move(error);
  }
  return std::move(scan).summary();
}

}  // namespace tactus::telemetry
