// SPDX-License-Identifier: Apache-2.0
// any_grip EXPERIMENT RIG MODEL [--taps N] [--seed N] [--only WORD]... [--set KEY=VALUE]...
//
// Taps on the rig of the file RIG with the controller's model of the file MODEL, in hands that hold more or less firmly
// than the one that was identified: what scripts/any-grip makes its table of. Prints a JSON array with one object for
// each condition, `settling_s` holding the settling time of each tap, null where it did not settle. WORD is a group of
// conditions: grips, gains, changes, delays, tremor, apart, costs; without one, all of them.
#include <tactus/data/configuration/document.hpp>
#include <tactus/simulation/experiments/contest/contest.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>
#include <tactus/simulation/teleoperator/teleoperator.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace {

using namespace tactus;
using experiments::Tap;
using experiments::TappingEnsemble;
using experiments::TappingParams;
using experiments::TapResult;

constexpr double grips[] = {0.25, 0.5, 1.0, 2.0, 4.0};
constexpr double change_s = 0.1;

template <class T>
T need(Result<T> result) {
  if (result) return *std::move(result);
  std::fprintf(stderr, "any_grip: %s\n", describe(result.error()).c_str());
  std::exit(exit_status(result.error()));
}

TapResult run(const Tap& tap, double observation_s) {
  auto teleoperator = need(simulation::Teleoperator::make(tap.params, tap.path.start_m));
  experiments::TapObserver judge(tap, observation_s);
  for (std::size_t tick = 0;; ++tick) {
    const double time_s = static_cast<double>(tick) * teleoperator.tick_s();
    const auto record =
        teleoperator.step(tap.path.position_m(time_s), tap.path.position_m(time_s + teleoperator.tick_s()));
    if (!judge.observe(record, teleoperator.healthy())) return judge.result();
  }
}

class Table {
 public:
  void add(const char* group, const std::string& condition, const TappingParams& params,
           const std::vector<TapResult>& taps) {
    std::printf("%s{\"group\": \"%s\", \"condition\": \"%s\", \"gain\": %g, \"settling_s\": [", first_ ? "[\n" : ",\n",
                group, condition.c_str(), params.control.force_gain);
    first_ = false;
    for (std::size_t i = 0; i < taps.size(); ++i) {
      std::printf(i == 0 ? "" : ", ");
      if (taps[i].metrics.settled) {
        std::printf("%.4f", taps[i].metrics.settling_time_s);
      } else {
        std::printf("null");
      }
    }
    std::printf("]}");
    std::fflush(stdout);
  }
  void add_costs(const TappingParams& online, const TappingParams& fixed) {
    std::printf("%s{\"group\": \"costs\", \"online\": ", first_ ? "[\n" : ",\n");
    first_ = false;
    print_costs(online);
    std::printf(", \"fixed\": ");
    print_costs(fixed);
    std::printf("}");
  }

 private:
  static void print_costs(const TappingParams& params) {
    const auto score = experiments::score_taps(params);
    const auto free_space = experiments::score_free_space(params);
    std::printf("{\"settling time\": %.5f, \"hand error\": %.5f, \"effort\": %.6f, \"lag\": %.6f}",
                score.metrics.settling_time_median_s, score.spectral_error.value_or(0.0), free_space.hand_force_rms_N,
                free_space.lag_s.value_or(0.0));
  }

  bool first_ = true;
};

std::vector<TapResult> all_taps(const TappingParams& params) {
  const auto ensemble = need(TappingEnsemble::make(params));
  std::vector<TapResult> taps;
  for (std::size_t i = 0; i < ensemble.size(); ++i) taps.push_back(ensemble.run(i));
  return taps;
}

/// The hand holds `from` times as firmly until about the touch and `to` times 0.1 s later. When the change begins is
/// spread over 0.1 s either way of the touch.
std::vector<TapResult> taps_with_change(TappingParams params, double from, double to) {
  params.person.grip = mechanics::scaled(params.person.grip, from);
  const auto ensemble = need(TappingEnsemble::make(params));
  std::vector<TapResult> taps;
  for (std::size_t i = 0; i < ensemble.size(); ++i) {
    Tap tap = ensemble.tap(i);
    const double share = (static_cast<double>((7 * i) % ensemble.size()) + 0.5) / static_cast<double>(ensemble.size());
    const double touch_s = tap.path.start_time_s + 0.5 * tap.path.duration_s;
    tap.params.person.grip_change = {.factor = to / from,
                                     .start_s = std::max(0.0, touch_s + change_s * (2.0 * share - 1.0)),
                                     .duration_s = change_s};
    taps.push_back(run(tap, params.task.observation_s));
  }
  return taps;
}

