// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/signal/random.hpp>

#include <cmath>
#include <sstream>
#include <string>

#include "tests/cli/command.hpp"
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using IdentifyFrf = Command;
using Json = nlohmann::json;

/// Random force on a spring of 500 N/m behind one tick of delay, sampled at 1 kHz.
std::string recording(double amplitude_N, std::uint64_t seed) {
  signal::Random random(seed);
  std::ostringstream text;
  text << "time_s,force_N,position_m,rest_N\n";
  double last_N = 0.0;
  for (int i = 0; i < 4000; ++i) {
    const double now_N = amplitude_N * random.normal();
    text << 1e-3 * i << ',' << now_N << ',' << last_N / 500.0 + 1e-6 * random.normal() << ",3\n";
    last_N = now_N;
  }
  return text.str();
}

TEST_F(IdentifyFrf, a_spring_behind_a_delay_has_its_compliance_and_phase_within_the_bands_and_is_linear) {
  const std::string small = write("small.csv", recording(1.0, 1)), large = write("large.csv", recording(3.0, 2));
  const Outcome outcome = tactus({"identify", "frf", small, large, "--input", "force", "--output", "position",
                                  "--compare", "--json", "--out", "results"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Json json = Json::parse(outcome.out);
  EXPECT_EQ(json["unit"], "m/N");
  EXPECT_TRUE(json["linearity"]["linear"]);
  for (const Json& line : json["response"]) {
    const double frequency_Hz = line["frequency_Hz"];
    if (frequency_Hz > 450.0) continue;
    EXPECT_NEAR(line["gain"], 1.0 / 500.0, 3.0 * line["gain_95"].get<double>());
    EXPECT_NEAR(line["phase_deg"], -0.36 * frequency_Hz, 3.0 * line["phase_95_deg"].get<double>());
    EXPECT_GT(line["coherence"], 0.99);
  }
  EXPECT_EQ(files(), (std::vector<std::string>{"large.csv", "results", "results/figure-1.svg", "results/report.html",
                                               "results/response.csv", "results/results.json", "small.csv"}));
  EXPECT_EQ(content("results/results.json"), outcome.out);
}

TEST_F(IdentifyFrf, every_method_prints_a_table) {
  const std::string file = write("run.csv", recording(1.0, 3));
  for (const char* method : {"h1", "h2", "etfe"}) {
    const Outcome outcome =
        tactus({"identify", "frf", file, "--input", "force", "--output", "position", "--method", method});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_NE(outcome.out.find("coherence"), std::string::npos);
  }
}

TEST_F(IdentifyFrf, bad_recordings_get_a_message_and_no_response) {
  const std::string file = write("run.csv", recording(1.0, 4));
  const auto message = [&](std::vector<std::string> rest) {
    rest.insert(rest.begin(), {"identify", "frf"});
    const Outcome outcome = tactus(rest);
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_EQ(outcome.out, "");
    return outcome.err;
  };
  const auto expect_in = [](const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  expect_in(message({file, "--input", "rest", "--output", "position"}), "input never changes");
  expect_in(message({file, "--input", "force", "--output", "rest"}), "output never changes");
  expect_in(message({file, "--input", "force", "--output", "velocity"}), "it has:");
  expect_in(message({file, "--input", "force", "--output", "position", "--segment-samples", "100"}), "power of two");
  expect_in(message({file, "--input", "force", "--output", "position", "--lower-Hz", "900"}), "no line");
  expect_in(message({"none.csv", "--input", "force", "--output", "position"}), "does not exist");
  expect_in(message({write("short.csv", recording(1.0, 5).substr(0, recording(1.0, 5).find("0.006,"))), "--input",
                     "force", "--output", "position"}),
            "record for longer");
}

}  // namespace
}  // namespace tactus::cli
