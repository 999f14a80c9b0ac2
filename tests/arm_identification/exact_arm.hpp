// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/arm/recording.hpp>
#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/arm_identification/kdl_arm.hpp"
#include <kdl/chaindynparam.hpp>

namespace tactus::arm_identification {

/// What a recording of an arm that follows its path exactly is to be like.
struct ExactSession {
  double duration_s = 20.0;
  std::uint64_t seed = 1;  ///< of the motion and of the noise
  double rate_Hz = 500.0;
  double noise_N_m = 0.02;
  double resolution_rad = 1e-5;
  double velocity_noise_rad_per_s = 1e-4;
  double slowest_Hz = 0.1;  ///< of the four sines of each joint
  double step_Hz = 0.35;    ///< from one to the next
  double size_rad = 0.35;
};

/// An arm that moves along sums of sines without any fault of following, and the torques that this takes by KDL's
/// dynamics and the law of friction: exact at every sample, unlike what an integrator of steps says.
inline Samples exact_motion(const arm::Chain::Params& truth, const ExactSession& session) {
  const KDL::Chain chain = kdl_chain(truth);
  const auto n = static_cast<unsigned>(truth.joints.size());
  KDL::ChainDynParam dynamics(
      chain, KDL::Vector(truth.gravity.x_m_per_s2, truth.gravity.y_m_per_s2, truth.gravity.z_m_per_s2));
  signal::Random random(session.seed);
  constexpr int sines = 4;
  std::vector<std::array<std::array<double, 3>, sines>> waves(n);
  for (auto& joint : waves) {
    for (int k = 0; k < sines; ++k) {
      joint[static_cast<std::size_t>(k)] = {
          session.size_rad * (0.4 + random.uniform()) / (1.0 + 0.7 * k),
          6.283185307 * (session.slowest_Hz + session.step_Hz * k + 0.6 * session.step_Hz * random.uniform()),
          6.283185307 * random.uniform()};
    }
  }
  KDL::JntArray q(n), v(n), gravity(n), coriolis(n);
  Eigen::VectorXd a(n);
  KDL::JntSpaceInertiaMatrix mass(static_cast<int>(n));
  Samples samples{.time_s = {},
                  .position = std::vector<std::vector<double>>(n),
                  .velocity = std::vector<std::vector<double>>(n),
                  .torque = std::vector<std::vector<double>>(n)};
  const auto count = static_cast<long>(session.duration_s * session.rate_Hz);
  for (long i = 0; i < count; ++i) {
    const double t = static_cast<double>(i) / session.rate_Hz;
    for (unsigned j = 0; j < n; ++j) {
      q(j) = j == 3 ? 1.2 : 0.2;
      v(j) = a[j] = 0.0;
      for (const auto& [size, omega, phase] : waves[j]) {
        q(j) += size * std::sin(omega * t + phase);
        v(j) += size * omega * std::cos(omega * t + phase);
        a[j] -= size * omega * omega * std::sin(omega * t + phase);
      }
    }
    dynamics.JntToMass(q, mass);
    dynamics.JntToGravity(q, gravity);
    dynamics.JntToCoriolis(q, v, coriolis);
    const Eigen::VectorXd rigid = mass.data * a + gravity.data + coriolis.data;
    samples.time_s.push_back(t);
    for (unsigned j = 0; j < n; ++j) {
      const arm::JointFriction& f = truth.joints[j].friction;
      const double friction =
          f.coulomb_N_m * std::tanh(v(j) / f.velocity_scale_rad_per_s) + f.viscous_N_m_s_per_rad * v(j) + f.offset_N_m;
      samples.position[j].push_back(std::round(q(j) / session.resolution_rad) * session.resolution_rad);
      samples.velocity[j].push_back(v(j) + session.velocity_noise_rad_per_s * random.normal());
      samples.torque[j].push_back(rigid[j] + friction + session.noise_N_m * random.normal());
    }
  }
  return samples;
}

/// Another arm of the same size: axes, lengths, masses and friction drawn.
inline arm::Chain::Params drawn_arm(std::uint64_t seed, std::size_t joints) {
  signal::Random random(1000 + seed);
  arm::Chain::Params params{.joints = Joints<arm::JointParams>(joints), .gravity = {0.0, 0.0, -9.81}};
  const auto between = [&](double low, double high) { return low * std::pow(high / low, random.uniform()); };
  const auto about_zero = [&](double size) { return size * (2.0 * random.uniform() - 1.0); };
  for (std::size_t j = 0; j < joints; ++j) {
    arm::JointParams& joint = params.joints[j];
    const double share = 1.0 - 0.7 * static_cast<double>(j) / static_cast<double>(joints);
    joint.origin = {.x_m = about_zero(0.05), .y_m = about_zero(0.05), .z_m = between(0.06, 0.3) * share};
    arm::Vector3 axis(0.0, 0.0, 0.0);
    axis[j % 2 == 0 ? 2 : (random.uniform() < 0.5 ? 0 : 1)] = random.uniform() < 0.5 ? 1.0 : -1.0;
    joint.axis = {axis.x(), axis.y(), axis.z()};
    // A heap of masses: an inertia that a body has.
    const double mass = between(0.5, 3.0) * share;
    const arm::Vector3 centre(about_zero(0.03), about_zero(0.03), between(0.03, 0.1));
    arm::Matrix3 factor;
    for (double& value : factor.reshaped()) value = about_zero(0.04);
    const arm::Matrix3 moments = mass * (factor * factor.transpose() + 4e-4 * arm::Matrix3::Identity());
    const arm::Matrix3 inertia = moments.trace() * arm::Matrix3::Identity() - moments;
    joint.body = {mass,          centre.x(),    centre.y(),    centre.z(),    inertia(0, 0),
                  inertia(1, 1), inertia(2, 2), inertia(0, 1), inertia(0, 2), inertia(1, 2)};
    joint.drive.armature_kg_m2 = between(0.005, 0.06) * share;
    joint.friction = {.coulomb_N_m = between(0.1, 0.8) * share,
                      .viscous_N_m_s_per_rad = between(0.05, 0.8) * share,
                      .offset_N_m = about_zero(0.2) * share,
                      .velocity_scale_rad_per_s = between(0.01, 0.1)};
  }
  return params;
}

/// A simulated arm with a recording of it and what its URDF would say: for each seed another arm of 4, 6 or 7 joints,
/// another motion, noise, resolution and rate.
struct IntervalCase {
  arm::Chain::Params truth;
  arm::Chain::Params urdf;
  std::vector<std::string> names;
  ArmRecording recording;
};

inline IntervalCase interval_case(std::uint64_t seed) {
  const std::size_t joints = std::array<std::size_t, 4>{7, 6, 7, 4}[seed % 4];
  IntervalCase made{
      .truth = seed % 4 == 0 ? open_arm() : drawn_arm(seed, joints), .urdf = {}, .names = {}, .recording = {}};
  made.urdf = believed(made.truth, 100 + seed);
  for (std::size_t j = 1; j <= joints; ++j) made.names.push_back("j" + std::to_string(j));
  signal::Random random(seed + 77);
  const double quick = 0.7 + 0.6 * random.uniform();
  const Samples samples = exact_motion(made.truth, {.duration_s = 20.0,
                                                    .seed = seed,
                                                    .rate_Hz = seed % 5 == 0 ? 1000.0 : 500.0,
                                                    .noise_N_m = 0.01 * std::pow(5.0, random.uniform()),
                                                    .resolution_rad = seed % 3 == 0 ? 1e-4 : 1e-5,
                                                    .slowest_Hz = 0.1 * quick,
                                                    .step_Hz = 0.35 * quick});
  made.recording = {.file = "simulated.csv",
                    .position_names = made.names,
                    .effort_names = made.names,
                    .sample_time = Seconds{samples.time_s[1]}};
  made.recording.position = samples.position;
  made.recording.velocity = samples.velocity;
  made.recording.effort = samples.torque;
  return made;
}

/// What the simulation has where `ArmJointFit::parameters` begins: body, armature, Coulomb and viscous friction,
/// offset.
inline std::vector<double> true_parameters(const arm::JointParams& joint) {
  const arm::BodyVector body = arm::linear_parameters(joint.body);
  std::vector<double> values(body.begin(), body.end());
  values.insert(values.end(), {joint.drive.armature_kg_m2, joint.friction.coulomb_N_m,
                               joint.friction.viscous_N_m_s_per_rad, joint.friction.offset_N_m});
  return values;
}

}  // namespace tactus::arm_identification
