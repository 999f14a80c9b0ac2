#include <tactus/configuration/toml_writer.hpp>
#include <tactus/runtime/replay.hpp>
#include <tactus/runtime/rights.hpp>
#include <tactus/runtime/site_loop.hpp>
#include <tactus/telemetry/log_reader.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <tests/allocation_counter.hpp>
#include <tests/link/pair.hpp>
#include <tests/scratch_path.hpp>

namespace tactus::runtime {
namespace site_loop_test {

using control::GateFault;
using control::SiteCause;
using control::SiteRole;
using control::SiteState;

constexpr std::int64_t tick_ns = 200'000;
/// Armed at once, the slave stands pressed against the wall at this tick.
constexpr int pressing_tick = 6500;

/// Both sites in one program, over the loopback and in plain text, at a clock of the test's own: as fast as they can.
class Sites : public ::testing::Test {
 protected:
  struct Site {
    SiteExchange exchange;
    std::optional<SiteLog> log;
    std::optional<SiteLoop> loop;
    std::int64_t tick = 0;
    /// Where it stood at the end of the second that ended last.
    SiteSecond second;
    bool more = true;  ///< what its step said last

    void step(std::int64_t now_ns) noexcept {
      more = (*loop)({.number = tick++, .deadline_ns = now_ns, .began_ns = now_ns});
      while (exchange.seconds.try_pop(second)) {
      }
    }
  };

  Sites() { params.control.force_gain = 1.0; }
  ~Sites() override { std::filesystem::remove_all(folder); }

  void open(bool arm_at_once = false) {
    const link::testing::Ports ports;
    const auto make = [&](Site& site, SiteRole role, std::uint16_t own, std::uint16_t other) {
      auto made = SiteLoop::make(params,
                                 {.link = {.site = role,
                                           .peer = link::testing::loopback(other),
                                           .listen = link::testing::loopback(own),
                                           .key = std::nullopt},
                                  .arm_at_once = arm_at_once && role == SiteRole::master},
                                 site.exchange, simulated_device(params, role).value());
      ASSERT_TRUE(made) << describe(made.error());
      site.loop.emplace(*std::move(made));
      SiteStreams streams = SiteStreams::of_one(role);
      streams.origin_ns = 0;  // the test's clock
      auto log =
          SiteLog::create(folder / name_of(role), streams,
                          {{"tactus", {{"site", name_of(role)}, {"configuration", configuration::to_toml(params)}}},
                           {std::string("device_of_") + name_of(role), in_words(station::DeviceLimits{})}});
      ASSERT_TRUE(log) << describe(log.error());
      site.log.emplace(*std::move(log));
      site.loop->leave_in(streams);
    };
    make(master, SiteRole::master, ports.master, ports.slave);
    make(slave, SiteRole::slave, ports.slave, ports.master);
  }
  /// Ends both and reads a topic of a site's log.
  telemetry::LogTable close(Site& site, SiteRole role, const std::string& topic = "/site") {
    site.loop->finish();
    while (site.exchange.seconds.try_pop(site.second)) {
    }
    EXPECT_FALSE(site.log->close());
    EXPECT_EQ(site.log->dropped(), 0U);
    auto content = telemetry::read_log(folder / name_of(role), topic).value();
    EXPECT_TRUE(content.summary.complete);
    metadata = content.summary.metadata["tactus"];
    return content.tables.at(0);
  }
  static std::vector<double> column(const telemetry::LogTable& table, const std::string& name) {
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      if (table.columns[i].name == name) return table.values[i];
    }
    ADD_FAILURE() << "no column " << name;
    return {};
  }

