// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace CLI {  // NOLINT: the name is not ours
class Validator;
}

namespace tactus::cli {

/// Checks that an option is a real number of `low` to `high`. CLI11's own range lets through what is not a number.
CLI::Validator real_between(double low, double high);

}  // namespace tactus::cli
