#include <tactus/runtime/replay.hpp>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <type_traits>

#include <gtest/gtest.h>
#include <tests/runtime/site_loop_test.hpp>

namespace tactus::runtime {
namespace site_loop_test {

/// The same log with one number of a topic changed by its last digit, a whole one by 1.
std::filesystem::path tampered(const std::filesystem::path& folder, const std::string& topic, const std::string& signal,
                               std::size_t row) {
  const auto content = telemetry::read_log(folder).value();
  const auto file = folder.parent_path() / "tampered.mcap";
  auto writer = telemetry::LogWriter::create(file).value();
  for (const auto& [name, metadata] : content.summary.metadata) writer.add_metadata(name, metadata);
  const auto write = [&](telemetry::LogTable table, auto record) {
    using Record = decltype(record);
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      if (table.topic != topic || table.columns[i].name != signal) continue;
      double& value = table.values[i][row];
      const bool whole = table.columns[i].type == telemetry::SignalType::int64;
      value = whole ? value + 1.0 : std::nextafter(value, std::numeric_limits<double>::infinity());
    }
    const auto channel =
        writer.add_channel({.topic = table.topic, .type_name = table.type_name, .columns = table.columns});
    for (std::size_t k = 0; k < table.times_ns.size(); ++k) {
      std::size_t column = 0;
      for_each_signal<Record>([&](const auto& one) {
        auto& member = record.*one.member;
        member = static_cast<std::remove_reference_t<decltype(member)>>(table.values[column++][k]);
      });
      writer.write(channel, static_cast<std::uint32_t>(k), table.times_ns[k], telemetry::to_cdr(record));
    }
  };
  for (const telemetry::LogTable& table : content.tables) {
    if (table.topic == "/site") write(table, SiteLogRecord());
    if (table.topic == "/packets") write(table, PacketRecord());
  }
  EXPECT_FALSE(writer.close());
  return file;
}

// Through all that changes a state: buttons, silence, an arming anew and an end.
TEST_F(Sites, TheLogOfEitherReplaysBitForBit) {
  open(true);
  run(5005);
  expect(SiteState::active, SiteState::active);
  for (const SiteWord word : {SiteWord::release, SiteWord::press, SiteWord::clutch, SiteWord::unclutch}) {
    master.exchange.words.try_push(word);
    run(700);
  }
  run(600, true, false);
  run(1000);
  for (const SiteWord word : {SiteWord::arm, SiteWord::stop, SiteWord::clear}) {
    master.exchange.words.try_push(word);
    run(1500);
  }
  master.exchange.end.ask();
  run(200);
  close(master, SiteRole::master);
  close(slave, SiteRole::slave);
  for (const Site* site : {&master, &slave}) {
    const std::string name = site == &master ? "master" : "slave";
    const auto replayed = replay(folder / name);
    ASSERT_TRUE(replayed) << describe(replayed.error());
    EXPECT_EQ(replayed->of, "the " + name);
    EXPECT_EQ(replayed->ticks, site->loop->totals().ticks);
    EXPECT_FALSE(replayed->difference) << name << ": " << replayed->difference->signal << " at "
                                       << replayed->difference->tick;
  }
  // Each input counts: what was read, what was pressed, what came.
  const auto differs = [this](const std::string& topic, const std::string& signal, std::size_t row) {
    const auto replayed = replay(tampered(folder / "slave", topic, signal, row));
    ASSERT_TRUE(replayed) << describe(replayed.error());
    ASSERT_TRUE(replayed->difference) << topic << " " << signal;
    EXPECT_GE(replayed->difference->tick, static_cast<std::int64_t>(row) - 2);
  };
  differs("/site", "motor_force_N", 5000);
  differs("/site", "position_m", 5000);
  differs("/packets", "position_m", 5000);
  const auto lacking = replay(tampered(folder / "slave", "/packets", "tick", 5000));
  ASSERT_FALSE(lacking);
  EXPECT_NE(lacking.error().message.find("/packets lacks"), std::string::npos) << lacking.error().message;
}

}  // namespace site_loop_test
}  // namespace tactus::runtime