  /// The log's streams hold 4096 ticks, and the disk wants time too.
  void run(int ticks, bool step_master = true, bool step_slave = true) {
    const FlushedDenormals as_a_servo_thread_does;
    for (int i = 0; i < ticks; ++i) {
      now_ns += tick_ns;
      if (step_master) master.step(now_ns);
      if (step_slave) slave.step(now_ns);
      if (i % 500 == 499) std::this_thread::sleep_for(std::chrono::milliseconds(25));
    }
  }
  /// One second in which this is asked first.
  void ask(Site& site, SiteWord word) {
    site.exchange.words.try_push(word);
    run(5000);
  }
  void expect(SiteState at_master, SiteState at_slave) const {
    EXPECT_STREQ(name_of(master.second.state), name_of(at_master));
    EXPECT_STREQ(name_of(slave.second.state), name_of(at_slave));
  }

  const std::filesystem::path folder = scratch_path();
  experiments::TappingParams params;
  Site master, slave;
  std::int64_t now_ns = 1'000'000'000;
  std::map<std::string, std::string> metadata;
};

TEST_F(Sites, GoThroughTheirStatesAsAPersonAsks) {
  open();
  run(5005);
  expect(SiteState::align, SiteState::align);
  ask(master, SiteWord::arm);
  expect(SiteState::active, SiteState::active);
  EXPECT_EQ(master.second.cause, SiteCause::none);
  EXPECT_GT(slave.second.peak_force_N, 0.01);
  ask(master, SiteWord::release);
  expect(SiteState::armed, SiteState::armed);
  EXPECT_EQ(master.second.cause, SiteCause::dead_man);
  ask(master, SiteWord::press);
  expect(SiteState::active, SiteState::active);
  ask(master, SiteWord::clutch);
  expect(SiteState::active, SiteState::active);
  ask(master, SiteWord::unclutch);
  const auto table = close(master, SiteRole::master);
  const auto told = column(table, "told_position_m"), read = column(table, "position_m");
  const auto spread = [](const std::vector<double>& all, std::size_t begin, std::size_t end) {
    const auto [low, high] = std::minmax_element(all.begin() + static_cast<std::ptrdiff_t>(begin),
                                                 all.begin() + static_cast<std::ptrdiff_t>(end));
    return *high - *low;
  };
  // From one second to the next with the clutch pressed.
  EXPECT_EQ(spread(told, 20'010, 25'000), 0.0);
  EXPECT_GT(spread(read, 20'010, 25'000), 1e-3) << "the hand moves on";
  EXPECT_GT(spread(told, 25'010, 30'000), 1e-3);
}

TEST_F(Sites, ThatAreCutOffHoldUntilAPersonArms) {
  open(true);
  run(5005);
  expect(SiteState::active, SiteState::active);
  run(600, true, false);
  run(5000);
  expect(SiteState::hold, SiteState::hold);
  EXPECT_EQ(master.second.cause, SiteCause::silent);
  run(5000);
  expect(SiteState::hold, SiteState::hold);
  ask(master, SiteWord::arm);
  expect(SiteState::active, SiteState::active);
  const SiteTotals totals = master.loop->totals();
  EXPECT_EQ(totals.armings, 2);
  EXPECT_EQ(totals.holds[SiteCause::silent], 1);
  EXPECT_NEAR(totals.longest_silence_at_hold_s, 0.1, 0.001);
  EXPECT_EQ(master.loop->link_totals().stale_applied, 0);
  EXPECT_EQ(totals.steps_above_limit, 0);
}

// The slave's gate is set so that the taps are too fast for it.
TEST_F(Sites, AFaultIsLeftByClearingAtThatSiteAndAnArmingThatGoesUnansweredIsGivenUp) {
  params.control.slave_gate.velocity_limit_m_per_s = 0.01;
  open(true);
  run(10'005);
  expect(SiteState::hold, SiteState::fault);
  EXPECT_EQ(slave.second.fault, GateFault::velocity);
  EXPECT_EQ(slave.second.cause, SiteCause::gate);
  EXPECT_EQ(master.second.fault, GateFault::none) << "state and cause of the master, no fault of its gate";
  EXPECT_EQ(master.second.cause, SiteCause::peer);
  ask(master, SiteWord::clear);
  expect(SiteState::hold, SiteState::fault);
  ask(master, SiteWord::arm);
  run(1000);
  EXPECT_EQ(master.loop->totals().holds[SiteCause::unanswered], 1);
  run(4000);
  expect(SiteState::hold, SiteState::fault);
  ask(slave, SiteWord::clear);
  expect(SiteState::hold, SiteState::align);
  EXPECT_EQ(slave.second.fault, GateFault::none);
  ask(master, SiteWord::arm);
  EXPECT_EQ(slave.loop->totals().armings, 2);
}

// What a site does to its last tick is in its log, and its last second in what the report is made from.
TEST_F(Sites, TheLastSecondIsInTheLogAndInTheReport) {
  open(true);
  run(7'777);
  const auto table = close(slave, SiteRole::slave);
  const auto servo = telemetry::read_log(folder / "slave", "/servo").value().tables.at(0);
  EXPECT_EQ(metadata["site"], "slave");
  EXPECT_EQ(metadata["configuration"], configuration::to_toml(params));
  EXPECT_TRUE(std::filesystem::exists(folder / "slave" / "metadata.yaml"));
  ASSERT_EQ(table.times_ns.size(), 7'777U);
  ASSERT_EQ(servo.times_ns.size(), 7'777U);
  EXPECT_EQ(table.times_ns.back(), static_cast<std::uint64_t>(now_ns));
  const SiteTotals totals = slave.loop->totals();
  EXPECT_EQ(totals.ticks, 7'777);
  EXPECT_DOUBLE_EQ(slave.second.time_s, totals.duration_s);
  EXPECT_NEAR(totals.duration_s, 7'776 * 200e-6, 1e-9);

  // State, cause, active limit and fault are four columns; the link's facts and both forces beside them.
  const auto state = column(table, "state"), cause = column(table, "cause");
  EXPECT_EQ(state.back(), static_cast<double>(SiteState::active));
  EXPECT_EQ(cause.back(), static_cast<double>(SiteCause::none));
  EXPECT_EQ(cause.front(), static_cast<double>(SiteCause::started));
  EXPECT_EQ(std::set<double>(state.begin(), state.end()), (std::set<double>{0, 1, 2, 3}));
  for (const char* name : {"limit", "fault"}) EXPECT_EQ(column(table, name).back(), 0.0) << name;
  EXPECT_GT(column(table, "round_trip_s").back(), 0.0);
  EXPECT_EQ(column(table, "link_silence_s").back(), 0.0);
  EXPECT_EQ(column(table, "told_sequence").back(), 7'777.0);
  EXPECT_EQ(column(table, "applied_sequence").back(), 7'777.0) << "the master is stepped first";
  const auto forces = column(table, "motor_force_N");
  EXPECT_GT(*std::ranges::max_element(forces), 0.01);
}

/// First tick at which a logged state was left that had lasted.
std::size_t end_of(const std::vector<double>& states, SiteState state) {
  const auto value = static_cast<double>(state);
  const auto begin = std::find(states.begin(), states.end(), value);
  return static_cast<std::size_t>(std::find_if(begin, states.end(), [&](double one) { return one != value; }) -
                                  states.begin());
}

TEST_F(Sites, WithoutThePersonBothStandAtTheNextTickAndNoWordMakesThemFollow) {
  open(true);
  run(5005);
  expect(SiteState::active, SiteState::active);
  master.exchange.person_lost = true;
  run(5000);
  expect(SiteState::armed, SiteState::armed);
  EXPECT_EQ(master.second.cause, SiteCause::dead_man);
  for (const SiteWord word : {SiteWord::press, SiteWord::arm}) {
    ask(master, word);
    expect(SiteState::armed, SiteState::armed);
  }
  const auto at_master = column(close(master, SiteRole::master), "state");
  const auto at_slave = column(close(slave, SiteRole::slave), "state");
  EXPECT_EQ(end_of(at_master, SiteState::active), 5005U);
  EXPECT_EQ(end_of(at_slave, SiteState::active), 5005U) << "it is told in the same tick";
  EXPECT_EQ(std::count(at_master.begin() + 5005, at_master.end(), static_cast<double>(SiteState::active)), 0);
}

/// The end of either site as it is seen at both.
class EndOfASite : public Sites, public ::testing::WithParamInterface<SiteRole> {};

TEST_P(EndOfASite, IsALossOfForceAtTheRateLimitAndTheOtherHolds) {
  constexpr double rate_limit_N_per_s = 500.0;
  constexpr double largest_step_N = rate_limit_N_per_s * 200e-6 * (1.0 + 1e-9);
  params.control.gate.rate_limit_N_per_s = params.control.slave_gate.rate_limit_N_per_s = rate_limit_N_per_s;
  open(true);
  run(pressing_tick);
  expect(SiteState::active, SiteState::active);
  const bool at_master = GetParam() == SiteRole::master;
  Site& ending = at_master ? master : slave;
  Site& other = at_master ? slave : master;
  ending.exchange.end.ask();
  int ticks = 0;
  for (; ending.more && ticks < 2500; ++ticks) run(1);
  EXPECT_LT(ticks, 750) << "it took more than 0.15 s";
  EXPECT_EQ(ending.loop->totals().steps_above_limit, 0);
  run(2, !at_master, at_master);
  const auto table = close(ending, GetParam());
  EXPECT_EQ(ending.second.state, SiteState::configure);
  EXPECT_EQ(ending.second.cause, SiteCause::dead_man);
  const auto states = column(table, "state"), force_N = column(table, "motor_force_N");
  EXPECT_EQ(end_of(states, SiteState::active), std::size_t{pressing_tick});
  EXPECT_GT(std::fabs(force_N[pressing_tick - 1]), 0.1) << "there was nothing to lose";
  for (std::size_t i = pressing_tick; i < force_N.size(); ++i) {
    EXPECT_LE(std::fabs(force_N[i] - force_N[i - 1]), largest_step_N) << "tick " << i;
  }
  EXPECT_EQ(force_N.back(), 0.0);
  const auto elsewhere = column(close(other, at_master ? SiteRole::slave : SiteRole::master), "state");
  EXPECT_LE(end_of(elsewhere, SiteState::active), std::size_t{pressing_tick} + 1) << "it was told at once";
  EXPECT_EQ(other.second.state, SiteState::hold);
  EXPECT_EQ(other.second.cause, SiteCause::peer);
}
INSTANTIATE_TEST_SUITE_P(, EndOfASite, ::testing::Values(SiteRole::master, SiteRole::slave),
                         [](const auto& role) { return std::string(name_of(role.param)); });

TEST_F(Sites, AnEmergencyStopAtEitherIsLeftByClearingThere) {
  open(true);
  run(5005);
  expect(SiteState::active, SiteState::active);
  ask(slave, SiteWord::stop);
  expect(SiteState::hold, SiteState::fault);
  EXPECT_EQ(slave.second.cause, SiteCause::emergency_stop);
  ask(slave, SiteWord::clear);
  expect(SiteState::hold, SiteState::align);
  ask(master, SiteWord::stop);
  expect(SiteState::fault, SiteState::align);
  ask(master, SiteWord::clear);
  ask(master, SiteWord::arm);
  expect(SiteState::active, SiteState::active);
}

TEST_F(Sites, AnEndThatIsInsistedOnIsNoTickMore) {
  open(true);
  run(5005);
  slave.exchange.end.insist();
  run(1);
  EXPECT_FALSE(slave.more);
  EXPECT_EQ(slave.loop->totals().ticks, 5005);
}

TEST_F(Sites, ATickWithItsLogDoesNotAllocate) {
  open(true);
  run(5005);
  expect(SiteState::active, SiteState::active);
  const std::uint64_t before = laws::own_allocation_count();
  run(3000);
  EXPECT_EQ(laws::own_allocation_count(), before);
}

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
