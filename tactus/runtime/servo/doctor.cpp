// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/text.hpp>
#include <tactus/runtime/servo/doctor.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::runtime {

namespace {

constexpr double micro = 1e-3;  ///< from ns to us

Finding unknown(std::string name, std::string means) {
  return {.name = std::move(name),
          .found = "not reported",
          .verdict = Fitness::unknown,
          .means = std::move(means),
          .remedy = {}};
}

Finding scheduler(const MachineFacts& facts) {
  const Right& right = facts.real_time;
  const std::string limit = facts.priority_limit ? ", ulimit -r " + std::to_string(*facts.priority_limit) : "";
  if (right.held) {
    return {"scheduler",
            right.what + " granted" + limit,
            Fitness::good,
            "no program of ordinary priority can delay a control cycle",
            {}};
  }
  return {"scheduler", right.what + " refused: " + right.why + limit, Fitness::bad, right.means, right.remedy};
}

Finding group_budget(const MachineFacts& facts) {
  const std::string name = "budget of the control group";
  if (!facts.group_budget_us) {
    return {name, "none", Fitness::good, "no control group limits real-time threads", {}};
  }
  const std::string found = std::to_string(*facts.group_budget_us) + " us in group " + facts.group;
  if (*facts.group_budget_us != 0) {
    return {name, found, Fitness::good, "the group's real-time threads may use this much of each period", {}};
  }
  return {name, found, Fitness::bad, "the group may not have real-time threads, whoever asks",
          "echo 950000 | sudo tee /sys/fs/cgroup/cpu" + facts.group + "/cpu.rt_runtime_us"};
}

Finding throttling(const MachineFacts& facts) {
  const std::string name = "throttling";
  if (!facts.budget_us || !facts.budget_period_us || *facts.budget_period_us <= 0) {
    return unknown(name, "how long real-time threads may hold a core is not known");
  }
  if (*facts.budget_us < 0) {
    return {name, "off", Fitness::good, "a real-time thread that never sleeps would lock its core up for good", {}};
  }
  const double share = static_cast<double>(*facts.budget_us) / static_cast<double>(*facts.budget_period_us);
  const std::string found = report::number(100.0 * share, 3) + " % of " +
                            report::number(micro * static_cast<double>(*facts.budget_period_us), 3) + " ms";
  const std::string means = "real-time threads that use more are stopped for the rest of the period";
  if (share >= 0.6) return {name, found, Fitness::good, means + "; a servo thread never holds a core that long", {}};
  return {name, found, Fitness::bad, means, "echo 950000 | sudo tee /proc/sys/kernel/sched_rt_runtime_us"};
}

Finding locked_memory(const MachineFacts& facts) {
  const std::string name = "locked memory";
  if (!facts.locked_limit_bytes) return unknown(name, "the limit on locked memory is not known");
  if (*facts.locked_limit_bytes < 0 || facts.superuser) {
    return {name,
            facts.superuser ? "no limit for the superuser" : "no limit",
            Fitness::good,
            "no page of the loop can go to disk",
            {}};
  }
  return {name, report::number(static_cast<double>(*facts.locked_limit_bytes) / 1048576.0, 3) + " MiB", Fitness::poor,
          "memory cannot be locked, or only what is there at the start: under pressure a page comes back late",
          "echo '@users - memlock unlimited' | sudo tee -a /etc/security/limits.d/tactus.conf, then log in again"};
}

Finding kernel(const MachineFacts& facts) {
  const std::string name = "kernel";
  if (facts.kernel.empty()) return unknown(name, "which kernel runs is not known");
  if (facts.preempt_rt) return {name, facts.kernel, Fitness::good, "PREEMPT_RT bounds the time to wake a thread", {}};
  return {name, facts.kernel, Fitness::poor,
          "without PREEMPT_RT the kernel finishes what it does before it wakes a thread: usually tens of microseconds, "
          "now and then milliseconds",
          "sudo apt install linux-image-rt-amd64, then boot it"};
}

Finding sessions(const MachineFacts& facts) {
  const std::string name = "sessions";
  if (facts.autogroup.value_or(0) == 0) {
    return {name, "no share of their own", Fitness::good, "no session keeps the kernel's own threads waiting", {}};
  }
  return {name, "each has its share of a core (autogroup)", Fitness::poor,
          "alongside a session that fills the cores, Linux 6.18 let threads of its own wait for up to 3 s; some of "
          "them carry "
          "the bytes of serial ports, so motors may seem not to respond",
          "sudo sysctl kernel.sched_autogroup_enabled=0"};
}

Finding governor(const MachineFacts& facts) {
  const std::string name = "frequency governor";
  if (facts.governors.empty()) {
    return unknown(name, "no frequency scaling shows: the processor's is fixed, or a hypervisor's affair");
  }
  std::string all;
  for (const std::string& one : facts.governors) all += (all.empty() ? "" : ", ") + one;
  if (all == "performance")
    return {name, all, Fitness::good, "the processor does not slow down between control cycles", {}};
  return {name, all, Fitness::poor, "the processor slows down between control cycles and takes its time to speed up",
          "sudo cpupower frequency-set --governor performance"};
}

Finding timer(const MachineFacts& facts) {
  const std::string name = "timer";
  if (!facts.timer_resolution_ns) return unknown(name, "the resolution of the timers is not known");
  const std::string found =
      "resolution " + std::to_string(*facts.timer_resolution_ns) + " ns" +
      (facts.timer_slack_ns ? ", slack " + report::number(micro * static_cast<double>(*facts.timer_slack_ns), 3) + " us"
                            : "");
  if (*facts.timer_resolution_ns <= 1000) {
    return {name,
            found,
            Fitness::good,
            "deadlines are kept to the nanosecond; a servo thread sets its slack to nothing",
            {}};
  }
  return {name, found, Fitness::bad, "deadlines are rounded to ticks of the kernel", "boot with highres=on"};
}

Finding clock_source(const MachineFacts& facts) {
  const std::string name = "clock";
  if (facts.clock_source.empty()) return unknown(name, "which clock the system reads is not known");
  const bool slow = facts.clock_source == "hpet" || facts.clock_source == "acpi_pm";
  if (!slow) return {name, facts.clock_source, Fitness::good, "the time is read in tens of nanoseconds", {}};
  return {name, facts.clock_source, Fitness::poor, "the time is read from a slow device, about 1 us each time",
          "boot with clocksource=tsc tsc=reliable, where the processor's counter is steady"};
}

Finding cores(const MachineFacts& facts) {
  const std::string name = "cores";
  const std::string found =
      std::to_string(facts.cores) + (facts.isolated.empty() ? ", none isolated" : ", isolated " + facts.isolated);
  if (facts.cores > 1) {
    return {name,
            found,
            Fitness::good,
            facts.isolated.empty()
                ? "the log has a core other than the servo thread's; isolating one keeps others off it"
                : "choose an isolated core with --core",
            {}};
  }
  return {name, found, Fitness::poor, "log, console and servo thread share one core", "taskset -c 0-1 tactus ..."};
}

Finding hypervisor(const MachineFacts& facts, const Measurement& measurement) {
  const std::string name = "hypervisor";
  const double stolen = measurement.stolen_fraction.value_or(0.0);
  if (!facts.hypervisor && stolen == 0.0) {
    return {name, "none", Fitness::good, "nobody takes the processor away", {}};
  }
  const std::string found =
      measurement.stolen_fraction ? "took " + report::number(100.0 * stolen, 2) + " % while measuring" : "one is there";
  constexpr double tolerable = 0.05;
  return {name, found, stolen > tolerable ? Fitness::bad : Fitness::poor,
          "a hypervisor takes the processor away for milliseconds when it likes: no deadline is sure here",
          "run on a machine of your own"};
}

Finding lateness(const Measurement& measurement) {
  const ServoReport& report = measurement.report;
  const double period_us = micro * static_cast<double>(report.period_ns);
  const auto quantile_us = [&](double q) { return micro * report.lateness.quantile_ns(q); };
  Finding finding{
      .name = "lateness",
      .found = "p50 " + report::number(quantile_us(0.5), 3) + ", p99 " + report::number(quantile_us(0.99), 3) +
               ", p99.9 " + report::number(quantile_us(0.999), 3) + ", worst " + report::number(quantile_us(1.0), 3) +
               " us; " + std::to_string(report.missed) + " of " + std::to_string(report.ticks + report.missed) +
               " control cycles missed",
      .verdict = Fitness::good,
      .means = "a control cycle starts this long after it is due, of " + report::number(period_us, 3) + " us",
      .remedy = {}};
  const double missed =
      static_cast<double>(report.missed) / static_cast<double>(std::max<std::int64_t>(report.ticks, 1));
  constexpr double tolerable = 1e-3;
  if (missed > tolerable) {
    finding.verdict = Fitness::bad;
    finding.remedy = "fix what is listed above, or lower servo.rate_Hz";
  } else if (report.missed > 0 || quantile_us(0.999) > 0.25 * period_us) {
    finding.verdict = Fitness::poor;
    finding.remedy = "fix what is listed above";
  }
  return finding;
}

}  // namespace

