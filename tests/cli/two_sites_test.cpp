// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include <nlohmann/json.hpp>
#include <tests/cli/command.hpp>
#include <tests/scratch_path.hpp>
#include <unistd.h>

namespace tactus::cli {
namespace {

/// Real programs on the loopback, started and stopped by a shell. A slow servo, so that sanitizers keep up.
class TwoSites : public ::testing::Test {
 protected:
  TwoSites() {
    std::filesystem::create_directory(folder);
    const int port = 20000 + 4 * (getpid() % 10000);
    for (int i = 0; i < 4; ++i) {
      std::string name = std::to_string(i);
      name.insert(name.begin(), 'P');
      setenv(name.c_str(), std::to_string(port + i).c_str(), 1);
    }
    setenv("TACTUS", TACTUS_COMMAND, 1);
    setenv("EXPERIMENT", TACTUS_EXPERIMENT_FOLDER "/tapping.toml", 1);
  }
  ~TwoSites() override { std::filesystem::remove_all(folder); }

  /// Runs a script in the folder, with functions that start the programs.
  void shell(const std::string& script) const {
    const std::string text = R"(
      site() { name=$1; shift; exec $TACTUS run $EXPERIMENT --set servo.rate_Hz=1000 --set plant.longest_step_s=5e-5 \
               --set control.supervision.watchdog.timeout_s=0.3 --set control.supervision.longest_stall_s=0.3 \
               --set control.supervision.overload.missed_share=0.9 --key key --json "$@" >$name.json 2>$name.log <&9; }
      wait_for() { for i in $(seq 300); do grep -q "$2" $1.log 2>/dev/null && return; sleep 0.1; done; exit 3; }
      wait_for_next() { lines=$(wc -l <$1.log); for i in $(seq 300); do
                        tail -n +$((lines + 1)) $1.log | grep -q "$2" && return; sleep 0.1; done; exit 4; }
      cd ')" + folder.string() +
                             R"('
      [ -e key ] || $TACTUS key key >/dev/null || exit 2
      # Somebody is there as long as this shell, who says nothing: an input that ends lets the dead-man switch go.
      [ -e person ] || mkfifo person
      exec 9<>person
    )" + script;
    std::ofstream(folder / "script") << text;
    ASSERT_EQ(std::system(("sh '" + (folder / "script").string() + "'").c_str()), 0) << log("master") << log("slave");
  }
  [[nodiscard]] nlohmann::json result(const std::string& name) const {
    std::ifstream file(folder / (name + ".json"));
    return nlohmann::json::parse(file);
  }
  static void expect_safe(const nlohmann::json& site) {
    EXPECT_EQ(site["stale_applied"], 0);
    EXPECT_EQ(site["not_finite"], 0);
    EXPECT_EQ(site["steps_above_limit"], 0);
  }

  /// Messages of each topic of a log, as another verb reads it.
  [[nodiscard]] nlohmann::json messages_of(const std::string& log) const {
    shell("$TACTUS export " + log + " --to mat --out export.mat --overwrite --json >export.json 2>/dev/null");
    const nlohmann::json document = result("export");
    nlohmann::json messages;
    for (const auto& topic : document["topics"]) messages[topic["topic"].get<std::string>()] = topic["messages"];
    return messages;
  }

  const std::filesystem::path folder = scratch_path();

