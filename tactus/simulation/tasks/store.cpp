// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/tasks/build.hpp>
#include <tactus/simulation/tasks/bytes.hpp>
#include <tactus/simulation/tasks/store.hpp>

#include <algorithm>
#include <cerrno>
#include <functional>
#include <limits>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>
#include <zlib.h>

namespace tactus::tasks {

namespace {

constexpr std::string_view family = "tactus tasks ";
constexpr std::string_view magic = "tactus tasks 1\n";
constexpr std::size_t lengths_size = 2 * sizeof(std::uint32_t);
constexpr std::size_t checksum_size = sizeof(std::uint32_t);

std::uint32_t checksum_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
}

std::string record_of(std::string_view key, std::string_view value) {
  std::string bytes =
      ByteWriter().put(static_cast<std::uint32_t>(key.size())).put(static_cast<std::uint32_t>(value.size())).take();
  bytes += key;
  bytes += value;
  return bytes + ByteWriter().put(checksum_of(bytes)).take();
}

Error refused(const std::filesystem::path& path, ErrorCode code, std::string message) {
  return {.code = code, .parameter = {}, .message = std::move(message), .place = path.string()};
}

std::string reason() { return std::error_code(errno, std::generic_category()).message(); }

Error unreadable(const std::filesystem::path& path) {
  return refused(path, ErrorCode::missing,
                 "the finished tasks could not be read (" + reason() +
                     "): check the permissions and the disk, or remove this file and lose them");
}

Error unwritable(const std::filesystem::path& path) {
  return refused(path, ErrorCode::unwritable,
                 "the finished tasks could not be written (" + reason() + "): give --out a place with room");
}

bool write_whole(int file, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

/// Fills `bytes` from this place of the file, or cuts it where the file ends. False: the file cannot be read.
bool read_at(int file, std::uint64_t at, std::string& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::pread(file, bytes.data() + done, bytes.size() - done, static_cast<off_t>(at + done));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  bytes.resize(done);
  return true;
}

}  // namespace

Result<TaskStore> TaskStore::open(const std::filesystem::path& file, std::string_view description) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);  // NOLINT: variadic in C
  if (descriptor < 0) return unwritable(file);
  TaskStore store(file, descriptor);
  // A file system without locks is no reason not to work.
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return refused(file, ErrorCode::inconsistent,
                   "another process is working on this job: wait for its end, or name another folder with --out");
  }
  if (auto error = store.read_records(description)) return *std::move(error);
  return store;
}

TaskStore::TaskStore(TaskStore&& other) noexcept
    : path_(std::move(other.path_)),
      file_(std::exchange(other.file_, -1)),
      end_(other.end_),
      size_(other.size_),
      records_(std::move(other.records_)) {}

TaskStore::~TaskStore() {
  if (file_ >= 0) ::close(file_);
}

Check TaskStore::read_records(std::string_view description) {
  const off_t length = ::lseek(file_, 0, SEEK_END);
  if (length < 0) return unreadable(path_);
  const std::string build = version_and_build();
  const std::string head = std::string(magic) + record_of(build, description);
  std::string start(magic.size(), '\0');
  if (!read_at(file_, 0, start)) return unreadable(path_);
  if (start != magic.substr(0, start.size())) {
    if (start.starts_with(family)) {
      return refused(path_, ErrorCode::inconsistent,
                     "has finished tasks in the format of another version of tactus: finish the job with that version, "
                     "name another folder with --out, or remove this file");
    }
    return refused(path_, ErrorCode::inconsistent,
                   "is not a file of finished tasks: name another folder with --out, or remove this file");
  }
  end_ = magic.size();
  std::string lengths, content;
  bool described = false;
  for (;;) {
    lengths.resize(lengths_size);
    if (!read_at(file_, end_, lengths)) return unreadable(path_);
    if (lengths.size() < lengths_size) break;
    ByteReader reader(lengths);
    Record record{.at = end_ + lengths_size};
    reader.get(record.key_length);
    reader.get(record.value_length);
    const std::uint64_t size = std::uint64_t{record.key_length} + record.value_length;
    if (record.at + size + checksum_size > static_cast<std::uint64_t>(length)) break;
    content.resize(static_cast<std::size_t>(size) + checksum_size);
    if (!read_at(file_, record.at, content)) return unreadable(path_);
    const std::string_view body = std::string_view(content).substr(0, static_cast<std::size_t>(size));
    if (ByteReader(std::string_view(content).substr(body.size())).get<std::uint32_t>() !=
        checksum_of(lengths + std::string(body))) {
      break;
    }
    const std::string_view key = body.substr(0, record.key_length);
    if (described) {
      add(key, record);
    } else if (key != build) {
      return refused(path_, ErrorCode::inconsistent,
                     "has finished tasks of tactus " + std::string(key) + ", and this is " + build +
                         ": finish the job with that one, name another folder with --out, or remove this file");
    } else if (body.substr(key.size()) != description) {
      return refused(path_, ErrorCode::inconsistent,
                     "has finished tasks of another job (other parameters, axes or precision): name another folder "
                     "with --out, or remove this file");
    }
    described = true;
    end_ = record.at + size + checksum_size;
  }
  if (!described) end_ = 0;
  if (::ftruncate(file_, static_cast<off_t>(end_)) != 0) return unwritable(path_);
  if (described) return {};
  if (!write_whole(file_, head)) return unwritable(path_);
  end_ = head.size();
  return {};
}

void TaskStore::add(std::string_view key, const Record& record) {
  records_.emplace(std::hash<std::string_view>{}(key), record);
  ++size_;
}

Result<std::optional<std::string>> TaskStore::find(std::string_view key) const {
  const auto [first, last] = records_.equal_range(std::hash<std::string_view>{}(key));
  for (auto place = first; place != last; ++place) {
    const Record& record = place->second;
    if (record.key_length != key.size()) continue;
    std::string body(std::size_t{record.key_length} + record.value_length, '\0');
    if (!read_at(file_, record.at, body)) return unreadable(path_);
    if (body.starts_with(key)) return std::optional(body.substr(key.size()));
  }
  return std::optional<std::string>();
}

Check TaskStore::append(std::string_view key, std::string_view value) {
  const std::string bytes = record_of(key, value);
  if (!write_whole(file_, bytes)) return unwritable(path_);
  add(key, {.at = end_ + lengths_size,
            .key_length = static_cast<std::uint32_t>(key.size()),
            .value_length = static_cast<std::uint32_t>(value.size())});
  end_ += bytes.size();
  return {};
}

}  // namespace tactus::tasks
