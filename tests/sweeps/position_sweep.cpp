// SPDX-License-Identifier: Apache-2.0
// position_sweep [RUNS [SEED [HOURS]]]: a wrong position at a joint of a shipped rig file, so many times, every fault
// at every joint once unless stated otherwise; then so many hours of true positions over all rig files, 1 unless stated
// otherwise; in between, as a control, a tenth of the wrong ones without the check. Prints every run that broke the
// rule. Status 1 where a side was not released within 0.2 rad of travel, where a true position tripped anything, or
// where the control shows no harm.
#include <tactus/simulation/teleoperator/parallel.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include <tests/sweeps/position_bench.hpp>

namespace {

using namespace tactus;
using namespace tactus::sweeps;

struct Run {
  PositionPlan plan;
  PositionOutcome outcome;
};

template <class Draw>
std::vector<Run> run_all(const std::vector<ShippedRig>& rigs, std::size_t count, Draw&& draw) {
  std::vector<Run> runs(count);
  simulation::for_each_in_parallel(
      count,
      [&](std::size_t i) {
        runs[i].plan = draw(i);
        runs[i].outcome = run(rigs[runs[i].plan.rig], runs[i].plan);
      },
      [](double share) { std::fprintf(stderr, "\r%3.0f %%", 100.0 * share); });
  std::fprintf(stderr, "\r     \r");
  return runs;
}

}  // namespace

int main(int count, char** arguments) {
  const auto rigs = shipped_rigs();
  const std::size_t runs = count > 1 ? static_cast<std::size_t>(std::atoi(arguments[1])) : position_plans(rigs);
  const std::int64_t seed = count > 2 ? std::atoi(arguments[2]) : 2;
  const double hours = count > 3 ? std::atof(arguments[3]) : 1.0;

  struct Tally {
    int runs = 0, kept = 0;
    double farthest_rad = 0.0;
  };
  std::map<std::string, Tally> tallies;
  int bad = 0;
  for (const Run& one : run_all(rigs, runs, [&](std::size_t i) { return position_plan(rigs, seed, i); })) {
    const bool kept = one.outcome.released && one.outcome.travelled_rad <= 0.2;
    for (const std::string& name : {std::string(name_of(one.plan.fault)), rigs[one.plan.rig].name}) {
      Tally& tally = tallies[name];
      ++tally.runs;
      tally.kept += kept ? 1 : 0;
      tally.farthest_rad = std::max(tally.farthest_rad, one.outcome.travelled_rad);
    }
    if (kept) continue;
    ++bad;
    std::printf("BROKEN: %s: %s\n", words_of(rigs, one.plan).c_str(), words_of(one.outcome).c_str());
  }
  for (const auto& [name, tally] : tallies) {
    std::printf("%-20s %d of %d released within 0.2 rad, at most %.3f rad\n", name.c_str(), tally.kept, tally.runs,
                tally.farthest_rad);
  }
  std::printf("wrong positions: %zu of %zu released within 0.2 rad of travel\n", runs - static_cast<std::size_t>(bad),
              runs);

  std::vector<ShippedRig> loose;
  for (const ShippedRig& rig : rigs) loose.push_back(unjudged(rig));
  std::size_t harmed = 0;
  // Spread over all faults and rigs: the stride shares no factor with their number.
  const std::size_t controls = std::min(runs, position_plans(rigs)) / 10, all = position_plans(rigs);
  std::size_t stride = std::max<std::size_t>(all / std::max<std::size_t>(controls, 1), 1);
  while (std::gcd(stride, all) != 1) ++stride;
  for (const Run& one :
       run_all(loose, controls, [&](std::size_t i) { return position_plan(rigs, seed, i * stride % all); })) {
    harmed += one.outcome.followed && one.outcome.travelled_rad > 0.2 ? 1 : 0;
  }
  std::printf("control, without the comparison of position and velocity: %zu of %zu travelled farther than 0.2 rad\n",
              harmed, controls);
  if (controls > 0 && harmed == 0) ++bad;

  constexpr double piece_s = 60.0;
  const auto pieces = static_cast<std::size_t>(3600.0 * hours / piece_s);
  double ran_s = 0.0;
  int tripped = 0;
  for (const Run& one : run_all(rigs, pieces, [&](std::size_t i) {
         return PositionPlan{.rig = i % rigs.size(),
                             .seed = static_cast<std::uint64_t>(seed) * 1'000'000 + i,
                             .contact = i / rigs.size() % 2 == 1,
                             .duration_s = piece_s};
       })) {
    ran_s += one.outcome.ran_s;
    if (one.outcome.followed && !one.outcome.released) continue;
    ++tripped;
    std::printf("TRIPPED: %s: %s\n", words_of(rigs, one.plan).c_str(), words_of(one.outcome).c_str());
  }
  std::printf("true positions: %.2f h of virtual time while following, free and in contact, %d tripped\n",
              ran_s / 3600.0, tripped);
  return bad + tripped == 0 ? 0 : 1;
}
