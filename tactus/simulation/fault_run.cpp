#include <tactus/simulation/bad_number.hpp>
#include <tactus/simulation/fault_run.hpp>
#include <tactus/simulation/fault_witness.hpp>
#include <tactus/simulation/internal/fault_schedule.hpp>
#include <tactus/simulation/packet_relay.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace tactus::simulation {

namespace {

using control::SiteState;
using namespace fault_schedule;

}  // namespace

class FaultRun::Run {
 public:
  static Result<Run> make(const Teleoperator::Params& params, const FaultPlan& plan);
  bool step(std::int64_t missed) noexcept;
  [[nodiscard]] const FaultOutcome& outcome() const { return outcome_; }

 private:
  struct Parts {
    Clock clock;
    mechanics::CableDrivenMaster master;
    mechanics::ElectricSlave slave;
    mechanics::Operator person;
    control::SupervisedMaster master_site;
    control::SupervisedSlave slave_site;
  };
  /// How one site's process fares: how long it was not stepped, and the packets that wait for it.
  struct Process {
    std::int64_t elapsed_ticks = 1;
    std::int64_t session = 1;
    bool killed = false;
    bool born = false;     ///< at this tick
    bool stalled = false;  ///< by the plan or, in real time, by the machine
    [[nodiscard]] bool stands_still() const { return killed || stalled; }
    double force_N = 0.0;
    double handle_N = 0.0;
    double frozen_m = 0.0;
    std::vector<control::Packet> waiting;
  };

  Run(const Teleoperator::Params& params, const FaultPlan& plan, Parts parts)
      : params_(params),
        plan_(plan),
        bad_(BadNumber::of(plan.choice)),
        parts_(std::move(parts)),
        tick_s_(parts_.clock.tick_s),
        end_s_(plan.start_s + plan.length_s),
        to_slave_(plan.impairment, signal::Random(static_cast<std::uint64_t>(plan.seed)).fork(1), tick_s_),
        to_master_(plan.impairment, signal::Random(static_cast<std::uint64_t>(plan.seed)).fork(2), tick_s_),
        at_master_(params.control.gate.force_limit_N, params.control.gate.rate_limit_N_per_s, tick_s_),
        at_handle_(params.control.handle_gate.force_limit_N, params.control.handle_gate.rate_limit_N_per_s, tick_s_),
        at_slave_(params.control.slave_gate.force_limit_N, params.control.slave_gate.rate_limit_N_per_s, tick_s_),
        of_master_(params.control.supervision.packets.longest_age_s, tick_s_),
        of_slave_(params.control.supervision.packets.longest_age_s, tick_s_) {
    signal::Random random = signal::Random(static_cast<std::uint64_t>(plan.seed)).fork(3);
    phase_cycles_ = random.uniform();
    tap_Hz_ = random.uniform(0.6, 1.2);
    depth_m_ = random.uniform(0.004, 0.012);
    for (Process* process : {&master_, &slave_}) process->waiting.reserve(4096);
  }

  [[nodiscard]] bool during() const { return now_s_ >= plan_.start_s && now_s_ < end_s_; }
  [[nodiscard]] bool at(FaultSite site) const { return plan_.site == site; }
  [[nodiscard]] bool bad_now(bool master) const {
    return plan_.kind == FaultKind::bad_number && tick_ == fault_tick_ && bad_.at_master == master;
  }
  [[nodiscard]] bool prelude(SiteState state) const {
    return plan_.kind == FaultKind::bad_number && bad_.state == state && now_s_ >= prelude_s &&
           now_s_ < prelude_s + prelude_length_s;
  }
  [[nodiscard]] bool cut_now() const { return (plan_.kind == FaultKind::cut && during()) || prelude(SiteState::hold); }
  [[nodiscard]] bool within(double begin_s) const { return now_s_ >= begin_s && now_s_ < begin_s + button_s; }

  [[nodiscard]] double path_m(double time_s) const;
  control::SiteRequests requests() const;
  void fare(Process& process, FaultSite site);
  double encoder(double position_m, Process& process, FaultSite site);
  double force_sensor(double force_N) const;
  void receive(PacketRelay& relay, Process& process, bool master);
  void step_master();
  void step_slave();
  void advance();
  void judge();
  bool tick(bool missed);

