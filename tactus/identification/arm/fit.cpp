// SPDX-License-Identifier: Apache-2.0
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
constexpr double one_scale = 0.05;         ///< of the logarithm: torque constants that differ by less are one
constexpr double least_explained = 0.75;   ///< relative residual beyond which a model is refused
constexpr double determined_scale = 0.35;  ///< deviation of a scale's logarithm: half of that assumed of a current's
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

/// Motions of recordings, and with what they were filtered.
struct Prepared {
  std::vector<ArmMotion> motions = {};
  double duration_s = 0.0;
  double cutoff_Hz = 0.0;
};

Result<Prepared> prepare(std::span<const ArmRecording> recordings, const std::vector<std::string>& joints,
                         std::optional<double> cutoff_Hz) {
  Prepared prepared;
  double slowest_s = 0.0;
  for (const ArmRecording& recording : recordings) {
    slowest_s = std::max(slowest_s, recording.sample_time.value);
    prepared.duration_s += recording.sample_time.value * static_cast<double>(recording.samples());
  }
  prepared.cutoff_Hz = cutoff_Hz.value_or(std::min(default_arm_cutoff_Hz, 0.1 / slowest_s));
  const double rows_per_s = std::min(rows_per_cutoff * prepared.cutoff_Hz, most_rows / prepared.duration_s);
  for (const ArmRecording& recording : recordings) {
    auto motion = ArmMotion::make(recording, prepared.cutoff_Hz, rows_per_s, joints);
    if (!motion) return motion.error();
    prepared.motions.push_back(*std::move(motion));
  }
  return prepared;
}

VectorXd bodies_of(const arm::Chain::Params& urdf) {
  VectorXd bodies(arm::body_parameters * static_cast<Index>(urdf.joints.size()));
  for (std::size_t j = 0; j < urdf.joints.size(); ++j) {
    bodies.segment<arm::body_parameters>(arm::body_parameters * static_cast<Index>(j)) =
        arm::linear_parameters(urdf.joints[j].body);
  }
  return bodies;
}

/// A fit of all rows, with what it leaves of the efforts.
struct TrialFit {
  ConsistentFit found;
  double squares = 0.0;  ///< of the shares that are left of the efforts, over all joints
};

TrialFit try_fit(const ArmData& data, const arm::Chain::Params& urdf, EffortUnit unit) {
  bool scaled = false;
  const auto priors = priors_of(data, *arm::Chain::make(urdf), urdf, bodies_of(urdf), unit, scaled);
  TrialFit trial{.found = fit_rows(data, {0, data.rows()}, priors, unit == EffortUnit::torque).found};
  for (int j = 0; j < data.joints(); ++j) {
    const double left = trial.found.residual_rms[static_cast<std::size_t>(j)] / rms(data.effort.col(j));
    trial.squares += left * left;
  }
  return trial;
}

/// The direction that fits best, where the bodies are found with it.
arm::Gravity find_gravity(const std::vector<ArmMotion>& motions, arm::Chain::Params urdf, EffortUnit unit) {
  constexpr int rounds = 3;
  arm::Chain::Params believed = urdf;
  for (int round = 0; round < rounds; ++round) {
    const ArmData data(*arm::Chain::make(urdf), motions);
    urdf.gravity = best_gravity(data, as_stated(believed), unit == EffortUnit::torque);
    believed.gravity = urdf.gravity;
    if (round + 1 == rounds) break;
    const ConsistentFit found = try_fit(ArmData(*arm::Chain::make(urdf), motions), urdf, unit).found;
    for (std::size_t j = 0; j < urdf.joints.size(); ++j) {
      believed.joints[j].body =
          arm::body_of(found.bodies.segment<arm::body_parameters>(arm::body_parameters * static_cast<Index>(j)));
    }
  }
  return urdf.gravity;
}

/// What contradicts the URDF, and what explains it.
struct Explanation {
  std::string words;
  bool small = false;  ///< another direction of gravity alone, where the URDF's bodies leave no more than 15 %
};

std::string percent(double share) {
  return share < 0.1 ? short_text(100.0 * share) + " %" : std::to_string(std::lround(100.0 * share)) + " %";
}

constexpr double clearly_contradicted = 2.0 * much_left;  ///< what the URDF's bodies leave at the worst joint
constexpr double share_of_search = 0.5;                   ///< of the work: the rest is the fits

double worst_of(const std::vector<double>& shares) { return *std::max_element(shares.begin(), shares.end()); }