std::string text(double number) {
  char word[32];
  std::snprintf(word, sizeof word, "%g", number);
  return word;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr,
                 "usage: any_grip EXPERIMENT RIG MODEL [--taps N] [--seed N] [--only WORD]... [--set KEY=VALUE]...\n");
    return 2;
  }
  std::vector<std::string> only, set;
  auto document = need(configuration::Document::load(argv[1]));
  for (const char* file : {argv[2], argv[3]}) {
    if (auto error = document.merge(need(configuration::Document::load(file)))) need<int>(*std::move(error));
  }
  // An identified model is as wrong as it is.
  for (const char* one :
       {"task.model_error=0", "control.force_limit_N=10", "control.force_gain=5", "control.operator_estimate=online"}) {
    set.emplace_back(one);
  }
  for (int i = 4; i + 1 < argc; i += 2) {
    if (std::strcmp(argv[i], "--taps") == 0) set.push_back(std::string("task.taps=") + argv[i + 1]);
    if (std::strcmp(argv[i], "--seed") == 0) set.push_back(std::string("task.seed=") + argv[i + 1]);
    if (std::strcmp(argv[i], "--only") == 0) only.emplace_back(argv[i + 1]);
    if (std::strcmp(argv[i], "--set") == 0) set.emplace_back(argv[i + 1]);
  }
  for (const std::string& one : set) {
    if (auto error = document.set(one)) need<int>(*std::move(error));
  }
  const auto wanted = [&only](const char* group) {
    return only.empty() || std::find(only.begin(), only.end(), group) != only.end();
  };
  const TappingParams nominal = need(document.read<TappingParams>());
  const auto at_gain = [](TappingParams params, double gain) {
    params.control.force_gain = gain;
    return params;
  };
  Table table;
  const auto in_any_grip = [&](const char* group, const std::string& condition, const TappingParams& params) {
    for (const double grip : grips) {
      table.add(group, std::string(condition).append("x").append(text(grip)), params,
                all_taps(experiments::with_grip(params, grip)));
    }
  };

  if (wanted("grips")) in_any_grip("grips", "", nominal);
  if (wanted("gains")) {
    for (const double gain : {2.0, 3.0, 8.0, 10.0}) {
      in_any_grip("gains", std::string("gain ") + text(gain) + ", ", at_gain(nominal, gain));
    }
  }
  if (wanted("changes")) {
    for (const double from : grips) {
      for (const double to : grips) {
        if (from == to) continue;
        table.add("changes", std::string("x") + text(from) + " to x" + text(to), nominal,
                  taps_with_change(nominal, from, to));
      }
    }
  }
  if (wanted("delays")) {
    for (const double delay_s : {0.001, 0.005, 0.02}) {
      in_any_grip("delays", text(1e3 * delay_s) + " ms, ", experiments::with_delay(nominal, delay_s));
    }
  }
  if (wanted("tremor")) {
    TappingParams trembling = nominal;
    trembling.person.tremor_amplitude_m *= 2.0;
    in_any_grip("tremor", "", trembling);
  }
  if (wanted("apart")) {
    for (const double stiffness : {0.5, 1.0, 2.0}) {
      for (const double damping : {0.5, 1.0, 2.0}) {
        if (stiffness == damping) continue;
        TappingParams apart = nominal;
        apart.person.grip.stiffness_N_per_m *= stiffness;
        apart.person.grip.damping_N_s_per_m *= damping;
        table.add("apart", std::string("stiffness x") + text(stiffness) + ", damping x" + text(damping), apart,
                  all_taps(apart));
      }
    }
  }
  if (wanted("costs")) {
    TappingParams fixed = nominal;
    fixed.control.operator_estimate = control::OperatorEstimate::off;
    table.add_costs(nominal, fixed);
  }
  std::printf("\n]\n");
  return 0;
}
