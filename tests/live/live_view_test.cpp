// SPDX-License-Identifier: Apache-2.0
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <string>
#include <vector>

#include "sample_view.hpp"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tactus::live {
namespace {

/// Reads CDR members in order, as a client would.
class Reader {
 public:
  explicit Reader(std::string bytes) : bytes_(std::move(bytes)) {}
  double float64() { return std::bit_cast<double>(bits(8)); }
  bool boolean() { return bits(1) != 0; }
  std::string text() {
    const auto size = static_cast<std::size_t>(bits(4));
    const std::string value = bytes_.substr(4 + offset_, size - 1);
    offset_ += size;
    return value;
  }
  std::vector<float> floats() {
    std::vector<float> values(static_cast<std::size_t>(bits(4)));
    for (float& value : values) value = std::bit_cast<float>(static_cast<std::uint32_t>(bits(4)));
    return values;
  }
  std::uint64_t bits(std::size_t size) {
    offset_ = (offset_ + size - 1) / size * size;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      value |= std::uint64_t{static_cast<unsigned char>(bytes_.at(4 + offset_ + i))} << (8 * i);
    }
    offset_ += size;
    return value;
  }
  [[nodiscard]] bool at_end() const { return 4 + offset_ == bytes_.size(); }

 private:
  std::string bytes_;
  std::size_t offset_ = 0;
};

using Messages = std::map<std::string, std::vector<std::string>>;

Messages collect(LiveView& view, double duration_s, bool all = true) {
  Messages messages;
  const auto nobody = [](std::size_t) { return false; };
  view.collect(nobody, [](std::size_t, std::uint64_t, const Payload&) {});
  for (auto i = std::lround(duration_s / view.engine().tick_s()); i > 0; --i) {
    view.engine().step();
    if (i % 100 != 1) continue;
    view.collect([all](std::size_t) { return all; },
                 [&](std::size_t topic, std::uint64_t, const Payload& payload) {
                   messages[view.topics()[topic].name].push_back(*payload);
                 });
  }
  return messages;
}

double vibration_energy_J_of(const std::string& state) {
  Reader reader(state);
  for (int i = 0; i < 7; ++i) reader.float64();
  return reader.float64();
}

std::string advice_of(const std::string& state) {
  Reader reader(state);
  for (int i = 0; i < 8; ++i) reader.float64();
  reader.boolean();
  reader.text();
  reader.text();
  return reader.text();
}

std::string verdict_of(const std::string& state) {
  Reader reader(state);
  for (int i = 0; i < 8; ++i) reader.float64();
  reader.boolean();
  return reader.text();
}

TEST(LiveView, BlocksHoldTheLeastAndLargestValuesOfTheRecordsAndTheForceAtEveryTick) {
  const auto view = sample_view();
  EXPECT_FALSE(publish(*view, "/operator/command", R"({"command":"tap"})"));
  const Messages messages = collect(*view, 0.6);
  EXPECT_EQ(messages.size(), 8U);
  const auto& records = messages.at("/left/teleoperator");
  ASSERT_EQ(records.size(), 3000U);
  const auto& blocks = messages.at("/left/block");
  const auto& forces = messages.at("/left/hand_force");
  ASSERT_EQ(blocks.size(), 30U) << "50 a second";
  ASSERT_EQ(forces.size(), 30U);
  // Of a record: time, master, induced, command, slave, tip, displayed, handle, hand.
  const auto member = [&records](std::size_t tick, int index) {
    Reader reader(records[tick]);
    for (int i = 0; i < index; ++i) reader.float64();
    return static_cast<float>(reader.float64());
  };
  for (std::size_t block = 0; block < blocks.size(); ++block) {
    Reader reader(blocks[block]);
    EXPECT_EQ(static_cast<float>(reader.float64()), member(100 * block, 0));
    EXPECT_DOUBLE_EQ(reader.float64(), 0.004);
    std::vector<std::vector<float>> lists;
    while (!reader.at_end()) lists.push_back(reader.floats());
    ASSERT_EQ(lists.size(), 16U);
    for (const auto& [signal, index] : {std::pair<std::size_t, int>{0, 1}, {1, 4}, {3, 2}, {4, 3}, {6, 6}, {7, 8}}) {
      for (std::size_t column = 0; column < 5; ++column) {
        float least = 1e9F, largest = -1e9F;
        for (std::size_t i = 0; i < 20; ++i) {
          const float value = member(100 * block + 20 * column + i, index);
          least = std::min(least, value);
          largest = std::max(largest, value);
        }
        ASSERT_EQ(lists[2 * signal].at(column), least);
        ASSERT_EQ(lists[2 * signal + 1].at(column), largest);
      }
    }
    Reader force(forces[block]);
    force.float64();
    EXPECT_DOUBLE_EQ(force.float64(), 2e-4);
    const std::vector<float> hand_force_N = force.floats();
    ASSERT_EQ(hand_force_N.size(), 100U);
    for (std::size_t i = 0; i < 100; ++i) ASSERT_EQ(hand_force_N[i], member(100 * block + i, 8));
  }
  EXPECT_EQ(verdict_of(messages.at("/left/state").back()), "settled");
  EXPECT_EQ(verdict_of(messages.at("/right/state").back()), "rings");
}

