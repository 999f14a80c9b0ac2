// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/external_torque.hpp>
#include <tactus/identification/arm/motion.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace tactus::arm_identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double fine_rows_per_cutoff = 16.0;
constexpr double contact_normal_95 = 1.96;

/// Rows from `first` to before `end`.
struct Stretch {
  Index first;
  Index end;
};

/// Where `found` is 1, gaps shorter than `reach` closed and stretches shorter than `shortest` left out.
std::vector<Stretch> stretches_of(const Eigen::Array<bool, Eigen::Dynamic, 1>& found, Index reach, Index shortest) {
  std::vector<Stretch> all;
  for (Index i = 0; i < found.size(); ++i) {
    if (!found[i]) continue;
    if (!all.empty() && i - all.back().end < reach) {
      all.back().end = i + 1;
    } else {
      all.push_back({i, i + 1});
    }
  }
  std::erase_if(all, [&](const Stretch& s) { return s.end - s.first < shortest; });
  return all;
}

/// Moves both ends inward to half of the height that the torque reaches within `reach` of them.
Stretch to_half_height(const VectorXd& height, Stretch s, Index reach) {
  const Index span = std::min(reach, s.end - s.first);
  const double at_start = 0.5 * height.segment(s.first, span).maxCoeff();
  const double at_end = 0.5 * height.segment(s.end - span, span).maxCoeff();
  while (s.first + 1 < s.end && height[s.first] < at_start) ++s.first;
  while (s.end - 1 > s.first && height[s.end - 1] < at_end) --s.end;
  return s;
}

/// One recording: rows as `ExternalTorque` has them, and what is known of each.
struct Estimated {
  std::vector<double> time_s;
  MatrixXd torque_N_m, effort;
  MatrixXd hidden_N_m;  ///< what friction may hide
  VectorXd free;        ///< 1 where nothing touches the arm
  std::vector<ArmContact> contacts;
};

/// 1 where a joint stands still: slow, and for `reach` rows before and after.
VectorXd standing(const VectorXd& velocity, Index reach) {
  VectorXd still = VectorXd::Ones(velocity.size());
  for (Index i = 0; i < velocity.size(); ++i) {
    if (std::fabs(velocity[i]) < slowest_rad_per_s) continue;
    const Index before = std::max<Index>(0, i - reach);
    still.segment(before, std::min(velocity.size(), i + reach + 1) - before).setZero();
  }
  return still;
}

double hidden_by(const arm::JointFriction& friction, double transmitted_N_m) {
  return friction.coulomb_N_m + friction.load * std::fabs(transmitted_N_m) + std::max(0.0, friction.stribeck_N_m);
}

void find_contacts(Estimated& part, const ArmModel& model, Index reach) {
  const Index rows = part.torque_N_m.rows(), count = part.torque_N_m.cols();
  // By how much each joint exceeds its threshold, and the most of them.
  MatrixXd excess(rows, count);
  for (Index j = 0; j < count; ++j) {
    const double threshold = std::max(model.joints[static_cast<std::size_t>(j)].contact_threshold_N_m, 1e-12);
    excess.col(j) =
        part.torque_N_m.col(j).cwiseAbs().cwiseQuotient((part.hidden_N_m.col(j).array() + threshold).matrix());
  }
  const VectorXd height = excess.rowwise().maxCoeff();
  part.free = VectorXd::Ones(rows);
  for (const Stretch& rough : stretches_of(height.array() > 1.0, reach, std::max<Index>(1, reach / 2))) {
    const Index before = std::max<Index>(0, rough.first - reach);
    part.free.segment(before, std::min(rows, rough.end + reach) - before).setZero();
    const Stretch s = to_half_height(height, rough, reach);
    ArmContact contact{.from_s = part.time_s[static_cast<std::size_t>(s.first)],
                       .to_s = part.time_s[static_cast<std::size_t>(s.end - 1)]};
    for (Index j = 0; j < count; ++j) {
      if (excess.col(j).segment(rough.first, rough.end - rough.first).maxCoeff() <= 1.0) continue;
      const ArmJointModel& joint = model.joints[static_cast<std::size_t>(j)];
      contact.joints.push_back({.joint = joint.name,
                                .mean_N_m = part.torque_N_m.col(j).segment(s.first, s.end - s.first).mean(),
                                .within_N_m = contact_normal_95 * joint.residual_rms_N_m +
                                              part.hidden_N_m.col(j).segment(s.first, s.end - s.first).mean()});
    }
    part.contacts.push_back(std::move(contact));
  }
}