/// A change that explains the data: by the URDF's bodies alone, where these leave much without it, or confirmed by fits
/// of all bodies with and without it. A fit of all bodies alone cannot tell: a planar arm whose bodies are free fits
/// gravity of any direction in its plane.
Result<std::optional<Explanation>> explain_data(std::span<const ArmRecording> recordings, const ArmData& data,
                                                const std::vector<std::string>& joints, const arm::Chain::Params& urdf,
                                                const ArmFitOptions& options, EffortUnit unit) {
  constexpr double confirmed = 0.5;
  const bool torques = unit == EffortUnit::torque;
  const auto searched = [&](double done) {
    if (options.progress) options.progress(share_of_search * done);
  };
  const Assumption stated = as_stated(urdf);
  Assumption changed = explain(data, stated, joints, torques, searched);
  if (!changed.changed()) return std::optional<Explanation>();
  const auto prepared = prepare(rearranged(recordings, changed), joints, options.cutoff_Hz);
  if (!prepared) return prepared.error();
  for (std::string& remedy : changed.remedies) {
    if (!remedy.starts_with("--gravity")) continue;
    changed.urdf.gravity = find_gravity(prepared->motions, changed.urdf, unit);
    remedy = "--gravity " + text_of(changed.urdf.gravity);
  }
  const double before = worst_of(left_by_urdf(data, stated, torques));
  const double after = worst_of(left_by_urdf(data, changed, torques));
  if (before < clearly_contradicted || after > confirmed * before) {
    const TrialFit without = try_fit(data, urdf, unit);
    const TrialFit with = try_fit(ArmData(*arm::Chain::make(changed.urdf), prepared->motions), changed.urdf, unit);
    if (with.squares > confirmed * without.squares) return std::optional<Explanation>();
  }
  std::string changes, remedies;
  for (const std::string& one : changed.changes) changes += (changes.empty() ? "" : ", and ") + one;
  for (const std::string& one : changed.remedies) remedies += (remedies.empty() ? "" : " and ") + one;
  return std::optional(Explanation{.words = changes + ": with " + remedies + " the bodies of the URDF leave " +
                                            percent(after) + " of the effort at the worst joint, without it " +
                                            percent(before),
                                   .small = before <= much_left && changed.remedies.size() == 1 &&
                                            changed.remedies.front().starts_with("--gravity")});
}

}  // namespace

Result<ArmIdentification> identify_arm(std::span<const ArmRecording> recordings, const std::vector<std::string>& joints,
                                       const arm::Chain::Params& stated, const ArmFitOptions& options) {
  if (const auto chain = arm::Chain::make(stated); !chain) return chain.error();
  auto prepared = prepare(recordings, joints, options.cutoff_Hz);
  if (!prepared) return prepared.error();
  const EffortUnit unit = options.free_scales ? EffortUnit::unknown : unit_of(recordings);
  arm::Chain::Params urdf = stated;
  if (options.free_gravity) urdf.gravity = find_gravity(prepared->motions, stated, unit);
  const arm::Chain chain = *arm::Chain::make(urdf);
  ArmIdentification result;
  result.duration_s = prepared->duration_s;
  result.cutoff_Hz = prepared->cutoff_Hz;
  const ArmData data(chain, std::move(prepared->motions));
  result.base_parameters = base_parameters_of(chain);
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
  if (Check wrong = check_efforts(data, joints, recordings.front())) return in_file(*std::move(wrong));
  const auto explanation = explain_data(recordings, data, joints, urdf, options, unit);
  if (!explanation) return explanation.error();
  if (*explanation && !(*explanation)->small) {
    return in_file(inconsistent("urdf", (*explanation)->words));
  }
  if (*explanation) result.warnings.push_back((*explanation)->words);

  std::vector<JointPrior> priors = priors_of(data, chain, urdf, bodies_of(urdf), unit, result.scaled_efforts);
  const RowSpan all{0, data.rows()};
  const RowSpan seen{0, data.rows() / 2};
  const RowSpan judged{seen.count, data.rows() - seen.count};
  const bool torques = unit == EffortUnit::torque;
  const auto fitted = [&](int fits) {
    constexpr double all_fits = 3.0;
    if (options.progress) options.progress(share_of_search + (1.0 - share_of_search) * fits / all_fits);
  };
  fitted(0);
  const RowsFit free = fit_rows(data, seen, priors, torques);
  if (!result.scaled_efforts && !torques) {
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
  fitted(1);
  const RowsFit half = fit_rows(data, seen, priors, !result.scaled_efforts);
  fitted(2);
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
    fit.scale_determined = result.scaled_efforts && free.found.scale_deviation(j) < determined_scale;
    if (fit.relative > least_explained) {
      return in_file(inconsistent(
          "effort", "the model leaves " + short_text(100.0 * fit.relative) + " % of the effort of joint '" +
                        joints[at] + "' (column '" + recordings.front().effort_names[at] +
                        "'): are columns swapped, was something touched, or is this the URDF of another arm?"));
    }
    if (fit.relative > much_left) {
      result.warnings.push_back("the model leaves " + percent(fit.relative) + " of the effort of joint '" + joints[at] +
                                "'; reversed joints, swapped columns and another direction of gravity do not explain "
                                "it: is the friction of another kind, or was something touched?");
    }
    fit.parameters = parameters_of(whole.found, nothing, j, whole.friction[at].shape);
    thresholds.push_back(threshold_margin * std::max(left.cwiseAbs().maxCoeff(), held_out.cwiseAbs().maxCoeff()));
    result.joints.push_back(std::move(fit));
  }
  if (torques) result.payload = find_payload(data, urdf);
  result.determined_combinations = told_of(whole.found);
  result.model = model_of(data, whole, joints, urdf, result.cutoff_Hz, thresholds);
  return result;
}

}  // namespace tactus::arm_identification
