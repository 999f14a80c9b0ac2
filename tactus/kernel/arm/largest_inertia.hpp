// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/arm/chain.hpp>

namespace tactus::arm {

/// An upper bound on each diagonal element of the mass matrix over all poses: kg m², or kg of a joint that slides.
/// Armature included.
///
/// The axis of joint i is at the distance D + |x| at most from a point x of the link k beyond it, where D is what the
/// origins between them are apart: the first one across the axis, which no pose changes, the others in a straight line.
/// With ∫|x|² dm = t and Minkowski's inequality, ∫(D + |x|)² dm ≤ (√m·D + √t)². So the bound is exact for the last
/// joint, and close where an arm that is stretched out moves as a whole. Not real-time safe.
JointVector largest_inertia(const Chain::Params& params);

}  // namespace tactus::arm
