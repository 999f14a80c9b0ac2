// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/supervised_site.hpp>
#include <tactus/kernel/station/step.hpp>
#include <tactus/simulation/experiments/faults/fault_operator.hpp>
#include <tactus/simulation/experiments/faults/faulty_configuration.hpp>
#include <tactus/simulation/experiments/faults/faulty_site.hpp>
#include <tactus/simulation/experiments/faults/handle.hpp>
#include <tactus/simulation/experiments/faults/injection.hpp>
#include <tactus/simulation/experiments/faults/judge.hpp>
#include <tactus/simulation/experiments/faults/pairs.hpp>
#include <tactus/simulation/experiments/faults/run.hpp>
#include <tactus/simulation/teleoperator/site_plants.hpp>

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <utility>
#include <vector>

namespace tactus::experiments {

namespace {

/// A motor that gives less than this share of its limit has let go.
constexpr double released_share = 0.05;
/// How far a device may coast beyond where its gate latches a fault, as a factor.
constexpr double coasting = 1.1;
/// A force that is wrong for less than this is hardly wrong.
constexpr double slowly_s = 0.02;
}  // namespace

class FaultRun::Run {
 public:
  static Result<Run> make(const simulation::Teleoperator::Params& params, const FaultPlan& plan);
  bool step(std::int64_t missed) noexcept;
  [[nodiscard]] const FaultOutcome& outcome() const { return outcome_; }

 private:
  using Master = FaultySite<simulation::MasterPlant, control::SupervisedMaster>;
  using Slave = FaultySite<simulation::SlavePlant, control::SupervisedSlave>;

  Run(const simulation::Teleoperator::Params& params, const FaultPlan& plan, const FaultOperator& person,
      const simulation::Clock& clock, Master master, Slave slave)
      : params_(params),
        plan_(plan),
        clock_(clock),
        tick_s_(clock.tick_s),
        injections_(injections_of(plan, tick_s_)),
        person_(person),
        handle_(params.person.grip),
        master_(std::move(master)),
        slave_(std::move(slave)),
        at_master_(witness_of(params.control.gate, tick_s_)),
        at_handle_(witness_of(params.control.handle_gate, tick_s_)),
        at_slave_(witness_of(params.control.slave_gate, tick_s_)),
        judge_({person.wall_m(), person.depth_m(), released_share * params.control.gate.force_limit_N, tick_s_},
               {params.environment.position_m, params.control.position_scale * person.depth_m(),
                released_share * params.control.slave_gate.force_limit_N, tick_s_},
               tick_s_),
        misread_slowly_(slowly_s, tick_s_),
        misdriven_slowly_(slowly_s, tick_s_) {
    ticks_ = std::lround((end_s() + fault_schedule::end_after_s) / tick_s_);
    master_.sent.expect(master_.restarted.size() + 1, ticks_);
    slave_.sent.expect(slave_.restarted.size() + 1, ticks_);
  }

  static ForceWitness witness_of(const auto& gate, double tick_s) {
    return {gate.force_limit_N, gate.rate_limit_N_per_s, gate.stop_time_s, tick_s};
  }
  static std::vector<FaultInjection> injections_of(const FaultPlan& plan, double tick_s) {
    std::vector<FaultInjection> injections;
    for (const FaultPlan& part : plans_of(plan)) injections.emplace_back(part, tick_s);
    return injections;
  }
  /// The oldest that may be applied. Of a way that takes longer than the other half passes for an offset of clocks; and
  /// a clock that loses ticks does not count how long a packet waits meanwhile.
  static double oldest_s(const simulation::Teleoperator::Params& params, const FaultPlan& plan, double tick_s) {
    const double factor = plan.kind == FaultKind::delay_asymmetric ? 2.0 : 1.0;
    double waits_ticks = 0.0;
    for (const FaultSite site : {FaultSite::master, FaultSite::slave}) {
      double longest_ticks = 1.0;  // from one step to the next
      for (const FaultPlan& part : plans_of(plan)) {
        if (part.kind == FaultKind::rate_drift && part.site == site)
          longest_ticks *= std::ceil(1.0 / (1.0 - part.size));
      }
      waits_ticks += longest_ticks - 1.0;
    }
    return factor * params.control.supervision.packets.longest_age_s + tick_s * waits_ticks;
  }
  template <class Site, class Make>
  static Result<std::pair<Site, std::vector<Site>>> starts(const FaultPlan& plan, const Make& make);
  /// A way whose packets the network treats as every part of the plan says.
  static simulation::PacketRelay relay(const FaultPlan& plan, std::uint64_t way, double tick_s) {
    std::vector<simulation::ImpairedLink> links;
    double longest_s = 0.0;
    signal::Random random = signal::Random(static_cast<std::uint64_t>(plan.seed)).fork(way);
    for (const FaultPlan& part : plans_of(plan)) {
      links.emplace_back(part.impairment, links.empty() ? random : random.fork(links.size()));
      longest_s += part.impairment.delay_s + part.impairment.jitter_s;
    }
    return {links, longest_s, tick_s};
  }
  [[nodiscard]] auto share_to(FaultSite site) const {
    return [this, site](std::size_t part) { return injections_[part].impaired_share(site); };
  }
  [[nodiscard]] const FaultMoment& moment() const { return injections_.front().moment(); }
  [[nodiscard]] double end_s() const {
    double latest_s = 0.0;
    for (const FaultInjection& injection : injections_) latest_s = std::max(latest_s, injection.span().end_s());
    return latest_s;
  }
  [[nodiscard]] bool cut() const {
    return std::any_of(injections_.begin(), injections_.end(), [](const auto& injection) { return injection.cuts(); });
  }

