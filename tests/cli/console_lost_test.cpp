// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <netinet/in.h>
#include <nlohmann/json.hpp>
#include <sys/socket.h>
#include <sys/wait.h>
#include <tests/cli/command.hpp>
#include <unistd.h>

namespace tactus::cli {
namespace console_lost_test {

using namespace std::chrono_literals;
using std::chrono::steady_clock;
using Words = std::vector<std::string>;
namespace fs = std::filesystem;

bool eventually(const std::function<bool()>& holds) {
  for (const auto last = steady_clock::now() + 30s; steady_clock::now() < last; std::this_thread::sleep_for(10ms)) {
    if (holds()) return true;
  }
  return false;
}

/// Ports of the loopback that nobody has, all at once so that they differ.
std::vector<int> free_ports(std::size_t count) {
  std::vector<int> sockets, ports;
  for (std::size_t i = 0; i < count; ++i) {
    const int made = socket(AF_INET, SOCK_DGRAM, 0);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    EXPECT_EQ(bind(made, reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(getsockname(made, reinterpret_cast<sockaddr*>(&address), &size), 0);
    sockets.push_back(made);
    ports.push_back(ntohs(address.sin_port));
  }
  for (const int made : sockets) close(made);
  return ports;
}

/// A `tactus` that runs beside the test: a person types into a pipe, and what it prints goes to a file, or into a
/// terminal that has stalled, which is a pipe that is full and that nobody reads.
class Running {
 public:
  enum class Terminal { file, stalled };

  Running(const fs::path& folder, const Words& arguments, const std::string& output, Terminal terminal) {
    Words words{TACTUS_COMMAND};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    std::array<int, 2> typed{}, printed{-1, -1};
    EXPECT_EQ(pipe2(typed.data(), O_CLOEXEC), 0);
    if (terminal == Terminal::stalled) {
      EXPECT_EQ(pipe2(printed.data(), O_CLOEXEC), 0);
      fcntl(printed[1], F_SETFL, O_NONBLOCK);
      const std::string some(4096, '.');
      while (write(printed[1], some.data(), some.size()) > 0) {
      }
      fcntl(printed[1], F_SETFL, 0);
      unread_ = printed[0];
    } else {
      printed[1] = open((folder / output).c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    }
    child_ = fork();
    if (child_ == 0) {
      const bool set = chdir(folder.c_str()) == 0 && dup2(typed[0], STDIN_FILENO) >= 0 &&
                       dup2(printed[1], STDOUT_FILENO) >= 0 && dup2(printed[1], STDERR_FILENO) >= 0;
      if (set) execv(argv[0], argv.data());
      _exit(127);
    }
    close(typed[0]);
    close(printed[1]);
    typed_ = typed[1];
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;
  ~Running() {
    if (child_ > 0 && !status_) {
      ::kill(child_, SIGKILL);
      waitpid(child_, nullptr, 0);
    }
    end_input();
    if (unread_ >= 0) close(unread_);
  }

  void type(const std::string& text) const {
    EXPECT_EQ(write(typed_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  void end_input() {
    if (typed_ >= 0) close(typed_);
    typed_ = -1;
  }
  void signal(int number) const { ::kill(child_, number); }
  /// Whether it holds this signal back for the thread that waits for it. While it starts a thread, it holds back all.
  [[nodiscard]] bool waits_for(int number) const {
    std::ifstream status("/proc/" + std::to_string(child_) + "/status");
    for (std::string line; std::getline(status, line);) {
      if (!line.starts_with("SigBlk:")) continue;
      const auto held = std::stoull(line.substr(7), nullptr, 16);
      const auto is_held = [held](int one) { return (held >> (one - 1) & 1) != 0; };
      return is_held(number) && !is_held(SIGWINCH);
    }
    return false;
  }
  [[nodiscard]] bool ended() {
    int status = 0;
    if (!status_ && waitpid(child_, &status, WNOHANG) == child_) {
      status_ = WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
    }
    return status_.has_value();
  }
  /// Its exit status, patiently; 1000 and more where a signal ended it, -1 where nothing did.
  int wait() {
    return eventually([this] { return ended(); }) ? *status_ : -1;
  }

 private:
  pid_t child_ = -1;
  int typed_ = -1;
  int unread_ = -1;
  std::optional<int> status_;
};

class ConsoleLost : public Command {
 protected:
  [[nodiscard]] nlohmann::json results(const std::string& name) const {
    const auto parsed = nlohmann::json::parse(content(fs::path(name) / "results.json"), nullptr, false);
    EXPECT_FALSE(parsed.is_discarded()) << name << " has left no results";
    return parsed;
  }
  [[nodiscard]] bool shows(const std::string& file, const std::string& text) const {
    return content(file).find(text) != std::string::npos;
  }
};

constexpr double rate_Hz = 1000.0;

/// A slave, and a master whose terminal has stalled, armed.
struct Pair {
  Pair(const fs::path& folder, const std::string& name, int master_port, int slave_port)
      : slave(folder, words("slave", name, slave_port, master_port), name + ".slave.log", Running::Terminal::file),
        master(folder, words("master", name, master_port, slave_port), "", Running::Terminal::stalled) {}
  static Words words(const std::string& site, const std::string& name, int own, int peer) {
    Words all{"run",
              TACTUS_EXPERIMENT_FOLDER "/tapping.toml",
              "--site",
              site,
              "--unencrypted",
              "--out",
              name + "." + site,
              "--listen",
              std::to_string(own),
              "--peer",
              "127.0.0.1:" + std::to_string(peer),
              "--priority",
              "10"};
    for (const std::string set :
         {"servo.rate_Hz=1000", "plant.longest_step_s=5e-5", "control.supervision.watchdog.timeout_s=0.5",
          "control.supervision.longest_stall_s=0.5", "control.supervision.overload.missed_share=0.9"}) {
      all.insert(all.end(), {"--set", set});
    }
    if (site == "master") all.emplace_back("--arm");
    return all;
  }
  Running slave, master;
};

TEST_F(ConsoleLost, KeepsNobodyFromLettingGoAndEndingASite) {
  const std::map<std::string, std::function<void(Running&)>> ways{
      {"release", [](Running& master) { master.type("release\n"); }},
      {"end-of-input", [](Running& master) { master.end_input(); }},
      {"SIGINT", [](Running& master) { master.signal(SIGINT); }},
      {"SIGTERM", [](Running& master) { master.signal(SIGTERM); }},
      {"SIGHUP", [](Running& master) { master.signal(SIGHUP); }}};
  const auto ports = free_ports(2 * ways.size());
  std::map<std::string, Pair> pairs;
  for (const auto& [name, lets_go] : ways) {
    pairs.try_emplace(name, folder(), name, ports[2 * pairs.size()], ports[2 * pairs.size() + 1]);
  }
  for (auto& [name, pair] : pairs) {
    ASSERT_TRUE(eventually([&, this_name = name] { return shows(this_name + ".slave.log", " active "); })) << name;
  }
  for (auto& [name, pair] : pairs) ways.at(name)(pair.master);
  std::this_thread::sleep_for(1s);
  for (auto& [name, pair] : pairs) {
    const bool stays = name == "release" || name == "end-of-input";
    if (stays) {
      EXPECT_FALSE(pair.master.ended()) << name;
      pair.master.signal(SIGTERM);
    }
    EXPECT_EQ(pair.master.wait(), 0) << name;
    pair.slave.signal(SIGTERM);
    EXPECT_EQ(pair.slave.wait(), 0) << name;
    const auto master = results(name + ".master"), slave = results(name + ".slave");
    EXPECT_EQ(master["ended_by"], stays ? "SIGTERM" : name);
    EXPECT_GT(master["ticks_in"]["active"], 0) << name;
    EXPECT_EQ(master["steps_above_limit"], 0) << name;
    EXPECT_EQ(slave["holds"]["peer"], 1) << name << ": it saw the master leave";
    EXPECT_EQ(slave["holds"]["timed-out"], 0) << name;
    // After `release`, and what is the same, both stood armed for the second.
    for (const auto& site : {master, slave}) {
      EXPECT_EQ(site["ticks_in"]["armed"] > 0.2 * rate_Hz, stays) << name << site["ticks_in"];
    }
    EXPECT_TRUE(fs::exists(folder() / (name + ".master") / "report.html")) << name;
    EXPECT_TRUE(fs::exists(folder() / (name + ".master") / "log" / "metadata.yaml")) << name << ": its log is closed";
  }
}

/// A run in real time of taps that last, begun.
struct LongRun : Running {
  LongRun(const fs::path& folder, const std::string& experiment, Terminal terminal)
      : Running(folder,
                {"run", experiment, "--realtime", "--json", "--out", "results", "--set", "servo.rate_Hz=1000", "--set",
                 "plant.longest_step_s=5e-5", "--set", "task.observation_s=10", "--priority", "10"},
                "out", terminal) {
    EXPECT_TRUE(eventually([&] {
      std::error_code none;
      return fs::file_size(folder / "results" / "log" / "log.mcap", none) > 100'000 && !none;
    }));
  }
};

TEST_F(ConsoleLost, AnInterruptedRunInRealTimeTellsWhatRan) {
  for (const auto& [number, status] : {std::pair{SIGINT, 130}, {SIGTERM, 143}}) {
    fs::remove_all(folder() / "results");
    LongRun run(folder(), quick_experiment(), Running::Terminal::file);
    run.signal(number);
    EXPECT_EQ(run.wait(), status);
    const auto told = results("results");
    EXPECT_EQ(told["interrupted"]["taps"], 0);
    EXPECT_EQ(told["interrupted"]["of"], 1);
    EXPECT_TRUE(shows("out", "\"interrupted\""));
    EXPECT_TRUE(shows("results/report.html", "Interrupted: 0 of 1 taps")) << "in the report";
    EXPECT_TRUE(fs::exists(folder() / "results" / "log" / "metadata.yaml")) << "the log is closed";
  }
  // The log is whole as far as it goes.
  EXPECT_EQ(tactus({"replay", "results/log", "--check"}).status, 0);
}

TEST_F(ConsoleLost, ASecondSignalEndsAtOnceWhatWaitsForATerminal) {
  LongRun run(folder(), quick_experiment(), Running::Terminal::stalled);
  run.signal(SIGINT);
  EXPECT_TRUE(eventually([&] { return fs::exists(folder() / "results" / "report.html"); }));
  std::this_thread::sleep_for(200ms);
  EXPECT_FALSE(run.ended()) << "it waits for somebody to read what it prints";
  run.signal(SIGTERM);
  EXPECT_EQ(run.wait(), 128 + SIGTERM);
}

/// A slave that nobody hears, which runs until it is ended.
Words lone_slave(int own, int peer, const Words& more) {
  Words all = Pair::words("slave", "lone", own, peer);
  for (auto word = all.begin(); word != all.end(); ++word) {
    if (*word != "--out") continue;
    all.erase(word, word + 2);
    break;
  }
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

TEST_F(ConsoleLost, EverySignalThatCanBeCaughtEndsASiteWithItsReport) {
  const std::map<std::string, int> signals{
      {"SIGQUIT", SIGQUIT}, {"SIGUSR2", SIGUSR2}, {"SIGALRM", SIGALRM}, {"SIGVTALRM", SIGVTALRM}, {"SIGPROF", SIGPROF},
      {"SIGXCPU", SIGXCPU}, {"SIGIO", SIGIO},     {"SIGTSTP", SIGTSTP}, {"SIGPWR", SIGPWR},       {"SIGHUP", SIGHUP}};
  const auto ports = free_ports(2 * signals.size());
  std::map<std::string, Running> sites;
  for (const auto& [name, number] : signals) {
    const std::size_t i = 2 * sites.size();
    sites.try_emplace(name, folder(), lone_slave(ports[i], ports[i + 1], {"--out", name}), name + ".log",
                      Running::Terminal::file);
  }
  for (auto& [name, site] : sites) {
    ASSERT_TRUE(eventually([&, this_name = name] { return shows(this_name + ".log", " align "); })) << name;
    // What a site ignores. The last two stop other programs in the background of a terminal.
    for (const int number : {SIGPIPE, SIGXFSZ, SIGTTIN, SIGTTOU}) site.signal(number);
    site.signal(signals.at(name));
    // Those that come by themselves come more than once; that is not a person who insists.
    if (name == "SIGXCPU") site.signal(SIGXCPU);
  }
  for (auto& [name, site] : sites) {
    EXPECT_EQ(site.wait(), 0) << name;
    EXPECT_EQ(results(name)["ended_by"], name);
    EXPECT_TRUE(fs::exists(folder() / name / "log" / "metadata.yaml")) << name << ": its log is closed";
  }
}

TEST_F(ConsoleLost, ARunInRealTimeThatNobodyCanArmIsEndedByTheSignalThatArms) {
  LongRun run(folder(), quick_experiment(), Running::Terminal::file);
  run.signal(SIGUSR1);
  EXPECT_EQ(run.wait(), 128 + SIGUSR1);
  EXPECT_EQ(results("results")["interrupted"]["taps"], 0);
}

TEST_F(ConsoleLost, ASiteThatIsInterruptedTwiceAtOnceEndsThoughNobodyReadsEitherOutput) {
  const auto ports = free_ports(2);
  Running site(folder(), lone_slave(ports[0], ports[1], {}), "", Running::Terminal::stalled);
  ASSERT_TRUE(eventually([&site] { return site.waits_for(SIGINT); }));
  std::this_thread::sleep_for(1s);
  site.signal(SIGINT);
  std::this_thread::sleep_for(20ms);
  site.signal(SIGINT);
  EXPECT_EQ(site.wait(), 1) << "its results found no reader";
}

/// As services and clusters set it: the log reaches the limit, and the site goes on to its end.
TEST_F(ConsoleLost, ALogThatReachesTheLimitOnFileSizesEndsAloneAndIsSaid) {
  const auto ports = free_ports(2);
  std::string command = "cd '" + folder().string() + "' && ulimit -f 100 && exec \"" TACTUS_COMMAND "\"";
  for (const std::string& word : lone_slave(ports[0], ports[1], {"--out", "full", "--json", "--duration-s", "5"})) {
    command += " '" + word + "'";
  }
  const int status = std::system((command + " >out 2>err </dev/null").c_str());
  ASSERT_TRUE(WIFEXITED(status)) << "signal " << WTERMSIG(status);
  EXPECT_EQ(WEXITSTATUS(status), 1) << content("err");
  EXPECT_TRUE(shows("err", "the log could not be written (File too large)")) << content("err");
  EXPECT_FALSE(shows("err", "ended in a fault")) << content("err");
}

}  // namespace console_lost_test
}  // namespace tactus::cli
