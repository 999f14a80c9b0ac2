#include <tactus/recording/file_bytes.hpp>

#include <fstream>

namespace tactus::recording {

Result<std::string> file_bytes(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary | std::ios::ate);
  const auto size = static_cast<std::streamoff>(stream.tellg());
  std::string bytes;
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