Result<Measurement> measure_lateness(const ServoThreadParams& params, double duration_s) {
  const auto before = read_stolen();
  const auto last = static_cast<std::int64_t>(std::llround(duration_s * params.rate_Hz));
  auto report = run_servo(params, [last](const station::Tick& tick) noexcept { return tick.number < last; });
  if (!report) return report.error();
  Measurement measurement{.report = *std::move(report), .stolen_fraction = {}};
  const auto after = read_stolen();
  if (before && after && after->total > before->total) {
    measurement.stolen_fraction =
        static_cast<double>(after->stolen - before->stolen) / static_cast<double>(after->total - before->total);
  }
  return measurement;
}

std::vector<Finding> diagnose(const MachineFacts& facts, const Measurement& measurement) {
  return {scheduler(facts),
          group_budget(facts),
          throttling(facts),
          locked_memory(facts),
          timer(facts),
          clock_source(facts),
          kernel(facts),
          sessions(facts),
          governor(facts),
          cores(facts),
          hypervisor(facts, measurement),
          lateness(measurement)};
}

bool can_keep_time(const std::vector<Finding>& findings) {
  return std::none_of(findings.begin(), findings.end(),
                      [](const Finding& finding) { return finding.verdict == Fitness::bad; });
}

}  // namespace tactus::runtime
