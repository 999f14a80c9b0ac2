// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/frequency_response.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <string>
#include <vector>

#include "tests/oracle_table.hpp"
#include <gtest/gtest.h>

namespace tactus::identification {
namespace frequency_response_test {

using Complex = std::complex<double>;
using Samples = std::vector<double>;

constexpr Seconds tick{2e-4};
constexpr SegmentParams oracle_segments{.samples = 128};

struct Signals {
  Samples input;
  Samples output;
  [[nodiscard]] InputOutput run() const { return {input, output}; }
};

/// White input, output = 2·(this + 0.5·last sample) + noise.
Signals two_taps(std::uint64_t seed, std::size_t samples, double noise, double cube = 0.0) {
  signal::Random random(seed);
  Signals signals;
  double last = 0.0;
  for (std::size_t i = 0; i < samples; ++i) {
    const double now = random.normal();
    signals.input.push_back(now);
    signals.output.push_back(2.0 * now + last + cube * now * now * now + noise * random.normal());
    last = now;
  }
  return signals;
}

Complex two_taps_at(double frequency_Hz) { return 2.0 + std::polar(1.0, -2.0 * M_PI * frequency_Hz * tick.value); }

void expect_close(const Samples& found, const Samples& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    EXPECT_NEAR(found[k], expected[k], 1e-9 * std::abs(expected[k])) << "line " << k;
  }
}

void expect_close(const std::vector<Complex>& found, const Samples& re, const Samples& im) {
  ASSERT_EQ(found.size(), re.size());
  for (std::size_t k = 0; k < found.size(); ++k) {
    const Complex expected{re[k], im[k]};
    EXPECT_LE(std::abs(found[k] - expected), 1e-9 * std::abs(expected)) << "line " << k;
  }
}

class FrequencyResponseOracle : public ::testing::Test {
 protected:
  const OracleTable signals{"identification_frequency_response_signals"};
  const OracleTable lines{"identification_frequency_response"};
  const Samples input = signals.column("input");
  const Samples output = signals.column("output");
  const InputOutput run{input, output};
};

TEST_F(FrequencyResponseOracle, spectra_and_coherence_are_those_of_SciPy_and_Octave) {
  const auto spectra = average_spectra(std::vector{run}, tick, oracle_segments);
  ASSERT_TRUE(spectra) << spectra.error().message;
  expect_close(spectra->frequency_Hz, lines.column("frequency_Hz"));
  expect_close(spectra->cross_power, lines.column("scipy_pxy_re"), lines.column("scipy_pxy_im"));
  for (const std::string peer : {"scipy", "octave"}) {
    expect_close(spectra->input_power, lines.column(peer + "_pxx"));
    expect_close(spectra->output_power, lines.column(peer + "_pyy"));
    expect_close(response_h1(*spectra).coherence, lines.column(peer + "_coherence"));
    expect_close(response_h1(*spectra).response, lines.column(peer + "_h1_re"), lines.column(peer + "_h1_im"));
  }
  expect_close(response_h2(*spectra).response, lines.column("scipy_h2_re"), lines.column("scipy_h2_im"));
}

TEST_F(FrequencyResponseOracle, etfe_of_two_runs_is_that_of_SciPy_and_Octave) {
  const std::vector<InputOutput> halves{{run.input.first(450), run.output.first(450)},
                                        {run.input.last(450), run.output.last(450)}};
  auto found = etfe(halves, tick, {.smoothing_lines = 9});
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->response.size(), 257U);
  found->response.resize(65);  // the oracle holds the first quarter of the axis
  for (const std::string peer : {"scipy", "octave"}) {
    expect_close(found->response, lines.column(peer + "_etfe_re"), lines.column(peer + "_etfe_im"));
  }
}

TEST(FrequencyResponse, a_delay_and_a_gain_without_noise_come_out_exactly_at_every_length) {
  for (const std::int64_t length : {8, 16, 32, 64, 1024, 2048}) {
    // Periodic in the segment, so that no segment leaks.
    Signals signals = two_taps(3, static_cast<std::size_t>(length), 0.0);
    for (std::size_t i = 0; i < static_cast<std::size_t>(length); ++i) {
      const double last = signals.input[(i + static_cast<std::size_t>(length) - 1) % static_cast<std::size_t>(length)];
      signals.output[i] = 2.0 * signals.input[i] + last;
    }
    for (Samples* samples : {&signals.input, &signals.output}) {
      const Samples period = *samples;
      samples->insert(samples->end(), period.begin(), period.end());
    }
    const auto spectra = average_spectra(std::vector{signals.run()}, tick,
                                         {.samples = length, .overlap = 0.0, .window = Window::rectangular});
    ASSERT_TRUE(spectra);
    const FrequencyResponse response = response_h1(*spectra);
    for (std::size_t k = 1; k < response.response.size(); ++k) {
      EXPECT_NEAR(std::abs(response.response[k] - two_taps_at(response.frequency_Hz[k])), 0.0, 1e-11) << length;
      EXPECT_NEAR(response.coherence[k], 1.0, 1e-12);
    }
  }
}

