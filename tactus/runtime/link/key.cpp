// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/key.hpp>

#include <cerrno>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <string.h>  // NOLINT: explicit_bzero is not in <cstring>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tactus::link {

namespace {

constexpr std::string_view digits = "0123456789abcdef";
constexpr std::size_t text_bytes = 2 * Key::bytes + 1;
using Text = std::array<char, text_bytes>;

Error fault(ErrorCode code, const std::filesystem::path& file, std::string message) {
  return Error{.code = code, .parameter = {}, .message = std::move(message), .place = file.string()};
}

std::string system_error() { return std::system_category().message(errno); }

struct Descriptor {
  int number;
  ~Descriptor() {
    if (number >= 0) close(number);
  }
};

/// Whether nobody drew it: of 32 random bytes fewer than 17 differ once in 10^20 keys, and never do all differ from
/// their neighbours by the same. So are zeros, repeated words and bytes that count.
bool is_made_up(const Key& key) {
  std::array<bool, 256> seen{};
  std::size_t different = 0;
  for (const unsigned char byte : key.secret) different += std::exchange(seen[byte], true) ? 0U : 1U;
  constexpr std::size_t least_different = 17;
  bool counts = true;
  const auto step = static_cast<unsigned char>(key.secret[1] - key.secret[0]);
  for (std::size_t i = 1; i < Key::bytes; ++i) {
    counts = counts && static_cast<unsigned char>(key.secret[i] - key.secret[i - 1]) == step;
  }
  return different < least_different || counts;
}

}  // namespace

Key::~Key() { explicit_bzero(secret.data(), secret.size()); }

Check make_key_file(const std::filesystem::path& file) {
  Key key;
  if (getrandom(key.secret.data(), Key::bytes, 0) != static_cast<ssize_t>(Key::bytes)) {
    return fault(ErrorCode::failed, file, "the operating system gave no random numbers (" + system_error() + ")");
  }
  const Descriptor opened{open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600)};
  if (opened.number < 0) {
    return fault(ErrorCode::unwritable, file,
                 errno == EEXIST ? "there is a file already, and a key is never overwritten: name a new file"
                                 : "the key could not be written (" + system_error() + "): name a place with room");
  }
  Text text;
  for (std::size_t i = 0; i < Key::bytes; ++i) {
    text[2 * i] = digits[key.secret[i] >> 4];
    text[2 * i + 1] = digits[key.secret[i] & 15];
  }
  text.back() = '\n';
  // The mode is set once more because the umask may have taken the owner's rights away.
  const bool written = fchmod(opened.number, 0600) == 0 &&
                       write(opened.number, text.data(), text.size()) == static_cast<ssize_t>(text.size()) &&
                       fsync(opened.number) == 0;
  const std::string why = written ? "" : system_error();
  explicit_bzero(text.data(), text.size());
  if (written) return std::nullopt;
  unlink(file.c_str());
  return fault(ErrorCode::unwritable, file, "the key could not be written (" + why + "): name a place with room");
}

Result<Key> read_key_file(const std::filesystem::path& file) {
  const Descriptor opened{open(file.c_str(), O_RDONLY | O_NOFOLLOW | O_CLOEXEC | O_NONBLOCK)};
  if (opened.number < 0) {
    const bool link = errno == ELOOP;
    return fault(link ? ErrorCode::inconsistent : ErrorCode::missing, file,
                 link ? "a key file may not be a symbolic link: name the file itself"
                      : "the key could not be read (" + system_error() + "): make one with `tactus key FILE`");
  }
  struct stat status {};
  if (fstat(opened.number, &status) != 0 || !S_ISREG(status.st_mode)) {
    return fault(ErrorCode::inconsistent, file, "a key must be a regular file: make one with `tactus key FILE`");
  }
  if (status.st_uid != geteuid()) {
    return fault(ErrorCode::inconsistent, file,
                 "the key belongs to another user: it must be owned by the user who runs tactus");
  }
  if ((status.st_mode & 07177) != 0) {
    return fault(ErrorCode::inconsistent, file,
                 "the key may be touched by others than its owner: run `chmod 600 " + file.string() + "`");
  }
  std::array<char, text_bytes + 1> text{};
  const ssize_t size = read(opened.number, text.data(), text.size());
  Key key;
  bool good = size == static_cast<ssize_t>(text_bytes) && text[text_bytes - 1] == '\n';
  for (std::size_t i = 0; good && i < Key::bytes; ++i) {
    const std::size_t high = digits.find(text[2 * i]), low = digits.find(text[2 * i + 1]);
    good = high != std::string_view::npos && low != std::string_view::npos;
    if (good) key.secret[i] = static_cast<unsigned char>(16 * high + low);
  }
  explicit_bzero(text.data(), text.size());
  if (good && is_made_up(key)) {
    return fault(ErrorCode::inconsistent, file,
                 "this key was not drawn at random, so others can guess it: make one with `tactus key FILE`");
  }
  if (good) return key;
  return fault(ErrorCode::syntax, file,
               "this is no key, which is 64 hexadecimal digits and a line feed: make one with `tactus key FILE`");
}

}  // namespace tactus::link
