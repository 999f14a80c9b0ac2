// SPDX-License-Identifier: Apache-2.0
// best_gain EXPERIMENT RIG MODEL [--exact] [--taps N] [--set KEY=VALUE]...
//
// The largest force gain that any method of `tactus advise` reaches on the rig of the file RIG, by trying them all on
// it: every combination, then other numbers for the best ten. With the controller's model of the file MODEL, or, with
// --exact, with one that has the rig's own numbers where MODEL has found ones. Prints one line of JSON.
#include <tactus/analysis/advice/advise.hpp>
#include <tactus/data/configuration/toml_writer.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

namespace {

using namespace tactus;
using experiments::GainLimit;

constexpr double resolution = 1.05;
constexpr std::size_t at_once = 8;
constexpr std::size_t retuned_best = 10;

template <class T>
T need(Result<T> result) {
  if (result) return *std::move(result);
  std::fprintf(stderr, "best_gain: %s\n", describe(result.error()).c_str());
  std::exit(exit_status(result.error()));
}

struct Best {
  advice::Method method;
  GainLimit limit;
};

/// Until one reaches the end of the search.
std::vector<Best> try_all(const advice::Bench& bench, const std::vector<advice::Method>& methods, double force_limit_N,
                          const advice::Draws& draws) {
  std::vector<Best> tried;
  for (std::size_t first = 0; first < methods.size(); first += at_once) {
    const auto begin = methods.begin() + static_cast<std::ptrdiff_t>(first);
    const std::vector<advice::Method> some(
        begin, begin + static_cast<std::ptrdiff_t>(std::min(at_once, methods.size() - first)));
    const auto limits = need(advice::limits_of(bench, some, force_limit_N, draws, resolution, [](double) {}));
    for (std::size_t i = 0; i < some.size(); ++i) tried.push_back({some[i], limits[i]});
    if (std::any_of(limits.begin(), limits.end(), [](const GainLimit& one) { return one.beyond_search; })) break;
  }
  std::stable_sort(tried.begin(), tried.end(),
                   [](const Best& a, const Best& b) { return a.limit.gain > b.limit.gain; });
  return tried;
}

/// `model` with what the rig really has, as a commanded newton sees it.
control::MasterModel exact(control::MasterModel model, const experiments::TappingParams& rig) {
  const auto& mechanism = rig.master.mechanism;
  const double gain = rig.master.amplifier.gain;
  model.motor = {.mass_kg = mechanism.motor.mass_kg / gain, .friction_N = mechanism.motor.friction_N / gain};
  model.drum = {.mass_kg = mechanism.drum.mass_kg / gain, .friction_N = mechanism.drum.friction_N / gain};
  model.cable = {.stiffness_N_per_m = mechanism.cable.stiffness_N_per_m / gain,
                 .damping_N_s_per_m = mechanism.cable.damping_N_s_per_m / gain};
  model.linkage = {.stiffness_N_per_m = mechanism.linkage.stiffness_N_per_m / gain,
                   .damping_N_s_per_m = mechanism.linkage.damping_N_s_per_m / gain,
                   .hysteretic_fraction = mechanism.linkage.hysteretic_fraction,
                   .slip_deflection_m = 0.65 * mechanism.linkage.slip_deflection_m,
                   .reference_deflection_m = mechanism.linkage.reference_deflection_m};
  model.handle.mass_kg = mechanism.tip.mass_kg / gain;
  model.hand.stiffness_N_per_m = rig.person.grip.stiffness_N_per_m / gain;
  model.hand.damping_N_s_per_m = rig.person.grip.damping_N_s_per_m / gain;
  return model;
}

struct ModelFile {
  struct Control {
    control::MasterModel model;
    static constexpr auto fields() { return List{field("model", &Control::model, "The controller's model.")}; }
  };
  Control control;
  static constexpr auto fields() { return List{field("control", &ModelFile::control, "The controllers.")}; }
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "usage: best_gain EXPERIMENT RIG MODEL [--exact] [--taps N] [--set KEY=VALUE]...\n");
    return 2;
  }
  bool with_exact = false;
  advice::Draws draws{.first = 5000, .rigs = 1, .taps = 20};
  std::vector<std::string> set;
  for (int i = 4; i < argc; ++i) {
    if (std::strcmp(argv[i], "--exact") == 0) with_exact = true;
    if (std::strcmp(argv[i], "--taps") == 0 && i + 1 < argc) draws.taps = std::atoi(argv[++i]);
    if (std::strcmp(argv[i], "--set") == 0 && i + 1 < argc) set.emplace_back(argv[++i]);
  }
  auto document = need(configuration::Document::load(argv[1]));
  for (const char* file : {argv[2], argv[3]}) {
    if (auto error = document.merge(need(configuration::Document::load(file)))) need<int>(*std::move(error));
  }
  for (const std::string& one : set) {
    if (auto error = document.set(one)) need<int>(*std::move(error));
  }
  if (with_exact) {
    const auto params = need(document.read<experiments::TappingParams>());
    const ModelFile model{.control = {.model = exact(params.control.model, params)}};
    if (auto error = document.merge(need(configuration::Document::parse(configuration::to_toml(model), "exact")))) {
      need<int>(*std::move(error));
    }
  }
  if (auto error = document.set("task.model_error=0")) need<int>(*std::move(error));
  const auto bench = need(advice::make_bench(std::move(document), {}, set));  // nothing is uncertain
  const auto params = need(bench.document.read<experiments::TappingParams>());
  const auto dimensions = need(advice::allowed(bench, advice::position_force_dimensions(params.control.model)));
  auto methods = advice::combine(dimensions, advice::most_stages);
  std::reverse(methods.begin(), methods.end());  // those with most stages reach the end of the search, if any does
  auto tried = try_all(bench, methods, params.control.force_limit_N, draws);
  if (!tried.front().limit.beyond_search) {
    std::vector<advice::Method> more;
    for (std::size_t i = 0; i < std::min(retuned_best, tried.size()); ++i) {
      for (advice::Method& method : advice::retuned(tried[i].method)) more.push_back(std::move(method));
    }
    for (Best& one : try_all(bench, more, params.control.force_limit_N, draws)) {
      if (one.limit.gain > tried.front().limit.gain) tried.front() = std::move(one);
    }
  }
  std::printf("{\"force_gain\": %.6g, \"force_gain_censored\": %s, \"method\": \"%s\"}\n", tried.front().limit.gain,
              tried.front().limit.beyond_search ? "true" : "false", tried.front().method.words().c_str());
  return 0;
}
