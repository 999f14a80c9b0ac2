// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <fstream>
#include <future>
#include <optional>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/cli/command.hpp"
#include "tests/cli/schema_validator.hpp"
#include "tests/live/raw_client.hpp"
#include "tests/ros2/fast_dds_peer.hpp"
#include "tests/ros2/test_network.hpp"
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace tactus::cli {
namespace {

using ros2::test::eventually;
using Words = std::vector<std::string>;

/// The page whose tables are tested.
std::string page() {
  std::ostringstream text;
  text << std::ifstream(TACTUS_COMBINATIONS).rdbuf();
  return text.str();
}

/// Cells of the table's row that begins so, spaces around them left out.
Words cells_of(const std::string& begin) {
  std::istringstream lines(page());
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with(begin)) continue;
    Words cells;
    std::istringstream row(line.substr(1));
    for (std::string cell; std::getline(row, cell, '|');) {
      const std::size_t first = cell.find_first_not_of(' ');
      cells.push_back(first == std::string::npos ? "" : cell.substr(first, cell.find_last_not_of(' ') + 1 - first));
    }
    return cells;
  }
  ADD_FAILURE() << "the page has no row " << begin;
  return Words(7);
}

/// What stands between the first and the last backquote, with quotation marks for the ones within.
std::string unquoted(const std::string& cell) {
  const std::size_t first = cell.find('`'), last = cell.rfind('`');
  return first == last ? cell : cell.substr(first + 1, last - first - 1);
}
std::string with_quotation_marks(std::string text) {
  for (char& letter : text) letter = letter == '`' ? '\'' : letter;
  return text;
}

struct Row {
  const char* clock;
  const char* devices;
  /// A line of the shell: `$TACTUS` and `$OWN` are the programs, `$MORE` the options of a cell.
  const char* command;
  bool replays = false;  ///< its log
};

// A slow servo, so that a busy machine keeps up.
constexpr const char* functions = R"(
  slow="--set servo.rate_Hz=1000 --set plant.longest_step_s=5e-5 --set control.supervision.watchdog.timeout_s=0.5
        --set control.supervision.longest_stall_s=0.5 --set control.supervision.overload.missed_share=0.9"
  taps="--set task.taps=4"
  # Somebody is there as long as this shell, who says nothing.
  rm -f person; mkfifo person; exec 9<>person
)";
constexpr std::array rows{
    Row{"virtual", "one's own", "$OWN run quick.toml $slow --device carriage $MORE"},
    Row{"virtual", "a plant's", "$TACTUS run quick.toml $slow --plant bench $MORE"},
    Row{"virtual", "two sites", "$TACTUS run quick.toml $slow $taps $MORE"},
    Row{"real", "one's own", "$OWN run quick.toml $slow --realtime --device carriage --arm --duration-s 3 $MORE <&9",
        true},
    Row{"real", "a plant's",
        "$TACTUS plant quick.toml $slow $taps --name $BENCH --silence-s 5 >plant 2>&1 & plant=$!\n"
        "until grep -q Plant plant; do sleep 0.05; done\n"
        "$TACTUS run quick.toml $slow $taps --realtime --plant $BENCH --plant-silence-s 5 $MORE; status=$?\n"
        "kill $plant; wait $plant; (exit $status)",
        true},
    Row{"real", "two simulated arms",
        "$TACTUS run $RIGS/../../experiments/arm-tapping.toml --set task.taps=4 --realtime $MORE", true},
    Row{"real", "a rig's",
        "mkfifo leader follower; emulate='emulate damiao --motors 7 --model DM4340,DM4340,DM4340,DM4310'\n"
        "$TACTUS $emulate >leader & peers=$!\n"
        "$TACTUS $emulate >follower & peers=\"$peers $!\"\n"
        "read leader <leader; read follower <follower\n"
        "sed \"s|/dev/serial/by-id/LEADER|$leader|; s|/dev/serial/by-id/FOLLOWER|$follower|\" $RIGS/yam.toml "
        ">yam.toml\n"
        "$TACTUS run $RIGS/joints.toml --realtime --device yam.toml --arm --duration-s 3 $MORE <&9; status=$?\n"
        "kill $peers; (exit $status)",
        true},
    Row{"real", "two sites",
        "$TACTUS run quick.toml $slow --site slave --peer 127.0.0.1:$P0 --listen 127.0.0.1:$P1 --unencrypted "
        "--duration-s 6 <&9 >slave 2>&1 & slave=$!\n"
        "$TACTUS run quick.toml $slow --site master --peer 127.0.0.1:$P1 --listen 127.0.0.1:$P0 --unencrypted --arm "
        "--duration-s 3 $MORE <&9; status=$?\n"
        "kill $slave; wait $slave; (exit $status)",
        true},
    Row{"real", "two sites of a rig",
        "mkfifo leader follower; emulate='emulate damiao --motors 7 --model DM4340,DM4340,DM4340,DM4310'\n"
        "$TACTUS $emulate >leader & peers=$!\n"
        "$TACTUS $emulate >follower & peers=\"$peers $!\"\n"
        "read leader <leader; read follower <follower\n"
        "sed \"s|/dev/serial/by-id/LEADER|$leader|; s|/dev/serial/by-id/FOLLOWER|$follower|\" $RIGS/yam.toml "
        ">yam.toml\n"
        "site=\"$TACTUS run $RIGS/joints.toml --device yam.toml --unencrypted\"\n"
        "$site --site slave --peer 127.0.0.1:$P0 --listen 127.0.0.1:$P1 --duration-s 6 <&9 >slave 2>&1 & slave=$!\n"
        "$site --site master --peer 127.0.0.1:$P1 --listen 127.0.0.1:$P0 --arm --duration-s 3 $MORE <&9; status=$?\n"
        "kill $slave; wait $slave; kill $peers; (exit $status)",
        true}};