  Teleoperator::Params params_;
  FaultPlan plan_;
  BadNumber bad_;
  Parts parts_;
  double tick_s_;
  double end_s_;
  PacketRelay to_slave_, to_master_;
  ForceWitness at_master_, at_handle_, at_slave_;
  PacketWitness of_master_, of_slave_;  ///< the sender
  EnergyWitness energy_;
  FaultOutcome outcome_;
  Process master_, slave_;
  double phase_cycles_ = 0.0, tap_Hz_ = 1.0, depth_m_ = 0.01;
  std::int64_t tick_ = 0;
  std::int64_t ticks_ = 0;
  std::int64_t fault_tick_ = 0;
  bool missed_ = false;  ///< at this tick no site is stepped
  double now_s_ = 0.0;
  bool rearming_ = false;
  bool left_[2] = {false, false};
};

Result<FaultRun::Run> FaultRun::Run::make(const Teleoperator::Params& params, const FaultPlan& plan) {
  const auto clock = Clock::make(params.servo, params.plant);
  if (!clock) return clock.error();
  const Seconds tick{clock->tick_s}, substep{clock->substep_s};
  auto master = mechanics::CableDrivenMaster::make(params.master, params.person.grip, substep);
  if (!master) return under("master", master.error());
  auto slave = mechanics::ElectricSlave::make(params.slave, params.environment, substep);
  if (!slave) return under("slave", slave.error());
  auto person = mechanics::Operator::make(params.person, tick);
  if (!person) return under("operator", person.error());
  auto master_site = control::make_supervised_master(params.control, 1, tick);
  if (!master_site) return under("control", master_site.error());
  auto slave_site = control::make_supervised_slave(params.control, 1, tick);
  if (!slave_site) return under("control", slave_site.error());
  Run run(params, plan, Parts{*clock, *master, *slave, *person, *std::move(master_site), *std::move(slave_site)});
  if (plan.kind == FaultKind::bad_number) {
    run.plan_.start_s = bad_number_at_s(run.bad_.state);
    // What was inactive before is armed after the usual time of the start.
    run.end_s_ = std::max(run.plan_.start_s, 0.5);
  }
  run.fault_tick_ = std::lround(run.plan_.start_s / run.tick_s_);
  run.plan_.start_s = static_cast<double>(run.fault_tick_) * run.tick_s_;
  run.ticks_ = std::lround((run.end_s_ + end_after_s) / run.tick_s_);
  run.of_master_.expect(run.ticks_);
  run.of_slave_.expect(run.ticks_);
  run.parts_.master.reset(run.path_m(0.0));
  run.parts_.slave.reset(params.control.position_scale * run.path_m(0.0));
  return run;
}

/// Taps as a raised cosine, the wall in the middle of the way; or presses on it and stays.
double FaultRun::Run::path_m(double time_s) const {
  const double wall_m = params_.environment.position_m / params_.control.position_scale;
  if (plan_.kind == FaultKind::delayed_wall) {
    return wall_m - depth_m_ * std::cos(std::numbers::pi * std::clamp(2.0 * (time_s - press_s), 0.0, 1.0));
  }
  return wall_m - depth_m_ * std::cos(2.0 * std::numbers::pi * (tap_Hz_ * time_s + 0.1 * phase_cycles_));
}

control::SiteRequests FaultRun::Run::requests() const {
  control::SiteRequests pressed{.align = within(align_s), .arm = within(arm_s), .dead_man = now_s_ >= press_s};
  if (now_s_ > end_s_ + look_after_s && rearming_) {
    pressed.clear = within(end_s_ + look_after_s + 0.02);
    pressed.align = within(end_s_ + realign_after_s);
    pressed.arm = within(end_s_ + rearm_after_s);
    pressed.dead_man = now_s_ >= end_s_ + repress_after_s;
  }
  return pressed;
}

