// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/document.hpp>
#include <tactus/data/telemetry/cdr.hpp>
#include <tactus/data/telemetry/log_reader.hpp>
#include <tactus/data/telemetry/log_writer.hpp>
#include <tactus/runtime/servo/sites_record.hpp>
#include <tactus/simulation/real_time/real_time_tapping.hpp>
#include <tactus/simulation/real_time/replay.hpp>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include "tests/scratch_path.hpp"
#include <gtest/gtest.h>

namespace tactus::real_time {
namespace {

/// A log of two short taps in real time.
class Replaying : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = scratch_path();
    const auto document = configuration::Document::parse(
        "task = { kind = \"tapping\", supervised = false, taps = 2, observation_s = 0.15, slowest_m_per_s = 0.07, "
        "model_error = 0.2 }\n"
        "control.force_gain = 5.0\nslave.force_sensor.noise_rms_N = 0.002\n"
        "channel.to_master = { delay_s = 0.002, jitter_s = 0.001, loss_fraction = 0.1 }\n",
        "test");
    ASSERT_TRUE(document) << describe(document.error());
    const auto ran = run_in_real_time({.document = *document, .variations = {}, .name = "taps", .command = {}},
                                      {.servo = {.priority = 10}, .log = log(), .about = {}}, [](double) {});
    ASSERT_TRUE(ran) << describe(ran.error());
    ASSERT_FALSE(ran->log);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  [[nodiscard]] std::filesystem::path log() const { return folder_ / "log.mcap"; }

  /// The same log with one number changed by so much, a whole one by 1; by its last digit where no amount is told.
  [[nodiscard]] std::filesystem::path tampered(const std::string& signal, std::size_t row, double by = 0.0) const {
    const auto content = telemetry::read_log(log(), "/sites").value();
    auto table = content.tables.front();
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      double& value = table.values[i][row];
      if (table.columns[i].name != signal) continue;
      const bool whole = table.columns[i].type == telemetry::SignalType::int64;
      const double next = std::nextafter(value, std::numeric_limits<double>::infinity());
      value = whole ? value + 1.0 : by == 0.0 ? next : value + by;
    }
    const auto file = folder_ / "tampered.mcap";
    auto writer = telemetry::LogWriter::create(file).value();
    for (const auto& [name, metadata] : content.summary.metadata) writer.add_metadata(name, metadata);
    const auto channel =
        writer.add_channel({.topic = table.topic, .type_name = table.type_name, .columns = table.columns});
    for (std::size_t k = 0; k < table.times_ns.size(); ++k) {
      runtime::SitesRecord record;
      std::size_t column = 0;
      for_each_signal<runtime::SitesRecord>([&](const auto& one) {
        auto& member = record.*one.member;
        member = static_cast<std::remove_reference_t<decltype(member)>>(table.values[column++][k]);
      });
      writer.write(channel, static_cast<std::uint32_t>(k), table.times_ns[k], telemetry::to_cdr(record));
    }
    EXPECT_FALSE(writer.close());
    return file;
  }

 private:
  std::filesystem::path folder_;
};

TEST_F(Replaying, ALogOfARunInRealTimeReplaysBitForBit) {
  const auto replayed = replay(log());
  ASSERT_TRUE(replayed) << describe(replayed.error());
  EXPECT_FALSE(replayed->difference) << replayed->difference->signal << " at " << replayed->difference->tick;
  EXPECT_EQ(replayed->taps, 2);
  const auto rows = telemetry::read_log(log(), "/sites").value().tables.front().times_ns.size();
  EXPECT_EQ(replayed->ticks, static_cast<std::int64_t>(rows));
  EXPECT_GT(rows, 0u);
}

TEST_F(Replaying, AnOutputThatWasChangedByItsLastDigitIsFoundWhereItStands) {
  for (const char* signal : {"slave_force_N", "master_force_N", "to_master_force_N", "to_slave_position_m"}) {
    const auto replayed = replay(tampered(signal, 700));
    ASSERT_TRUE(replayed) << describe(replayed.error());
    ASSERT_TRUE(replayed->difference) << signal;
    EXPECT_EQ(replayed->difference->signal, signal);
    EXPECT_EQ(replayed->difference->tap, 0);
    EXPECT_EQ(replayed->ticks, 701);
    EXPECT_NE(replayed->difference->recorded, replayed->difference->replayed);
  }
}

// A micrometre: the last digit of a position that is near zero is lost in the sum that makes the force.
TEST_F(Replaying, AnInputThatWasChangedGivesOtherOutputsFromThereOn) {
  const auto replayed = replay(tampered("slave_position_m", 700, 1e-6));
  ASSERT_TRUE(replayed) << describe(replayed.error());
  ASSERT_TRUE(replayed->difference);
  EXPECT_EQ(replayed->difference->signal, "slave_force_N");
  EXPECT_EQ(replayed->ticks, 701);
}

TEST_F(Replaying, AStepThatIsMissingIsSaid) {
  const auto replayed = replay(tampered("tick", 700));
  ASSERT_FALSE(replayed);
  EXPECT_NE(replayed.error().message.find("is missing"), std::string::npos) << replayed.error().message;
}

/// Three taps in real time, of which the end is asked for after so many.
RealTimeOutcome ran_until(std::int64_t after) {
  const auto document = configuration::Document::parse(
      "task = { kind = \"tapping\", supervised = false, taps = 3, observation_s = 0.15 }\nservo.rate_Hz = 1000.0\n",
      "test");
  runtime::EndRequest end;
  if (after == 0) end.ask();
  auto ran = run_in_real_time({.document = document.value(), .variations = {}, .name = "taps", .command = {}},
                              {.servo = {.priority = 10}, .log = {}, .about = {}, .end = &end}, [&](double done) {
                                if (std::lround(3.0 * done) == after) end.ask();
                              });
  EXPECT_TRUE(ran) << describe(ran.error());
  return *std::move(ran);
}

TEST(RunInRealTime, ThatIsAskedToEndTellsOfTheTapsThatRan) {
  const RealTimeOutcome two = ran_until(2);
  EXPECT_TRUE(two.interrupted);
  EXPECT_NE(two.outcome.text.find("Interrupted: 2 of 3 taps"), std::string::npos) << two.outcome.text;
  EXPECT_NE(two.outcome.html.find("Interrupted: 2 of 3 taps"), std::string::npos);
  EXPECT_NE(two.outcome.json.find("\"interrupted\""), std::string::npos);
  const RealTimeOutcome none = ran_until(0);
  EXPECT_TRUE(none.interrupted);
  EXPECT_NE(none.outcome.text.find("Interrupted: 0 of 3 taps"), std::string::npos) << none.outcome.text;
  const RealTimeOutcome all = ran_until(3);
  EXPECT_FALSE(all.interrupted) << "it was asked for too late";
  EXPECT_EQ(all.outcome.json.find("\"interrupted\""), std::string::npos);
}

}  // namespace
}  // namespace tactus::real_time
