// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include <malloc.h>
#include <tests/soak/day.hpp>
#include <unistd.h>

namespace tactus::soak {

namespace {

/// A sum that keeps what its additions lose (A. Neumaier, ZAMM 54, 1974).
class CompensatedSum {
 public:
  void add(double value) {
    const double sum = sum_ + value;
    lost_ += std::fabs(sum_) >= std::fabs(value) ? (sum_ - sum) + value : (value - sum) + sum_;
    sum_ = sum;
  }
  [[nodiscard]] double value() const { return sum_ + lost_; }

 private:
  double sum_ = 0.0, lost_ = 0.0;
};

/// The account that `[gate.energy]` promises, in wider numbers, and the energy that it is the account of. It reads what
/// reaches the motor and what the encoder says.
class Account {
 public:
  Account(const control::PassivityMonitor::Params& params, double tick_s)
      : credit_J_(params.credit_J), drain_J_(static_cast<long double>(params.drain_W) * tick_s) {}

  /// The force since the tick before worked along the way to this reading. Returns that work.
  double see(double position_m, double force_N) {
    const double work_J = started_ ? force_N_ * (position_m - position_m_) : 0.0;
    account_J_ = std::max(account_J_ + static_cast<long double>(work_J), -credit_J_);
    if (account_J_ > 0.0L) account_J_ = std::max(account_J_ - drain_J_, 0.0L);
    gave_.add(work_J);
    started_ = true;
    position_m_ = position_m;
    force_N_ = force_N;
    return work_J;
  }
  /// The gate was re-armed: an empty account.
  void empty() {
    account_J_ = 0.0L;
    started_ = false;
  }
  [[nodiscard]] double account_J() const { return static_cast<double>(account_J_); }
  [[nodiscard]] double gave_J() const { return gave_.value(); }

 private:
  long double credit_J_, drain_J_, account_J_ = 0.0L;
  CompensatedSum gave_;
  double position_m_ = 0.0, force_N_ = 0.0;
  bool started_ = false;
};

std::int64_t heap_bytes() { return static_cast<std::int64_t>(mallinfo2().uordblks); }

std::int64_t resident_bytes() {
  long long pages = 0, resident = 0;
  std::FILE* file = std::fopen("/proc/self/statm", "r");
  if (file == nullptr || std::fscanf(file, "%lld %lld", &pages, &resident) != 2) resident = 0;
  if (file != nullptr) std::fclose(file);
  return resident * sysconf(_SC_PAGESIZE);
}

/// Each figure of a period, with its bound.
struct Figure {
  double Period::*of;
  double PeriodBounds::*bound;
  const char* differs;
};
constexpr std::array figures{
    Figure{&Period::peak_master_N, &PeriodBounds::force_N, "the master's peak force is not what it was"},
    Figure{&Period::peak_tip_N, &PeriodBounds::force_N, "the tip's peak force is not what it was"},
    Figure{&Period::farthest_m, &PeriodBounds::position_m, "the slave's farthest position is not what it was"},
    Figure{&Period::nearest_m, &PeriodBounds::position_m, "the slave's nearest position is not what it was"},
    Figure{&Period::master_gave_J, &PeriodBounds::energy_J, "the energy of the master's motor is not what it was"},
    Figure{&Period::slave_gave_J, &PeriodBounds::energy_J, "the energy of the slave's motor is not what it was"}};

/// Means of periods.
class Means {
 public:
  void add(const Period& period) {
    for (std::size_t i = 0; i < figures.size(); ++i) sums_[i].add(period.*figures[i].of);
    ++count_;
  }
  [[nodiscard]] std::int64_t count() const { return count_; }
  [[nodiscard]] Period value() const {
    Period mean;
    for (std::size_t i = 0; i < figures.size(); ++i) {
      mean.*figures[i].of = sums_[i].value() / static_cast<double>(count_);
    }
    return mean;
  }

 private:
  std::array<CompensatedSum, figures.size()> sums_;
  std::int64_t count_ = 0;
};

class Day {
 public:
  Day(TwoSites sites, const simulation::Teleoperator::Params& params, const Origin& origin)
      : sites_(std::move(sites)),
        origin_(origin),
        gates_{params.control.gate.energy, params.control.slave_gate.energy},
        accounts_{Account(gates_[0], sites_.tick_s()), Account(gates_[1], sites_.tick_s())} {}