TEST(LiveView, ALoopThatRingsGivesEnergyByVibrationAndOneThatSettlesHardlyAny) {
  const auto view = sample_view();
  EXPECT_FALSE(publish(*view, "/operator/command", R"({"command":"tap"})"));
  static_cast<void>(collect(*view, 0.6));
  const auto energies_mJ = [](const Messages& messages) {
    return std::pair{1e3 * vibration_energy_J_of(messages.at("/left/state").back()),
                     1e3 * vibration_energy_J_of(messages.at("/right/state").back())};
  };
  const auto [settled_mJ, ringing_mJ] = energies_mJ(collect(*view, 0.1));
  EXPECT_LT(std::fabs(settled_mJ), 1.0);
  EXPECT_GT(ringing_mJ, 5.0);
  const auto [settled_later_mJ, ringing_later_mJ] = energies_mJ(collect(*view, 0.2));
  EXPECT_NEAR(settled_later_mJ, settled_mJ, 0.1);
  EXPECT_GT(ringing_later_mJ, ringing_mJ + 2.0);
}

TEST(LiveView, RemembersEachContactWithWhatWasSetAndForgetsSettingsThatSawNone) {
  const auto view = sample_view();
  EXPECT_FALSE(publish(*view, "/operator/command", R"({"command":"tap"})"));
  static_cast<void>(collect(*view, 0.6));
  for (const double gain : {9.0, 6.0, 0.5}) EXPECT_TRUE(view->set_parameters({{"control.force_gain", gain}}).empty());
  EXPECT_FALSE(publish(*view, "/operator/command", R"({"command":"tap"})"));
  static_cast<void>(collect(*view, 0.6));

  const SessionHistory& history = view->history();
  ASSERT_EQ(history.settings().size(), 2U) << "as on a slider that is dragged, 9 and 6 saw no contact";
  EXPECT_EQ(std::get<double>(history.settings()[0][0].value), 10.0);
  EXPECT_EQ(std::get<double>(history.settings()[1][0].value), 0.5);
  std::map<std::pair<std::size_t, std::size_t>, SessionHistory::Contact> last;
  for (const auto& contact : history.contacts()) last[{contact.setting, contact.loop}] = contact;
  ASSERT_EQ(last.size(), 4U);
  const auto &crisp = last.at({0, 0}), &ringing = last.at({0, 1}), &later = last.at({1, 1});
  EXPECT_EQ(crisp.verdict, LiveVerdict::settled);
  EXPECT_EQ(ringing.verdict, LiveVerdict::rings);
  EXPECT_EQ(later.verdict, LiveVerdict::settled) << "a gain of 0.5 is calm without cancellation too";
  EXPECT_GT(ringing.settling_time_s, experiments::settled_within_s);
  EXPECT_LT(crisp.settling_time_s, experiments::settled_within_s);
  EXPECT_GT(ringing.vibration_energy_J, 5.0 * crisp.vibration_energy_J);
  EXPECT_GT(crisp.peak_force_N, 0.05);
  EXPECT_NEAR(crisp.time_s, ringing.time_s, 0.01) << "the same hand";
  EXPECT_GT(later.time_s, crisp.time_s + 0.5);
}

