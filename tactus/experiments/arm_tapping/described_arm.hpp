#pragma once

#include <tactus/configuration/document.hpp>
#include <tactus/experiments/arm_tapping/params.hpp>

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace tactus::experiments {

/// An arm as a file describes it, and where its joints begin.
struct DescribedArm {
  std::string urdf;                 ///< its name in the file
  std::string urdf_text;            ///< what that says
  std::vector<std::string> joints;  ///< their names, from the base on
  arm_plants::ArmPlant::Params arm;
  arm::JointVector start;

  /// Of each joint's transmission; 0 is rigid.
  [[nodiscard]] arm::JointVector joint_stiffness_N_m_per_rad() const;
  [[nodiscard]] arm::JointVector joint_damping_N_m_s_per_rad() const;
};

/// A leader and the follower that it commands.
struct DescribedPair {
  DescribedArm leader;
  DescribedArm follower;  ///< led joint by joint, it begins where the leader does
};

/// What a URDF says, and the file that errors name.
struct UrdfText {
  std::string text;
  std::filesystem::path file;
};
/// Where the URDFs are that an experiment names.
using Urdfs = std::function<Result<UrdfText>(const std::string& name)>;
/// Files, from `folder` on. Errors: those of `urdf::text_of`.
Urdfs urdfs_below(const std::filesystem::path& folder);

/// Reads the URDF and adds what it does not say. Errors: `missing` without a URDF; those of its text and of
/// `urdf::parse`.
Result<DescribedArm> describe_arm(const ArmParams& params, const Urdfs& urdfs);

/// Both arms. Errors: those of `describe_arm`; `inconsistent` where something is said of a follower that has no URDF of
/// its own; of arms that are led joint by joint, for different numbers of joints and for another start of the follower;
/// of one that leads the tool, for a follower without a URDF and for a leader that is no handle.
Result<DescribedPair> describe_pair(const ArmPairParams& params, arm_control::Coupling coupling, const Urdfs& urdfs);

/// Errors: `inconsistent`, under `control.follower.coupling`, for a leader that leads the tool: `what` ("tactus
/// faults") knows arms that are led joint by joint alone.
Check refuse_tool_coupling(const ArmTappingParams& params, std::string_view what);

/// Whether a document asks for two arms: its kind is arm-tapping.
bool is_of_arms(const configuration::Document& document);

/// Whether the follower is another arm than the leader.
inline bool differs(const ArmPairParams& params) { return !params.follower.urdf.empty(); }

}  // namespace tactus::experiments
