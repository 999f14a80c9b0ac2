// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/file_bytes.hpp>

#include <fstream>

namespace tactus::recording {

Result<std::string> file_bytes(const std::filesystem::path& file, std::size_t most) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  const auto size = static_cast<std::streamoff>(stream.tellg());
  std::string bytes;
  if (stream && static_cast<std::size_t>(size) > most) {
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = {},
                 .message = "holds " + std::to_string(size) + " bytes, more than the " + std::to_string(most >> 20U) +
                            " MiB that are read; cut it into smaller files",
                 .place = file.string()};
  }
  if (stream) {
    bytes.resize(static_cast<std::size_t>(size));
    stream.seekg(0);
    stream.read(bytes.data(), size);
  }
  if (stream) return bytes;
  return Error{.code = ErrorCode::missing,
               .parameter = {},
               .message = "cannot be read; check its permissions",
               .place = file.string()};
}

}  // namespace tactus::recording
