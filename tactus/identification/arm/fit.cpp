#include <tactus/identification/arm/first_look.hpp>
#include <tactus/identification/arm/fit.hpp>
#include <tactus/identification/arm/rows_fit.hpp>
#include <tactus/identification/axis/refusal.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>

#include <Eigen/Dense>

namespace tactus::arm_identification {
namespace {

using identification::inconsistent;

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double most_rows = 12'000.0;
constexpr double rows_per_cutoff = 4.0;
constexpr double normal_95 = 1.96;
constexpr double worth_a_scale = 0.97;
constexpr double one_scale = 0.05;        ///< of the logarithm: torque constants that differ by less are one
constexpr double least_explained = 0.75;  ///< relative residual beyond which a model is refused
constexpr double threshold_margin = 1.25;

/// Leaves a scale of its own to joints whose found one differs from the others', and gives the others one: 1 where they
/// are torques. A scale that is free where none is needed takes up what is no scale, and unseen motion shows it.
void keep_scales_that_differ(const std::vector<double>& found, std::vector<JointPrior>& priors) {
  std::vector<double> sorted = found;
  std::sort(sorted.begin(), sorted.end());
  const double middle = sorted[sorted.size() / 2];
  const double common = std::fabs(std::log(middle)) < one_scale ? 1.0 : middle;
  for (std::size_t j = 0; j < priors.size(); ++j) {
    if (std::fabs(std::log(found[j] / common)) >= one_scale) continue;
    priors[j].scale = common;
    priors[j].scale_deviation = 0.0;
  }
}

std::string short_text(double value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.2g", value);
  return buffer.data();
}

ArmModel model_of(const ArmData& data, const RowsFit& fit, const std::vector<std::string>& joints,
                  const arm::Chain::Params& urdf, double cutoff_Hz, const std::vector<double>& thresholds) {
  ArmModel model{
      .head = {.joints = static_cast<std::int64_t>(joints.size()), .cutoff_Hz = cutoff_Hz, .gravity = urdf.gravity},
      .joints = Joints<ArmJointModel>(joints.size())};
  for (std::size_t j = 0; j < joints.size(); ++j) {
    ArmJointModel& joint = model.joints[j];
    const FrictionShape& shape = fit.friction[j].shape;
    const auto& local = fit.found.local[j];
    joint.name = joints[j];
    joint.effort_per_N_m = fit.found.scales[j];
    joint.residual_rms_N_m = fit.found.residual_rms[j] / fit.found.scales[j];
    joint.contact_threshold_N_m = thresholds[j] / fit.found.scales[j];
    joint.arm = urdf.joints[j];
    joint.arm.body =
        arm::body_of(fit.found.bodies.segment<arm::body_parameters>(arm::body_parameters * static_cast<Index>(j)));
    joint.arm.drive = {.armature_kg_m2 = local[0], .rotor_inertia_kg_m2 = 0.0, .gear_ratio = 1.0};
    joint.arm.friction = {
        .coulomb_N_m = local[1],
        .viscous_N_m_s_per_rad = local[2],
        .offset_N_m = local[3],
        .load = shape.load ? local[4] : 0.0,
        .stribeck_N_m = shape.stribeck >= 0 ? local[5] : 0.0,
        .velocity_scale_rad_per_s = data.turning_velocity(static_cast<int>(j), shape) * std::exp(local[6])};
    if (shape.stribeck >= 0) {
      joint.arm.friction.stribeck_velocity_rad_per_s =
          ArmData::slownesses[static_cast<std::size_t>(shape.stribeck)] * data.speed[j];
    }
  }
  return model;
}

}  // namespace

Result<ArmIdentification> identify_arm(std::span<const ArmRecording> recordings, const std::vector<std::string>& joints,
                                       const arm::Chain::Params& urdf, std::optional<double> cutoff_Hz) {
  const auto chain = arm::Chain::make(urdf);
  if (!chain) return chain.error();
  ArmIdentification result;
  double slowest_s = 0.0;
  for (const ArmRecording& recording : recordings) {
    slowest_s = std::max(slowest_s, recording.sample_time.value);
    result.duration_s += recording.sample_time.value * static_cast<double>(recording.samples());
  }
  result.cutoff_Hz = cutoff_Hz.value_or(std::min(default_arm_cutoff_Hz, 0.1 / slowest_s));
  std::vector<ArmMotion> motions;
  const double rows_per_s = std::min(rows_per_cutoff * result.cutoff_Hz, most_rows / result.duration_s);
  for (const ArmRecording& recording : recordings) {
    auto motion = ArmMotion::make(recording, result.cutoff_Hz, rows_per_s, joints);
    if (!motion) return motion.error();
    motions.push_back(*std::move(motion));
  }
  const ArmData data(*chain, std::move(motions));
  result.base_parameters = base_parameters_of(*chain);
  const auto in_file = [&](Error error) {
    error.place = recordings.front().file.string();
    return error;
  };
  // Half of the rows say something new at this rate, half are held out, and a number needs two.
  if (static_cast<double>(data.rows() * data.joints()) < 8.0 * (result.base_parameters + 3 * data.joints())) {
    return in_file(inconsistent(short_text(result.duration_s) + " s are too short to determine " +
                                std::to_string(result.base_parameters) +
                                " parameters and friction, and to hold half of it out; record more motion"));
  }
  VectorXd bodies(arm::body_parameters * data.joints());
  for (Index j = 0; j < data.joints(); ++j) {
    bodies.segment<arm::body_parameters>(arm::body_parameters * j) =
        arm::linear_parameters(urdf.joints[static_cast<std::size_t>(j)].body);
  }
  if (Check wrong = check_efforts(data, bodies, joints, recordings.front())) return in_file(*std::move(wrong));

  std::vector<JointPrior> priors = priors_of(data, *chain, urdf, bodies, result.scaled_efforts);
  const RowSpan all{0, data.rows()};
  const RowSpan seen{0, data.rows() / 2};
  const RowSpan judged{seen.count, data.rows() - seen.count};
  const RowsFit free = fit_rows(data, seen, priors, false);
  if (!result.scaled_efforts) {
    const RowsFit as_torques = fit_rows(data, seen, priors, true);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const bool better = free.found.residual_rms[j] < worth_a_scale * as_torques.found.residual_rms[j];
      result.scaled_efforts = result.scaled_efforts || better;
    }
  }
  if (result.scaled_efforts) {
    keep_scales_that_differ(free.found.scales, priors);
    result.scaled_efforts = std::any_of(priors.begin(), priors.end(), [](const JointPrior& prior) {
      return prior.scale != 1.0 || prior.scale_deviation > 0.0;
    });
  }
  const RowsFit half = fit_rows(data, seen, priors, !result.scaled_efforts);
  const RowsFit whole = fit_rows(data, all, priors, !result.scaled_efforts);
  const std::vector<double> ordinary = ordinary_least_squares(data, seen, judged);
  std::vector<JointPrior> used = priors;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    used[j].load = whole.friction[j].shape.load;
    used[j].stribeck = whole.friction[j].shape.stribeck >= 0;
  }
  const ConsistentFit nothing = fit_of_nothing(used);

  std::vector<double> thresholds;
  for (int j = 0; j < data.joints(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    const VectorXd left = residual_of(data, whole, j, all);
    const VectorXd held_out = residual_of(data, half, j, judged);
    ArmJointFit fit{.name = joints[at]};
    fit.effort_rms = rms(data.effort.col(j));
    fit.residual_rms = rms(left);
    fit.relative = fit.residual_rms / fit.effort_rms;
    fit.held_out_relative = rms(held_out) / rms(data.effort.col(j).segment(judged.first, judged.count));
    fit.least_squares_relative = ordinary[at];
    MatrixXd seen_by(judged.count, data.bodies[at].cols() + local_parameters);
    seen_by << data.bodies[at].middleRows(judged.first, judged.count),
        data.local(j, half.friction[at], data.rigid_torque(j, half.found), half.found.local[at])
            .middleRows(judged.first, judged.count);
    const Eigen::ArrayXd uncertain = half.found.prediction_deviation(j, seen_by);
    const double left_alone = half.found.residual_rms[at];
    const Eigen::ArrayXd bound = normal_95 * (uncertain.square() + left_alone * left_alone).sqrt();
    fit.held_out_coverage = (held_out.array().abs() <= bound).cast<double>().mean();
    fit.effort_per_N_m = whole.found.scales[at];
    if (fit.relative > least_explained) {
      return in_file(inconsistent(
          "effort", "the model leaves " + short_text(100.0 * fit.relative) + " % of the effort of joint '" +
                        joints[at] + "' (column '" + recordings.front().effort_names[at] +
                        "'): are columns swapped, was something touched, or is this the URDF of another arm?"));
    }
    fit.parameters = parameters_of(whole.found, nothing, j, whole.friction[at].shape);
    thresholds.push_back(threshold_margin * std::max(left.cwiseAbs().maxCoeff(), held_out.cwiseAbs().maxCoeff()));
    result.joints.push_back(std::move(fit));
  }
  result.determined_combinations = told_of(whole.found);
  result.model = model_of(data, whole, joints, urdf, result.cutoff_Hz, thresholds);
  return result;
}

}  // namespace tactus::arm_identification
