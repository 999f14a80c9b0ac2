// SPDX-License-Identifier: Apache-2.0
// sample_log FOLDER: writes a log of known content and all its exports, for programs of others to read.
#include <tactus/data/telemetry/export.hpp>

#include <filesystem>
#include <iostream>

#include "tests/telemetry/sample.hpp"

using namespace tactus::telemetry;  // NOLINT: a program of one function

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);
  auto log = LogWriter::create(folder / "log.mcap");
  if (!log) return 1;
  log->add_metadata("tactus", {{"configuration", "[servo]\nrate_Hz = 5000\n"}, {"version", "1.2.3"}});
  const auto first = log->add_channel(sample_channel("/run_1/sample"));
  const auto second = log->add_channel(sample_channel("/run_2/sample"));
  for (std::int64_t k = 0; k < 20000; ++k) {
    write_sample(*log, first, k);
    if (k % 2 == 0) write_sample(*log, second, k);
  }
  if (log->close() || write_bag_metadata(folder / "log.mcap", *log)) return 1;
  const auto content = read_log(folder);
  if (!content) return 1;
  const auto error = [&]() -> tactus::Check {
    if (auto failed = export_csv(*content, folder / "log.csv")) return failed;
    if (auto failed = export_mat(*content, folder / "log.mat")) return failed;
    return export_hdf5(*content, folder / "log.h5");
  }();
  if (error) std::cerr << describe(*error) << "\n";
  return error ? 1 : 0;
}
