// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/data/configuration/document.hpp>
#include <tactus/simulation/experiments/arm_tapping/arm_taps.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <utility>

#include <gtest/gtest.h>

namespace tactus::experiments {

inline const std::filesystem::path shipped_folder = TACTUS_EXPERIMENT_FOLDER;

/// The experiment on arms that ships, with files on top, as `--with` lays them.
inline ArmTappingParams shipped_with(std::initializer_list<const char*> on_top) {
  auto document = *configuration::Document::load(shipped_folder / "arm-tapping.toml");
  for (const char* file : on_top) {
    EXPECT_EQ(document.merge(*configuration::Document::load(shipped_folder / file)), std::nullopt);
  }
  return document.read<ArmTappingParams>().value();
}

inline double share_that_settles(ArmTappingParams params, std::int64_t taps) {
  params.task.taps = taps;
  const ArmTaps made = *ArmTaps::make(params, shipped_folder);
  std::size_t settled = 0;
  for (std::size_t tap = 0; tap < made.size(); ++tap) settled += made.run(tap).settled() ? 1U : 0U;
  return static_cast<double>(settled) / static_cast<double>(taps);
}

}  // namespace tactus::experiments