/// What a cell adds to its row.
struct Column {
  const char* name;
  std::size_t place;  ///< of the cell in the row
  bool log, ros2, live;
};
constexpr std::array columns{Column{"log", 3, true, false, false}, Column{"ros2", 4, false, true, false},
                             Column{"live", 5, false, false, true}, Column{"all", 6, true, true, true}};

/// The programs, and what somebody beside them sees.
class Programs : public Command {
 protected:
  void SetUp() override {
    Command::SetUp();
    quick_experiment();
    setenv("TACTUS", TACTUS_COMMAND, 1);
    setenv("OWN", TACTUS_OWN_DEVICE, 1);
    setenv("RIGS", TACTUS_RIGS, 1);
    setenv("BENCH", ("bench" + std::to_string(getpid())).c_str(), 1);
    const int port = 20000 + 2 * (getpid() % 20000);
    setenv("P0", std::to_string(port).c_str(), 1);
    setenv("P1", std::to_string(port + 1).c_str(), 1);
    setenv("ROS_DOMAIN_ID", std::to_string(ros2::test::private_network().domain).c_str(), 1);
    setenv("ROS_LOCALHOST_ONLY", "1", 1);
  }
  [[nodiscard]] int shell(const std::string& script) const {
    std::ofstream(folder() / "script") << "cd '" << folder().string() << "'\n" << functions << script << "\n";
    return WEXITSTATUS(std::system(("sh '" + (folder() / "script").string() + "' >'" + (folder() / "said").string() +
                                    "' 2>'" + (folder() / "complained").string() + "'")
                                       .c_str()));
  }
  /// Frames that a viewer gets who subscribes to the first topic, while the run goes on.
  [[nodiscard]] int frames() const {
    std::smatch found;
    std::string said;
    const bool told = eventually([&] {
      said = content("said");
      return std::regex_search(said, found, std::regex("http://127\\.0\\.0\\.1:([0-9]+)/"));
    });
    if (!told) return 0;
    const auto port = static_cast<std::uint16_t>(std::stoi(found[1]));
    live::RawClient viewer(port);
    if (!viewer.open(port) || !viewer.text_with("advertise")) return 0;
    viewer.say(live::subscribe_often("1", 1));
    int count = 0;
    while (count < 10) {
      const auto message = viewer.next(3000);
      if (!message) break;
      count += message->binary ? 1 : 0;
    }
    return count;
  }
};

class Combination : public Programs, public ::testing::WithParamInterface<std::tuple<std::size_t, std::size_t>> {};

