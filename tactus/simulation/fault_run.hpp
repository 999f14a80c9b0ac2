#pragma once

#include <tactus/control/supervised_site.hpp>
#include <tactus/simulation/fault_plan.hpp>
#include <tactus/simulation/teleoperator.hpp>

#include <cstdint>
#include <memory>

/// Two supervised sites in virtual time, a person who taps the wall, and one fault.
namespace tactus::simulation {

/// What a witness saw that stands outside of both sites: it reads what reaches the motors, and remembers when each
/// packet was sent. It shares no code with what it judges.
struct FaultOutcome {
  std::int64_t not_finite = 0;             ///< forces at a motor that were no numbers
  std::int64_t stale_applied = 0;          ///< packets applied that were too old, or older than one before
  std::int64_t steps_above_rate = 0;       ///< changes of a motor's force in a tick above the rate limit
  std::int64_t forces_above_limit = 0;     ///< of a motor
  std::int64_t active_without_arming = 0;  ///< times a site followed again by itself
  double peak_force_N = 0.0;               ///< at either motor
  double given_J = 0.0;                    ///< largest rise of the energy that the master's motor gave
  bool became_active = false;              ///< before the fault
  bool stopped = false;                    ///< a site left `active` after the fault began
  double time_to_stop_s = 0.0;             ///< from the begin of the fault until no site was active
  std::int64_t detection_ticks = -1;       ///< from the begin of the fault to a latched fault or a hold; -1 is never
  bool left_workspace = false;             ///< a device was beyond where its gate latches a fault, whatever it read
  bool active_at_end = false;              ///< both, after clearing and arming where that was needed
  double resume_step_N = 0.0;  ///< largest change of a force in a tick, from arming to 20 ms after following began
};

/// One plan, tick by tick, in virtual or in real time.
class FaultRun {
 public:
  /// `params` must make a teleoperator; its channel is not used.
  static Result<FaultRun> make(const Teleoperator::Params& params, const FaultPlan& plan);
  FaultRun(FaultRun&&) noexcept;
  FaultRun& operator=(FaultRun&&) noexcept;
  ~FaultRun();

  /// One tick; false once there is none left. Before it the machine missed so many: devices, person and packets went on
  /// and neither site was stepped. Does not block; allocates only where a killed site is started again.
  bool step(std::int64_t missed = 0) noexcept;
  [[nodiscard]] const FaultOutcome& outcome() const;

 private:
  class Run;
  explicit FaultRun(std::unique_ptr<Run> run);
  std::unique_ptr<Run> run_;
};

/// Runs one plan in virtual time. `params` must make a teleoperator; its channel is not used.
Result<FaultOutcome> run_fault(const Teleoperator::Params& params, const FaultPlan& plan);

/// How many choices a bad number has: every input of both sites, every value, every state.
std::int64_t bad_number_choices();

}  // namespace tactus::simulation
