// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/frequency_response.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <chrono>
#include <complex>
#include <cstdio>
#include <limits>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

template <class Work>
double shortest_ms(const Work& work) {
  constexpr int repetitions = 5;
  double shortest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repetitions; ++i) {
    const auto start = Clock::now();
    work();
    shortest = std::min(shortest, std::chrono::duration<double, std::milli>(Clock::now() - start).count());
  }
  return shortest;
}

}  // namespace

/// Times of frequency responses from five minutes at 5 kHz, one line each, name and milliseconds, the shortest of five.
/// `bench/frequency_response.py` runs it beside SciPy.
int main() {
  namespace identification = tactus::identification;
  constexpr std::size_t samples = 1'500'000;
  const tactus::Seconds tick{2e-4};
  tactus::signal::Random random(1);
  std::vector<double> input(samples), output(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    input[i] = random.normal();
    output[i] = 0.1 * input[i] + (i > 0 ? 0.2 * input[i - 1] + 0.3 * output[i - 1] : 0.0) + 0.01 * random.normal();
  }
  const std::vector<identification::InputOutput> runs{{input, output}};
  volatile double used = 0.0;
  for (const std::int64_t length : {1024, 4096, 16384}) {
    const double spent_ms = shortest_ms([&] {
      const auto spectra = identification::average_spectra(runs, tick, {.samples = length});
      const auto response = identification::response_h1(*spectra);
      used = used + response.response[1].real() + response.radius_95[1];
    });
    std::printf("h1_%lld %.3f\n", static_cast<long long>(length), spent_ms);
  }
  const double spent_ms = shortest_ms([&] {
    const auto response = identification::etfe(runs, tick, {.smoothing_lines = 1});
    used = used + response->response[1].real();
  });
  std::printf("etfe_whole %.3f\n", spent_ms);
}
