// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/model/induced_motion_model.hpp>
#include <tactus/simulation/experiments/experiment.hpp>

#include <string>
#include <string_view>
#include <vector>

/// What can be set against contact that rings.
namespace tactus::advice {

/// One way to have a thing, such as a notch in the command.
struct Choice {
  experiments::Settings settings;
  std::string words = {};   ///< for a user: `a notch in the command at {} Hz`, {} for the number; empty for without
  std::string tuned = {};   ///< key whose number is the one in the words and may be moved; empty for none
  std::string within = {};  ///< words of the choice of an earlier dimension that this is a part of; empty for none
  bool operator==(const Choice&) const = default;
};

/// Choices of which a configuration has exactly one.
using Dimension = std::vector<Choice>;

/// A configuration: one choice of each dimension.
struct Method {
  std::vector<Choice> choices;
  [[nodiscard]] experiments::Settings settings() const;
  /// Whether one of the choices has these words, as they are in it.
  [[nodiscard]] bool has(std::string_view words) const;
  /// Choices that have a number to be tuned: damping, compensation, filters.
  [[nodiscard]] std::size_t stages() const;
  /// For a user, `cancellation and local damping of 5 N s/m`; `no stage` for none.
  [[nodiscard]] std::string words() const;
  bool operator==(const Method&) const = default;
};

/// The words of the choice that follows the grip of whoever holds the master (docs/theory/changing-grip.md).
inline constexpr std::string_view grip_estimate = "an estimate of the grip";

/// The dimensions of position-force control that are searched: cancellation, an estimate of the grip within it, local
/// damping, hand compensation, filter of the command, filter of the force. Notches are at the master's mode in the
/// hand as `model` has it.
std::vector<Dimension> position_force_dimensions(const control::MasterModel& model);
/// Other architectures, for where position-force control settles at no gain. They reflect less of the force.
std::vector<Dimension> other_dimensions();

/// Every combination with at most `stages` choices that are more than "without", cancellation and what is within it not
/// counted, and no two filters; those with fewer first.
std::vector<Method> combine(const std::vector<Dimension>& dimensions, std::size_t stages);

/// The method with each of its tuned numbers at a factor of 0.7 and of 1.4, one at a time.
std::vector<Method> retuned(const Method& method);

/// A number with three digits.
double rounded(double value);

}  // namespace tactus::advice
