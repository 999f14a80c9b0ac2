// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/advice/arm_methods.hpp>
#include <tactus/analysis/advice/knowledge.hpp>
#include <tactus/data/configuration/document.hpp>
#include <tactus/kernel/arm/hand.hpp>
#include <tactus/simulation/experiments/arm_tapping/params.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// Two arms that are advised on.
namespace tactus::advice {

/// A hand that must be served.
struct ArmHand {
  std::string name;  ///< `yours`, or `a soft one`
  arm::HandImpedance hand;
};

/// A light grip, as experiments/arms/light-grip.toml has it. Every pair is tried in it alongside the file's own.
inline constexpr arm::HandImpedance light_grip{
    .mass_kg = 0.1, .stiffness_N_per_m = 60.0, .damping_N_s_per_m = 10.0, .lever_m = 0.05};

/// Poses alongside the file's own that a search may see, and all that there are with it: what confirms an answer sees
/// those too that no search saw.
inline constexpr std::size_t seen_poses = 7, most_poses = 12;

/// An experiment on two arms with what must stay as it is.
struct ArmBench {
  configuration::Document document;  ///< of kind arm-tapping, with the values that were given
  std::filesystem::path folder;      ///< that the URDF's path counts from
  std::vector<std::string> set;      ///< what was given, `key=value`
  Conditions given;                  ///< the keys of that
  experiments::ArmTappingParams as_given;
  std::size_t joints = 0;
  std::vector<ArmHand> hands;                         ///< the file's own first
  std::vector<std::int64_t> poses;                    ///< that the arms may begin in, the file's own first
  std::vector<experiments::TapDirection> directions;  ///< the file's own first
  std::optional<double> asked_gain;                   ///< the force gain that was given
};

/// From a document on which the files of `--with` and the values of `set` are already applied. Only `set` holds
/// conditions: other files describe the pair, and what they recommend is searched again. One hand where `set` has a key
/// of `operator`, or where the file's own is as soft as `light_grip`; one pose or direction where it has that.
///
/// Errors: those of reading the document and of `ArmTaps::make`, where the document has them.
Result<ArmBench> make_arm_bench(configuration::Document document, const std::vector<std::string>& set);

/// The choices of a dimension that agree with what was given, without what was given of them; where none does, one
/// without settings: as given. Errors: those of reading the document.
Result<Dimension> allowed(const ArmBench& bench, const Dimension& dimension);

/// The parameters of a method on top of the document. Errors: those of reading it.
Result<experiments::ArmTappingParams> params_of(const ArmBench& bench, const Method& method);
/// The same with other keys on top. Errors: those of reading it.
Result<experiments::ArmTappingParams> params_of(const ArmBench& bench, const Method& method,
                                                const experiments::Settings& other);

}  // namespace tactus::advice
