// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/supervised_site.hpp>

#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

namespace tactus::control {
namespace renumbered_test {

/// A site that is alive and says the same again and again, under fresh numbers, is as good as silent.
TEST(RenumberedPackets, DoNotCountUntilAllThatTheyCarryHasComeInItsTurnAgain) {
  const Seconds tick{2e-4};
  auto master = make_supervised_master({}, 1, tick).value();
  auto slave = make_supervised_slave({}, 2, tick).value();
  Packet said;
  for (int i = 0; i < 200; ++i) {
    said = slave.step({}).packet;
    ASSERT_EQ(master.take(said), PacketVerdict::applied);
  }
  for (int i = 0; i < 1000; ++i) {
    slave.step({});
    ++said.sequence;
    ASSERT_NE(master.take(said), PacketVerdict::applied) << "not even where number and content meet by chance";
  }
  const auto round = static_cast<int>(master.agreement().own().size());
  for (int i = 0; i < round - 1; ++i) ASSERT_NE(master.take(slave.step({}).packet), PacketVerdict::applied);
  for (int i = 0; i < 3; ++i) slave.step({});
  EXPECT_EQ(master.take(slave.step({}).packet), PacketVerdict::applied);
}

TEST(RenumberedPackets, OfASessionThatWasLeftAreNoDoubtAboutTheNext) {
  const Seconds tick{2e-4};
  auto master = make_supervised_master({}, 1, tick).value();
  auto slave = make_supervised_slave({}, 2, tick).value();
  Packet said = slave.step({}).packet;
  ASSERT_EQ(master.take(said), PacketVerdict::applied);
  said.sequence += 1;
  EXPECT_EQ(master.take(said), PacketVerdict::stale);
  auto again = make_supervised_slave({}, 3, tick).value();
  EXPECT_EQ(master.take(again.step({}).packet), PacketVerdict::applied);
}

/// The number after which a session is believed again does not wrap.
TEST(RenumberedPackets, AreStaleUpToTheLastNumberThatThereIs) {
  constexpr auto last = std::numeric_limits<std::int64_t>::max();
  const Seconds tick{2e-4};
  auto master = make_supervised_master({}, 1, tick).value();
  auto slave = make_supervised_slave({}, 2, tick).value();
  Packet said = slave.step({}).packet;
  ASSERT_EQ(master.take(said), PacketVerdict::applied);
  said.sequence = last;
  said.agreement = master.agreement().own().excerpt(last - 1);
  EXPECT_EQ(master.take(said), PacketVerdict::stale);
}

}  // namespace renumbered_test
}  // namespace tactus::control
