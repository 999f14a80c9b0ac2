// SPDX-License-Identifier: Apache-2.0
// attack_handshake [HAND-SHAKES [PER_SECOND]]: so many hand-shakes of two sites under each kind of hostile packet,
// toward the slave, the master and both, so many a second. Prints how long they took. Status 1 where one failed.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <tuple>
#include <vector>

#include <tests/link/handshake_attack.hpp>

int main(int count, char** arguments) {
  using tactus::link::testing::HandshakeAttack;
  constexpr double longest_s = 8.0;
  const int handshakes = count > 1 ? std::atoi(arguments[1]) : 50;
  const double per_second = count > 2 ? std::atof(arguments[2]) : 10'000.0;
  if (handshakes <= 0 || !(per_second >= 0.0)) {
    std::fprintf(stderr, "attack_handshake: use: attack_handshake [HAND-SHAKES [PER_SECOND]]\n");
    return 2;
  }
  HandshakeAttack attack(1);
  int failed = 0;
  const auto run = [&](const char* name, const char* toward, const HandshakeAttack::Plan& plan) {
    std::vector<double> took_s;
    for (int i = 0; i < handshakes; ++i) {
      if (const auto one_s = attack.shake_hands(plan, longest_s)) took_s.push_back(*one_s);
    }
    const int here = handshakes - static_cast<int>(took_s.size());
    failed += here;
    std::sort(took_s.begin(), took_s.end());
    const double median_s = took_s.empty() ? 0.0 : took_s[took_s.size() / 2];
    const double longest = took_s.empty() ? 0.0 : took_s.back();
    std::printf("%-24s to %-7s failed %d of %d   median %6.3f s   longest %6.3f s\n", name, toward, here, handshakes,
                median_s, longest);
    std::fflush(stdout);
  };
  run("nothing", "nobody", {.to_master = false, .to_slave = false});
  for (std::size_t kind = 0; kind < HandshakeAttack::names.size(); ++kind) {
    for (const auto& [toward, to_master, to_slave] :
         {std::tuple{"slave", false, true}, {"master", true, false}, {"both", true, true}}) {
      run(HandshakeAttack::names[kind], toward,
          {.kind = static_cast<HandshakeAttack::Kind>(kind),
           .to_master = to_master,
           .to_slave = to_slave,
           .per_second = per_second});
    }
  }
  return failed > 0 ? 1 : 0;
}
