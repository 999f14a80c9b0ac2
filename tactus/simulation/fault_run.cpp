#include <tactus/control/supervised_site.hpp>
#include <tactus/mechanics/minimum_jerk.hpp>
#include <tactus/simulation/fault_injection.hpp>
#include <tactus/simulation/fault_judge.hpp>
#include <tactus/simulation/fault_pairs.hpp>
#include <tactus/simulation/fault_person.hpp>
#include <tactus/simulation/fault_process.hpp>
#include <tactus/simulation/fault_run.hpp>
#include <tactus/simulation/fault_witness.hpp>
#include <tactus/simulation/faulty_configuration.hpp>
#include <tactus/simulation/packet_relay.hpp>
#include <tactus/simulation/site_plants.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace tactus::simulation {

namespace {

/// A motor that gives less than this share of its limit has let go.
constexpr double released_share = 0.05;
/// How far a device may coast beyond where its gate latches a fault, as a factor.
constexpr double coasting = 1.1;
/// A force that is wrong for less than this is hardly wrong.
constexpr double slowly_s = 0.02;
/// What a clamp holds a handle with.
constexpr mechanics::LinearSpring::Params clamp{.stiffness_N_per_m = 20000.0, .damping_N_s_per_m = 50.0};

}  // namespace

class FaultRun::Run {
 public:
  static Result<Run> make(const Teleoperator::Params& params, const FaultPlan& plan);
  bool step(std::int64_t missed) noexcept;
  [[nodiscard]] const FaultOutcome& outcome() const { return outcome_; }

 private:
  struct Parts {
    Clock clock;
    MasterPlant master;
    SlavePlant slave;
    control::SupervisedMaster master_site;
    control::SupervisedSlave slave_site;
  };
  /// What a site last commanded, and what its drives make of that.
  struct Forces {
    double motor_N = 0.0;
    double handle_N = 0.0;
    double drive_N = 0.0;
    bool enabled = true;  ///< the line that switches the drive on
  };

  Run(const Teleoperator::Params& params, const FaultPlan& plan, const FaultPerson& person, Parts parts)
      : params_(params),
        plan_(plan),
        parts_(std::move(parts)),
        tick_s_(parts_.clock.tick_s),
        injections_(injections_of(plan, tick_s_)),
        person_(person),
        to_slave_(relay(plan, 1, tick_s_)),
        to_master_(relay(plan, 2, tick_s_)),
        at_master_(params.control.gate.force_limit_N, params.control.gate.rate_limit_N_per_s, tick_s_),
        at_handle_(params.control.handle_gate.force_limit_N, params.control.handle_gate.rate_limit_N_per_s, tick_s_),
        at_slave_(params.control.slave_gate.force_limit_N, params.control.slave_gate.rate_limit_N_per_s, tick_s_),
        of_master_(oldest_s(params, plan, tick_s_), tick_s_),
        of_slave_(oldest_s(params, plan, tick_s_), tick_s_),
        judge_({person.wall_m(), person.depth_m(), released_share * params.control.gate.force_limit_N, tick_s_},
               {params.environment.position_m, params.control.position_scale * person.depth_m(),
                released_share * params.control.slave_gate.force_limit_N, tick_s_},
               tick_s_),
        misread_slowly_(slowly_s, tick_s_),
        misdriven_slowly_(slowly_s, tick_s_) {
    ticks_ = std::lround((end_s() + fault_schedule::end_after_s) / tick_s_);
    of_master_.expect(ticks_);
    of_slave_.expect(ticks_);
  }