TEST(FrequencyResponse, the_band_holds_the_truth_about_as_often_as_it_says) {
  for (const Window window : {Window::hann, Window::rectangular}) {
    double inside = 0.0, all = 0.0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
      const Signals signals = two_taps(seed, 1500, 2.0);
      const auto spectra =
          average_spectra(std::vector{signals.run()}, tick,
                          {.samples = 64, .overlap = window == Window::hann ? 0.5 : 0.0, .window = window});
      const FrequencyResponse response = response_h1(*spectra);
      for (std::size_t k = 2; k + 2 < response.response.size(); ++k) {
        all += 1.0;
        const double error = std::abs(response.response[k] - two_taps_at(response.frequency_Hz[k]));
        if (error <= response.radius_95[k]) inside += 1.0;
      }
    }
    EXPECT_GT(inside / all, 0.93);
    EXPECT_LT(inside / all, 0.97);
  }
}

TEST(FrequencyResponse, noise_on_the_output_biases_h2_up_and_h1_not) {
  const Signals signals = two_taps(5, 400'000, 3.0);
  const auto spectra = average_spectra(std::vector{signals.run()}, tick, {.samples = 64});
  const double frequency_Hz = spectra->frequency_Hz[8];
  const double truth = std::abs(two_taps_at(frequency_Hz));
  EXPECT_NEAR(std::abs(response_h1(*spectra).response[8]) / truth, 1.0, 0.03);
  // |H2| = |H| (1 + noise power / noiseless output power), by hand.
  EXPECT_NEAR(std::abs(response_h2(*spectra).response[8]) / truth, 1.0 + 9.0 / (truth * truth), 0.1);
}

TEST(FrequencyResponse, runs_averaged_narrow_the_band_of_the_etfe_and_one_run_alone_has_none) {
  const Signals one = two_taps(1, 1024, 0.5), two = two_taps(2, 1024, 0.5), three = two_taps(3, 1024, 0.5);
  const auto alone = etfe(std::vector{one.run()}, tick, {});
  ASSERT_TRUE(alone);
  EXPECT_TRUE(std::isinf(alone->radius_95[100]));
  const std::vector<InputOutput> runs{one.run(), two.run(), three.run()};
  const auto few = etfe(runs, tick, {.smoothing_lines = 3});
  const auto many = etfe(runs, tick, {.smoothing_lines = 51});
  EXPECT_TRUE(std::isnan(alone->response[0].real()));
  EXPECT_LT(many->radius_95[200], few->radius_95[200]);
}

TEST(FrequencyResponse, a_linear_device_is_called_linear_at_every_amplitude_and_a_cubic_one_is_not) {
  for (const double cube : {0.0, 0.2}) {
    std::vector<FrequencyResponse> responses;
    for (const double amplitude : {0.5, 1.0, 2.0}) {
      Signals signals =
          two_taps(static_cast<std::uint64_t>(amplitude * 10), 40'000, 0.1 / amplitude, cube * amplitude * amplitude);
      for (std::size_t i = 0; i < signals.input.size(); ++i) {
        signals.input[i] *= amplitude;
        signals.output[i] *= amplitude;
      }
      responses.push_back(response_h1(*average_spectra(std::vector{signals.run()}, tick, {.samples = 256})));
    }
    const auto verdict = judge_linearity(responses, 50.0, 2400.0);
    ASSERT_TRUE(verdict);
    EXPECT_EQ(verdict->linear, cube == 0.0) << verdict->outside;
    EXPECT_GT(verdict->lines, 100U);
  }
}

void expect_refused(const Result<Spectra>& result, const std::string& word) {
  ASSERT_FALSE(result);
  EXPECT_NE(result.error().message.find(word), std::string::npos) << result.error().message;
}

TEST(FrequencyResponse, recordings_that_cannot_tell_get_a_message) {
  const Signals good = two_taps(1, 300, 0.1);
  const Samples constant(300, 2.5);
  Samples spoilt = good.output;
  spoilt[17] = std::numeric_limits<double>::quiet_NaN();
  const auto estimate = [](const Samples& input, const Samples& output, SegmentParams params = {.samples = 64}) {
    return average_spectra(std::vector<InputOutput>{{input, output}}, tick, params);
  };
  EXPECT_TRUE(estimate(good.input, good.output));
  expect_refused(estimate(constant, good.output), "input never changes");
  expect_refused(estimate(good.input, constant), "output never changes");
  expect_refused(estimate(good.input, spoilt), "sample 17 of the output");
  expect_refused(estimate(good.input, Samples(299, 1.0)), "299");
  expect_refused(estimate(good.input, good.output, {.samples = 4096}), "record for longer");
  expect_refused(estimate(good.input, good.output, {.samples = 100}), "take 64");
  EXPECT_FALSE(estimate({}, {}));
  EXPECT_FALSE(average_spectra({}, tick, {}));
  EXPECT_FALSE(average_spectra(std::vector{good.run()}, Seconds{0.0}, {.samples = 64}));
  EXPECT_FALSE(etfe(std::vector{good.run()}, tick, {.smoothing_lines = 4}));
  EXPECT_FALSE(etfe(std::vector<InputOutput>{{constant, constant}}, tick, {}));
  EXPECT_FALSE(judge_linearity({}, 0.0, 100.0));
}

}  // namespace frequency_response_test
}  // namespace tactus::identification