/// Kills, stalls and starts a site's process.
void FaultRun::Run::fare(Process& process, FaultSite site) {
  process.born = false;
  const bool here = at(site) && during();
  if (plan_.kind == FaultKind::restart && here) {
    process.killed = true;
    process.stalled = false;
    process.force_N = process.handle_N = 0.0;
    process.waiting.clear();
  } else if (process.killed) {
    if (missed_) return;
    process.killed = false;
    process.born = true;
    process.elapsed_ticks = 1;
    ++process.session;
    const Seconds tick{tick_s_};
    // What made the first one makes the second.
    if (site == FaultSite::master) {
      parts_.master_site = *control::make_supervised_master(params_.control, process.session, tick);
      of_slave_.restart();
    } else {
      parts_.slave_site = *control::make_supervised_slave(params_.control, process.session, tick);
      of_master_.restart();
    }
  } else {
    // The first step after a stall counts the ticks before it.
    process.elapsed_ticks = process.stalled ? process.elapsed_ticks + 1 : 1;
    process.stalled = missed_ || (plan_.kind == FaultKind::stall && here);
  }
}

double FaultRun::Run::encoder(double position_m, Process& process, FaultSite site) {
  const bool here = at(site);
  if (tick_ <= fault_tick_) process.frozen_m = position_m;
  if (prelude(SiteState::fault) && (bad_.at_master == (site == FaultSite::master))) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  if (!here) return position_m;
  if (plan_.kind == FaultKind::encoder_spike && tick_ == fault_tick_) return position_m + plan_.size;
  if (plan_.kind == FaultKind::encoder_wrap && during()) return position_m + plan_.size;
  if (plan_.kind == FaultKind::encoder_freeze && during()) return process.frozen_m;
  return position_m;
}

double FaultRun::Run::force_sensor(double force_N) const {
  if (plan_.kind == FaultKind::force_dropout && during()) return 0.0;
  if (plan_.kind == FaultKind::force_bias && during()) return force_N + plan_.size;
  return force_N;
}

void FaultRun::Run::receive(PacketRelay& relay, Process& process, bool master) {
  relay.deliver(tick_, [&](control::Packet packet) {
    if (process.killed) return;
    if (bad_now(master)) bad_.spoil(packet);
    if (process.waiting.size() < process.waiting.capacity()) process.waiting.push_back(packet);
  });
  if (process.stands_still()) return;
  for (control::Packet& packet : process.waiting) {
    // What waited in the queue of a stalled site has aged there.
    packet.age_s += static_cast<double>(process.elapsed_ticks - 1) * tick_s_;
    master ? parts_.master_site.take(packet) : parts_.slave_site.take(packet);
  }
  process.waiting.clear();
}

void FaultRun::Run::step_master() {
  const auto reading = parts_.master.measure();
  fare(master_, FaultSite::master);
  receive(to_master_, master_, true);
  if (!master_.stands_still()) {
    control::SupervisedMaster::Input input{
        .sensors = {.motor_position_m = encoder(reading.motor_position_m, master_, FaultSite::master),
                    .hand_force_N = reading.hand_force_N,
                    .arrival = {}},
        .requests = requests(),
        .elapsed_ticks = master_.elapsed_ticks};
    if (bad_now(true)) bad_.spoil(input.sensors);
    const auto output = parts_.master_site.step(input);
    master_.force_N = output.site.motor_force_N;
    master_.handle_N = output.site.handle_force_N;
    of_slave_.applied(output.record, tick_, outcome_);
    of_master_.sent(output.packet, tick_);
    if (!cut_now()) to_slave_.send(output.packet, tick_, during());
  }
  const bool excused = master_.killed || master_.born;
  at_master_.see(master_.force_N, excused, outcome_);
  at_handle_.see(master_.handle_N, excused, outcome_);
}

void FaultRun::Run::step_slave() {
  const auto reading = parts_.slave.measure();
  fare(slave_, FaultSite::slave);
  receive(to_slave_, slave_, false);
  if (!slave_.stands_still()) {
    control::SupervisedSlave::Input input{
        .sensors = {.motor_position_m = encoder(reading.motor_position_m, slave_, FaultSite::slave),
                    .tip_force_N = force_sensor(reading.tip_force_N),
                    .arrival = {}},
        .requests = requests(),
        .elapsed_ticks = slave_.elapsed_ticks};
    if (bad_now(false)) bad_.spoil(input.sensors);
    const auto output = parts_.slave_site.step(input);
    slave_.force_N = output.site.motor_force_N;
    of_master_.applied(output.record, tick_, outcome_);
    of_slave_.sent(output.packet, tick_);
    // It arrives at the next tick at the earliest.
    if (!cut_now()) to_master_.send(output.packet, tick_ + 1, during());
  }
  const bool excused = slave_.killed || slave_.born;
  at_slave_.see(slave_.force_N, excused, outcome_);
}

