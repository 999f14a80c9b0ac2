// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/machine_facts.hpp>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>

#include <sched.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/utsname.h>
#include <time.h>
#include <unistd.h>

namespace tactus::runtime {

namespace {

std::string first_line(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

std::optional<std::int64_t> whole_number(const std::string& text) {
  std::int64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc{} || end == text.data()) return std::nullopt;
  return number;
}

std::optional<std::int64_t> number_in(const std::filesystem::path& file) { return whole_number(first_line(file)); }

std::optional<std::int64_t> limit_of(int resource) {
  rlimit limit{};
  if (getrlimit(static_cast<__rlimit_resource_t>(resource), &limit) != 0) return std::nullopt;
  return limit.rlim_cur == RLIM_INFINITY ? -1 : static_cast<std::int64_t>(limit.rlim_cur);
}

/// The group of the `cpu` controller, where control groups of version 1 have a budget for real-time threads:
/// `4:cpu,cpuacct:/user.slice`.
void read_group(const std::filesystem::path& root, MachineFacts& facts) {
  std::ifstream groups(root / "proc/self/cgroup");
  for (std::string line; std::getline(groups, line);) {
    const auto first = line.find(':');
    const auto second = line.find(':', first + 1);
    if (first == std::string::npos || second == std::string::npos) continue;
    const std::string controllers = line.substr(first + 1, second - first - 1);
    if (("," + controllers + ",").find(",cpu,") == std::string::npos) continue;
    facts.group = line.substr(second + 1);
    const auto base = root / "sys/fs/cgroup" / controllers;
    // In a container the path may lie outside of what is mounted.
    for (const auto& folder : {base / std::filesystem::path(facts.group).relative_path(), base}) {
      facts.group_budget_us = number_in(folder / "cpu.rt_runtime_us");
      if (facts.group_budget_us) return;
    }
  }
}

std::vector<std::string> governors(const std::filesystem::path& root) {
  std::vector<std::string> found;
  std::error_code ignored;
  for (const auto& core : std::filesystem::directory_iterator(root / "sys/devices/system/cpu", ignored)) {
    std::string governor = first_line(core.path() / "cpufreq/scaling_governor");
    if (!governor.empty()) found.push_back(std::move(governor));
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

bool under_hypervisor(const std::filesystem::path& root) {
  std::ifstream cores(root / "proc/cpuinfo");
  for (std::string line; std::getline(cores, line);) {
    if (line.starts_with("flags") && (line + " ").find(" hypervisor ") != std::string::npos) return true;
  }
  return false;
}

}  // namespace

MachineFacts read_machine_facts(int priority, const std::filesystem::path& root) {
  MachineFacts facts;
  facts.real_time = try_real_time(priority);
  facts.priority_limit = limit_of(RLIMIT_RTPRIO);
  facts.superuser = geteuid() == 0;
  facts.locked_limit_bytes = limit_of(RLIMIT_MEMLOCK);
  read_group(root, facts);
  facts.budget_us = number_in(root / "proc/sys/kernel/sched_rt_runtime_us");
  facts.budget_period_us = number_in(root / "proc/sys/kernel/sched_rt_period_us");
  facts.autogroup = number_in(root / "proc/sys/kernel/sched_autogroup_enabled");
  facts.governors = governors(root);

  timespec resolution{};
  if (clock_getres(CLOCK_MONOTONIC, &resolution) == 0) {
    facts.timer_resolution_ns = resolution.tv_sec * 1'000'000'000 + resolution.tv_nsec;
  }
  if (const int slack_ns = prctl(PR_GET_TIMERSLACK, 0UL, 0UL, 0UL, 0UL); slack_ns >= 0) facts.timer_slack_ns = slack_ns;
  facts.clock_source = first_line(root / "sys/devices/system/clocksource/clocksource0/current_clocksource");

  utsname system{};
  if (uname(&system) == 0) facts.kernel = std::string(system.release) + " " + system.version;
  facts.preempt_rt = number_in(root / "sys/kernel/realtime") == std::optional<std::int64_t>(1) ||
                     facts.kernel.find("PREEMPT_RT") != std::string::npos;

  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof(allowed), &allowed) == 0) facts.cores = CPU_COUNT(&allowed);
  facts.isolated = first_line(root / "sys/devices/system/cpu/isolated");
  facts.hypervisor = under_hypervisor(root);
  return facts;
}

std::optional<Stolen> read_stolen(const std::filesystem::path& root) {
  std::istringstream line(first_line(root / "proc/stat"));
  std::string name;
  line >> name;
  if (name != "cpu") return std::nullopt;
  constexpr int stolen_column = 7;
  constexpr int columns = 8;  // those behind are part of the first two
  Stolen found;
  std::int64_t value = 0;
  int column = 0;
  for (; column < columns && line >> value; ++column) {
    found.total += value;
    if (column == stolen_column) found.stolen = value;
  }
  if (column < columns) return std::nullopt;
  return found;
}

}  // namespace tactus::runtime
