// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/log_part.hpp>
#include <tactus/data/telemetry/mcap_format.hpp>

#include <cerrno>
#include <numeric>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

namespace tactus::telemetry {

namespace {

using mcap::append;
using mcap::append_record;
using mcap::append_text;
using mcap::crc32_of;
using mcap::Opcode;

constexpr std::size_t most_in_memory = std::size_t{256} * 1024;

std::string reason_of(int error_number) { return std::generic_category().message(error_number); }

/// Whether all bytes were written at that place; else errno tells why not, or is 0.
bool write_at(int descriptor, std::string_view bytes, std::uint64_t offset) {
  while (!bytes.empty()) {
    errno = 0;
    const ssize_t written = ::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
    offset += static_cast<std::uint64_t>(written);
  }
  return true;
}

}  // namespace

EndIndex::~EndIndex() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void EndIndex::append(std::string_view bytes) {
  if (given_up_) return;
  recent_ += bytes;
  if (recent_.size() >= most_in_memory) spill();
}

void EndIndex::spill() {
  if (descriptor_ < 0) {
    std::filesystem::path name = beside_;
    name += ".index";
    descriptor_ = ::open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
    if (descriptor_ >= 0) ::unlink(name.c_str());
  }
  given_up_ = descriptor_ < 0 || !write_at(descriptor_, recent_, in_file_);
  in_file_ += recent_.size();
  recent_.clear();
}

Check EndIndex::for_each_piece(const std::function<Check(std::string_view)>& take) {
  if (given_up_) return std::nullopt;
  std::string piece;
  for (std::uint64_t at = 0; at < in_file_; at += piece.size()) {
    piece.resize(static_cast<std::size_t>(std::min<std::uint64_t>(most_in_memory, in_file_ - at)));
    const ssize_t got = ::pread(descriptor_, piece.data(), piece.size(), static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) {
      piece.clear();
      continue;
    }
    if (got <= 0) {
      return Error{.code = ErrorCode::unwritable,
                   .parameter = {},
                   .message = "the index of the log could not be read back: look at the disk",
                   .place = beside_.string()};
    }
    piece.resize(static_cast<std::size_t>(got));
    if (auto error = take(piece)) return error;
  }
  return take(recent_);
}

Result<std::unique_ptr<LogPart>> LogPart::create(const std::filesystem::path& file) {
  const int descriptor = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (descriptor < 0) {
    const std::string remedy = errno == ELOOP ? "it is a symbolic link, which is never followed: remove it"
                                              : "name a place where files can be written";
    return Error{.code = ErrorCode::unwritable,
                 .parameter = {},
                 .message = "the log could not be made (" + reason_of(errno) + "): " + remedy,
                 .place = file.string()};
  }
  return std::unique_ptr<LogPart>(new LogPart(file, descriptor));
}

LogPart::~LogPart() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

Check LogPart::put(std::string_view bytes) {
  if (!write_at(descriptor_, bytes, offset_)) {
    const std::string reason = errno != 0 ? reason_of(errno) : "nothing was written";
    // A device cannot be cut; then there is nothing to keep readable either.
    const bool cut = ::ftruncate(descriptor_, static_cast<off_t>(offset_)) == 0;
    return Error{.code = ErrorCode::unwritable,
                 .parameter = {},
                 .message = "the log could not be written (" + reason + "): give it a place with room" +
                            (cut || offset_ == 0 ? "" : "; it ends within a record"),
                 .place = path_.string()};
  }
  crc_ = crc32_of(bytes, crc_);
  offset_ += bytes.size();
  return std::nullopt;
}

Check LogPart::put_metadata(std::string_view name, std::string_view record) {
  std::string index;
  append(index, offset_);
  append(index, std::uint64_t{record.size()});
  append_text(index, name);
  if (auto error = put(record)) return error;
  append_record(metadata_indexes_, Opcode::metadata_index, index);
  ++metadata_records_;
  return std::nullopt;
}

Check LogPart::put_chunk(std::string_view bytes, std::string_view index, const TimeSpan& span,
                         const std::vector<std::uint64_t>& messages) {
  if (auto error = put(bytes)) return error;
  chunk_indexes_.append(index);
  ++chunks_;
  span_.add(span.first_ns);
  span_.add(span.last_ns);
  for (std::size_t channel = 0; channel < messages.size(); ++channel) written_[channel] += messages[channel];
  return std::nullopt;
}

std::string LogPart::statistics(std::size_t schemas) const {
  std::string content;
  append(content, std::accumulate(written_.begin(), written_.end(), std::uint64_t{0}));
  append(content, static_cast<std::uint16_t>(schemas));
  append(content, static_cast<std::uint32_t>(written_.size()));
  append(content, std::uint32_t{0});  // attachments
  append(content, metadata_records_);
  append(content, chunks_);
  append(content, span_.first_or_zero());
  append(content, span_.last_ns);
  std::string written;
  for (std::size_t channel = 0; channel < written_.size(); ++channel) {
    append(written, static_cast<std::uint16_t>(channel));
    append(written, written_[channel]);
  }
  append_text(content, written);
  return content;
}

std::uint64_t LogPart::size_with(std::size_t bytes, std::size_t index, std::size_t declarations) const {
  constexpr std::uint64_t data_end = mcap::record_head_bytes + 4, footer = mcap::record_head_bytes + 20;
  return offset_ + bytes + data_end + declarations + mcap::record_head_bytes + statistics(0).size() +
         chunk_indexes_.size() + index + metadata_indexes_.size() + footer + mcap::magic.size();
}

Check LogPart::put_end(std::string_view declarations, std::size_t schemas) {
  std::string record;
  std::string crc_of_data;
  append(crc_of_data, crc_);
  append_record(record, Opcode::data_end, crc_of_data);
  if (auto error = put(record)) return error;
  const std::uint64_t summary_at = offset_;
  crc_ = 0;
  record = declarations;
  append_record(record, Opcode::statistics, statistics(schemas));
  if (auto error = put(record)) return error;
  if (auto error = chunk_indexes_.for_each_piece([this](std::string_view piece) { return put(piece); })) return error;
  record = metadata_indexes_;
  // The footer's CRC covers the summary and the footer up to the CRC itself.
  record += static_cast<char>(Opcode::footer);
  append(record, std::uint64_t{20});
  append(record, summary_at);
  append(record, std::uint64_t{0});  // no section of summary offsets
  append(record, crc32_of(record, crc_));
  record += mcap::magic;
  return put(record);
}

Check LogPart::end(std::string_view declarations, std::size_t schemas) {
  const std::uint64_t end_of_data = offset_;
  Check error = put_end(declarations, schemas);
  if (error) (void)::ftruncate(descriptor_, static_cast<off_t>(end_of_data));
  if (::close(std::exchange(descriptor_, -1)) != 0 && !error) {
    error = Error{.code = ErrorCode::unwritable,
                  .parameter = {},
                  .message = "the log could not be closed (" + reason_of(errno) + "): look whether its disk is full",
                  .place = path_.string()};
  }
  return error;
}

}  // namespace tactus::telemetry
