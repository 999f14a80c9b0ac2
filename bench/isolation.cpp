// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/axis/isolation.hpp>
#include <tactus/simulation/teleoperator/simulated_rig.hpp>

#include <algorithm>
#include <ctime>
#include <vector>

#include <bench/sections.hpp>

namespace tactus::bench {

namespace {

/// Keeps every run and gives them again in the same order, which takes no time.
class RecordedRig final : public identification::Rig {
 public:
  explicit RecordedRig(Rig& rig) : rig_(rig) {}
  [[nodiscard]] std::string name() const override { return rig_.name(); }
  [[nodiscard]] double tick_s() const override { return rig_.tick_s(); }
  [[nodiscard]] identification::RigLimits limits() const override { return rig_.limits(); }
  Check assemble(identification::Assembly assembly) override { return rig_.assemble(assembly); }
  Result<identification::RigRun> run(const identification::MotorProgram& program) override {
    if (next_ == runs_.size()) {
      auto run = rig_.run(program);
      if (!run) return run;
      runs_.push_back(*std::move(run));
    }
    return runs_[next_++];
  }
  void rewind() { next_ = 0; }

 private:
  Rig& rig_;
  std::vector<identification::RigRun> runs_;
  std::size_t next_ = 0;
};

}  // namespace

Findings isolation() {
  auto rig = simulation::SimulatedRig::make(simulation::draw_rig(1)).value();
  RecordedRig recorded(rig);
  if (!identification::isolate(recorded, {}, {})) return {};
  std::vector<double> times_s;
  for (int i = 0; i < 5; ++i) {
    recorded.rewind();
    const std::clock_t start = std::clock();
    const auto again = identification::isolate(recorded, {}, {});
    times_s.push_back(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC);
    if (!again) return {};
  }
  std::nth_element(times_s.begin(), times_s.begin() + 2, times_s.end());
  return {{.section = "Successive isolation, the runs on the rig as recorded",
           .name = "all stages fitted, CPU time",
           .value = times_s[2],
           .unit = "s",
           .goal = Finding::Goal::at_most,
           .bound = 1.0}};
}

}  // namespace tactus::bench
