// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/files.hpp>

#include <cerrno>
#include <cstdio>
#include <exception>
#include <string>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tactus::report {
namespace {

namespace fs = std::filesystem;

Error unwritable(const fs::path& path, const std::string& action, const std::string& reason, std::error_code code) {
  std::string remedy = "choose another place or correct this one";
  if (code == std::errc::permission_denied || code == std::errc::operation_not_permitted) {
    remedy = "choose a folder that you may write to, or change its permissions";
  } else if (code == std::errc::no_space_on_device) {
    remedy = "free some space on the disk or choose another one";
  } else if (code == std::errc::read_only_file_system) {
    remedy = "choose a folder on a file system that is not mounted read-only";
  } else if (code == std::errc::no_such_file_or_directory) {
    remedy = "create the folder first or choose one that exists";
  } else if (code == std::errc::not_a_directory || code == std::errc::file_exists) {
    remedy = "a part of the path is a file: choose another folder or move that file away";
  } else if (code == std::errc::too_many_symbolic_link_levels) {
    remedy = "remove the link or choose another place";
  } else if (code == std::errc::is_a_directory) {
    remedy = "choose the name of a file";
  }
  return {.code = ErrorCode::unwritable,
          .parameter = {},
          .message = "cannot " + action + " '" + path.string() + "': " + reason + "; " + remedy,
          .place = {}};
}

Error unwritable(const fs::path& path, const std::string& action, std::error_code code) {
  return unwritable(path, action, code.message(), code);
}

/// The reason that the C library left, or a plain input/output error where it left none.
std::error_code last_error() { return {errno != 0 ? errno : EIO, std::generic_category()}; }

/// A file that is deleted again unless it is renamed to its final name.
class TemporaryFile {
 public:
  /// Opens a file that did not exist, beside `target`. `stream()` is null, with errno set, when that fails.
  explicit TemporaryFile(const fs::path& target) {
    constexpr int attempts = 1000;  // names left behind by killed processes are stepped over
    for (int i = 0; i < attempts && stream_ == nullptr; ++i) {
      std::string name(".");
      name.append(target.filename().string()).append(".").append(std::to_string(i)).append(".partial");
      path_ = target.parent_path() / name;
      errno = 0;
      stream_ = std::fopen(path_.c_str(), "wbx");
      if (stream_ == nullptr && errno != EEXIST) return;
    }
    pending_ = stream_ != nullptr;
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (stream_ != nullptr) std::fclose(stream_);
    if (pending_) std::remove(path_.c_str());
  }

  [[nodiscard]] bool open() const { return stream_ != nullptr; }
  [[nodiscard]] std::string name() const { return path_.string(); }

  /// True when every byte has been handed to the system. Otherwise errno tells why not.
  bool write(std::string_view content, bool durable = false) {
    errno = 0;
    const bool written = std::fwrite(content.data(), 1, content.size(), stream_) == content.size() &&
                         (!durable || (std::fflush(stream_) == 0 && fsync(fileno(stream_)) == 0));
    const int write_error = errno;
    const bool closed = std::fclose(std::exchange(stream_, nullptr)) == 0;
    if (!written) errno = write_error;
    return written && closed;
  }

  /// True when it has the mode and the owner of `other`. Otherwise errno tells why not.
  bool become_like(const fs::path& other) {
    struct stat status {};
    const int descriptor = fileno(stream_);
    constexpr mode_t all_bits = 07777;
    return stat(other.c_str(), &status) == 0 && fchown(descriptor, status.st_uid, status.st_gid) == 0 &&
           fchmod(descriptor, status.st_mode & all_bits) == 0;
  }

  std::error_code rename_to(const fs::path& target) {
    std::error_code code;
    fs::rename(path_, target, code);
    pending_ = static_cast<bool>(code);
    return code;
  }

 private:
  fs::path path_;
  std::FILE* stream_ = nullptr;
  bool pending_ = false;
};

/// `fill` writes the content and leaves errno where it could not.
template <class Fill>
Check replace_unguarded(const fs::path& path, Fill&& fill) {
  std::error_code code;
  const fs::file_status status = fs::symlink_status(path, code);
  if (fs::is_symlink(status)) {
    return unwritable(path, "write", "it is a symbolic link, which is never followed",
                      std::make_error_code(std::errc::too_many_symbolic_link_levels));
  }
  if (fs::is_directory(status)) {
    return unwritable(path, "write", std::make_error_code(std::errc::is_a_directory));
  }
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    return unwritable(path, "write", "it is not a regular file", std::make_error_code(std::errc::invalid_argument));
  }
  TemporaryFile file(path);
  if (!file.open()) return unwritable(path, "write", last_error());
  if (!fill(file)) return unwritable(path, "write", last_error());
  if (const std::error_code renamed = file.rename_to(path)) return unwritable(path, "write", renamed);
  return std::nullopt;
}

Check prepare_unguarded(const fs::path& path) {
  std::error_code code;
  fs::create_directories(path, code);
  if (code) return unwritable(path, "create the folder", code);
  if (!fs::is_directory(path, code)) {
    return unwritable(path, "use the folder", std::make_error_code(std::errc::not_a_directory));
  }
  TemporaryFile probe(path / "probe");
  if (!probe.open()) return unwritable(path, "write to the folder", last_error());
  if (!probe.write("probe")) return unwritable(path, "write to the folder", last_error());
  return std::nullopt;
}

/// The file system library throws when memory runs out or a path cannot be converted, even from its quiet overloads.
template <class Job>
Check guarded(const fs::path& path, Job&& job) {
  try {
    return job();
  } catch (const std::exception& error) {
    return unwritable(path, "write", error.what(), {});
  }
}

}  // namespace

Check write_file(const fs::path& path, std::string_view content) {
  return guarded(
      path, [&] { return replace_unguarded(path, [content](TemporaryFile& file) { return file.write(content); }); });
}

Check rewrite_file(const fs::path& path, std::string_view content) {
  return guarded(path, [&]() -> Check {
    const auto fill = [&](TemporaryFile& file) { return file.become_like(path) && file.write(content, true); };
    if (Check error = replace_unguarded(path, fill)) return error;
    // The new name is on the disk too, where the file system can say so.
    const std::string folder = path.has_parent_path() ? path.parent_path().string() : ".";
    if (const int opened = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); opened >= 0) {
      static_cast<void>(fsync(opened));
      close(opened);
    }
    return std::nullopt;
  });
}

Check replace_file(const fs::path& path, const std::function<bool(const std::string& temporary)>& write) {
  return guarded(path, [&] {
    return replace_unguarded(path, [&write](TemporaryFile& file) { return file.write("") && write(file.name()); });
  });
}

Check prepare_directory(const fs::path& path) {
  return guarded(path, [&] { return prepare_unguarded(path); });
}

}  // namespace tactus::report