void FaultRun::Run::advance() {
  const double force_N = std::isfinite(master_.force_N) ? master_.force_N : 0.0;
  const double slave_N = std::isfinite(slave_.force_N) ? slave_.force_N : 0.0;
  energy_.see(force_N, parts_.master.mechanism().motor_position_m(), outcome_);
  const auto aim = parts_.person.step({.path_m = path_m(now_s_),
                                       .path_at_next_tick_m = path_m(now_s_ + tick_s_),
                                       .handle_position_m = parts_.master.mechanism().tip_position_m()});
  for (int i = 0; i < parts_.clock.substeps; ++i) {
    parts_.master.step({.commanded_force_N = force_N,
                        .commanded_handle_force_N = master_.handle_N,
                        .grip_position_m = aim.position_m + (i + 0.5) * parts_.clock.substep_s * aim.velocity_m_per_s,
                        .grip_velocity_m_per_s = aim.velocity_m_per_s});
    parts_.slave.step(slave_N);
  }
}

void FaultRun::Run::judge() {
  const SiteState states[2] = {parts_.master_site.state(), parts_.slave_site.state()};
  const bool gone[2] = {master_.killed, slave_.killed};
  const bool both = states[0] == SiteState::active && states[1] == SiteState::active;
  if (tick_ < fault_tick_) {
    outcome_.became_active = both;
    return;
  }
  const control::ControlParams& params = params_.control;
  const auto beyond = [](double position_m, const control::SafetyGate::Params& gate) {
    return std::fabs(position_m) >= control::SafetyGate::fault_factor * gate.position_limit_m;
  };
  outcome_.left_workspace = outcome_.left_workspace ||
                            beyond(parts_.master.mechanism().motor_position_m(), params.gate) ||
                            beyond(parts_.slave.mechanism().motor_position_m(), params.slave_gate);
  const bool before_rearming = now_s_ <= end_s_ + look_after_s;
  bool none_active = true;
  for (int site = 0; site < 2; ++site) {
    const bool active = !gone[site] && states[site] == SiteState::active;
    none_active = none_active && !active;
    const bool latched = gone[site] || states[site] == SiteState::hold || states[site] == SiteState::fault;
    if (latched && outcome_.detection_ticks < 0) outcome_.detection_ticks = tick_ - fault_tick_;
    if (!before_rearming) continue;
    if (left_[site] && active) ++outcome_.active_without_arming;
    left_[site] = left_[site] || (outcome_.became_active && !active);
  }
  if (before_rearming && outcome_.became_active && none_active && !outcome_.stopped) {
    outcome_.stopped = true;
    outcome_.time_to_stop_s = static_cast<double>(tick_ - fault_tick_) * tick_s_;
  }
  if (now_s_ <= end_s_ + look_after_s) rearming_ = !both;
  if (rearming_ && now_s_ > end_s_ + rearm_after_s && now_s_ < end_s_ + repress_after_s + resume_watch_s) {
    outcome_.resume_step_N =
        std::max({outcome_.resume_step_N, at_master_.step_N(), at_handle_.step_N(), at_slave_.step_N()});
  }
  if (now_s_ >= end_s_ + settled_after_s) outcome_.active_at_end = both;
}

bool FaultRun::Run::tick(bool missed) {
  if (tick_ >= ticks_) return false;
  missed_ = missed;
  // A fault that began while no site is stepped would meet none: it waits for the next step.
  if (missed && tick_ == fault_tick_) {
    ++fault_tick_;
    ++ticks_;
    plan_.start_s = static_cast<double>(fault_tick_) * tick_s_;
    end_s_ += tick_s_;
  }
  now_s_ = static_cast<double>(tick_) * tick_s_;
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

std::int64_t bad_number_choices() { return BadNumber::choices; }

}  // namespace tactus::simulation
