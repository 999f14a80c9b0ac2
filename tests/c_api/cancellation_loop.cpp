// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/cancellation_file.hpp>
#include <tactus/kernel/control/stages/cancellation.hpp>

#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <vector>

/// `cancellation_loop MODEL.toml SAMPLE_TIME_S IN OUT`: the loop of the README over a file of numbers, the position and
/// the force of each cycle, into a file of the intended positions. Prints the processor time of a
/// cycle, in ns.
int main(int argc, char** argv) {
  using namespace tactus;
  if (argc != 5) return 2;
  const auto params = configuration::read_cancellation(argv[1]);
  if (!params) return 1;
  auto cancellation = control::Cancellation::make(*params, Seconds{std::strtod(argv[2], nullptr)});
  if (!cancellation) return 1;
  std::ifstream in(argv[3], std::ios::binary);
  std::vector<control::Cancellation::Input> cycles;
  for (control::Cancellation::Input cycle; in.read(reinterpret_cast<char*>(&cycle), sizeof cycle);) {
    cycles.push_back(cycle);
  }
  std::vector<double> intended_m(cycles.size());
  const std::clock_t start = std::clock();
  for (std::size_t i = 0; i < cycles.size(); ++i) intended_m[i] = cancellation->step(cycles[i]);
  const double took_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  std::printf("%.6g\n", 1e9 * took_s / static_cast<double>(cycles.size()));
  std::ofstream(argv[4], std::ios::binary)
      .write(reinterpret_cast<const char*>(intended_m.data()),
             static_cast<std::streamsize>(intended_m.size() * sizeof(double)));
}
