// arm_coverage FIRST LAST [integrated]: identifies simulated arms, a case for each seed, and prints a line for each
// parameter: case, joint, name, whether it is told, the simulation's value, the found one, and both ends of its
// interval.

#include <tactus/arm_identification/fit.hpp>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "tests/arm_identification/exact_arm.hpp"

namespace {

using namespace tactus;
using namespace tactus::arm_identification;

ArmRecording recorded(const Samples& samples, const std::vector<std::string>& names) {
  ArmRecording recording{.file = "simulated.csv",
                         .position_names = names,
                         .effort_names = names,
                         .sample_time = Seconds{samples.time_s[1]}};
  recording.position = samples.position;
  recording.velocity = samples.velocity;
  recording.effort = samples.torque;
  return recording;
}

}  // namespace

int main(int count, char** words) {
  const std::uint64_t first = std::strtoull(words[1], nullptr, 10);
  const std::uint64_t last = std::strtoull(words[2], nullptr, 10);
  const bool integrated = count > 3;
  for (std::uint64_t seed = first; seed <= last; ++seed) {
    const std::size_t joints = std::array<std::size_t, 4>{7, 6, 7, 4}[seed % 4];
    const arm::Chain::Params truth = seed % 4 == 0 ? open_arm() : drawn_arm(seed, joints);
    std::vector<std::string> names;
    for (std::size_t j = 1; j <= joints; ++j) names.push_back("j" + std::to_string(j));
    signal::Random random(seed + 77);
    const double quick = 0.7 + 0.6 * random.uniform();
    const double noise = 0.01 * std::pow(5.0, random.uniform());
    const double fine = seed % 3 == 0 ? 1e-4 : 1e-5;
    const double rate = seed % 5 == 0 ? 1000.0 : 500.0;
    Samples samples;
    if (integrated) {
      samples = simulate(truth, {.duration_s = 20.0,
                                 .seed = seed,
                                 .noise_N_m = noise,
                                 .resolution_rad = fine,
                                 .step_s = 1.0 / 32000.0,
                                 .steps_between = 64});
    } else {
      samples = exact_motion(truth, {.duration_s = 20.0,
                                     .seed = seed,
                                     .rate_Hz = rate,
                                     .noise_N_m = noise,
                                     .resolution_rad = fine,
                                     .slowest_Hz = 0.1 * quick,
                                     .step_Hz = 0.35 * quick});
    }
    const auto start = std::chrono::steady_clock::now();
    const auto found = identify_arm(std::array{recorded(samples, names)}, names, believed(truth, 100 + seed));
    if (!found) {
      std::fprintf(stderr, "%llu: %s\n", static_cast<unsigned long long>(seed), describe(found.error()).c_str());
      continue;
    }
    std::fprintf(stderr, "%llu %.1f s scaled %d", static_cast<unsigned long long>(seed),
                 std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
                 found->scaled_efforts);
    for (const ArmJointFit& joint : found->joints) std::fprintf(stderr, " %.2f", 100.0 * joint.held_out_relative);
    for (const ArmJointFit& joint : found->joints) std::fprintf(stderr, " (%.4f)", joint.residual_rms);
    std::fprintf(stderr, "\n");
    for (std::size_t j = 0; j < joints; ++j) {
      const arm::JointParams& joint = truth.joints[j];
      const arm::BodyVector body = arm::linear_parameters(joint.body);
      std::vector<double> values(body.begin(), body.end());
      values.insert(values.end(), {joint.drive.armature_kg_m2, joint.friction.coulomb_N_m,
                                   joint.friction.viscous_N_m_s_per_rad, joint.friction.offset_N_m});
      for (std::size_t k = 0; k < values.size(); ++k) {
        const ArmParameter& p = found->joints[j].parameters[k];
        std::printf("%llu %zu %s %d %.9g %.9g %.9g %.9g\n", static_cast<unsigned long long>(seed), j + 1,
                    p.name.c_str(), p.told, values[k], p.value, p.lower, p.upper);
      }
    }
    std::fflush(stdout);
  }
  return 0;
}
