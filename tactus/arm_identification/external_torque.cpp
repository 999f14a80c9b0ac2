#include <tactus/arm_identification/external_torque.hpp>
#include <tactus/arm_identification/motion.hpp>

#include <algorithm>
#include <cmath>

namespace tactus::arm_identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double fine_rows_per_cutoff = 16.0;

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

}  // namespace

Result<ExternalTorque> estimate_external_torque(const ArmModel& model, const ArmRecording& recording) {
  const auto chain = arm::Chain::make(model.chain());
  if (!chain) return chain.error();
  std::vector<std::string> names;
  for (const ArmJointModel& joint : model.joints) names.push_back(joint.name);
  const double cutoff_Hz = model.head.cutoff_Hz;
  const auto motion = ArmMotion::make(recording, cutoff_Hz, fine_rows_per_cutoff * cutoff_Hz, names);
  if (!motion) return motion.error();

  const Index rows = motion->rows();
  const Index count = motion->joints();
  ExternalTorque result;
  result.torque_N_m.resize(rows, count);
  for (const double time_s : motion->time_s) result.time_s.push_back(recording.start_s + time_s);
  const MatrixXd rigid = motion->of_motion(
      count, [&](const VectorXd& position, const VectorXd& velocity, const VectorXd& acceleration, auto torque) {
        torque = chain->inverse_dynamics(position, velocity, acceleration);
      });
  for (Index j = 0; j < count; ++j) {
    const ArmJointModel& joint = model.joints[static_cast<std::size_t>(j)];
    const arm::JointFriction& friction = joint.arm.friction;
    // Of the law: what depends on velocity alone, and how the load counts.
    const VectorXd own = motion->of_velocity(
        static_cast<int>(j), [&](double v) { return friction.torque(v, 0.0) - friction.viscous_N_m_s_per_rad * v; });
    const VectorXd turned = motion->of_velocity(static_cast<int>(j), [&](double v) { return friction.direction(v); });
    result.torque_N_m.col(j) = rigid.col(j) + own + friction.viscous_N_m_s_per_rad * motion->velocity.col(j) +
                               friction.load * turned.cwiseProduct(rigid.col(j).cwiseAbs()) -
                               motion->effort.col(j) / joint.effort_per_N_m;
  }

  const double step_s = rows > 1 ? motion->time_s[1] - motion->time_s[0] : 1.0;
  const Index reach = std::max<Index>(1, static_cast<Index>(std::lround(1.0 / (cutoff_Hz * step_s))));
  // By how much each joint exceeds its threshold, and the most of them.
  MatrixXd excess(rows, count);
  for (Index j = 0; j < count; ++j) {
    const double threshold = model.joints[static_cast<std::size_t>(j)].contact_threshold_N_m;
    excess.col(j) = result.torque_N_m.col(j).cwiseAbs() / std::max(threshold, 1e-12);
  }
  const VectorXd height = excess.rowwise().maxCoeff();
  VectorXd free = VectorXd::Ones(rows);
  for (const Stretch& rough : stretches_of(height.array() > 1.0, reach, std::max<Index>(1, reach / 2))) {
    const Index before = std::max<Index>(0, rough.first - reach);
    free.segment(before, std::min(rows, rough.end + reach) - before).setZero();
    const Stretch s = to_half_height(height, rough, reach);
    ArmContact contact{.from_s = result.time_s[static_cast<std::size_t>(s.first)],
                       .to_s = result.time_s[static_cast<std::size_t>(s.end - 1)]};
    for (Index j = 0; j < count; ++j) {
      if (excess.col(j).segment(rough.first, rough.end - rough.first).maxCoeff() > 1.0) {
        contact.joints.push_back(names[static_cast<std::size_t>(j)]);
      }
    }
    result.contacts.push_back(std::move(contact));
  }

  const double freely = std::max(1.0, free.sum());
  for (Index j = 0; j < count; ++j) {
    const double scale = model.joints[static_cast<std::size_t>(j)].effort_per_N_m;
    ArmJointResidual joint{.name = names[static_cast<std::size_t>(j)]};
    joint.effort_rms = std::sqrt(motion->effort.col(j).cwiseProduct(free).squaredNorm() / freely);
    joint.residual_rms = scale * std::sqrt(result.torque_N_m.col(j).cwiseProduct(free).squaredNorm() / freely);
    joint.relative = joint.effort_rms > 0.0 ? joint.residual_rms / joint.effort_rms : 0.0;
    joint.peak_external_N_m = result.torque_N_m.col(j).cwiseAbs().maxCoeff();
    result.joints.push_back(joint);
  }
  return result;
}

}  // namespace tactus::arm_identification
