// SPDX-License-Identifier: Apache-2.0
#include "tests/laws.hpp"

#include <tactus/runtime/ros2/remote_path.hpp>

namespace tactus::laws {

/// A wish in about half of the ticks.
template <>
struct Doubles<ros2::RemotePath::Input> {
  using Row = std::array<double, 2>;
  static ros2::RemotePath::Input from(const Row& row) {
    return {.scripted_m = row[0], .requested_m = row[1] > 0.0 ? std::optional(row[1]) : std::nullopt};
  }
};

INSTANTIATE_TYPED_TEST_SUITE_P(Ros2, ElementLaws, ::testing::Types<ros2::RemotePath>);

}  // namespace tactus::laws
