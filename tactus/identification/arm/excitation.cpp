// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/excitation.hpp>
#include <tactus/identification/arm/minimise.hpp>
#include <tactus/identification/arm/motion.hpp>
#include <tactus/identification/arm/motion_information.hpp>
#include <tactus/identification/axis/refusal.hpp>
#include <tactus/kernel/core/parameters.hpp>
#include <tactus/kernel/signal/random.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

namespace tactus::arm_identification {
namespace {

using arm::JointVector;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using identification::inconsistent;

constexpr int starts = 3;
constexpr int most_draws = 400;
constexpr int most_harmonics = 20;
constexpr int steps_of_a_stage = 60;
constexpr int checks_of_a_harmonic = 100;  ///< of the highest
constexpr double slow_rad_per_s = 0.1;     ///< within which friction is taken to turn round
constexpr double friction_share = 0.1;     ///< of the torques' size where the URDF has none
constexpr double unlimited = 1e9;          ///< what a URDF without a limit reads

/// How firmly and how finely limits are kept while a motion is sought, and how much of them is left free: one stage
/// after the other, those of the last kind until no limit is left.
struct Stage {
  double firmness;
  int instants_of_a_harmonic;  ///< of the highest
  double share;
};
constexpr std::array<Stage, 2> search{{{3e2, 10, 0.98}, {1e4, 10, 0.98}}};
constexpr std::array<Stage, 3> finish{{{1e5, 20, 0.97}, {1e5, 20, 0.93}, {1e5, 20, 0.85}}};

/// The series that is asked for.
struct Series {
  double period_s;
  int harmonics;
  [[nodiscard]] int instants() const { return search.front().instants_of_a_harmonic * harmonics; }
  [[nodiscard]] int checks() const { return checks_of_a_harmonic * harmonics; }
};

Check check_request(const ExcitationRequest& request, std::size_t joints) {
  const auto refuse = [](const char* name, double value, const std::string& bounds) {
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = name,
                 .message = "is " + rounded_number(value) + "; it must be " + bounds,
                 .place = {}};
  };
  if (!(request.duration_s >= 1.0 && request.duration_s <= 600.0)) {
    return refuse("duration_s", request.duration_s, "1 to 600 s");
  }
  if (!(request.highest_Hz > 0.0 && request.highest_Hz <= 0.5 * default_arm_cutoff_Hz)) {
    return refuse("highest_Hz", request.highest_Hz, "above 0 and at most 5 Hz");
  }
  if (!(request.share > 0.0 && request.share <= 1.0)) return refuse("share", request.share, "above 0 and at most 1");
  if (request.noise_N_m.size() != joints) {
    return inconsistent("noise_N_m", std::to_string(request.noise_N_m.size()) + " numbers are given, but the arm has " +
                                         std::to_string(joints) + " joints; give one for each");
  }
  for (const double noise : request.noise_N_m) {
    if (!(noise > 0.0 && std::isfinite(noise))) return refuse("noise_N_m", noise, "above 0 N m");
  }
  const double harmonics = std::floor(request.duration_s * request.highest_Hz + 1e-9);
  if (harmonics < 2.0 || harmonics > most_harmonics) {
    return inconsistent("highest_Hz", "a series of " + rounded_number(request.duration_s) + " s has " +
                                          rounded_number(harmonics) + " harmonics up to " +
                                          rounded_number(request.highest_Hz) + " Hz; ask for 2 to " +
                                          std::to_string(most_harmonics));
  }
  return {};
}

Result<MotionLimits> limits_of(const std::vector<std::string>& joints, const arm::Chain::Params& urdf,
                               const ExcitationRequest& request) {
  const auto count = static_cast<Index>(joints.size());
  MotionLimits limits{.lower = JointVector(count),
                      .upper = JointVector(count),
                      .velocity = JointVector(count),
                      .effort = JointVector(count),
                      .box_lower_m = request.box_lower_m,
                      .box_upper_m = request.box_upper_m,
                      .points = request.points};
  for (Index j = 0; j < count; ++j) {
    const auto at = static_cast<std::size_t>(j);
    arm::JointLimits own = urdf.joints[at].limits;
    if (urdf.joints[at].kind == arm::JointKind::revolute && own.lower_rad <= -unlimited && own.upper_rad >= unlimited) {
      own.lower_rad = -std::numbers::pi;
      own.upper_rad = std::numbers::pi;
    }
    const auto missing = [&](const char* what) {
      return Error{.code = ErrorCode::missing,
                   .parameter = {},
                   .message = "joint '" + joints[at] + "' has no limit of " + what +
                              ", and a motion must keep to one; write <limit lower=\"\" upper=\"\" velocity=\"\" "
                              "effort=\"\"/> into the URDF",
                   .place = {}};
    };
    if (!(own.lower_rad < own.upper_rad) || own.lower_rad <= -unlimited || own.upper_rad >= unlimited) {
      return missing("position");
    }
    if (!(own.velocity_rad_per_s > 0.0) || own.velocity_rad_per_s >= unlimited) return missing("velocity");
    if (!(own.effort_N_m > 0.0) || own.effort_N_m >= unlimited) return missing("effort");
    const double middle = 0.5 * (own.lower_rad + own.upper_rad);
    const double half = 0.5 * request.share * (own.upper_rad - own.lower_rad);
    limits.lower[j] = middle - half;
    limits.upper[j] = middle + half;
    limits.velocity[j] = request.share * own.velocity_rad_per_s;
    limits.effort[j] = request.share * own.effort_N_m;
  }
  return limits;
}

/// The points that some motion moves.
std::vector<std::vector<arm::Vector3>> movable(const std::vector<std::vector<arm::Vector3>>& points,
                                               const arm::Chain& chain, signal::Random random) {
  constexpr double moved_m = 1e-6;
  std::vector<std::vector<arm::Vector3>> found(points.size());
  const auto here = chain.poses(JointVector::Zero(chain.joints()));
  JointVector position(chain.joints());
  for (double& q : position) q = random.uniform(-1.0, 1.0);
  const auto there = chain.poses(position);
  for (std::size_t j = 0; j < points.size(); ++j) {
    for (const arm::Vector3& p : points[j]) {
      const arm::Vector3 before = here[j].rotation * p + here[j].position_m;
      if ((there[j].rotation * p + there[j].position_m - before).norm() > moved_m) found[j].push_back(p);
    }
  }
  return found;
}

/// The same with all limits `share` as far from their middle, and the box drawn in by what weighs as much.
MotionLimits tightened(MotionLimits limits, double share) {
  limits.box_lower_m.array() += (1.0 - share) / metre_beyond;
  limits.box_upper_m.array() -= (1.0 - share) / metre_beyond;
  const JointVector middle = 0.5 * (limits.lower + limits.upper);
  const JointVector half = 0.5 * share * (limits.upper - limits.lower);
  limits.lower = middle - half;
  limits.upper = middle + half;
  limits.velocity *= share;
  limits.effort *= share;
  return limits;
}

/// A centre in the inner half of the range and normal coefficients, about as large as the range.
FourierMotion drawn(signal::Random& random, const Series& series, const MotionLimits& limits) {
  const Index joints = limits.lower.size();
  MatrixXd coordinates(joints, FourierMotion::coordinates(series.harmonics));
  for (Index j = 0; j < joints; ++j) {
    const double middle = 0.5 * (limits.lower[j] + limits.upper[j]);
    const double half = 0.5 * (limits.upper[j] - limits.lower[j]);
    for (Index k = 1; k < coordinates.cols(); ++k) coordinates(j, k) = random.normal();
    coordinates(j, 0) = middle + half * random.uniform(-0.5, 0.5);
  }
  const FourierMotion raw(series.period_s, series.harmonics, coordinates);
  VectorXd reach = VectorXd::Zero(joints);
  for (int i = 0; i < series.instants(); ++i) {
    const FourierMotion::State state = raw.at(series.period_s * i / series.instants());
    reach = reach.cwiseMax((state.position - coordinates.col(0)).cwiseAbs());
  }
  for (Index j = 0; j < joints; ++j) {
    coordinates.row(j).tail(coordinates.cols() - 1) *= 0.5 * (limits.upper[j] - limits.lower[j]) / reach[j];
  }
  return {series.period_s, series.harmonics, std::move(coordinates)};
}

/// Shrunk about its centre until no limit is left; none if the centre itself leaves one.
std::optional<FourierMotion> shrunk(const MotionInformation& information, const FourierMotion& motion,
                                    const Series& series) {
  constexpr double step = 0.97;
  constexpr double least = 0.02;
  if (!information.use(motion.scaled(0.0), 1).within) return {};
  double share = 1.0;
  while (share > least && !information.use(motion.scaled(share), series.instants()).within) share *= step;
  while (share > least && !information.use(motion.scaled(share), series.checks()).within) share *= step;
  if (share <= least) return {};
  return motion.scaled(share);
}

/// What is believed of each joint before anything is recorded, as `priors_of` has it, with torques of the size of those
/// that `motion` takes.
std::vector<JointPrior> beliefs_of(const arm::Chain& chain, const arm::Chain::Params& urdf, const Series& series,
                                   const FourierMotion& motion) {
  const int count = chain.joints();
  JointVector squares = JointVector::Zero(count);
  for (int i = 0; i < series.instants(); ++i) {
    const FourierMotion::State state = motion.at(series.period_s * i / series.instants());
    squares += chain.motor_torque(state.position, state.velocity, state.acceleration).cwiseAbs2() / series.instants();
  }
  const arm::JointMatrix mass = chain.mass_matrix(JointVector::Zero(count));
  std::vector<JointPrior> priors;
  for (int j = 0; j < count; ++j) {
    const arm::JointParams& joint = urdf.joints[static_cast<std::size_t>(j)];
    const double armature = joint.drive.reflected_kg_m2();
    JointPrior prior;
    prior.body = joint.body;
    prior.torque = std::max(std::sqrt(squares[j]), 1e-3 * joint.limits.effort_N_m);
    prior.armature = armature > 0.0 ? armature : std::max(0.1 * mass(j, j), 1e-6);
    prior.coulomb = joint.friction.coulomb_N_m > 0.0 ? joint.friction.coulomb_N_m : friction_share * prior.torque;
    prior.viscous = joint.friction.viscous_N_m_s_per_rad > 0.0 ? joint.friction.viscous_N_m_s_per_rad
                                                               : friction_share * prior.torque;
    priors.push_back(prior);
  }
  return priors;
}

/// Which limit stands in the way of every motion.
Error nowhere(const MotionInformation& information, const MotionLimits& limits, const Series& series,
              const std::vector<std::string>& joints) {
  const MatrixXd still = MatrixXd::Zero(limits.lower.size(), FourierMotion::coordinates(series.harmonics));
  MatrixXd middle = still;
  middle.col(0) = 0.5 * (limits.lower + limits.upper);
  const MotionUse use = information.use(FourierMotion(series.period_s, series.harmonics, middle), 1);
  std::string why;
  if (use.clearance_m < 0.0) {
    why = "in the middle of all ranges a point of the link behind joint '" + joints[use.nearest] + "' is " +
          rounded_number(std::ceil(-1e3 * use.clearance_m)) + " mm outside of the box";
  }
  for (Index j = 0; j < limits.lower.size() && why.empty(); ++j) {
    if (use.effort[j] <= limits.effort[j]) continue;
    why = "in the middle of all ranges joint '" + joints[static_cast<std::size_t>(j)] + "' takes " +
          rounded_number(std::ceil(100.0 * use.effort[j]) / 100.0) + " N m to hold the arm, and " +
          rounded_number(limits.effort[j]) + " N m may be used";
  }
  if (why.empty()) why = "none of " + std::to_string(most_draws) + " poses that were tried is";
  return inconsistent("no motion was found within the limits: " + why +
                      "; widen the box or the share, or see to the URDF's limits and masses");
}

MotionWorth worth_of(const MotionInformation& information, const FourierMotion& motion, const Series& series,
                     int parameters) {
  const VectorXd gains = information.gains(motion, series.instants());
  MotionWorth worth;
  worth.condition = std::sqrt(gains.maxCoeff() / std::max(1e-300, gains[gains.size() - parameters]));
  worth.information_nats = 0.5 * (1.0 + gains.array().max(0.0)).log().sum();
  // Half of the prior's variance is left where the information is as much as that of the prior.
  worth.determined_combinations = static_cast<int>((gains.array() > 1.0).count());
  return worth;
}

}  // namespace

