// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/real_time/plant_segment.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tactus::real_time {

namespace {

/// `tactus` and the version of the layout, which its size belongs to.
constexpr std::uint64_t magic_word = 0x746163747573'0003;
/// The bytes of the file that stand for its two places.
constexpr off_t owner_place = 0, controller_place = 1;
constexpr std::uint64_t tap_bits = 16;

/// Closes its file, whatever happens.
struct File {
  int descriptor = -1;
  explicit File(int opened) : descriptor(opened) {}
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File() {
    if (descriptor >= 0) close(descriptor);
  }
  int release() { return std::exchange(descriptor, -1); }
};

Error segment_error(ErrorCode code, const char* option, std::string message) {
  return {.code = code, .parameter = {}, .message = std::move(message), .place = option};
}

Error system_error(const char* option, const std::string& name, const char* what) {
  return segment_error(ErrorCode::failed, option,
                       "plant '" + name + "': " + what + " failed (" + std::system_category().message(errno) +
                           "): look at /dev/shm, its free space and who may write there");
}

constexpr std::size_t longest = 64;

/// What the system calls a plant. On the stack: a lack of memory must not leave the file behind.
class FileName {
 public:
  /// Of a name that was checked.
  explicit FileName(const std::string& name) noexcept {
    name.copy(std::copy(prefix.begin(), prefix.end(), text_.begin()), longest);
  }
  [[nodiscard]] const char* c_str() const noexcept { return text_.data(); }

 private:
  static constexpr std::string_view prefix = "/tactus-plant-";
  std::array<char, prefix.size() + longest + 1> text_{};
};

Check check_name(const std::string& name, const char* option) {
  const bool plain = std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  });
  if (plain && !name.empty() && name.size() <= longest) return std::nullopt;
  return segment_error(ErrorCode::syntax, option,
                       "'" + name + "' is no name of a plant: write 1 to 64 letters, digits, - or _, as in bench-1");
}

struct flock lock_of(off_t place) {
  struct flock lock {};
  lock.l_type = F_WRLCK;
  lock.l_whence = SEEK_SET;
  lock.l_start = place;
  lock.l_len = 1;
  return lock;
}

bool take(int file, off_t place) {
  struct flock lock = lock_of(place);
  return fcntl(file, F_OFD_SETLK, &lock) == 0;
}

/// Whether somebody else has it.
bool is_taken(int file, off_t place) {
  struct flock lock = lock_of(place);
  return fcntl(file, F_OFD_GETLK, &lock) == 0 && lock.l_type != F_UNLCK;
}

/// Whether the name still leads to this file.
bool is_named(int file, const std::string& name) {
  const File again(shm_open(FileName(name).c_str(), O_RDWR | O_CLOEXEC, 0));
  struct stat own {
  }, there{};
  return again.descriptor >= 0 && fstat(file, &own) == 0 && fstat(again.descriptor, &there) == 0 &&
         own.st_ino == there.st_ino;
}

/// That nobody but this user can have made the file, or can change it: before anything of it is believed.
Check check_private(int file, const std::string& name, const char* option) {
  struct stat status {};
  if (fstat(file, &status) != 0) return system_error(option, name, "fstat");
  if (status.st_uid != geteuid()) {
    return segment_error(ErrorCode::inconsistent, option,
                         "the plant '" + name + "' belongs to user " + std::to_string(status.st_uid) +
                             ", and this process runs as user " + std::to_string(geteuid()) +
                             ": run both as the same user, or give it another name");
  }
  if (!S_ISREG(status.st_mode) || (status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    return segment_error(ErrorCode::inconsistent, option,
                         "the plant '" + name + "' is open to other users, as no plant of tactus is: remove /dev/shm" +
                             FileName(name).c_str() + " and start it again");
  }
  return std::nullopt;
}

Error open_error(const char* option, const std::string& name) {
  if (errno != EACCES) return system_error(option, name, "shm_open");
  return segment_error(ErrorCode::inconsistent, option,
                       "the plant '" + name + "' belongs to another user, and this process runs as user " +
                           std::to_string(geteuid()) + ": run both as the same user, or give it another name");
}

/// None where the file is no segment of this version.
std::optional<runtime::SharedMapping> map(int file) {
  struct stat status {};
  if (fstat(file, &status) != 0 || status.st_size != static_cast<off_t>(sizeof(PlantLayout))) return std::nullopt;
  return runtime::SharedMapping::map(file, sizeof(PlantLayout));
}

PlantLayout& layout_in(const runtime::SharedMapping& memory) { return *static_cast<PlantLayout*>(memory.data()); }

std::string process_of(const std::atomic<std::uint64_t>& word) {
  return "process " + std::to_string(word.load(std::memory_order_acquire));
}

/// What a segment says of its owner, whatever it may be.
std::string owner_of(int file) {
  const auto memory = map(file);
  return memory ? process_of(layout_in(*memory).owner) : "another version";
}

void tell(PlantLayout& layout, const PlantFacts& facts) {
  layout.owner.store(static_cast<std::uint64_t>(getpid()));
  layout.master_limits = facts.master;
  layout.slave_limits = facts.slave;
  layout.simulated = facts.simulated ? 1 : 0;
  layout.taps = facts.taps;
  layout.configuration_length = facts.configuration.size();
  std::copy(facts.configuration.begin(), facts.configuration.end(), layout.configuration.begin());
  layout.magic.store(magic_word, std::memory_order_release);
}

}  // namespace

