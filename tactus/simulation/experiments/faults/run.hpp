// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/experiments/faults/outcome.hpp>
#include <tactus/simulation/experiments/faults/plan.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <cstdint>
#include <memory>

/// Two supervised sites in virtual time, an operator who taps the wall, and one fault.
namespace tactus::experiments {

/// One plan, tick by tick, in virtual or in real time.
class FaultRun {
 public:
  /// `params` must make a teleoperator; its channel is not used.
  static Result<FaultRun> make(const simulation::Teleoperator::Params& params, const FaultPlan& plan);
  FaultRun(FaultRun&&) noexcept;
  FaultRun& operator=(FaultRun&&) noexcept;
  ~FaultRun();

  /// One tick; false once no tick is left. Before it the machine missed so many: devices, operator and packets
  /// continued and neither site was stepped. Real-time safe.
  bool step(std::int64_t missed = 0) noexcept;
  [[nodiscard]] const FaultOutcome& outcome() const;

 private:
  class Run;
  explicit FaultRun(std::unique_ptr<Run> run);
  std::unique_ptr<Run> run_;
};

/// Runs one plan in virtual time. `params` must make a teleoperator; its channel is not used.
Result<FaultOutcome> run_fault(const simulation::Teleoperator::Params& params, const FaultPlan& plan);

}  // namespace tactus::experiments
