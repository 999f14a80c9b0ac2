// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace tactus::recording {

/// The samples of one column with what the file states about them.
struct Column {
  std::vector<double> values;
  std::string name;
  std::string unit;
};

}  // namespace tactus::recording