  static std::vector<FaultInjection> injections_of(const FaultPlan& plan, double tick_s) {
    std::vector<FaultInjection> injections;
    for (const FaultPlan& part : plans_of(plan)) injections.emplace_back(part, tick_s);
    return injections;
  }
  /// The oldest that may be applied. Of a way that takes longer than the other half passes for an offset of clocks; and
  /// a clock that loses ticks does not count how long a packet waits meanwhile.
  static double oldest_s(const Teleoperator::Params& params, const FaultPlan& plan, double tick_s) {
    const double factor = plan.kind == FaultKind::delay_asymmetric ? 2.0 : 1.0;
    double waits_s = 0.0;
    for (const FaultPlan& part : plans_of(plan)) {
      if (part.kind == FaultKind::rate_drift) waits_s += tick_s * std::ceil(part.size / (1.0 - part.size));
    }
    return factor * params.control.supervision.packets.longest_age_s + waits_s;
  }
  /// A way whose packets the network treats as every part of the plan says.
  static PacketRelay relay(const FaultPlan& plan, std::uint64_t way, double tick_s) {
    std::vector<ImpairedLink> links;
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
  /// A packet on its way to a site, which a control may blind to what differs.
  template <class Site>
  void give(control::Packet packet, Site& site) {
    if (injections_.front().hides_disagreement()) packet.agreement = site.agreement().own().excerpt(packet.sequence);
    site.take(packet);
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
  void read(double& position_m, double& force_N, FaultSite site);
  void say(control::Packet& packet, FaultSite site);
  double drive(const Forces& told, FaultSite site);
  void hold_handle();
  [[nodiscard]] mechanics::Operator::Output clamped() const;
  void step_master();
  void step_slave();
  void advance();
  void judge();
  bool tick(bool missed);

  Teleoperator::Params params_;
  FaultPlan plan_;
  Parts parts_;
  double tick_s_;
  std::vector<FaultInjection> injections_;  ///< all that goes wrong; the first counts for the judge
  FaultPerson person_;
  PacketRelay to_slave_, to_master_;
  ForceWitness at_master_, at_handle_, at_slave_;
  PacketWitness of_master_, of_slave_;  ///< the sender
  FaultJudge judge_;
  FaultOutcome outcome_;
  FaultProcess master_{FaultSite::master}, slave_{FaultSite::slave};
  Forces of_master_site_, of_slave_site_;
  FaultyPerson::Hand hand_ = FaultyPerson::Hand::holds;
  double clamped_at_m_ = 0.0;
  mechanics::MinimumJerk returns_;  ///< how far off its path the hand still leads a handle that it took again
  double misread_N_ = 0.0;          ///< of the tip's force, by a fault
  Lasting misread_slowly_, misdriven_slowly_;
  std::int64_t tick_ = 0;
  std::int64_t ticks_ = 0;
  bool missed_ = false;  ///< at this tick no site is stepped
};

Result<FaultRun::Run> FaultRun::Run::make(const Teleoperator::Params& params, const FaultPlan& plan) {
  const auto clock = Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  const Seconds tick{clock->tick_s};
  const FaultPerson person(plan, params.environment.position_m / params.control.position_scale,
                           params.control.supervision.probe.force_N > 0.0);
  const double start_m = person.path_m(0.0);
  auto master = MasterPlant::make(params.master, params.person, *clock, start_m);
  if (!master) return master.error();
  auto slave = SlavePlant::make(params.slave, params.environment, *clock, params.control.position_scale * start_m);
  if (!slave) return slave.error();
  const FaultyConfiguration of_master(params.control, tick, plan, FaultSite::master);
  auto master_site = control::make_supervised_master(of_master.control, 1, of_master.tick);
  if (!master_site) return under("control", master_site.error());
  const FaultyConfiguration of_slave(params.control, tick, plan, FaultSite::slave);
  auto slave_site = control::make_supervised_slave(of_slave.control, 1, of_slave.tick);
  if (!slave_site) return under("control", slave_site.error());
  return Run(params, plan, person, Parts{*clock, *master, *slave, *std::move(master_site), *std::move(slave_site)});
}

control::SiteRequests FaultRun::Run::requests(FaultSite site) const {
  control::SiteRequests pressed = FaultPerson::presses(moment().now_s, end_s(), judge_.rearms());
  for (const FaultInjection& injection : injections_) {
    pressed = injection.person.presses(pressed, site, injection.moment());
  }
  return pressed;
}

/// Puts what reaches the site's inputs in place of what is true.
void FaultRun::Run::read(double& position_m, double& force_N, FaultSite site) {
  const double true_N = force_N;
  for (FaultInjection& injection : injections_) {
    const FaultMoment& moment = injection.moment();
    position_m = injection.at(site).encoder.step(position_m, moment);
    if (site == FaultSite::slave) force_N = injection.force_sensor.step(force_N, moment);
    injection.at(site).wiring.step(position_m, force_N, moment);
  }
  if (site == FaultSite::slave) misread_N_ = force_N - true_N;
}

double FaultRun::Run::drive(const Forces& told, FaultSite site) {
  double force_N = std::isfinite(told.motor_N) ? told.motor_N : 0.0;
  for (FaultInjection& injection : injections_) {
    FaultyActuator& actuator = injection.at(site).actuator;
    force_N = actuator.step(force_N, told.enabled, injection.moment());
    outcome_.winding_warmth = std::max(outcome_.winding_warmth, actuator.warmth());
  }
  return force_N;
}

void FaultRun::Run::say(control::Packet& packet, FaultSite site) {
  for (FaultInjection& injection : injections_) injection.at(site).peer.step(packet, injection.moment());
}

void FaultRun::Run::step_master() {
  const auto reading = parts_.master.read({});
  if (master_.fare(injections_, missed_)) {
    // What made the first one makes the second.
    const FaultyConfiguration with(params_.control, Seconds{tick_s_}, plan_, FaultSite::master);
    parts_.master_site = *control::make_supervised_master(with.control, master_.session(), with.tick);
    of_slave_.restart();
  }
  if (master_.killed()) of_master_site_ = {};
  master_.receive(to_master_, tick_, injections_, tick_s_,
                  [&](const control::Packet& packet) { give(packet, parts_.master_site); });
  control::SupervisedMaster::Input input{.sensors = {.motor_position_m = reading.position_m,
                                                     .hand_force_N = reading.force_N,
                                                     .arrival = {},
                                                     .grip = reading.grip},
                                         .requests = requests(FaultSite::master),
                                         .elapsed_ticks = master_.elapsed_ticks()};
  read(input.sensors.motor_position_m, input.sensors.hand_force_N, FaultSite::master);
  for (const FaultInjection& injection : injections_) injection.spoil(FaultSite::master, input.sensors);
  if (!master_.stands_still()) {
    auto output = parts_.master_site.step(input);
    of_master_site_.motor_N = output.site.motor_force_N;
    of_master_site_.handle_N = output.site.handle_force_N;
    of_master_site_.enabled = output.record.enabled;
    of_slave_.applied(output.record, tick_, outcome_);
    say(output.packet, FaultSite::master);
    of_master_.sent(output.packet, tick_);
    if (!cut()) to_slave_.send(output.packet, tick_, share_to(FaultSite::slave));
  }
  of_master_site_.drive_N = drive(of_master_site_, FaultSite::master);
  at_master_.see(of_master_site_.motor_N, master_.excused(), outcome_);
  at_handle_.see(of_master_site_.handle_N, master_.excused(), outcome_);
}

void FaultRun::Run::step_slave() {
  const auto reading = parts_.slave.read({});
  if (slave_.fare(injections_, missed_)) {
    const FaultyConfiguration with(params_.control, Seconds{tick_s_}, plan_, FaultSite::slave);
    parts_.slave_site = *control::make_supervised_slave(with.control, slave_.session(), with.tick);
    of_master_.restart();
  }
  if (slave_.killed()) of_slave_site_ = {};
  slave_.receive(to_slave_, tick_, injections_, tick_s_,
                 [&](const control::Packet& packet) { give(packet, parts_.slave_site); });
  control::SupervisedSlave::Input input{
      .sensors = {.motor_position_m = reading.position_m, .tip_force_N = reading.force_N, .arrival = {}},
      .requests = requests(FaultSite::slave),
      .elapsed_ticks = slave_.elapsed_ticks()};
  read(input.sensors.motor_position_m, input.sensors.tip_force_N, FaultSite::slave);
  for (const FaultInjection& injection : injections_) injection.spoil(FaultSite::slave, input.sensors);
  if (!slave_.stands_still()) {
    auto output = parts_.slave_site.step(input);
    of_slave_site_.motor_N = output.site.motor_force_N;
    of_slave_site_.enabled = output.record.enabled;
    of_master_.applied(output.record, tick_, outcome_);
    say(output.packet, FaultSite::slave);
    of_slave_.sent(output.packet, tick_);
    // It arrives at the next tick at the earliest.
    if (!cut()) to_master_.send(output.packet, tick_ + 1, share_to(FaultSite::master));
  }
  of_slave_site_.drive_N = drive(of_slave_site_, FaultSite::slave);
  at_slave_.see(of_slave_site_.motor_N, slave_.excused(), outcome_);
}

/// Lets go of the handle, clamps it or takes it again.
void FaultRun::Run::hold_handle() {
  using Hand = FaultyPerson::Hand;
  Hand hand = Hand::holds;
  for (const FaultInjection& injection : injections_) hand = std::max(hand, injection.person.hand(injection.moment()));
  if (hand == hand_) return;
  hand_ = hand;
  const double now_s = moment().now_s, handle_m = parts_.master.mechanism().tip_position_m();
  clamped_at_m_ = handle_m;
  if (hand == Hand::holds) {
    returns_ = FaultyPerson::returns_from(handle_m - person_.path_m(now_s), now_s);
    parts_.master.take_again(params_.person.grip);
  } else {
    parts_.master.hold(hand == Hand::lets_go ? mechanics::nobody_holds : clamp);
  }
}

/// Where the clamp that holds the handle wants it.
mechanics::Operator::Output FaultRun::Run::clamped() const {
  for (const FaultInjection& injection : injections_) {
    if (injection.person.hand(injection.moment()) != FaultyPerson::Hand::is_clamped) continue;
    const mechanics::Operator::Output pushed = injection.person.pushed(injection.moment());
    return {.position_m = clamped_at_m_ + pushed.position_m, .velocity_m_per_s = pushed.velocity_m_per_s};
  }
  return {.position_m = clamped_at_m_, .velocity_m_per_s = 0.0};
}

void FaultRun::Run::advance() {
  const double now_s = moment().now_s;
  parts_.master.write({.force_N = of_master_site_.drive_N, .handle_force_N = of_master_site_.handle_N});
  parts_.slave.write({.force_N = of_slave_site_.drive_N});
  hold_handle();
  if (hand_ == FaultyPerson::Hand::holds) {
    const auto meant_m = [this](double time_s) { return person_.path_m(time_s) + returns_.position_m(time_s); };
    parts_.master.begin_tick(meant_m(now_s), meant_m(now_s + tick_s_));
  } else {
    // A hand that is away corrects nothing.
    parts_.master.begin_tick(clamped());
  }
  parts_.slave.begin_tick();
  for (int i = 0; i < parts_.clock.substeps; ++i) {
    parts_.master.substep(i);
    parts_.slave.substep(i);
  }
}

void FaultRun::Run::judge() {
  if (moment().during) {
    const auto wrong_N = [](const Forces& of) { return of.enabled ? of.drive_N - of.motor_N : 0.0; };
    const double misdriven_N = wrong_N(of_master_site_) + wrong_N(of_slave_site_);  // at most one is
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
      view(parts_.master_site.state(), master_.killed(), std::max(at_master_.step_N(), at_handle_.step_N()),
           params_.control.gate, parts_.master.mechanism(), of_master_site_.drive_N, parts_.master.hand_force_N()),
      view(parts_.slave_site.state(), slave_.killed(), at_slave_.step_N(), params_.control.slave_gate,
           parts_.slave.mechanism(), of_slave_site_.drive_N, parts_.slave.contact().peak_N),
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
  step_master();
  step_slave();
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

Result<FaultRun> FaultRun::make(const Teleoperator::Params& params, const FaultPlan& plan) {
  if (auto error = validate(params)) return *std::move(error);
  if (auto error = validate(plan)) return *std::move(error);
  auto run = Run::make(params, plan);
  if (!run) return run.error();
  return FaultRun(std::make_unique<Run>(*std::move(run)));
}

bool FaultRun::step(std::int64_t missed) noexcept { return run_->step(missed); }

const FaultOutcome& FaultRun::outcome() const { return run_->outcome(); }

Result<FaultOutcome> run_fault(const Teleoperator::Params& params, const FaultPlan& plan) {
  auto run = FaultRun::make(params, plan);
  if (!run) return run.error();
  while (run->step()) {
  }
  return run->outcome();
}

}  // namespace tactus::simulation