TEST(LiveView, WhatNobodyWantsIsNotSent) {
  const auto view = sample_view();
  EXPECT_EQ(collect(*view, 0.1, false).count("/left/teleoperator"), 0U);
}

TEST(LiveView, CollectingEndsThoughTheLoopsGoOnAsFastAsItShows) {
  const auto view = sample_view();
  const auto everybody = [](std::size_t) { return true; };
  view->collect(everybody, [](std::size_t, std::uint64_t, const Payload&) {});
  view->engine().step();
  int steps = 0;
  view->collect(everybody, [&](std::size_t, std::uint64_t, const Payload&) {
    if (++steps < 5000) view->engine().step();
  });
  EXPECT_LT(steps, 5000);
}

TEST(LiveView, DescribesItsParametersForAPage) {
  const auto view = sample_view(false);
  const auto list = nlohmann::json::parse(view->metadata().at("tactus.parameters"));
  ASSERT_EQ(list.size(), view->parameters().size());
  EXPECT_EQ(list[0]["name"], "control.force_gain");
  EXPECT_EQ(list[0]["kind"], "number");
  EXPECT_EQ(list[0]["minimum"], 0.0);
  EXPECT_EQ(list[0]["maximum"], 30.0);
  EXPECT_EQ(list[0]["tunable"], false);
  EXPECT_EQ(view->metadata().at("tactus.experiment"), "sample");
}

TEST(LiveView, ParametersStayAsTheyAreWithoutLeaveAndOutsideTheirBounds) {
  const auto read_only = sample_view(false);
  const auto refused = read_only->set_parameters({{"control.force_gain", 3.0}});
  ASSERT_EQ(refused.size(), 1U);
  EXPECT_NE(refused[0].message.find("--allow-tuning"), std::string::npos);
  EXPECT_EQ(std::get<double>(read_only->parameters()[0].value), 10.0);

  const auto view = sample_view();
  const auto statuses = view->set_parameters({{"control.force_gain", 99.0},
                                              {"control.force_gain", std::string("much")},
                                              {"left.method", std::string("magic")},
                                              {"nothing", 1.0},
                                              {"side_by_side", 1.0},
                                              {"environment.stiffness_N_per_m", std::nan("")},
                                              {"operator.grip", 2.0}});
  ASSERT_EQ(statuses.size(), 6U) << "the last is fine and is taken";
  EXPECT_EQ(statuses[0].message, "control.force_gain: 99 is out of bounds: it must be at least 0 and at most 30");
  EXPECT_EQ(std::get<double>(view->parameters()[0].value), 10.0);
  EXPECT_EQ(std::get<double>(view->parameters()[3].value), 2.0);
}

TEST(LiveView, AGentleTouchIsToldFromATapAndAContactFromBeforeAChangeToo) {
  const auto view = sample_view();
  // A hand that creeps to the wall, 10 mm in a second.
  for (int i = 0; i <= 60; ++i) {
    const std::string there = std::to_string(2e-4 * i);
    EXPECT_FALSE(publish(*view, "/operator/hand", R"({"position_m":)" + there + R"(,"engaged":true})"));
    collect(*view, 0.02);
  }
  const std::string gentle = collect(*view, 0.4).at("/left/state").back();
  EXPECT_EQ(verdict_of(gentle), "settled");
  EXPECT_NE(advice_of(gentle).find("You touched at 10 mm/s, too gently"), std::string::npos) << advice_of(gentle);
  EXPECT_TRUE(view->set_parameters({{"left.method", std::string("none")}}).empty());
  const std::string changed = collect(*view, 0.4).at("/left/state").back();
  EXPECT_NE(advice_of(changed).find("before the change"), std::string::npos) << advice_of(changed);
  EXPECT_FALSE(publish(*view, "/operator/command", R"({"command":"tap"})"));
  const std::string tapped = collect(*view, 0.6).at("/left/state").back();
  EXPECT_EQ(verdict_of(tapped), "rings");
  EXPECT_EQ(advice_of(tapped), "You touched at 60 mm/s.");
}

