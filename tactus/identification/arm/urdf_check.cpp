// SPDX-License-Identifier: Apache-2.0
#include <tactus/identification/arm/internal/urdf_residual.hpp>
#include <tactus/identification/arm/urdf_check.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <utility>

#include <Eigen/Dense>

namespace tactus::arm_identification {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double clearly_better = 0.5;  ///< of the squares that are left: what a change must bring them to
constexpr double worth_having = 0.01;   ///< of a joint's squares, summed over joints, at least
constexpr double one_more = 0.7;        ///< of what one change leaves: what two must bring it to
constexpr int most_changes = 3;

/// Rates assumptions. Those that differ in their efforts alone share their torques, which are computed once.
class Rating {
 public:
  Rating(const ArmData& data, bool torques) : data_(&data), torques_(torques) {}
  /// Squares of the shares that are left, summed over joints.
  double operator()(const Assumption& assumption) {
    const arm::Gravity& gravity = assumption.urdf.gravity;
    std::vector<double> motion(assumption.position_of.begin(), assumption.position_of.end());
    motion.insert(motion.end(), {gravity.x_m_per_s2, gravity.y_m_per_s2, gravity.z_m_per_s2});
    for (const arm::JointParams& joint : assumption.urdf.joints) {
      motion.insert(motion.end(), {joint.axis.x, joint.axis.y, joint.axis.z});
    }
    auto found = torques_by_motion_.find(motion);
    if (found == torques_by_motion_.end()) {
      MatrixXd torques = torques_of(*data_, without_armatures(assumption.urdf), assumption.position_of);
      found = torques_by_motion_.emplace(motion, std::move(torques)).first;
    }
    return total(left_with(*data_, found->second, assumption, torques_));
  }

 private:
  const ArmData* data_;
  bool torques_;
  std::map<std::vector<double>, MatrixXd> torques_by_motion_ = {};
};

arm::Vector3 vector_of(const arm::Gravity& g) { return {g.x_m_per_s2, g.y_m_per_s2, g.z_m_per_s2}; }
arm::Gravity gravity_of(const arm::Vector3& g) { return {g.x(), g.y(), g.z()}; }

std::string one_number(double value) {
  std::array<char, 32> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.3g", std::fabs(value) < 5e-3 ? 0.0 : value);
  return buffer.data();
}

std::string quoted(const std::string& name) { return "'" + name + "'"; }

Assumption reversed(const Assumption& from, const std::vector<std::string>& joints, std::vector<int> which) {
  Assumption changed = from;
  std::string names;
  for (const int joint : which) {
    arm::JointAxis& axis = changed.urdf.joints[static_cast<std::size_t>(joint)].axis;
    axis = {-axis.x, -axis.y, -axis.z};
    const std::string& name = joints[static_cast<std::size_t>(joint)];
    names += (names.empty() ? "joint " : " and joint ") + quoted(name);
    changed.remedies.push_back("--reverse " + name);
  }
  changed.changes.push_back(names + (which.size() > 1 ? " count" : " counts") + " the other way than the URDF");
  return changed;
}

Assumption with_effort_turned(const Assumption& from, const std::vector<std::string>& joints, int joint) {
  Assumption changed = from;
  const auto at = static_cast<std::size_t>(joint);
  changed.effort_sign[at] = -changed.effort_sign[at];
  changed.changes.push_back("the effort of joint " + quoted(joints[at]) +
                            " has the wrong sign: it must push toward +position");
  changed.remedies.push_back("the sign of its effort column changed");
  return changed;
}

Assumption with_position_turned(const Assumption& from, const std::vector<std::string>& joints, int joint) {
  const auto at = static_cast<std::size_t>(joint);
  Assumption changed = reversed(from, joints, {joint});
  changed.effort_sign[at] = -changed.effort_sign[at];
  changed.changes.back() =
      "the position of joint " + quoted(joints[at]) + " counts the other way than the URDF and its effort";
  changed.remedies.back() = "the signs of its position and velocity columns changed";
  return changed;
}

Assumption exchanged(const Assumption& from, const std::vector<std::string>& joints, int a, int b, bool efforts_alone) {
  Assumption changed = from;
  const auto i = static_cast<std::size_t>(a), k = static_cast<std::size_t>(b);
  if (!efforts_alone) std::swap(changed.position_of[i], changed.position_of[k]);
  std::swap(changed.effort_of[i], changed.effort_of[k]);
  changed.changes.push_back((efforts_alone ? "the efforts of joints " : "all columns of joints ") + quoted(joints[i]) +
                            " and " + quoted(joints[k]) + " look swapped");
  changed.remedies.push_back(efforts_alone ? "their effort columns exchanged" : "their columns exchanged");
  return changed;
}

Assumption with_gravity(const Assumption& from, const arm::Gravity& gravity) {
  Assumption changed = from;
  changed.urdf.gravity = gravity;
  changed.changes.push_back("gravity does not point along " + text_of(from.urdf.gravity) + " in the frame of the base");
  changed.remedies.push_back("--gravity " + text_of(gravity));
  return changed;
}

/// Everything that may be changed next. Of two that leave as much, the earlier one is the likelier.
std::vector<Assumption> next_changes(const ArmData& data, const Assumption& from,
                                     const std::vector<std::string>& joints, bool torques) {
  std::vector<Assumption> all;
  const int count = data.joints();
  for (int j = 0; j < count; ++j) all.push_back(reversed(from, joints, {j}));
  all.push_back(with_gravity(from, best_gravity(data, from, torques)));
  for (int j = 0; j < count; ++j) all.push_back(with_effort_turned(from, joints, j));
  for (int j = 0; j < count; ++j) all.push_back(with_position_turned(from, joints, j));
  for (int j = 0; j < count; ++j) {
    for (int k = j + 1; k < count; ++k) {
      all.push_back(exchanged(from, joints, j, k, true));
      all.push_back(exchanged(from, joints, j, k, false));
    }
  }
  return all;
}

}  // namespace