Result<ArmExcitation> design_excitation(const std::vector<std::string>& joints, const arm::Chain::Params& urdf,
                                        const ExcitationRequest& request, const std::function<void(double)>& progress) {
  if (Check wrong = check_request(request, joints.size())) return *std::move(wrong);
  Result<MotionLimits> limits = limits_of(joints, urdf, request);
  if (!limits) return limits.error();
  arm::Chain::Params believed = urdf;
  for (arm::JointParams& joint : believed.joints) joint.friction.velocity_scale_rad_per_s = slow_rad_per_s;
  const Result<arm::Chain> chain = arm::Chain::make(believed);
  if (!chain) return chain.error();
  const Series series{request.duration_s, static_cast<int>(std::floor(request.duration_s * request.highest_Hz + 1e-9))};
  signal::Random random(request.seed);
  limits->points = movable(request.points, *chain, random.fork(0));
  const std::vector<JointPrior> priors = beliefs_of(*chain, urdf, series, drawn(random, series, *limits).scaled(0.5));
  const ConsistentFit nothing = fit_of_nothing(priors);
  const double rows_per_s = 2.0 * default_arm_cutoff_Hz;
  const JointVector noise = Eigen::Map<const VectorXd>(request.noise_N_m.data(), chain->joints());
  const MotionInformation information(*chain, nothing, noise, rows_per_s, *limits);
  const int base = base_parameters_of(*chain);
  const int parameters = base + 3 * chain->joints();

  std::vector<std::pair<MotionWorth, FourierMotion>> found;
  for (int draw = 0; draw < most_draws && found.size() < compared_motions; ++draw) {
    const std::optional<FourierMotion> motion = shrunk(information, drawn(random, series, *limits), series);
    if (motion) found.emplace_back(worth_of(information, *motion, series, parameters), *motion);
    if (progress && motion) progress(0.1 * static_cast<double>(found.size()) / compared_motions);
  }
  if (found.empty()) return nowhere(information, *limits, series, joints);
  std::sort(found.begin(), found.end(),
            [](const auto& a, const auto& b) { return a.first.information_nats < b.first.information_nats; });
  const auto& [usual_worth, usual] = found[found.size() / 2];

  std::optional<std::pair<MotionWorth, FourierMotion>> best;
  const std::size_t tries = std::min<std::size_t>(starts, found.size());
  const auto improved = [&](const FourierMotion& from, const Stage& stage) {
    const MotionInformation within(*chain, nothing, noise, rows_per_s, tightened(*limits, stage.share));
    const SmoothCost cost = [&](const VectorXd& there, VectorXd& slope) {
      return within.cost(there, series.period_s, series.harmonics, stage.instants_of_a_harmonic * series.harmonics,
                         stage.firmness, &slope);
    };
    const VectorXd at = minimise(cost, Eigen::Map<const VectorXd>(from.coordinates().data(), from.coordinates().size()),
                                 steps_of_a_stage);
    return FourierMotion(series.period_s, series.harmonics,
                         Eigen::Map<const MatrixXd>(at.data(), chain->joints(), from.coordinates().cols()));
  };
  for (std::size_t start = 0; start < tries; ++start) {
    FourierMotion motion = found[found.size() - 1 - start].second;
    const auto tell = [&](double share) {
      if (progress) progress(0.1 + 0.9 * (static_cast<double>(start) + share) / static_cast<double>(tries));
    };
    tell(0.0);
    for (const Stage& stage : search) motion = improved(motion, stage);
    tell(0.5);
    for (const Stage& stage : finish) {
      motion = improved(motion, stage);
      if (!information.use(motion, series.checks()).within) continue;
      const MotionWorth worth = worth_of(information, motion, series, parameters);
      if (!best || worth.information_nats > best->first.information_nats) best.emplace(worth, motion);
      break;
    }
  }
  const bool searched = best.has_value();
  if (!searched) best = found.back();

  ArmExcitation made{.motion = best->second,
                     .worth = best->first,
                     .searched = searched,
                     .random = usual_worth,
                     .random_motion = usual,
                     .base_parameters = base};
  const MotionUse use = information.use(made.motion, series.checks());
  made.clearance_m = use.clearance_m;
  const ConsistentFit promised =
      fit_consistently(information.sums(made.motion, series.checks()), priors, request.noise_N_m, {});
  for (Index j = 0; j < chain->joints(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    made.joints.push_back({.name = joints[at],
                           .least = use.least[j],
                           .greatest = use.greatest[j],
                           .velocity_rad_per_s = use.velocity[j],
                           .effort_N_m = use.effort[j],
                           .limits = urdf.joints[at].limits,
                           .noise_N_m = request.noise_N_m[at],
                           .parameters = parameters_of(promised, nothing, static_cast<int>(j), {})});
  }
  return made;
}

}  // namespace tactus::arm_identification
