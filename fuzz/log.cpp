// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/telemetry/log_reader.hpp>

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <sys/mman.h>
#include <unistd.h>

namespace {

void demand(bool holds) {
  if (!holds) std::abort();
}

}  // namespace

/// The input is a log: what is in it becomes tables of whole columns, or an error that says something.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const int file = ::memfd_create("log", 0);
  static const std::filesystem::path path = "/proc/self/fd/" + std::to_string(file);
  demand(file >= 0 && ::ftruncate(file, 0) == 0 && ::pwrite(file, data, size, 0) == static_cast<ssize_t>(size));
  const auto content = tactus::telemetry::read_log(path);
  if (!content) {
    demand(!content.error().message.empty());
    return 0;
  }
  std::uint64_t messages = 0;
  for (const auto& table : content->tables) {
    messages += table.times_ns.size();
    demand(!table.times_ns.empty() && table.values.size() == table.columns.size());
    for (const auto& column : table.values) demand(column.size() == table.times_ns.size());
  }
  demand(messages == content->summary.messages);
  return 0;
}
