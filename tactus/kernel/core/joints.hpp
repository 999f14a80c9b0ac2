// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/kernel/core/units.hpp>

#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

/// Devices of several joints: whatever one joint has, `Joints` holds for up to eight. What is written with `Each` and
/// `for_each_joint` is written once for one axis, which stays a plain value, and for all of a device's joints.
///
/// A joint's numbers are in its own unit: where a name states m and N, one that turns has rad and N m.
namespace tactus {

/// The largest number of joints that a device may have.
inline constexpr std::size_t most_joints = 8;

/// One `T` for each joint, held in place. Real-time safe where copies of `T` are.
template <class T>
class Joints {
 public:
  using Joint = T;

  /// No joint yet.
  Joints() requires std::default_initializable<T>
  = default;
  /// `size` joints, 1 to `most_joints`, each as `each` is.
  explicit Joints(std::size_t size, const T& each = T())
      : Joints(size, each, std::make_index_sequence<most_joints>()) {}

  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  [[nodiscard]] T& operator[](std::size_t joint) noexcept { return at_[joint]; }
  [[nodiscard]] const T& operator[](std::size_t joint) const noexcept { return at_[joint]; }
  [[nodiscard]] T* begin() noexcept { return at_.data(); }
  [[nodiscard]] T* end() noexcept { return at_.data() + size_; }
  [[nodiscard]] const T* begin() const noexcept { return at_.data(); }
  [[nodiscard]] const T* end() const noexcept { return at_.data() + size_; }

 private:
  template <std::size_t... I>
  Joints(std::size_t size, const T& each, std::index_sequence<I...>) : at_{((void)I, each)...}, size_(size) {}

  std::array<T, most_joints> at_{};
  std::size_t size_ = 0;
};

namespace detail {

template <class X>
struct JointsOf {
  using Joint = X;
  template <class T>
  using Each = T;
  static constexpr bool several = false;
};
template <class X>
struct JointsOf<Joints<X>> {
  using Joint = X;
  template <class T>
  using Each = Joints<T>;
  static constexpr bool several = true;
};

}  // namespace detail

/// Whether `X` is of several joints, not of one axis.
template <class X>
inline constexpr bool has_joints = detail::JointsOf<std::remove_cvref_t<X>>::several;
/// A `T`, where `Like` is of one axis; `Joints<T>`, where it is of several.
template <class Like, class T>
using Each = typename detail::JointsOf<std::remove_cvref_t<Like>>::template Each<T>;
/// What one joint of `X` has; `X` itself where it is of one axis.
template <class X>
using JointOf = typename detail::JointsOf<std::remove_cvref_t<X>>::Joint;

/// How many joints there are; 1 of one axis.
template <class X>
constexpr std::size_t joints_of(const X& x) noexcept {
  if constexpr (has_joints<X>) {
    return x.size();
  } else {
    return 1;
  }
}

/// What joint number `joint` has, from 0.
template <class X>
constexpr auto& joint_of(X& x, [[maybe_unused]] std::size_t joint) noexcept {
  if constexpr (has_joints<X>) {
    return x[joint];
  } else {
    return x;
  }
}

/// Calls `visit(first, rest...)` with what each joint has, in order; all must have as many.
template <class Visit, class First, class... Rest>
constexpr void for_each_joint(Visit&& visit, First&& first, Rest&&... rest) {
  for (std::size_t joint = 0; joint < joints_of(first); ++joint)
    visit(joint_of(first, joint), joint_of(rest, joint)...);
}

/// `each` for every joint that `like` has.
template <class Like, class T>
constexpr Each<Like, T> same_for_each(const Like& like, const T& each) {
  if constexpr (has_joints<Like>) {
    return Joints<T>(like.size(), each);
  } else {
    return each;
  }
}

/// A member of what each joint has; of one axis that member itself, which lives as long as `x`.
template <class X, class T>
constexpr std::conditional_t<has_joints<X>, Joints<T>, const T&> member_of_each(const X& x, T JointOf<X>::*member) {
  if constexpr (has_joints<X>) {
    Joints<T> found(x.size());
    for_each_joint([member](T& to, const JointOf<X>& from) { to = from.*member; }, found, x);
    return found;
  } else {
    return x.*member;
  }
}

/// The one of two values that is farther from zero: for a figure that stands for all joints. Real-time safe.
inline double farther(double one, double other) noexcept { return std::fabs(one) > std::fabs(other) ? one : other; }

/// The error of one joint of several, under `joint_1` and on; that of one axis as it is.
template <class Like>
Error under_joint(std::size_t joint, Error error) {
  if constexpr (has_joints<Like>) {
    return under("joint_" + std::to_string(joint + 1), std::move(error));
  } else {
    return error;
  }
}

/// An element of type `E` for each joint, of its parameters. Errors: those of `E::make`, under the joint.
template <class E, class Params>
Result<Each<Params, E>> make_each(const Params& params, Seconds dt) {
  std::optional<Each<Params, E>> made;
  for (std::size_t joint = 0; joint < joints_of(params); ++joint) {
    auto one = E::make(joint_of(params, joint), dt);
    if (!one) return under_joint<Params>(joint, one.error());
    if (!made) made = same_for_each(params, *one);
    joint_of(*made, joint) = *std::move(one);
  }
  return *std::move(made);
}

}  // namespace tactus