  DayReport run(double seconds, int hours, const std::function<void(const DayProgress&)>& progress);

 private:
  void expect(bool good, const char* what) {
    if (good) return;
    if (report_.broken.size() < 10) {
      report_.broken.push_back(std::string(what) + ", at " +
                               std::to_string(static_cast<double>(sites_.ticks()) * sites_.tick_s()) + " s");
    }
    ++broken_;
  }
  void look(const TwoSites::Seen& seen);
  void watch(const control::SiteRecord& record, std::size_t site, double heard_age_s, std::int64_t peer_session);
  void expect_near(const Period& period, const PeriodBounds& bounds);
  void end_period();
  void end_hour();

  TwoSites sites_;
  Origin origin_;
  std::array<control::PassivityMonitor::Params, 2> gates_;
  std::array<Account, 2> accounts_;
  DayReport report_;
  Period period_;
  Means means_;  ///< of this hour
  std::int64_t periods_ = 0;
  std::int64_t broken_ = 0;
  bool in_first_hour_ = true;
  std::array<std::uint64_t, 2> limits_{};        ///< a bit for each that was active in the first hour
  std::array<std::int64_t, 2> refused_{-1, -1};  ///< once active
  std::array<std::int64_t, 2> applied_{};
  std::int64_t heap_ = 0, resident_ = 0;
};

/// What every tick of a site must show once both are active.
void Day::watch(const control::SiteRecord& record, std::size_t site, double heard_age_s, std::int64_t peer_session) {
  expect(record.state == static_cast<std::int64_t>(control::SiteState::active), "a site left active");
  expect(record.cause == 0, "a site has a cause");
  expect(record.fault == 0, "a gate latched");
  expect(record.fresh, "no packet was applied");
  expect(record.applied_session == peer_session, "a wrong session was applied");
  // The master hears what the slave sent a tick before.
  const std::int64_t sent = site == 0 ? sites_.ticks() - 1 : sites_.ticks();
  expect(record.applied_sequence == origin_.sequence + sent, "a wrong sequence was applied");
  if (refused_[site] < 0) refused_[site] = record.refused;
  expect(record.refused == refused_[site], "a packet was refused");
  const double half_tick_s = 0.5 * sites_.tick_s();
  expect(std::fabs(heard_age_s - half_tick_s) < 2e-9, "an age is wrong");
  const std::uint64_t limit = std::uint64_t{1} << record.limit;
  if (in_first_hour_) limits_[site] |= limit;
  expect((limits_[site] & limit) != 0, "a limit that was not there before");
  const double wrong_J = std::fabs(record.given_J - accounts_[site].account_J());
  report_.account_error_J = std::max(report_.account_error_J, wrong_J);
  expect(record.given_J >= -gates_[site].credit_J && record.given_J <= gates_[site].damp_above_J,
         "a monitor's account left its band");
}

void Day::look(const TwoSites::Seen& seen) {
  const double master_m = seen.master.reading.position_m, slave_m = seen.slave.reading.position_m;
  if (!sites_.active() || periods_ == 0) {
    // The account is emptied when a site is armed; until the first period is over it catches up with that.
    if (seen.master.output.record.given_J == 0.0) accounts_[0].empty();
    if (seen.slave.output.record.given_J == 0.0) accounts_[1].empty();
  }
  period_.master_gave_J += accounts_[0].see(master_m, seen.master.output.site.motor_force_N);
  period_.slave_gave_J += accounts_[1].see(slave_m, seen.slave.output.site.motor_force_N);
  period_.peak_master_N = std::max(period_.peak_master_N, std::fabs(seen.master.output.site.motor_force_N));
  period_.peak_tip_N = std::max(period_.peak_tip_N, std::fabs(seen.slave.reading.force_N));
  period_.farthest_m = std::max(period_.farthest_m, slave_m);
  period_.nearest_m = std::min(period_.nearest_m, slave_m);
  applied_[0] += seen.master.output.record.fresh;
  applied_[1] += seen.slave.output.record.fresh;
  report_.told_energy_J = seen.slave.output.packet.message.energy_J;
  if (periods_ == 0) return;
  watch(seen.master.output.record, 0, seen.master_heard_age_s, origin_.slave_session);
  watch(seen.slave.output.record, 1, seen.slave_heard_age_s, origin_.master_session);
}

void Day::expect_near(const Period& period, const PeriodBounds& bounds) {
  for (const Figure& figure : figures) {
    expect(std::fabs(period.*figure.of - report_.first.*figure.of) <= bounds.*figure.bound, figure.differs);
  }
}

void Day::end_period() {
  // In the first one the sites were armed.
  if (periods_ == 1) report_.least = report_.most = period_;
  if (periods_ > 0) {
    means_.add(period_);
    for (const Figure& figure : figures) {
      report_.least.*figure.of = std::min(report_.least.*figure.of, period_.*figure.of);
      report_.most.*figure.of = std::max(report_.most.*figure.of, period_.*figure.of);
    }
    if (!in_first_hour_) expect_near(period_, one_period);
  }
  ++periods_;
  period_ = {};
}

void Day::end_hour() {
  expect(means_.count() > 0, "an hour is shorter than a period of the person's path");
  report_.last = means_.value();
  if (in_first_hour_) {
    report_.first = report_.last;
    heap_ = heap_bytes();
    resident_ = resident_bytes();
  }
  expect_near(report_.last, mean_period);
  for (const Figure& figure : figures) {
    const double off = std::fabs(report_.last.*figure.of - report_.first.*figure.of);
    report_.farthest_mean.*figure.of = in_first_hour_ ? 0.0 : std::max(report_.farthest_mean.*figure.of, off);
  }
  means_ = {};
  in_first_hour_ = false;
  report_.heap_growth = heap_bytes() - heap_;
  report_.resident_growth = resident_bytes() - resident_;
  expect(report_.heap_growth <= 0, "the heap grew");
  // Pages of the program itself that are read late count too.
  expect(report_.resident_growth <= 512 * 1024, "resident memory grew");
}

DayReport Day::run(double seconds, int hours, const std::function<void(const DayProgress&)>& progress) {
  const auto ticks = static_cast<std::int64_t>(std::llround(seconds / sites_.tick_s()));
  static_cast<void>(resident_bytes());  // the first reading of a file leaves a buffer behind
  for (int hour = 1; hour <= hours; ++hour) {
    const std::int64_t end = ticks * hour / hours;
    while (sites_.ticks() < end) {
      look(sites_.step());
      if (sites_.ticks() % sites_.period_ticks() == 0) end_period();
    }
    end_hour();
    progress({.virtual_s = static_cast<double>(end) * sites_.tick_s(), .all_s = seconds});
  }
  report_.ticks = sites_.ticks();
  report_.master_gave_J = accounts_[0].gave_J();
  report_.slave_gave_J = accounts_[1].gave_J();
  expect(report_.account_error_J <= 1e-9, "a monitor's account differs from an independent one");
  // The link begins with a greeting each way, and an age is known only after the first echo.
  constexpr std::int64_t start = 4;
  for (const End* end : {&sites_.master_end(), &sites_.slave_end()}) {
    const auto& counters = end->inbound().counters();
    expect(counters.repeated == 0 && counters.reflected == 0 && counters.foreign == 0 && counters.sessions == 1 &&
               end->malformed() == 0,
           "the link counted what nobody sent");
    expect(static_cast<std::int64_t>(counters.counted) >= ticks - start &&
               end->inbound().expected() == end->inbound().arrived(),
           "the link lost packets");
  }
  expect(std::min(applied_[0], applied_[1]) >= ticks - start && std::max(applied_[0], applied_[1]) <= ticks,
         "not every packet was applied");
  report_.passed = broken_ == 0;
  return std::move(report_);
}

}  // namespace

DayReport run_day(const simulation::Teleoperator::Params& params, const Origin& origin, double seconds, int hours,
                  const std::function<void(const DayProgress&)>& progress) {
  auto sites = TwoSites::make(params, origin);
  if (!sites) return {.broken = {describe(sites.error())}};
  return Day(*std::move(sites), params, origin).run(seconds, hours, progress);
}

}  // namespace tactus::soak
