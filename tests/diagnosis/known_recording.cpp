// SPDX-License-Identifier: Apache-2.0
// known_recording CAUSE STRENGTH SEED: prints as a table what a user would have recorded of a simulated teleoperator
// that shakes for a known reason. CAUSE is the word of a diagnosis, STRENGTH quiet, near or clear.

#include <algorithm>
#include <cstdlib>
#include <iostream>

#include "tests/diagnosis/known_cause.hpp"

int main(int argc, char** argv) {
  using namespace tactus;
  constexpr std::array<std::string_view, 3> strengths{"quiet", "near", "clear"};
  const auto cause = argc == 4 ? std::find(known::words.begin(), known::words.end(), argv[1]) : known::words.end();
  const auto strength = argc == 4 ? std::find(strengths.begin(), strengths.end(), argv[2]) : strengths.end();
  if (cause == known::words.end() || strength == strengths.end()) {
    std::cerr << "known_recording CAUSE quiet|near|clear SEED\n";
    return 2;
  }
  const auto made =
      known::make(static_cast<known::Cause>(cause - known::words.begin()),
                  static_cast<known::Strength>(strength - strengths.begin()), std::strtoull(argv[3], nullptr, 10));
  if (!made) {
    std::cerr << describe(made.error()) << '\n';
    return 1;
  }
  std::cerr << made->parameter << " " << made->strength << " of its onset, " << made->onset << '\n';
  std::cout << known::to_csv(*made);
  return 0;
}
