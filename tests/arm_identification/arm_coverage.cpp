// SPDX-License-Identifier: Apache-2.0
// arm_coverage FIRST LAST: identifies simulated arms (tests/arm_identification/exact_arm.hpp), one for each seed from
// FIRST to LAST, and prints how many of the 95 % intervals hold what the simulation has, for each kind of parameter.

#include <tactus/identification/arm/fit.hpp>

#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <vector>

#include "tests/arm_identification/exact_arm.hpp"

namespace {

using namespace tactus;
using namespace tactus::arm_identification;

struct Count {
  int all = 0;
  int held = 0;
};

void print(const std::string& what, const Count& count) {
  std::printf("%-24s %5d of %5d: %.1f %%\n", what.c_str(), count.held, count.all,
              100.0 * count.held / (count.all > 0 ? count.all : 1));
}

}  // namespace

int main(int count, char** words) {
  if (count != 3) {
    std::fprintf(stderr, "use: arm_coverage FIRST LAST\n");
    return 2;
  }
  const std::uint64_t last = std::strtoull(words[2], nullptr, 10);
  Count all;
  Count told;
  std::map<std::string, Count> kinds;
  for (std::uint64_t seed = std::strtoull(words[1], nullptr, 10); seed <= last; ++seed) {
    const IntervalCase made = interval_case(seed);
    const auto found = identify_arm(std::array{made.recording}, made.names, made.urdf);
    if (!found) {
      std::fprintf(stderr, "seed %s: %s\n", std::to_string(seed).c_str(), describe(found.error()).c_str());
      return 1;
    }
    for (std::size_t j = 0; j < made.names.size(); ++j) {
      const std::vector<double> values = true_parameters(made.truth.joints[j]);
      for (std::size_t k = 0; k < values.size(); ++k) {
        const ArmParameter& p = found->joints[j].parameters[k];
        const int holds = values[k] >= p.lower && values[k] <= p.upper ? 1 : 0;
        for (Count* to : {&all, p.determined ? &told : nullptr, p.determined ? &kinds[p.name] : nullptr}) {
          if (to == nullptr) continue;
          ++to->all;
          to->held += holds;
        }
      }
    }
  }
  print("all", all);
  print("told by the recording", told);
  for (const auto& [name, kind] : kinds) print("  " + name, kind);
  return 0;
}