Assumption as_stated(const arm::Chain::Params& urdf) {
  Assumption stated{.urdf = urdf};
  for (std::size_t j = 0; j < urdf.joints.size(); ++j) {
    stated.position_of.push_back(static_cast<int>(j));
    stated.effort_of.push_back(static_cast<int>(j));
    stated.effort_sign.push_back(1.0);
  }
  return stated;
}

std::vector<ArmRecording> rearranged(std::span<const ArmRecording> recordings, const Assumption& assumption) {
  std::vector<ArmRecording> all(recordings.begin(), recordings.end());
  for (ArmRecording& recording : all) {
    const ArmRecording was = recording;
    for (std::size_t j = 0; j < was.joints(); ++j) {
      const auto motion_of = static_cast<std::size_t>(assumption.position_of[j]);
      const auto effort_of = static_cast<std::size_t>(assumption.effort_of[j]);
      recording.position[j] = was.position[motion_of];
      if (!was.velocity.empty()) recording.velocity[j] = was.velocity[motion_of];
      recording.effort[j] = was.effort[effort_of];
      for (double& value : recording.effort[j]) value *= assumption.effort_sign[j];
    }
  }
  return all;
}

std::vector<double> left_by_urdf(const ArmData& data, const Assumption& assumption, bool torques) {
  return left_with(data, torques_of(data, without_armatures(assumption.urdf), assumption.position_of), assumption,
                   torques);
}

