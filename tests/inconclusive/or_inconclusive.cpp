// SPDX-License-Identifier: Apache-2.0
// or_inconclusive PROGRAM [ARGUMENT...]: runs a real-time test. Where the test fails and the machine was late or busy
// meanwhile, it is run again, up to three times in all. If that was so each time, the result is neither a pass nor a
// failure: the status is 77, which CTest shows as skipped, and the last line starts with "inconclusive". A test that
// fails on a machine that was on time has failed. The test has no say in it: this process sleeps for 10 ms at a time
// and measures by how much it wakes late, and the kernel counts the time in which any thread waited for a processor.
//
// Of a GoogleTest program that runs many cases, only those that failed are run again, and the line before the last
// names them as "cases: A.b:C.d". TACTUS_CASES, set to such names, runs these alone. What a sanitizer reports is a
// failure on any machine.

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

namespace {

using Clock = std::chrono::steady_clock;

constexpr auto nap = std::chrono::milliseconds(10);
/// A machine that is this late gave the test no fair chance: rigs of the tests take a motor for lost that did not
/// answer for 20 to 30 ms, and the threads that emulate motors wait for their turn as this process does.
constexpr auto late = std::chrono::milliseconds(20);
/// A sleeper is woken in time on a busy machine, on which threads that compute fall behind.
constexpr double busy_share = 0.2;
constexpr int most_runs = 3;
constexpr int inconclusive = 77;
/// The status of a program in which a sanitizer found something.
constexpr int sanitizer_report = 99;

struct Run {
  int status = 0;  ///< as a shell has it
  Clock::duration lateness{};
  double waiting_share = 0.0;  ///< of the time, in which a thread of the machine waited for a processor
  [[nodiscard]] bool excused() const { return lateness >= late || waiting_share >= busy_share; }
};

/// What the kernel counts of the time in which a thread waited for a processor; zeros where it does not.
struct Waiting {
  double lately_share = 0.0;                ///< of the last ten seconds
  std::chrono::microseconds since_start{};  ///< of the machine; brought up to date every two seconds
};

Waiting waiting() {
  std::ifstream pressure("/proc/pressure/cpu");
  Waiting found;
  std::string word;
  const auto number = [&word] { return word.substr(word.find('=') + 1); };
  while (pressure >> word) {
    if (word.starts_with("avg10=")) found.lately_share = 1e-2 * std::stod(number());
    if (!word.starts_with("total=")) continue;
    found.since_start = std::chrono::microseconds(std::stoll(number()));
    break;
  }
  return found;
}

Run run(char** command) {
  const auto start = Clock::now();
  const Waiting at_start = waiting();
  auto before = start;
  const pid_t child = fork();
  if (child == 0) {
    execvp(command[0], command);
    std::perror(command[0]);
    _exit(127);
  }
  if (child < 0) {
    std::perror("fork");
    return {.status = 126};
  }
  Run done;
  int ended = 0;
  const auto measure = [&] {
    const auto now = Clock::now();
    done.lateness = std::max(done.lateness, now - before - nap);
    before = now;
  };
  while (waitpid(child, &ended, WNOHANG) == 0) {
    std::this_thread::sleep_for(nap);
    measure();
  }
  measure();
  const Waiting at_end = waiting();
  const std::chrono::duration<double> waited = at_end.since_start - at_start.since_start, all = before - start;
  done.waiting_share = std::max(std::min(waited / all, 1.0), at_end.lately_share);
  done.status = WIFEXITED(ended) ? WEXITSTATUS(ended) : 128 + WTERMSIG(ended);
  return done;
}

/// The value of an XML attribute, or nothing.
std::string_view attribute(std::string_view tag, std::string_view name) {
  const std::string opening = " " + std::string(name) + "=\"";
  const auto found = tag.find(opening);
  if (found == std::string_view::npos) return {};
  tag.remove_prefix(found + opening.size());
  return tag.substr(0, tag.find('"'));
}

/// The cases that failed, separated by colons, as GoogleTest's XML report has them; empty where there is no report.
std::string failed_cases(const std::filesystem::path& report) {
  std::ifstream file(report);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  std::string_view rest = text;
  std::string failed;
  constexpr std::string_view opening = "<testcase ";
  for (auto found = rest.find(opening); found != std::string_view::npos; found = rest.find(opening)) {
    rest.remove_prefix(found + opening.size() - 1);
    const std::string_view tag = rest.substr(0, rest.find('>')), until_next = rest.substr(0, rest.find(opening));
    if (until_next.find("<failure ") == std::string_view::npos) continue;
    if (!failed.empty()) failed += ':';
    failed.append(attribute(tag, "classname")).append(".").append(attribute(tag, "name"));
  }
  return failed;
}

/// From now on the program runs these cases alone.
void run_only(const std::string& cases) {
  setenv("GTEST_FILTER", cases.c_str(), 1);
  unsetenv("GTEST_TOTAL_SHARDS");
  unsetenv("GTEST_SHARD_INDEX");
}

void ask_for_sanitizer_status() {
  for (const char* const name : std::array{"ASAN_OPTIONS", "LSAN_OPTIONS", "UBSAN_OPTIONS", "TSAN_OPTIONS"}) {
    const char* const before = std::getenv(name);
    setenv(name, ((before ? std::string(before) + ":" : "") + "exitcode=" + std::to_string(sanitizer_report)).c_str(),
           1);
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fputs("usage: or_inconclusive PROGRAM [ARGUMENT...]\n", stderr);
    return 2;
  }
  ask_for_sanitizer_status();
  if (const char* const cases = std::getenv("TACTUS_CASES")) run_only(cases);
  const std::filesystem::path report =
      std::filesystem::temp_directory_path() / ("or_inconclusive-" + std::to_string(getpid()) + ".xml");
  setenv("GTEST_OUTPUT", ("xml:" + report.string()).c_str(), 1);
  std::string cases;
  for (int runs = 1;; ++runs) {
    const Run done = run(argv + 1);
    if (const std::string failed = failed_cases(report); !failed.empty()) {
      cases = failed;
      run_only(cases);
    }
    std::error_code gone;
    std::filesystem::remove(report, gone);
    if (done.status == 0 || done.status == inconclusive || done.status == sanitizer_report) return done.status;
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(done.lateness).count();
    const std::string machine = "the machine was late by up to " + std::to_string(ms) +
                                " ms, and some thread waited for a processor " +
                                std::to_string(std::lround(1e2 * done.waiting_share)) + " % of the time";
    if (!done.excused()) {
      std::fprintf(stderr, "failed: %s\n", machine.c_str());
      return done.status;
    }
    if (runs == most_runs) {
      if (!cases.empty()) std::fprintf(stderr, "cases: %s\n", cases.c_str());
      std::fprintf(stderr, "inconclusive: %s; so it was in each of %d runs\n", machine.c_str(), most_runs);
      return inconclusive;
    }
    std::fprintf(stderr, "%s: %s once more\n", machine.c_str(),
                 cases.empty() ? "the test runs" : "the cases that failed run");
  }
}