Result<PlantSegment> PlantSegment::create(const std::string& name, const PlantFacts& facts) {
  constexpr const char* option = "--name";
  if (auto error = check_name(name, option)) return *std::move(error);
  if (facts.configuration.size() > PlantLayout::configuration_bytes) {
    return segment_error(ErrorCode::inconsistent, option,
                         "the configuration of the plant takes " + std::to_string(facts.configuration.size()) +
                             " bytes, more than " + std::to_string(PlantLayout::configuration_bytes) +
                             ": shorten its texts");
  }
  // Again where another process makes or removes one of that name at the same time.
  constexpr int attempts = 10;
  std::string kept_name = name;
  for (int attempt = 0; attempt < attempts; ++attempt) {
    File file(shm_open(FileName(name).c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600));
    if (file.descriptor < 0) {
      if (errno != EEXIST) return system_error(option, name, "shm_open");
      const File old(shm_open(FileName(name).c_str(), O_RDWR | O_CLOEXEC, 0));
      if (old.descriptor < 0 && errno == ENOENT) continue;
      if (old.descriptor < 0) return open_error(option, name);
      if (auto error = check_private(old.descriptor, name, option)) return *std::move(error);
      if (!take(old.descriptor, owner_place)) {
        return segment_error(ErrorCode::inconsistent, option,
                             "a plant '" + name + "' runs already (" + owner_of(old.descriptor) +
                                 "): stop it, or give this one another name");
      }
      // Its owner is dead. Only who holds this lock takes the name away, so it cannot be another's meanwhile.
      if (is_named(old.descriptor, name)) shm_unlink(FileName(name).c_str());
      continue;
    }
    if (!take(file.descriptor, owner_place) || !is_named(file.descriptor, name)) continue;
    if (const int error = posix_fallocate(file.descriptor, 0, sizeof(PlantLayout)); error != 0) {
      errno = error;
      const Error refused = system_error(option, name, "posix_fallocate");
      shm_unlink(FileName(name).c_str());
      return refused;
    }
    auto memory = map(file.descriptor);
    if (!memory) {
      const Error refused = system_error(option, name, "mmap");
      shm_unlink(FileName(name).c_str());
      return refused;
    }
    tell(layout_in(*memory), facts);
    return PlantSegment(std::move(kept_name), file.release(), *std::move(memory), true);
  }
  return segment_error(ErrorCode::failed, option,
                       "plant '" + name +
                           "': other processes make and remove plants of that name all the time: give "
                           "this one another name");
}

Result<PlantSegment> PlantSegment::attach(const std::string& name) {
  constexpr const char* option = "--plant";
  if (auto error = check_name(name, option)) return *std::move(error);
  File file(shm_open(FileName(name).c_str(), O_RDWR | O_CLOEXEC, 0));
  if (file.descriptor < 0 && errno == ENOENT) {
    return segment_error(
        ErrorCode::missing, option,
        "no plant '" + name + "' runs here: start it with `tactus plant EXPERIMENT --name " + name + "`");
  }
  if (file.descriptor < 0) return open_error(option, name);
  if (auto error = check_private(file.descriptor, name, option)) return *std::move(error);
  if (!is_taken(file.descriptor, owner_place)) {
    return segment_error(ErrorCode::missing, option,
                         "the plant '" + name + "' is dead (" + owner_of(file.descriptor) +
                             "): start it again with `tactus plant EXPERIMENT --name " + name + "`");
  }
  auto memory = map(file.descriptor);
  const bool fits = memory && layout_in(*memory).magic.load(std::memory_order_acquire) == magic_word &&
                    layout_in(*memory).configuration_length <= PlantLayout::configuration_bytes;
  if (!fits) {
    return segment_error(ErrorCode::inconsistent, option,
                         "the plant '" + name +
                             "' is not of this version of tactus, or has not come up yet: run both with the same "
                             "version");
  }
  if (!take(file.descriptor, controller_place)) {
    return segment_error(ErrorCode::inconsistent, option,
                         "the plant '" + name + "' is driven already (" + process_of(layout_in(*memory).controller) +
                             "): wait for its end, or stop it");
  }
  layout_in(*memory).controller.store(static_cast<std::uint64_t>(getpid()));
  return PlantSegment(name, file.release(), *std::move(memory), false);
}

PlantSegment::~PlantSegment() {
  if (file_ < 0) return;
  if (owner_) {
    shm_unlink(FileName(name_).c_str());
  } else {
    layout_->controller.store(0);
  }
  close(file_);
}

PlantFacts PlantSegment::facts() const {
  return {.master = layout_->master_limits,
          .slave = layout_->slave_limits,
          .simulated = layout_->simulated != 0,
          .taps = layout_->taps,
          .configuration = {layout_->configuration.data(),
                            std::min<std::size_t>(layout_->configuration_length, PlantLayout::configuration_bytes)}};
}

std::optional<std::int64_t> PlantSegment::living_owner() const {
  if (!owner_ && !is_taken(file_, owner_place)) return std::nullopt;
  return static_cast<std::int64_t>(layout_->owner.load());
}

std::optional<std::int64_t> PlantSegment::living_controller() const {
  if (owner_ && !is_taken(file_, controller_place)) return std::nullopt;
  return static_cast<std::int64_t>(layout_->controller.load());
}

PlantRequest PlantSegment::request() const noexcept {
  const std::uint64_t word = layout_->request.load(std::memory_order_acquire);
  const std::uint64_t tap = word & ((1U << tap_bits) - 1);
  return {.session = word, .tap = tap == 0 ? std::nullopt : std::optional<std::size_t>(tap - 1)};
}

std::uint64_t PlantSegment::ask(std::optional<std::size_t> tap) noexcept {
  const std::uint64_t number = (layout_->request.load(std::memory_order_relaxed) >> tap_bits) + 1;
  const std::uint64_t word = (number << tap_bits) + (tap ? *tap + 1 : 0);
  layout_->request.store(word, std::memory_order_release);
  return word;
}

}  // namespace tactus::real_time
