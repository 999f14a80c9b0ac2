// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/real_time/replay.hpp>

#include <cstdint>
#include <string>

#include <gtest/gtest.h>
#include <tests/runtime/changed_log.hpp>
#include <tests/runtime/site_loop_test.hpp>

namespace tactus::runtime {
namespace site_loop_test {

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
    const auto replayed = real_time::replay(folder / name);
    ASSERT_TRUE(replayed) << describe(replayed.error());
    EXPECT_EQ(replayed->of, "the " + name);
    EXPECT_EQ(replayed->ticks, site->loop->totals().ticks);
    EXPECT_FALSE(replayed->difference) << name << ": " << replayed->difference->signal << " at "
                                       << replayed->difference->tick;
  }
  // Each input counts: what was read, what was pressed, what came.
  const auto differs = [this](const std::string& topic, const std::string& signal, std::size_t row) {
    const auto replayed = real_time::replay(tampered(folder / "slave", topic, signal, row));
    ASSERT_TRUE(replayed) << describe(replayed.error());
    ASSERT_TRUE(replayed->difference) << topic << " " << signal;
    EXPECT_GE(replayed->difference->tick, static_cast<std::int64_t>(row) - 2);
  };
  differs("/site", "motor_force_N", 5000);
  differs("/site", "position_m", 5000);
  differs("/packets", "position_m", 5000);
  const auto lacking = real_time::replay(tampered(folder / "slave", "/packets", "tick", 5000));
  ASSERT_FALSE(lacking);
  EXPECT_NE(lacking.error().message.find("/packets lacks"), std::string::npos) << lacking.error().message;
}

}  // namespace site_loop_test
}  // namespace tactus::runtime