TEST_P(Combination, RunsAndDeliversOrIsRefusedAsThePageSays) {
  const Row& row = rows.at(std::get<0>(GetParam()));
  const Column& column = columns.at(std::get<1>(GetParam()));
  const std::string cell = cells_of(std::string("| ") + row.clock + " | " + row.devices + " |").at(column.place);
  const std::string name_space = ros2::test::private_namespace();
  std::string more;
  if (column.log) more += " --out out";
  if (column.ros2) more += " --ros2 --namespace " + name_space;
  if (column.live) more += " --live";
  const std::string script = "MORE='" + more + "'\n" + row.command;

  if (cell.starts_with("refused")) {
    EXPECT_EQ(shell(script), 2) << content("said");
    const std::string reason = unquoted(cells_of("| " + cell.substr(cell.find('(')) + " |").at(1));
    EXPECT_NE(with_quotation_marks(content("complained")).find(reason), std::string::npos) << content("complained");
    EXPECT_FALSE(std::filesystem::exists(folder() / "out"));
    return;
  }
  ASSERT_TRUE(cell.starts_with("runs")) << cell;
  std::optional<ros2::test::FastDdsPeer> peer;
  const std::string topic = ros2::dds_topic(name_space, "master/measured_js");
  if (column.ros2) {
    peer.emplace(ros2::test::private_network().domain);
    peer->subscribe(topic, "sensor_msgs::msg::dds_::JointState_");
  }
  auto run = std::async(std::launch::async, [&] { return shell(script); });
  if (column.live) {
    EXPECT_GE(frames(), 10);
  }
  EXPECT_EQ(run.get(), 0) << content("said") << content("complained");
  if (column.ros2) {
    EXPECT_GT(peer->received(topic).size(), 10U);
  }
  if (!column.log) return;
  const Outcome read = row.replays ? tactus({"replay", "out/log", "--check", "--json"})
                                   : tactus({"export", "out/log", "--to", "mat", "--json"});
  EXPECT_EQ(read.status, 0) << read.out << read.err;
  const auto document = nlohmann::json::parse(read.out);
  EXPECT_GT(row.replays ? document["ticks"] : document["topics"][0]["messages"], 500) << read.out;
}
INSTANTIATE_TEST_SUITE_P(, Combination,
                         ::testing::Combine(::testing::Range<std::size_t>(0, rows.size()),
                                            ::testing::Range<std::size_t>(0, columns.size())),
                         [](const auto& cell) {
                           std::string name = std::string(rows.at(std::get<0>(cell.param)).clock) + "_" +
                                              rows.at(std::get<0>(cell.param)).devices + "_" +
                                              columns.at(std::get<1>(cell.param)).name;
                           for (char& letter : name) letter = std::isalnum(letter) ? letter : '_';
                           return name;
                         });

/// Sites that a person arms say a line a second; with `--json` those go to standard error.
TEST_F(Programs, OneDocumentOfItsSchemaIsAllThatSitesPrintWithJson) {
  const Outcome printed = tactus({"schema", "--results", "run"});
  const SchemaValidator schema(nlohmann::json::parse(printed.out));
  int tried = 0;
  for (const Row& row : rows) {
    const std::string command = row.command;
    if (command.find("--arm") == std::string::npos) continue;
    EXPECT_EQ(shell("MORE=--json\n" + command), 0) << content("complained");
    const auto document = nlohmann::json::parse(content("said"), nullptr, false);
    EXPECT_TRUE(document.is_object()) << row.devices << ": " << content("said").substr(0, 400);
    EXPECT_EQ(schema.faults(document), "") << row.devices;
    EXPECT_GE(document["seconds"].size(), 2U) << row.devices;
    ++tried;
  }
  EXPECT_EQ(tried, 4);
}

TEST_F(Programs, MoreThatMakesNoSenseIsRefusedAsThePageSays) {
  const std::string text = page();
  std::istringstream lines(text.substr(text.find("Other combinations that are refused")));
  int refused = 0;
  for (std::string line; std::getline(lines, line) && !line.starts_with("##");) {
    if (!line.starts_with("| `--")) continue;
    const Words cells = cells_of(line);
    const int status = shell("$OWN run quick.toml " + unquoted(cells.at(0)));
    EXPECT_EQ(status, 2) << line;
    EXPECT_NE(with_quotation_marks(content("complained")).find(unquoted(cells.at(1))), std::string::npos)
        << line << "\n"
        << content("complained");
    ++refused;
  }
  EXPECT_GE(refused, 8);
}

}  // namespace
}  // namespace tactus::cli
