// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/map_file.hpp>

#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

namespace tactus::stability {

namespace {

constexpr std::string_view magic = "tactus map 1\n";
constexpr std::size_t numbers_per_point = 5;
constexpr std::size_t most_stored_points = 1'000'000;

std::uint32_t checksum(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32(crc32(0, nullptr, 0), reinterpret_cast<const Bytef*>(bytes.data()), static_cast<uInt>(bytes.size())));
}

template <class T>
void put(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}
template <class T>
T take(std::string_view& bytes) {
  T value{};
  std::memcpy(&value, bytes.data(), sizeof value);
  bytes.remove_prefix(sizeof value);
  return value;
}

std::string header(std::uint64_t identity) {
  std::string bytes(magic);
  put(bytes, identity);
  return bytes;
}

std::filesystem::path path_of(const std::filesystem::path& folder, std::size_t rank) {
  return folder / ("blocks-" + std::to_string(rank) + ".partial");
}

/// What the file holds; nothing where there is none.
Result<std::string> slurp(const std::filesystem::path& path) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  if (!file && errno == ENOENT) return std::string();
  std::ostringstream bytes;
  if (file) bytes << file.rdbuf();
  if (file && !bytes.bad()) return std::move(bytes).str();
  return Error{.code = ErrorCode::missing,
               .parameter = {},
               .message = std::string("the finished blocks could not be read (") +
                          std::error_code(errno, std::generic_category()).message() +
                          "): look at the permissions and the disk, or remove this file and lose them",
               .place = path.string()};
}

Error unwritable(const std::filesystem::path& path) {
  return {.code = ErrorCode::unwritable,
          .parameter = {},
          .message = std::string("the finished blocks could not be written (") +
                     std::error_code(errno, std::generic_category()).message() + "): give --out a place with room",
          .place = path.string()};
}

Error of_another_map(const std::filesystem::path& path) {
  return {.code = ErrorCode::inconsistent,
          .parameter = {},
          .message =
              "holds a part of another map (other parameters, axes or precision): name another folder with "
              "--out, or remove this file",
          .place = path.string()};
}

/// The whole blocks at the start of `bytes`, which begin behind the header; how long they are together.
std::size_t read_blocks(std::string_view bytes, std::vector<MapStore::Block>& blocks) {
  constexpr std::size_t head = 2 * sizeof(std::uint64_t);
  const std::size_t length = bytes.size();
  for (;;) {
    const std::size_t done = length - bytes.size();
    if (bytes.size() < head) return done;
    std::string_view rest = bytes;
    MapStore::Block block;
    block.number = take<std::uint64_t>(rest);
    const auto count = take<std::uint64_t>(rest);
    if (count > most_stored_points) return done;
    const std::size_t body = head + count * numbers_per_point * sizeof(double);
    if (bytes.size() < body + sizeof(std::uint32_t)) return done;
    for (std::uint64_t i = 0; i < count; ++i) {
      PointResult point;
      point.verdict = static_cast<experiments::Verdict>(static_cast<int>(take<double>(rest)));
      point.settling_time_s = take<double>(rest);
      point.contacts = take<double>(rest);
      point.peak_force_N = take<double>(rest);
      point.residual_rms_N = take<double>(rest);
      block.points.push_back(point);
    }
    if (take<std::uint32_t>(rest) != checksum(bytes.substr(0, body))) return done;
    blocks.push_back(std::move(block));
    bytes = rest;
  }
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

}  // namespace

Result<MapStore> MapStore::open(const std::filesystem::path& folder, std::uint64_t identity, std::size_t rank) {
  const auto path = path_of(folder, rank);
  const std::string wanted = header(identity);
  const auto bytes = slurp(path);
  if (!bytes) return bytes.error();
  std::size_t keep = 0;
  if (bytes->size() >= wanted.size()) {
    if (!bytes->starts_with(wanted)) return of_another_map(path);
    std::vector<Block> ignored;
    keep = wanted.size() + read_blocks(std::string_view(*bytes).substr(wanted.size()), ignored);
  }
  const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);  // NOLINT: variadic in C
  if (file < 0) return unwritable(path);
  if (::ftruncate(file, static_cast<off_t>(keep)) != 0 || (keep == 0 && !write_whole(file, wanted))) {
    ::close(file);
    return unwritable(path);
  }
  return MapStore(folder, identity, rank, file);
}

MapStore::MapStore(MapStore&& other) noexcept
    : folder_(std::move(other.folder_)),
      identity_(other.identity_),
      rank_(other.rank_),
      file_(std::exchange(other.file_, -1)) {}

MapStore::~MapStore() {
  if (file_ >= 0) ::close(file_);
}

Result<std::vector<MapStore::Block>> MapStore::read_all() const {
  std::vector<Block> blocks;
  const std::string wanted = header(identity_);
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder_, ignored)) {
    if (entry.path().extension() != ".partial") continue;
    const auto bytes = slurp(entry.path());
    if (!bytes) return bytes.error();
    if (bytes->size() < wanted.size()) continue;  // another rank has just made it
    if (!bytes->starts_with(wanted)) return of_another_map(entry.path());
    read_blocks(std::string_view(*bytes).substr(wanted.size()), blocks);
  }
  return blocks;
}

Check MapStore::append(std::uint64_t number, const PointResult* points, std::size_t count) {
  std::string bytes;
  put(bytes, number);
  put(bytes, static_cast<std::uint64_t>(count));
  for (std::size_t i = 0; i < count; ++i) {
    put(bytes, static_cast<double>(static_cast<int>(points[i].verdict)));
    put(bytes, points[i].settling_time_s);
    put(bytes, points[i].contacts);
    put(bytes, points[i].peak_force_N);
    put(bytes, points[i].residual_rms_N);
  }
  put(bytes, checksum(bytes));
  if (!write_whole(file_, bytes)) return unwritable(folder_);
  return {};
}

bool MapStore::is_there() const {
  std::error_code ignored;
  return std::filesystem::exists(path_of(folder_, rank_), ignored);
}

void MapStore::remove_all(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
    if (entry.path().extension() == ".partial") files.push_back(entry.path());
  }
  for (const auto& file : files) std::filesystem::remove(file, ignored);
}

}  // namespace tactus::stability