 private:
  [[nodiscard]] std::string log(const std::string& name) const {
    std::ostringstream text;
    text << name << ":\n" << std::ifstream(folder / (name + ".log")).rdbuf();
    return text.str();
  }
};

TEST_F(TwoSites, TapThroughARelayThatLosesDelaysReordersAndDoubles) {
  shell(R"(
    $TACTUS relay $EXPERIMENT --master 127.0.0.1:$P0 --for-master 127.0.0.1:$P1 --slave 127.0.0.1:$P2 \
      --for-slave 127.0.0.1:$P3 --mean-burst 3 --duplicate-fraction 0.1 --json \
      --set channel.to_slave.loss_fraction=0.1 --set channel.to_slave.delay_s=0.002 \
      --set channel.to_slave.jitter_s=0.004 --set channel.to_master.delay_s=0.003 >relay.json & relay=$!
    site slave --site slave --listen 127.0.0.1:$P2 --peer 127.0.0.1:$P3 --out report & slave=$!
    site master --site master --listen 127.0.0.1:$P0 --peer 127.0.0.1:$P1 --arm & master=$!
    wait_for master ' active '
    wait_for slave ' active '
    sleep 2
    kill -INT $master $slave $relay
    wait
  )");
  const auto master = result("master"), slave = result("slave"), relay = result("relay");
  expect_safe(master);
  expect_safe(slave);
  EXPECT_EQ(master["armings"], 1);
  EXPECT_EQ(slave["armings"], 1);
  EXPECT_GT(slave["peak_force_N"], 0.05);  // it moved
  EXPECT_GT(slave["packets"]["late"], 10);
  EXPECT_GT(slave["link"]["authentic"], 1000);
  EXPECT_NEAR(slave["loss_fraction"].get<double>(), 0.1, 0.06);
  // A doubled record is dropped by DTLS, before the link's own window.
  EXPECT_GT(slave["link"]["refused"].get<int>(), relay["to_slave"]["doubled"].get<int>() / 2);
  EXPECT_GT(master["round_trip_mean_s"], 0.005);
  // The last second and every tick, in the words of the supervision.
  ASSERT_FALSE(slave["seconds"].empty());
  EXPECT_EQ(slave["seconds"].back()["time_s"], slave["duration_s"]);
  EXPECT_EQ(slave["log_dropped"], 0);
  const auto log = messages_of("report/log");
  EXPECT_EQ(log["/site"], slave["ticks"]);
  EXPECT_EQ(log["/servo"], slave["ticks"]);
  std::ostringstream page;
  page << std::ifstream(folder / "report" / "report.html").rdbuf();
  for (const char* part : {"the slave", "round trip", "age of packets", "SCHED_FIFO", "--site slave", "[servo]"}) {
    EXPECT_NE(page.str().find(part), std::string::npos) << part;
  }
}

TEST_F(TwoSites, ASlaveThatIsKilledAndComesBackFollowsOnlyAfterArming) {
  shell(R"(
    site slave --site slave --listen 127.0.0.1:$P2 --peer 127.0.0.1:$P0 & slave=$!
    site master --site master --listen 127.0.0.1:$P0 --peer 127.0.0.1:$P2 --arm & master=$!
    wait_for master ' active '
    kill -9 $slave
    wait_for master ' hold  *timed-out '
    site slave2 --site slave --listen 127.0.0.1:$P2 --peer 127.0.0.1:$P0 & slave=$!
    wait_for_next slave2 ' align '
    # A word to arm counts only while the other site is heard: a round trip is told then.
    wait_for_next master ' hold  *timed-out  *none  *none  *[0-9.]*[1-9]'
    kill -USR1 $master
    wait_for_next master ' active '
    wait_for_next slave2 ' active '
    kill -INT $master $slave
    wait
  )");
  const auto master = result("master"), slave = result("slave2");
  expect_safe(master);
  expect_safe(slave);
  EXPECT_EQ(master["armings"], 2);
  EXPECT_EQ(slave["armings"], 1);
  EXPECT_EQ(master["link"]["sessions"], 2);
  EXPECT_LT(master["longest_silence_at_hold_s"], 0.5);
}

TEST_F(TwoSites, OfOtherParametersAreNotArmedAndBothSayWhichKeyDiffers) {
  shell(R"(
    site slave --site slave --listen 127.0.0.1:$P2 --peer 127.0.0.1:$P0 & slave=$!
    site master --site master --listen 127.0.0.1:$P0 --peer 127.0.0.1:$P2 --arm \
      --set control.slave_gate.force_limit_N=7.5 & master=$!
    wait_for master ' disagreement '
    wait_for slave ' disagreement '
    wait_for master 'control.slave_gate.force_limit_N is 7.5 N here and .* N at the slave: start both'
    wait_for slave 'control.slave_gate.force_limit_N is .* N here and 7.5 N at the master: start both'
    kill -USR1 $master
    wait_for_next master ' disagreement '
    wait_for_next slave ' disagreement '
    kill -INT $master $slave
    wait
  )");
  for (const char* name : {"master", "slave"}) {
    EXPECT_EQ(result(name)["armings"], 0);
    EXPECT_EQ(result(name)["ticks_in"]["armed"], 0);
    EXPECT_EQ(result(name)["ticks_in"]["active"], 0);
  }
}

TEST_F(TwoSites, OfOtherKeysOrOneWithoutSayItAtBothSites) {
  shell(R"(
    other_site() { name=$1; shift; exec $TACTUS run $EXPERIMENT --set servo.rate_Hz=1000 \
                   --set plant.longest_step_s=5e-5 --json "$@" >$name.json 2>$name.log <&9; }
    $TACTUS key other >/dev/null || exit 2
    site slave --site slave --listen 127.0.0.1:$P2 --peer 127.0.0.1:$P0 & slave=$!
    other_site master --key other --site master --listen 127.0.0.1:$P0 --peer 127.0.0.1:$P2 & master=$!
    wait_for master 'tactus: what comes from the address of the slave was made with another key: give both sites the same'
    wait_for slave 'tactus: what comes from the address of the master was made with another key: give both sites the same'
    kill -INT $master; wait $master
    other_site master --unencrypted --site master --listen 127.0.0.1:$P0 --peer 127.0.0.1:$P2 & master=$!
    wait_for master 'tactus: the slave has a key, and this site sends plain text: start both with --key'
    wait_for slave 'tactus: the master sends plain text, and this site has a key: start both with --key'
    kill -INT $master $slave
    wait
  )");
  for (const char* name : {"master", "slave"}) EXPECT_EQ(result(name)["armings"], 0);
}

TEST_F(Command, OneSiteRefusesWhatCannotBeWithTheRemedy) {
  const auto refused = [this](std::vector<std::string> more, const std::string& words) {
    std::vector<std::string> arguments{"run", TACTUS_EXPERIMENT_FOLDER "/tapping.toml", "--site", "master"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const Outcome outcome = tactus(arguments);
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
  };
  refused({}, "--peer");
  refused({"--peer", "127.0.0.1:7300"}, "tactus key");
  refused({"--peer", "127.0.0.1:99999", "--unencrypted"}, "1 to 65535");
  refused({"--peer", "::1:7300", "--unencrypted"}, "brackets");
  refused({"--peer", "192.0.2.1:7300", "--listen", "27411", "--unencrypted"}, "may not leave");
  refused({"--peer", "127.0.0.1:7300", "--unencrypted", "--key", "key"}, "leave out one");
  refused({"--peer", "127.0.0.1:7300", "--key", "missing"}, "tactus key");
  refused({"--peer", "127.0.0.1:7300", "--unencrypted", "--vary", "control.force_gain=1,2"}, "--vary");
  // None of these is a time after which a run ends.
  for (const char* time_s : {"nan", "inf", "-1", "1e300"}) {
    refused({"--peer", "127.0.0.1:7300", "--unencrypted", "--duration-s", time_s}, "--duration-s");
  }
}

TEST_F(Command, AKeyIsMadeOnceAndNeverOverwritten) {
  EXPECT_EQ(tactus({"key", "k"}).status, 0);
  const std::string first = content("k");
  EXPECT_EQ(first.size(), 65U);
  EXPECT_NE(tactus({"key", "k"}).status, 0);
  EXPECT_EQ(content("k"), first);
}

}  // namespace
}  // namespace tactus::cli
