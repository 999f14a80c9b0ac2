#include <tactus/core/binding.hpp>

namespace tactus {

std::string join(std::string_view section, std::string_view key) {
  std::string path(section);
  if (!section.empty() && !key.empty()) path += '.';
  return path.append(key);
}

std::string_view section_of(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string_view::npos ? std::string_view{} : path.substr(0, dot);
}

std::string_view key_of(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string_view::npos ? path : path.substr(dot + 1);
}

}  // namespace tactus
