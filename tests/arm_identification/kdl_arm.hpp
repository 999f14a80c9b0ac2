// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Cholesky>
#include <kdl/chain.hpp>
#include <kdl/chaindynparam.hpp>
#include <kdl/chainjnttojacsolver.hpp>

namespace tactus::arm_identification {

/// A seven-joint arm of the size of OpenArm's, after the figures of its public description; simulated by another
/// library's dynamics.
inline arm::Chain::Params open_arm() {
  struct Row {
    std::array<double, 3> offset, axis;
    double mass;
    std::array<double, 3> centre;
    std::array<double, 6> inertia;  // xx yy zz xy xz yz
    double armature, coulomb, viscous;
  };
  static constexpr std::array<Row, 7> rows{{{{0, 0, 0.0625},
                                             {0, 0, 1},
                                             1.1417,
                                             {0.00115, 0.00003, 0.05395},
                                             {0.001567, 0.001273, 0.001016, -1e-6, -2.9e-5, 1e-6},
                                             0.0167,
                                             0.306,
                                             0.063},
                                            {{-0.0301, 0, 0.06},
                                             {-1, 0, 0},
                                             0.2775,
                                             {0.0084, 0, 0.03257},
                                             {0.000359, 0.000376, 0.000232, 1e-6, -1.09e-4, 1e-6},
                                             0.0167,
                                             0.306,
                                             0.063},
                                            {{0.0301, 0, 0.06625},
                                             {0, 0, 1},
                                             1.0739,
                                             {-0.0021, 0.00055, 0.08847},
                                             {0.004372, 0.004319, 0.000661, 1e-6, 1.1e-5, -3.6e-5},
                                             0.029,
                                             0.40,
                                             0.604},
                                            {{0, 0.0315, 0.15375},
                                             {0, 1, 0},
                                             0.5599,
                                             {-0.0029, -0.03031, 0.0634},
                                             {0.000623, 0.000511, 0.000334, -1e-6, -1.9e-5, 3.8e-5},
                                             0.029,
                                             0.166,
                                             0.813},
                                            {{0, -0.0315, 0.0955},
                                             {0, 0, 1},
                                             0.5507,
                                             {-0.00305, 0.00089, 0.04308},
                                             {0.000423, 0.000445, 0.000324, -8e-6, 6e-6, -6e-6},
                                             0.0018,
                                             0.050,
                                             0.029},
                                            {{0.0375, 0, 0.1205},
                                             {1, 0, 0},
                                             0.3852,
                                             {-0.03714, 0.00033, -0.00009},
                                             {0.000143, 0.000157, 0.000159, 1e-6, 1e-6, 1e-6},
                                             0.0018,
                                             0.083,
                                             0.072},
                                            {{-0.0375, 0, 0},
                                             {0, 1, 0},
                                             0.756,
                                             {0.00003, 0.00744, 0.08443},
                                             {0.00142, 0.00127, 0.00055, 0, 0, 1.2e-4},
                                             0.0018,
                                             0.172,
                                             0.084}}};
  arm::Chain::Params params{.joints = Joints<arm::JointParams>(rows.size()), .gravity = {0.0, -9.81, 0.0}};
  for (std::size_t j = 0; j < rows.size(); ++j) {
    const Row& r = rows[j];
    arm::JointParams& joint = params.joints[j];
    joint.origin = {.x_m = r.offset[0], .y_m = r.offset[1], .z_m = r.offset[2]};
    joint.axis = {r.axis[0], r.axis[1], r.axis[2]};
    joint.body = {r.mass,       r.centre[0],  r.centre[1],  r.centre[2],  r.inertia[0],
                  r.inertia[1], r.inertia[2], r.inertia[3], r.inertia[4], r.inertia[5]};
    joint.drive.armature_kg_m2 = r.armature;
    joint.friction = {.coulomb_N_m = r.coulomb, .viscous_N_m_s_per_rad = r.viscous, .velocity_scale_rad_per_s = 0.02};
  }
  return params;
}

/// The same as a URDF would have it: nobody's masses are exact. No friction, no armature.
inline arm::Chain::Params believed(const arm::Chain::Params& truth, std::uint64_t seed) {
  signal::Random random(seed);
  arm::Chain::Params params = truth;
  const auto about = [&](double share) { return 1.0 + share * (2.0 * random.uniform() - 1.0); };
  for (arm::JointParams& joint : params.joints) {
    arm::Body& b = joint.body;
    const double mass = about(0.2);
    const double size = mass * about(0.3);
    b.mass_kg *= mass;
    for (double arm::Body::*c : {&arm::Body::centre_x_m, &arm::Body::centre_y_m, &arm::Body::centre_z_m}) {
      b.*c += 0.005 * (2.0 * random.uniform() - 1.0);
    }
    for (double arm::Body::*i : {&arm::Body::xx_kg_m2, &arm::Body::yy_kg_m2, &arm::Body::zz_kg_m2, &arm::Body::xy_kg_m2,
                                 &arm::Body::xz_kg_m2, &arm::Body::yz_kg_m2}) {
      b.*i *= size;
    }
    joint.drive = {};
    joint.friction = {};
  }
  return params;
}

/// A push on the tool along an axis of the base.
struct Push {
  double from_s = 0.0;
  double to_s = 0.0;
  double force_N = 0.0;
};

/// What a recording of the simulated arm is to be like.
struct Session {
  double duration_s = 20.0;
  std::uint64_t seed = 1;  ///< of the motion and of the noise
  double noise_N_m = 0.02;
  double resolution_rad = 1e-5;
  /// Of the integrator, which is of first order: its torques are half a step early.
  double step_s = 1.0 / 4000.0;
  int steps_between = 8;  ///< recorded at 500 Hz
  std::vector<Push> pushes = {};
  /// Where a joint is to be at a time; without it a sum of sines that `seed` draws.
  std::function<double(unsigned joint, double time_s)> path = {};
};

struct Samples {
  std::vector<double> time_s;
  std::vector<std::vector<double>> position, velocity, torque;  ///< by joint
};

/// The arm as KDL has it: joints, bodies and armatures, no friction.
inline KDL::Chain kdl_chain(const arm::Chain::Params& truth) {
  KDL::Chain chain;
  for (const arm::JointParams& j : truth.joints) {
    const KDL::Vector at(j.origin.x_m, j.origin.y_m, j.origin.z_m);
    chain.addSegment(KDL::Segment(
        KDL::Joint(at, KDL::Vector(j.axis.x, j.axis.y, j.axis.z), KDL::Joint::RotAxis, 1.0, 0.0,
                   j.drive.armature_kg_m2),
        KDL::Frame(at),
        KDL::RigidBodyInertia(j.body.mass_kg, KDL::Vector(j.body.centre_x_m, j.body.centre_y_m, j.body.centre_z_m),
                              KDL::RotationalInertia(j.body.xx_kg_m2, j.body.yy_kg_m2, j.body.zz_kg_m2, j.body.xy_kg_m2,
                                                     j.body.xz_kg_m2, j.body.yz_kg_m2))));
  }
  return chain;
}

/// Integrates the arm under a controller that follows a path, with KDL's mass matrix, Coriolis torque and
/// gravity: none of this project's dynamics is in it.
inline Samples simulate(const arm::Chain::Params& truth, const Session& session) {
  const KDL::Chain chain = kdl_chain(truth);
  const auto n = static_cast<unsigned>(truth.joints.size());
  KDL::ChainDynParam dynamics(
      chain, KDL::Vector(truth.gravity.x_m_per_s2, truth.gravity.y_m_per_s2, truth.gravity.z_m_per_s2));
  KDL::ChainJntToJacSolver jacobians(chain);

  signal::Random random(session.seed);
  constexpr int sines = 4;
  std::vector<std::array<std::array<double, 3>, sines>> waves(n);
  for (auto& joint : waves) {
    for (int k = 0; k < sines; ++k) {
      joint[static_cast<std::size_t>(k)] = {(0.15 + 0.35 * random.uniform()) / (1.0 + 0.7 * k),
                                            0.1 + 0.35 * k + 0.2 * random.uniform(), 6.28 * random.uniform()};
    }
  }
  const auto wanted = [&](unsigned j, double t) {
    if (session.path) return session.path(j, t);
    double sum = j == 3 ? 1.2 : 0.2;
    for (const auto& [size, frequency, phase] : waves[j]) sum += size * std::sin(6.2832 * frequency * t + phase);
    return sum;
  };
  constexpr std::array<double, 7> stiffness{240, 240, 240, 240, 24, 31, 25};
  constexpr std::array<double, 7> damping{6, 6, 6, 6, 0.6, 0.6, 0.6};
  const double step_s = session.step_s;
  KDL::JntArray q(n), v(n), gravity(n), coriolis(n);
  KDL::JntSpaceInertiaMatrix mass(static_cast<int>(n));
  KDL::Jacobian jacobian(n);
  for (unsigned j = 0; j < n; ++j) q(j) = wanted(j, 0.0);
  Samples samples{.time_s = {},
                  .position = std::vector<std::vector<double>>(n),
                  .velocity = std::vector<std::vector<double>>(n),
                  .torque = std::vector<std::vector<double>>(n)};
  Eigen::VectorXd torque(n), free(n);
  const auto steps = static_cast<long>(session.duration_s / step_s);
  for (long i = 0; i < steps; ++i) {
    const double t = static_cast<double>(i) * step_s;
    dynamics.JntToMass(q, mass);
    dynamics.JntToGravity(q, gravity);
    dynamics.JntToCoriolis(q, v, coriolis);
    for (unsigned j = 0; j < n; ++j) {
      const arm::JointFriction& f = truth.joints[j].friction;
      // The slope of the path from its difference; the motor holds the arm's weight.
      const double wanted_speed = (wanted(j, t + 1e-4) - wanted(j, t - 1e-4)) / 2e-4;
      torque[j] = gravity(j) + stiffness[j] * (wanted(j, t) - q(j)) + damping[j] * (wanted_speed - v(j));
      free[j] = torque[j] - gravity(j) - coriolis(j) - f.coulomb_N_m * std::tanh(v(j) / f.velocity_scale_rad_per_s) -
                f.viscous_N_m_s_per_rad * v(j) - f.offset_N_m;
    }
    for (const Push& push : session.pushes) {
      if (t < push.from_s || t >= push.to_s) continue;
      jacobians.JntToJac(q, jacobian);
      free += push.force_N * jacobian.data.row(2).transpose();
    }
    if (i % session.steps_between == 0) {
      samples.time_s.push_back(t);
      for (unsigned j = 0; j < n; ++j) {
        samples.position[j].push_back(std::round(q(j) / session.resolution_rad) * session.resolution_rad);
        samples.velocity[j].push_back(v(j));
        samples.torque[j].push_back(torque[j] + session.noise_N_m * (random.uniform() - 0.5) * 3.46);
      }
    }
    // Friction that grows steeply about standstill is taken at the end of the step.
    Eigen::MatrixXd held = mass.data;
    for (unsigned j = 0; j < n; ++j) {
      const arm::JointFriction& f = truth.joints[j].friction;
      const double c = std::cosh(v(j) / f.velocity_scale_rad_per_s);
      held(j, j) +=
          step_s * (f.coulomb_N_m / f.velocity_scale_rad_per_s / (c * c) + f.viscous_N_m_s_per_rad + damping[j]);
    }
    v.data += step_s * Eigen::LLT<Eigen::MatrixXd>(held).solve(free);
    q.data += step_s * v.data;
  }
  return samples;
}

}  // namespace tactus::arm_identification