Result<Estimated> estimate(const ArmModel& model, const arm::Chain& chain, const std::vector<std::string>& names,
                           const ArmRecording& recording) {
  const double cutoff_Hz = model.head.cutoff_Hz;
  const auto motion =
      ArmMotion::make(recording, cutoff_Hz, fine_rows_per_cutoff * cutoff_Hz, names, JointsThatMove::any);
  if (!motion) return motion.error();
  const Index rows = motion->rows();
  const Index count = motion->joints();
  const double step_s = rows > 1 ? motion->time_s[1] - motion->time_s[0] : 1.0;
  const Index reach = std::max<Index>(1, static_cast<Index>(std::lround(1.0 / (cutoff_Hz * step_s))));
  Estimated part{.time_s = {},
                 .torque_N_m = MatrixXd(rows, count),
                 .effort = motion->effort,
                 .hidden_N_m = MatrixXd(rows, count),
                 .free = {},
                 .contacts = {}};
  for (const double time_s : motion->time_s) part.time_s.push_back(recording.start_s + time_s);
  const MatrixXd rigid =
      motion->of_motion(count, [&](const VectorXd& position, const VectorXd& velocity, const VectorXd& acceleration,
                                   auto torque) { torque = chain.inverse_dynamics(position, velocity, acceleration); });
  for (Index j = 0; j < count; ++j) {
    const ArmJointModel& joint = model.joints[static_cast<std::size_t>(j)];
    const arm::JointFriction& friction = joint.arm.friction;
    // Of the law: what depends on velocity alone, and how the load counts.
    const VectorXd own = motion->of_velocity(
        static_cast<int>(j), [&](double v) { return friction.torque(v, 0.0) - friction.viscous_N_m_s_per_rad * v; });
    const VectorXd turned = motion->of_velocity(static_cast<int>(j), [&](double v) { return friction.direction(v); });
    part.torque_N_m.col(j) = rigid.col(j) + own + friction.viscous_N_m_s_per_rad * motion->velocity.col(j) +
                             friction.load * turned.cwiseProduct(rigid.col(j).cwiseAbs()) -
                             motion->effort.col(j) / joint.effort_per_N_m;
    part.hidden_N_m.col(j) =
        standing(motion->velocity.col(j), reach).cwiseProduct(VectorXd(rigid.col(j).unaryExpr([&](double own_N_m) {
          return hidden_by(friction, own_N_m);
        })));
  }
  find_contacts(part, model, reach);
  return part;
}

}  // namespace

Result<ExternalTorque> estimate_external_torque(const ArmModel& model, std::span<const ArmRecording> recordings) {
  const auto chain = arm::Chain::make(model.chain());
  if (!chain) return chain.error();
  std::vector<std::string> names;
  for (const ArmJointModel& joint : model.joints) names.push_back(joint.name);
  ExternalTorque result;
  std::vector<Estimated> parts;
  const auto length_s = [](const ArmRecording& recording) {
    return recording.sample_time.value * static_cast<double>(recording.samples());
  };
  const bool any_long = std::ranges::any_of(recordings, [&](const ArmRecording& recording) {
    return length_s(recording) >= shortest_motion_s(model.head.cutoff_Hz);
  });
  std::size_t rows = 0;
  for (const ArmRecording& recording : recordings) {
    if (any_long && length_s(recording) < shortest_motion_s(model.head.cutoff_Hz)) {
      result.left_out_s += length_s(recording);
      continue;
    }
    auto part = estimate(model, *chain, names, recording);
    if (!part) return part.error();
    result.stretches.push_back(rows);
    rows += part->time_s.size();
    result.time_s.insert(result.time_s.end(), part->time_s.begin(), part->time_s.end());
    result.contacts.insert(result.contacts.end(), part->contacts.begin(), part->contacts.end());
    parts.push_back(*std::move(part));
  }
  const auto count = static_cast<Index>(names.size());
  result.torque_N_m.resize(static_cast<Index>(rows), count);
  VectorXd efforts = VectorXd::Zero(count), residuals = VectorXd::Zero(count);
  double freely = 0.0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const Estimated& part = parts[i];
    result.torque_N_m.middleRows(static_cast<Index>(result.stretches[i]), part.torque_N_m.rows()) = part.torque_N_m;
    efforts += (part.effort.array().square().matrix().transpose() * part.free);
    residuals += (part.torque_N_m.array().square().matrix().transpose() * part.free);
    freely += part.free.sum();
  }
  freely = std::max(1.0, freely);
  for (Index j = 0; j < count; ++j) {
    const double scale = model.joints[static_cast<std::size_t>(j)].effort_per_N_m;
    ArmJointResidual joint{.name = names[static_cast<std::size_t>(j)]};
    joint.effort_rms = std::sqrt(efforts[j] / freely);
    joint.residual_rms = scale * std::sqrt(residuals[j] / freely);
    joint.relative = joint.effort_rms > 0.0 ? joint.residual_rms / joint.effort_rms : 0.0;
    joint.peak_external_N_m = result.torque_N_m.col(j).cwiseAbs().maxCoeff();
    result.joints.push_back(joint);
  }
  return result;
}

Result<ExternalTorque> estimate_external_torque(const ArmModel& model, const ArmRecording& recording) {
  return estimate_external_torque(model, std::span(&recording, 1));
}

double false_contacts_per_hour(const ArmModel& model) {
  constexpr double per_hour = 3600.0, both_signs = 2.0;
  double rate = 0.0;
  for (const ArmJointModel& joint : model.joints) {
    if (!(joint.residual_rms_N_m > 0.0)) continue;
    const double heights = joint.contact_threshold_N_m / joint.residual_rms_N_m;
    rate += both_signs * per_hour * model.head.cutoff_Hz / std::numbers::sqrt3 * std::exp(-0.5 * heights * heights);
  }
  return rate;
}

}  // namespace tactus::arm_identification
