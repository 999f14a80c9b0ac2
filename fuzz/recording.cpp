// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/recording.hpp>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

using namespace tactus::recording;

namespace {

void demand(bool holds) {
  if (!holds) std::abort();
}

/// In memory where there is a place for that.
std::string file_named(const char* ending) {
  const char* folder = std::filesystem::exists("/dev/shm") ? "/dev/shm/" : "/tmp/";
  return folder + std::string("tactus-fuzz-") + std::to_string(::getpid()) + ending;
}

}  // namespace

/// The first byte chooses between a table and a MATLAB file, the rest is the file. What is read is finite and has two
/// samples or more.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string table = file_named(".csv"), matlab = file_named(".mat");
  if (size == 0) return 0;
  const std::string& file = data[0] == 'm' ? matlab : table;
  {
    std::ofstream out(file, std::ios::binary | std::ios::trunc);
    out.write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
  }
  const auto entries = contents(file);
  if (!entries) {
    demand(!entries.error().message.empty());
    return 0;
  }
  int read_so_far = 0;
  for (const Entry& entry : *entries) {
    if (++read_so_far > 4) break;
    const auto signal = read({.file = file, .variable = entry.name});
    if (!signal) continue;
    demand(signal->values.size() >= 2);
    for (const double value : signal->values) demand(std::isfinite(value));
    demand(!signal->sample_time_s || *signal->sample_time_s > 0.0);
  }
  return 0;
}
