// SPDX-License-Identifier: Apache-2.0
// arming_sweep [WRONG [SEED [RIGHT [all]]]]: arms so many wrong and so many nearly right pairs of arms in virtual time,
// 500 each with seed 2 unless stated otherwise. Prints what became of them, and every one that broke a rule; with `all`
// every one. As a control, a tenth of the wrong ones are armed without judgement. Status 1 where a joint of a wrong
// pair exceeded 0.5 rad/s or 30 mrad before it was released, a right pair did or was refused, or the control shows no
// leap.
#include <tactus/simulation/teleoperator/parallel.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include <tests/sweeps/arming_bench.hpp>

namespace {

using namespace tactus;
using namespace tactus::sweeps;

struct Run {
  WrongPair wrong;
  Arming arming;
};

template <class Draw>
std::vector<Run> run_all(const std::vector<ShippedPair>& pairs, std::size_t count, Draw&& draw) {
  std::vector<Run> runs(count);
  simulation::for_each_in_parallel(
      count,
      [&](std::size_t i) {
        runs[i].wrong = draw(i);
        runs[i].arming = arm_both(pairs[runs[i].wrong.pair], runs[i].wrong.before, runs[i].wrong.beliefs);
      },
      [](double share) { std::fprintf(stderr, "\r%3.0f %%", 100.0 * share); });
  std::fprintf(stderr, "\r     \r");
  return runs;
}

bool breaks(const Run& run) { return run.arming.fastest() > 0.5 || run.arming.farthest() > 0.03; }

/// Whether its support was refused or taken back.
bool is_doubted(const Arming& arming) {
  const auto doubts = [](control::SiteCause cause) {
    return cause == control::SiteCause::support || cause == control::SiteCause::weight;
  };
  return arming.refused() || doubts(arming.leader.cause) || doubts(arming.follower.cause);
}

/// Whether a right pair was refused: its support was, or it did not become active, whatever the cause. One that lies on
/// a rest cannot move both ways, so its motors do not pass their trial: of it the support alone counts.
bool is_refused(const Run& run) {
  return is_doubted(run.arming) || (run.wrong.before != arming::Before::rests && !run.arming.became_active());
}

void print(const Run& run, const char* what) {
  std::printf("%s: %s: %s\n", what, run.wrong.words.c_str(), words_of(run.arming).c_str());
}

int count_broken(const char* of, const std::vector<Run>& runs, bool all, bool (*broken)(const Run&)) {
  int bad = 0, armed = 0, refused = 0;
  double fastest = 0.0, farthest = 0.0, active = 0.0;
  for (const Run& run : runs) {
    const bool is_bad = broken(run);
    if (is_bad || all) print(run, is_bad ? "BROKEN" : "kept");
    bad += is_bad ? 1 : 0;
    armed += run.arming.became_active() ? 1 : 0;
    refused += run.arming.refused() ? 1 : 0;
    fastest = std::max(fastest, run.arming.fastest());
    farthest = std::max(farthest, run.arming.farthest());
    active = std::max({active, run.arming.leader.active_rad_per_s, run.arming.follower.active_rad_per_s});
  }
  std::printf(
      "%s: %zu pairs, %d broke the rule; %d refused before power, %zu released, %d armed; until then at most %.3f "
      "rad/s and "
      "%.1f mrad; armed ones moved at up to %.2f rad/s\n",
      of, runs.size(), bad, refused, runs.size() - static_cast<std::size_t>(armed + refused), armed, fastest,
      1e3 * farthest, active);
  return bad;
}

}  // namespace

int main(int count, char** arguments) {
  const auto rigs = static_cast<std::size_t>(count > 1 ? std::atoi(arguments[1]) : 500);
  const std::int64_t seed = count > 2 ? std::atoi(arguments[2]) : 2;
  const auto nearly_right = count > 3 ? static_cast<std::size_t>(std::atoi(arguments[3])) : rigs;
  const bool all = count > 4 && std::strcmp(arguments[4], "all") == 0;
  const auto pairs = shipped_pairs();
  const auto wrong = run_all(pairs, rigs, [&](std::size_t i) { return wrong_pair(pairs, seed, i); });
  int bad = count_broken("wrong", wrong, all, breaks);
  std::vector<ShippedPair> loose;
  for (const ShippedPair& pair : pairs) loose.push_back(unjudged(pair));
  const auto control = run_all(loose, rigs / 10, [&](std::size_t i) { return wrong_pair(pairs, seed, i); });
  const auto leaps = std::count_if(control.begin(), control.end(), breaks);
  std::printf("control, the first tenth of them without judgement: %ld of %zu broke the rule\n",
              static_cast<long>(leaps), control.size());
  if (!control.empty() && leaps == 0) ++bad;
  const auto right =
      run_all(pairs, nearly_right, [&](std::size_t i) { return nearly_right_pair(pairs, seed, i, 0.2); });
  bad += count_broken("right", right, all, [](const Run& run) { return breaks(run) || is_refused(run); });
  return bad == 0 ? 0 : 1;
}
