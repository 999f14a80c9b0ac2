// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/advice/methods.hpp>
#include <tactus/simulation/experiments/arm_tapping/params.hpp>

#include <cstddef>
#include <vector>

/// What can be set where two arms are coupled.
namespace tactus::advice {

/// The most damping that is proposed for a drive of the leader, N m s/rad: what Damiao's drives take. More is for
/// whoever sets it.
inline constexpr double most_drive_damping_N_m_s_per_rad = 5.0;

/// The dimensions of position-force control that are searched together, the coupling first and in each the bare choice
/// first: position-force, cancellation or feedback avoidance; damping in the leader's drives, a multiple of what the
/// follower's have, limited at the tool; a damper at the leader's tool over the bus; a filter of the command; the
/// follower's share of its stiffness, limits at its tool, and a dead band of its observer. With elastic joints the
/// observer, and the model that is cancelled with, may take them for elastic or rigid. Every key of a choice is set, so
/// nothing that a file recommends is left over. What is no coupling's choice but the pair's own (the follower's gains,
/// feed-forward, the source of torque, the hand of the model) stays as `params` has it.
std::vector<Dimension> arm_dimensions(const experiments::ArmTappingParams& params, std::size_t joints);

/// Whether the joints of the follower, be it like the leader or another arm, are elastic.
bool has_elastic_follower(const experiments::ArmTappingParams& params);

/// Couplings that are complete by themselves, tried on the bare pair alone: position-position, FACTR's law without
/// dither, four-channel control, and position-force with a low-pass of the displayed force. They are choices of the
/// first dimension.
Dimension arm_rivals(const experiments::ArmTappingParams& params);

/// The first choice of every dimension.
Method bare_method(const std::vector<Dimension>& dimensions);

/// `method` with another choice in one dimension, one for each such choice, in the dimensions' order.
std::vector<Method> neighbours(const Method& method, const std::vector<Dimension>& dimensions);

}  // namespace tactus::advice