arm::Gravity best_gravity(const ArmData& data, const Assumption& assumption, bool torques) {
  arm::Chain::Params urdf = without_armatures(assumption.urdf);
  const double size = vector_of(urdf.gravity).norm();
  std::array<MatrixXd, 4> parts;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    urdf.gravity =
        gravity_of(k == 0 ? arm::Vector3::Zero() : arm::Vector3(arm::Vector3::Unit(static_cast<Index>(k) - 1)));
    parts[k] = torques_of(data, urdf, assumption.position_of);
    if (k > 0) parts[k] -= parts[0];
  }
  std::vector<MatrixXd> sums;
  for (int j = 0; j < data.joints(); ++j) {
    const auto at = static_cast<std::size_t>(j);
    MatrixXd torques_of_joint(data.rows(), 4);
    for (Index k = 0; k < 4; ++k) torques_of_joint.col(k) = parts[static_cast<std::size_t>(k)].col(j);
    sums.push_back(products(data, torques_of_joint, assumption.position_of[at], assumption.effort_of[at]));
  }
  const auto left = [&](const arm::Vector3& direction) {
    VectorXd mix(4);
    mix << 1.0, size * direction;
    double sum = 0.0;
    for (std::size_t j = 0; j < sums.size(); ++j) sum += left_of(sums[j], mix, assumption.effort_sign[j], torques);
    return sum;
  };
  arm::Vector3 best = arm::Vector3::UnitZ();
  double least = 1e300;
  const auto consider = [&](const arm::Vector3& direction, double bonus) {
    const double found = left(direction.normalized());
    if (found >= bonus * least) return false;
    least = found, best = direction.normalized();
    return true;
  };
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        if (x != 0 || y != 0 || z != 0) consider(arm::Vector3(x, y, z), 1.0);
      }
    }
  }
  for (double step = 0.4; step > 2e-3;) {
    const arm::Vector3 about = best;
    const arm::Vector3 aside = about.unitOrthogonal(), other = about.cross(aside);
    bool better = false;
    for (int k = 0; k < 8; ++k) {
      const double angle = std::numbers::pi * k / 4.0;
      better = consider(about + step * (std::cos(angle) * aside + std::sin(angle) * other), 1.0) || better;
    }
    if (!better) step *= 0.5;
  }
  // An arm is mounted along an axis unless the data say otherwise.
  constexpr double about_an_axis = 0.12, as_good = 1.05, a_little = 1e-4;
  for (Index k = 0; k < 3; ++k) {
    for (const double way : {1.0, -1.0}) {
      const arm::Vector3 axis = way * arm::Vector3::Unit(k);
      if ((best - axis).norm() < about_an_axis && left(axis) <= as_good * least + a_little) best = axis;
    }
  }
  return gravity_of(size * best);
}

std::string text_of(const arm::Gravity& gravity) {
  return one_number(gravity.x_m_per_s2) + "," + one_number(gravity.y_m_per_s2) + "," + one_number(gravity.z_m_per_s2);
}

Assumption explain(const ArmData& data, const Assumption& stated, const std::vector<std::string>& joints, bool torques,
                   const std::function<void(double)>& progress) {
  // A direction of gravity has two numbers that fit errors of masses too.
  constexpr double as_good = 0.98, by_its_freedom = 0.5;
  Rating rating(data, torques);
  Assumption best = stated;
  double least = rating(stated);
  // Where so little is left, no change can be worth having.
  for (int round = 0; round < most_changes && least > worth_having; ++round) {
    Assumption found = best;
    double found_left = least;
    std::vector<Assumption> all = next_changes(data, best, joints, torques);
    for (std::size_t i = 0; i < all.size(); ++i) {
      if (progress) progress((round + static_cast<double>(i) / static_cast<double>(all.size())) / most_changes);
      const double left = rating(all[i]);
      const bool turns_gravity = all[i].remedies.back().starts_with("--gravity");
      if (left < (turns_gravity ? by_its_freedom : as_good) * found_left) found = std::move(all[i]), found_left = left;
    }
    if (found_left > clearly_better * least) {
      // Two joints of a planar arm may have to be reversed together.
      for (int j = 0; j < data.joints(); ++j) {
        for (int k = j + 1; k < data.joints(); ++k) {
          Assumption one = reversed(best, joints, {j, k});
          const double left = rating(one);
          if (left < one_more * found_left) found = std::move(one), found_left = left;
        }
      }
    }
    if (found_left > clearly_better * least || least - found_left < worth_having) break;
    best = std::move(found), least = found_left;
  }
  return best;
}

}  // namespace tactus::arm_identification