TEST(LiveView, WhoComesAfterTheLastVisitorFindsTheDefaults) {
  const auto view = sample_view();
  const auto initial = view->parameters();
  EXPECT_TRUE(view->set_parameters({{"control.force_gain", 3.0}, {"left.method", std::string("none")}}).empty());
  view->stand_alone();
  for (std::size_t i = 0; i < initial.size(); ++i) EXPECT_EQ(view->parameters()[i].value, initial[i].value);
  const auto list = nlohmann::json::parse(view->metadata().at("tactus.parameters"));
  EXPECT_EQ(list[0]["initial"], 10.0);
  for (const auto& item : list) EXPECT_EQ(item.contains("explanations"), item["kind"] == "choice");
}

TEST(LiveView, WithoutSideBySideTheRightLoopRests) {
  const auto view = sample_view();
  EXPECT_TRUE(view->set_parameters({{"side_by_side", false}}).empty());
  EXPECT_EQ(collect(*view, 0.1).count("/right/state"), 0U);
  EXPECT_TRUE(view->set_parameters({{"side_by_side", true}}).empty());
  EXPECT_EQ(collect(*view, 0.1).count("/right/state"), 1U);
}

TEST(LiveView, TheHandBelongsToTheFirstWhoTakesItUntilItIsLetGo) {
  const auto view = sample_view();
  const std::string take = R"({"position_m":-0.02,"engaged":true})";
  EXPECT_FALSE(publish(*view, "/operator/hand", take, 1));
  EXPECT_TRUE(publish(*view, "/operator/hand", take, 2));
  EXPECT_FALSE(publish(*view, "/operator/hand", R"({"position_m":0,"engaged":false})", 1));
  EXPECT_FALSE(publish(*view, "/operator/hand", take, 2));
  view->leave(2);
  EXPECT_FALSE(publish(*view, "/operator/hand", take, 3));
}

TEST(LiveView, TheHandStaysInItsWorkspaceAndComesToRestWhenItsClientLeaves) {
  const auto view = sample_view();
  const auto position = [&view] {
    Reader reader(collect(*view, 1.0).at("/left/state").back());
    reader.float64();
    return reader.float64();
  };
  const auto status = publish(*view, "/operator/hand", R"({"position_m":-7,"engaged":true})");
  ASSERT_TRUE(status.has_value());
  EXPECT_EQ(status->level, StatusLevel::warning);
  EXPECT_EQ(position(), -sample_settings().workspace_m()[0]);
  view->leave(1);
  EXPECT_EQ(position(), 0.0);
}

TEST(LiveView, NonsenseFromAClientIsAnsweredAndMovesNothing) {
  const auto view = sample_view();
  for (const char* text : {"", "{", "[]", "7", R"({"position_m":"x","engaged":true})", R"({"position_m":1})",
                           R"({"engaged":true})", R"({"position_m":1e999,"engaged":true})", R"({"command":"dance"})"}) {
    EXPECT_TRUE(publish(*view, "/operator/hand", text)) << text;
    EXPECT_TRUE(publish(*view, "/operator/command", text)) << text;
  }
  EXPECT_TRUE(publish(*view, "/elsewhere", "{}"));
  EXPECT_TRUE(view->receive(1, "/operator/hand", "cdr", R"({"position_m":0,"engaged":true})"));
}

}  // namespace
}  // namespace tactus::live
