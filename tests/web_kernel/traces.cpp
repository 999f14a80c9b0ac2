// SPDX-License-Identifier: Apache-2.0
// The native side of the comparison with WebAssembly (web/tests/unit/kernel.test.ts): runs every tap of an experiment
// through the interface of web/kernel, as the browser does.
//
//   web_kernel_traces SETTINGS FILE
//
// SETTINGS has a line `key=value` for each key. FILE gets doubles: the number of taps, and for each tap the number of
// its cycles, its results and its trace.
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <string>

#include "../../web/kernel/kernel.hpp"

namespace {

constexpr int results = 5;
constexpr int signals = 16;

int fail(const std::string& what) {
  std::cerr << "web_kernel_traces: " << what << "\n";
  return EXIT_FAILURE;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return fail("use: web_kernel_traces SETTINGS FILE");
  std::ifstream settings(argv[1]);
  std::ofstream file(argv[2], std::ios::binary);
  if (!settings || !file) return fail("a file cannot be opened");
  for (std::string line; std::getline(settings, line);) {
    if (line.size() > 4000) return fail("a line is too long");
    std::strcpy(tactus_text(), line.c_str());
    if (tactus_set(0) != 0) return fail(tactus_text());
  }
  const auto write = [&file](const double* numbers, int count) {
    file.write(reinterpret_cast<const char*>(numbers), static_cast<std::streamsize>(sizeof(double)) * count);
  };
  const int taps = tactus_taps();
  if (taps < 0) return fail(tactus_text());
  const double count = taps;
  write(&count, 1);
  for (int tap = 0; tap < taps; ++tap) {
    const int cycles = tactus_run_tap(tap);
    const double rows = cycles;
    write(&rows, 1);
    write(tactus_result(), results);
    write(tactus_trace(), cycles * signals);
  }
  return file.good() ? EXIT_SUCCESS : fail("the file could not be written");
}
