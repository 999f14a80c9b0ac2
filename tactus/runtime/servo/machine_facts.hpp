// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/runtime/servo/servo_thread.hpp>

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace tactus::runtime {

/// What can be read of a machine that is to keep time; empty where the system does not report it.
struct MachineFacts {
  Right real_time;                             ///< SCHED_FIFO, as tried
  std::optional<std::int64_t> priority_limit;  ///< `ulimit -r`
  bool superuser = false;
  std::optional<std::int64_t> locked_limit_bytes;  ///< `ulimit -l`; −1: no limit
  std::string group;                               ///< control group that has the budget
  std::optional<std::int64_t> group_budget_us;     ///< real-time budget of the control group
  std::optional<std::int64_t> budget_us;           ///< of all real-time threads in each period; −1 is no limit
  std::optional<std::int64_t> budget_period_us;
  std::optional<std::int64_t> autogroup;  ///< whether each session has its own share of a core (man 7 sched): 0 or 1
  std::vector<std::string> governors;     ///< of the cores, each once
  std::optional<std::int64_t> timer_resolution_ns;
  std::optional<std::int64_t> timer_slack_ns;
  std::string clock_source;
  std::string kernel;  ///< release and version
  bool preempt_rt = false;
  std::int64_t cores = 0;  ///< that this process may run on
  std::string isolated;    ///< cores kept free of other programs
  bool hypervisor = false;
};

/// Reads them, the files under `root`. Not real-time safe.
MachineFacts read_machine_facts(int priority, const std::filesystem::path& root = "/");

/// Time that a hypervisor took away from all cores, in ticks of 10 ms since the start of the machine, and the time of
/// all cores in the same unit.
struct Stolen {
  std::int64_t stolen = 0;
  std::int64_t total = 0;
};
std::optional<Stolen> read_stolen(const std::filesystem::path& root = "/");

}  // namespace tactus::runtime
