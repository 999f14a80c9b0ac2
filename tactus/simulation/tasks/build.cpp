// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/core/version.hpp>
#include <tactus/simulation/tasks/build.hpp>

#include <cstdint>
#include <cstring>
#include <string_view>

#include <elf.h>
#include <link.h>

namespace tactus::tasks {

namespace {

/// The notes of a segment follow one another: header, name, content, each padded to four bytes.
std::string build_id_in(std::string_view notes) {
  const auto padded = [](std::size_t size) { return (size + 3) & ~std::size_t{3}; };
  constexpr std::string_view digits = "0123456789abcdef";
  ElfW(Nhdr) header{};
  while (notes.size() >= sizeof header) {
    std::memcpy(&header, notes.data(), sizeof header);
    notes.remove_prefix(sizeof header);
    const std::size_t name = padded(header.n_namesz), content = padded(header.n_descsz);
    if (notes.size() < name + content) return {};
    if (header.n_type == NT_GNU_BUILD_ID && notes.starts_with(std::string_view("GNU\0", 4))) {
      std::string id;
      for (const char c : notes.substr(name, header.n_descsz)) {
        const auto byte = static_cast<unsigned char>(c);
        id += digits[byte >> 4U];
        id += digits[byte & 15U];
      }
      return id;
    }
    notes.remove_prefix(name + content);
  }
  return {};
}

/// Of a loaded object: leaves its build ID if this function is in it, which ends the search.
int look_into(dl_phdr_info* object, std::size_t /*size*/, void* found) {
  const auto here = reinterpret_cast<std::uintptr_t>(&look_into);
  std::string id;
  bool contains_this = false;
  for (int i = 0; i < object->dlpi_phnum; ++i) {
    const ElfW(Phdr)& segment = object->dlpi_phdr[i];
    const std::uintptr_t start = object->dlpi_addr + segment.p_vaddr;
    if (segment.p_type == PT_LOAD) contains_this = contains_this || (here >= start && here < start + segment.p_memsz);
    if (segment.p_type == PT_NOTE && id.empty()) {
      id = build_id_in({reinterpret_cast<const char*>(start), segment.p_memsz});
    }
  }
  if (!contains_this) return 0;
  *static_cast<std::string*>(found) = id;
  return 1;
}

}  // namespace

std::string version_and_build() {
  std::string id;
  dl_iterate_phdr(look_into, &id);
  return std::string(version()) + (id.empty() ? "" : ", build " + id);
}

}  // namespace tactus::tasks
