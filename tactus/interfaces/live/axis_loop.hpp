// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/interfaces/live/loops.hpp>

namespace tactus::live {

/// A teleoperator of one axis, in virtual time. Nothing moves across.
class AxisLoop final : public Loop {
 public:
  using Teleoperator = simulation::Teleoperator;

  /// At rest at `start_m`; gives `parts` where another continues with it. Errors: those of `Teleoperator::make`.
  static Result<std::unique_ptr<Loop>> make(const Teleoperator::Params& params, double start_m,
                                            const Teleoperator::Parts& parts = {});
  /// As `change_loop`. Another architecture starts over.
  static Result<LoopChange> change(const Teleoperator::Params& before, const Teleoperator::Params& after,
                                   double start_m);

  void step(const HandPoint& path, const HandPoint& path_at_next_tick, double share, LoopTick& tick) noexcept override;
  [[nodiscard]] bool good() const noexcept override { return inside_ && teleoperator_.healthy(); }
  [[nodiscard]] bool at_rest() const noexcept override { return teleoperator_.at_rest(); }
  [[nodiscard]] double tick_s() const noexcept override { return teleoperator_.tick_s(); }
  void exchange(Loop& made) noexcept override;

 private:
  AxisLoop(const Teleoperator& teleoperator, double reach_m, const Teleoperator::Parts& parts)
      : teleoperator_(teleoperator), reach_m_(reach_m), parts_(parts) {}

  Teleoperator teleoperator_;
  double reach_m_;
  Teleoperator::Parts parts_;
  bool inside_ = true;
};

}  // namespace tactus::live
