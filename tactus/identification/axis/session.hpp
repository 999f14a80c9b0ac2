// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/axis/rig.hpp>

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace tactus::identification {

/// A rig whose every run is kept in a folder, and taken from there when it is asked for again: identification can be
/// stopped at any time, also between two mechanical steps, and continues where it was when it is started again.
///
/// Run n is `run-00n.csv`: columns `time_s`, `commanded_N`, `position_m` and, where the rig monitors it, `current_N`,
/// as `recording::read` takes them. Its first line states what was run on which rig. A mechanical step is asked for
/// only once a run that needs it is missing, and not again while the master is still in that state.
class SessionRig final : public Rig {
 public:
  /// Over `rig`, which must outlive it. Errors: `unwritable`.
  static Result<SessionRig> open(Rig& rig, const std::filesystem::path& folder);

  [[nodiscard]] std::string name() const override { return rig_->name(); }
  [[nodiscard]] double tick_s() const override { return rig_->tick_s(); }
  [[nodiscard]] RigLimits limits() const override { return rig_->limits(); }
  Check assemble(Assembly assembly) override;
  /// Errors, besides the rig's: `inconsistent` for a file of another rig, assembly or program, or of other length;
  /// those of `recording::read` for a damaged one; `unwritable`. Each names the file.
  Result<RigRun> run(const MotorProgram& program) override;

  /// How many runs came from the folder so far.
  [[nodiscard]] std::size_t replayed() const { return replayed_; }

 private:
  SessionRig(Rig& rig, std::filesystem::path folder) : rig_(&rig), folder_(std::move(folder)) {}
  Rig* rig_;
  std::filesystem::path folder_;
  Assembly wanted_ = Assembly::held;
  std::optional<Assembly> standing_;  ///< as the rig was last put together
  std::size_t runs_ = 0;
  std::size_t replayed_ = 0;
};

}  // namespace tactus::identification