  control::SiteRequests requests(FaultSite site) const;
  void spoil(station::DeviceReading& reading, FaultSite site);
  double drive(double told_N, bool enabled, FaultSite site);
  template <class Here, class There>
  struct Transport;
  template <class Here, class There>
  void step_site(Here& here, There& there);
  void advance();
  void judge();
  bool tick(bool missed);

  simulation::Teleoperator::Params params_;
  FaultPlan plan_;
  simulation::Clock clock_;
  double tick_s_;
  std::vector<FaultInjection> injections_;  ///< all that goes wrong; the first counts for the judge
  FaultOperator person_;
  FaultHandle handle_;
  Master master_;
  Slave slave_;
  ForceWitness at_master_, at_handle_, at_slave_;
  FaultJudge judge_;
  FaultOutcome outcome_;
  double misread_N_ = 0.0;  ///< of the tip's force, by a fault
  Lasting misread_slowly_, misdriven_slowly_;
  std::int64_t tick_ = 0;
  std::int64_t ticks_ = 0;
  bool missed_ = false;  ///< at this tick no site is stepped
};

/// A site, and one for each time that a fault starts its process again, the first of these last: a run that goes on
/// allocates nothing. `make` is told the session.
template <class Site, class Make>
Result<std::pair<Site, std::vector<Site>>> FaultRun::Run::starts(const FaultPlan& plan, const Make& make) {
  auto first = make(1);
  if (!first) return first.error();
  std::vector<Site> restarted;
  const auto plans = plans_of(plan);
  for (auto session = static_cast<std::int64_t>(plans.size()) + 1; session > 1; --session) {
    auto again = make(session);
    if (!again) return again.error();
    restarted.push_back(*std::move(again));
  }
  return std::pair(*std::move(first), std::move(restarted));
}

Result<FaultRun::Run> FaultRun::Run::make(const simulation::Teleoperator::Params& params, const FaultPlan& plan) {
  const auto clock = simulation::Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  const Seconds tick{clock->tick_s};
  const FaultOperator person(plan, params.environment.position_m / params.control.position_scale,
                             params.control.supervision.probe.force_N > 0.0);
  const double start_m = person.path_m(0.0);
  auto master = simulation::MasterPlant::make(params.master, params.person, *clock, start_m);
  if (!master) return master.error();
  auto slave =
      simulation::SlavePlant::make(params.slave, params.environment, *clock, params.control.position_scale * start_m);
  if (!slave) return slave.error();
  const FaultyConfiguration of_master(params.control, tick, plan, FaultSite::master);
  auto master_sites = starts<control::SupervisedMaster>(plan, [&](std::int64_t session) {
    return control::make_supervised_master(of_master.control, session, of_master.tick);
  });
  if (!master_sites) return under("control", master_sites.error());
  const FaultyConfiguration of_slave(params.control, tick, plan, FaultSite::slave);
  auto slave_sites = starts<control::SupervisedSlave>(plan, [&](std::int64_t session) {
    return control::make_supervised_slave(of_slave.control, session, of_slave.tick);
  });
  if (!slave_sites) return under("control", slave_sites.error());
  const double oldest = oldest_s(params, plan, clock->tick_s);
  return Run(params, plan, person, *clock,
             Master{.where = FaultSite::master,
                    .plant = *master,
                    .site = std::move(master_sites->first),
                    .restarted = std::move(master_sites->second),
                    .process = FaultProcess(FaultSite::master),
                    .inbox = relay(plan, 2, clock->tick_s),
                    .sent = PacketWitness(oldest, clock->tick_s)},
             Slave{.where = FaultSite::slave,
                   .plant = *slave,
                   .site = std::move(slave_sites->first),
                   .restarted = std::move(slave_sites->second),
                   .process = FaultProcess(FaultSite::slave),
                   .inbox = relay(plan, 1, clock->tick_s),
                   .sent = PacketWitness(oldest, clock->tick_s)});
}

control::SiteRequests FaultRun::Run::requests(FaultSite site) const {
  control::SiteRequests pressed = FaultOperator::presses(moment().now_s, end_s(), judge_.rearms());
  for (const FaultInjection& injection : injections_) {
    pressed = injection.person.presses(pressed, site, injection.moment());
  }
  return pressed;
}

/// Puts what reaches the site's inputs in place of what is true.
void FaultRun::Run::spoil(station::DeviceReading& reading, FaultSite site) {
  const double true_N = reading.force_N;
  for (FaultInjection& injection : injections_) {
    const FaultMoment& moment = injection.moment();
    reading.position_m = injection.at(site).encoder.step(reading.position_m, moment);
    if (site == FaultSite::slave) reading.force_N = injection.force_sensor.step(reading.force_N, moment);
    injection.at(site).wiring.step(reading.position_m, reading.force_N, moment);
  }
  if (site == FaultSite::slave) misread_N_ = reading.force_N - true_N;
  for (const FaultInjection& injection : injections_) injection.spoil(site, reading);
}

double FaultRun::Run::drive(double told_N, bool enabled, FaultSite site) {
  double force_N = std::isfinite(told_N) ? told_N : 0.0;
  for (FaultInjection& injection : injections_) {
    simulation::FaultyActuator& actuator = injection.at(site).actuator;
    force_N = actuator.step(force_N, enabled, injection.moment());
    outcome_.winding_warmth = std::max(outcome_.winding_warmth, actuator.warmth());
  }
  return force_N;
}

/// The way of a site: what waits for its process, and whatever the network and a faulty site make of what it says.
template <class Here, class There>
struct FaultRun::Run::Transport {
  Run& run;
  Here& here;
  There& there;
  template <class Take>
  void receive(const station::Tick&, Take&& take) {
    here.process.hand_over(run.tick_s_, [&](control::Packet packet) {
      // A control blinds the site to what differs.
      if (run.injections_.front().hides_disagreement()) {
        packet.agreement = here.site.agreement().own().excerpt(packet.sequence);
      }
      take(packet);
    });
  }
  void send(control::Packet packet, const station::Tick& tick) {
    for (FaultInjection& injection : run.injections_) {
      injection.at(here.where).peer.step(packet, injection.moment());
    }
    here.sent.sent(packet, tick.number);
    // To the master it arrives at the next tick at the earliest.
    const std::int64_t arrives = tick.number + (there.where == FaultSite::master ? 1 : 0);
    if (!run.cut()) there.inbox.send(packet, arrives, run.share_to(there.where));
  }
};

template <class Here, class There>
void FaultRun::Run::step_site(Here& here, There& there) {
  here.sensed = here.plant.read({});
  spoil(here.sensed, here.where);
  if (here.process.fare(injections_, missed_)) {
    here.site = std::move(here.restarted.back());
    here.restarted.pop_back();
    there.sent.restart();
  }
  if (here.process.killed()) here.forces = {};
  here.process.collect(here.inbox, tick_, injections_);
  if (!here.process.stands_still()) {
    Transport<Here, There> transport{*this, here, there};
    const station::Tick tick{.number = tick_, .missed = here.process.elapsed_ticks() - 1};
    const auto done = station::step(here.site, here, transport, tick, requests(here.where));
    there.sent.applied(done.output.record, tick_, outcome_);
  }
  here.forces.drive_N = drive(here.forces.motor_N, here.forces.enabled, here.where);
}

void FaultRun::Run::advance() {
  master_.plant.write({.force_N = master_.forces.drive_N, .handle_force_N = master_.forces.handle_N});
  slave_.plant.write({.force_N = slave_.forces.drive_N});
  handle_.lead(master_.plant, person_, injections_, tick_s_);
  slave_.plant.begin_tick();
  for (int i = 0; i < clock_.substeps; ++i) {
    master_.plant.substep(i);
    slave_.plant.substep(i);
  }
}

void FaultRun::Run::judge() {
  if (moment().during) {
    const auto wrong_N = [](const auto& of) { return of.enabled ? of.drive_N - of.motor_N : 0.0; };
    const double misdriven_N = wrong_N(master_.forces) + wrong_N(slave_.forces);  // at most one is
    outcome_.fault_N = std::max(
        {outcome_.fault_N, std::fabs(misread_slowly_.see(misread_N_)), std::fabs(misdriven_slowly_.see(misdriven_N))});
  }
  const auto view = [](control::SiteState state, bool gone, double step_N, const control::SafetyGate::Params& gate,
                       const mechanics::CableChain& mechanism, double drive_N, double outside_N) {
    const bool left =
        std::fabs(mechanism.motor_position_m()) >= coasting * control::SafetyGate::fault_factor * gate.position_limit_m;
    return FaultJudge::SiteView{.state = state,
                                .gone = gone,
                                .step_N = step_N,
                                .left_workspace = left,
                                .truth = {.drive_N = drive_N,
                                          .motor_m = mechanism.motor_position_m(),
                                          .motor_m_per_s = mechanism.state().velocity_m_per_s[0],
                                          .tip_m = mechanism.tip_position_m(),
                                          .tip_m_per_s = mechanism.tip_velocity_m_per_s(),
                                          .outside_N = outside_N}};
  };
  judge_.see(
      view(master_.site.state(), master_.process.killed(), std::max(at_master_.step_N(), at_handle_.step_N()),
           params_.control.gate, master_.plant.mechanism(), master_.forces.drive_N, master_.plant.hand_force_N()),
      view(slave_.site.state(), slave_.process.killed(), at_slave_.step_N(), params_.control.slave_gate,
           slave_.plant.mechanism(), slave_.forces.drive_N, slave_.plant.contact().peak_N),
      moment(), end_s(), outcome_);
}

bool FaultRun::Run::tick(bool missed) {
  if (tick_ >= ticks_) return false;
  missed_ = missed;
  // A fault that began while no site is stepped would meet none: it waits for the next step.
  for (FaultInjection& injection : injections_) {
    if (missed && tick_ == injection.span().first_tick()) {
      injection.span().postpone();
      ++ticks_;
    }
    injection.enter(tick_);
  }
  step_site(master_, slave_);
  step_site(slave_, master_);
  at_master_.see(master_.forces.motor_N, master_.process.excused(), outcome_);
  at_handle_.see(master_.forces.handle_N, master_.process.excused(), outcome_);
  at_slave_.see(slave_.forces.motor_N, slave_.process.excused(), outcome_);
  judge();
  advance();
  ++tick_;
  return tick_ < ticks_;
}

bool FaultRun::Run::step(std::int64_t missed) noexcept {
  for (std::int64_t i = 0; i < missed; ++i) tick(true);
  return tick(false);
}

FaultRun::FaultRun(std::unique_ptr<Run> run) : run_(std::move(run)) {}
FaultRun::FaultRun(FaultRun&&) noexcept = default;
FaultRun& FaultRun::operator=(FaultRun&&) noexcept = default;
FaultRun::~FaultRun() = default;

Result<FaultRun> FaultRun::make(const simulation::Teleoperator::Params& params, const FaultPlan& plan) {
  if (auto error = validate(params)) return *std::move(error);
  if (auto error = validate(plan)) return *std::move(error);
  auto run = Run::make(params, plan);
  if (!run) return run.error();
  return FaultRun(std::make_unique<Run>(*std::move(run)));
}

bool FaultRun::step(std::int64_t missed) noexcept { return run_->step(missed); }

const FaultOutcome& FaultRun::outcome() const { return run_->outcome(); }

Result<FaultOutcome> run_fault(const simulation::Teleoperator::Params& params, const FaultPlan& plan) {
  auto run = FaultRun::make(params, plan);
  if (!run) return run.error();
  while (run->step()) {
  }
  return run->outcome();
}

}  // namespace tactus::experiments
