// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/element.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "tests/allocation_counter.hpp"
#include <gtest/gtest.h>

/// The laws that every element keeps. An element joins with one line:
///
///     INSTANTIATE_TYPED_TEST_SUITE_P(Mine, ElementLaws, ::testing::Types<MyElement>);
///
/// Each law is a function that returns what is wrong, or nothing, so that `tests/signal/laws_test.cpp` can show that it
/// catches an element that breaks it.
namespace tactus::laws {

/// What the laws have to know of an element. Specialise it where these defaults do not fit.
template <class E>
struct Subject {
  static constexpr double dt_s = 200e-6;
  /// Parameter sets to try; the first is also the one whose fields are pushed out of bounds.
  static std::vector<typename E::Params> parameters() { return {typename E::Params{}}; }
  /// Turns an arbitrary input into one that the element is defined for.
  static void admit(typename E::Input&) {}
};

/// An input or output as a row of doubles. Specialise it for a type that holds anything but doubles.
template <class T>
struct Doubles {
  static_assert(std::is_trivially_copyable_v<T> && sizeof(T) % sizeof(double) == 0, "specialise laws::Doubles");
  using Row = std::array<double, sizeof(T) / sizeof(double)>;
  static T from(const Row& row) { return std::bit_cast<T>(row); }
  static Row to(const T& value) { return std::bit_cast<Row>(value); }
};

using Violation = std::optional<std::string>;

/// Bit for bit, so that −0 is not 0.
template <class T>
bool alike(const T& left, const T& right) {
  using Row = typename Doubles<T>::Row;
  using Bits = std::array<std::uint64_t, std::tuple_size_v<Row>>;
  return std::bit_cast<Bits>(Doubles<T>::to(left)) == std::bit_cast<Bits>(Doubles<T>::to(right));
}

/// Inputs from a seeded generator: ordinary signals, or every magnitude from the smallest denormal to 1e9.
template <class E>
class Inputs {
 public:
  explicit Inputs(std::uint64_t seed) : engine_(seed) {}

  typename E::Input ordinary() {
    return make([&] { return 2.0 * fraction() - 1.0; });
  }

  typename E::Input extreme() {
    return make([&] {
      static constexpr double edges[] = {
          0.0, -0.0, 1e9, -1e9, std::numeric_limits<double>::denorm_min(), -std::numeric_limits<double>::min()};
      if (engine_() % 4 == 0) return edges[engine_() % std::size(edges)];
      return std::copysign(std::pow(10.0, -323.0 + 332.0 * fraction()), fraction() - 0.5);
    });
  }

 private:
  double fraction() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }

  template <class Draw>
  typename E::Input make(Draw draw) {
    typename Doubles<typename E::Input>::Row row{};
    for (double& number : row) number = draw();
    auto input = Doubles<typename E::Input>::from(row);
    Subject<E>::admit(input);
    return input;
  }

  std::mt19937_64 engine_;
};

/// Runs `law(element, inputs)` on a fresh element of every parameter set and returns the first violation.
template <class E, class Law>
Violation on_every_parameter_set(Law law) {
  std::uint64_t seed = 1;
  for (const auto& params : Subject<E>::parameters()) {
    Result<E> element = E::make(params, Seconds{Subject<E>::dt_s});
    if (!element) return "make refused a parameter set of the suite: " + describe(element.error());
    Inputs<E> inputs(seed++);
    if (Violation violation = law(*element, inputs)) return violation;
  }
  return {};
}

/// Steps both with the same inputs and returns the first tick at which they differ.
template <class E>
Violation run_alike(E& left, E& right, Inputs<E>& inputs, const char* claim) {
  std::vector<typename E::Input> sequence;
  std::vector<typename E::Output> outputs;
  for (int tick = 0; tick < 300; ++tick) sequence.push_back(inputs.ordinary());
  for (const auto& input : sequence) outputs.push_back(left.step(input));
  for (std::size_t tick = 0; tick < sequence.size(); ++tick) {
    const typename E::Output expected = outputs[tick];  // a vector of bool gives no reference
    if (!alike(right.step(sequence[tick]), expected)) {
      return std::string(claim) + ": they differ at tick " + std::to_string(tick);
    }
  }
  return {};
}

template <class E>
Violation reset_equals_new() {
  return on_every_parameter_set<E>([](E& element, Inputs<E>& inputs) {
    E fresh = element;
    for (int tick = 0; tick < 300; ++tick) (void)element.step(inputs.ordinary());
    element.reset();
    return run_alike(fresh, element, inputs, "a reset element must behave as a new one");
  });
}

/// The original runs to the end before the copy starts, so state that the two share shows as a difference.
template <class E>
Violation a_copy_continues_identically() {
  return on_every_parameter_set<E>([](E& element, Inputs<E>& inputs) {
    for (int tick = 0; tick < 100; ++tick) (void)element.step(inputs.ordinary());
    E copy = element;
    return run_alike(element, copy, inputs, "a copy must continue as the original does");
  });
}

template <class E>
Violation finite_in_gives_finite_out() {
  return on_every_parameter_set<E>([](E& element, Inputs<E>& inputs) -> Violation {
    for (int tick = 0; tick < 20000; ++tick) {
      const auto input = tick % 2000 < 1000 ? inputs.extreme() : inputs.ordinary();
      for (const double number : Doubles<typename E::Output>::to(element.step(input))) {
        if (!std::isfinite(number)) return "the output at tick " + std::to_string(tick) + " is not finite";
      }
    }
    return {};
  });
}

template <class E>
Violation the_hot_calls_do_not_allocate() {
  return on_every_parameter_set<E>([](E& element, Inputs<E>& inputs) -> Violation {
    std::vector<typename E::Input> sequence;
    for (int tick = 0; tick < 1000; ++tick) sequence.push_back(inputs.extreme());
    const std::uint64_t before = allocation_count();
    for (const auto& input : sequence) (void)element.step(input);
    element.reset();
    const std::uint64_t made = allocation_count() - before;
    if (made != 0) return "1000 steps and a reset made " + std::to_string(made) + " allocations";
    return {};
  });
}

/// Stands for a value of any type where an aggregate is initialised in an unevaluated expression.
struct Anything {
  template <class T>
  operator T() const;  // NOLINT: implicit is the point, and it is never defined
};

/// The number of members of an aggregate: the most initialisers that it takes.
template <class Aggregate, class... Initialisers>
constexpr std::size_t member_count() {
  if constexpr (requires { Aggregate{Initialisers{}..., Anything{}}; }) {
    return member_count<Aggregate, Initialisers..., Anything>();
  } else {
    return sizeof...(Initialisers);
  }
}

/// Every member is a field, its name is unique, ends as its unit does and in no unit that it does not have, its doc is
/// not empty, and the defaults are valid.
template <Described Params>
Violation the_parameters_are_described() {
  Violation found;
  std::set<std::string> names;
  const auto blame = [&](const char* name, const char* what) {
    if (!found) found = std::string(name) + ": " + what;
  };
  for_each_field<Params>([&](const auto& f) {
    using Value = typename std::remove_cvref_t<decltype(f)>::value_type;
    const std::string_view name = f.name;
    if (!names.insert(f.name).second) blame(f.name, "the name stands twice");
    if (!name.ends_with(f.unit.suffix)) blame(f.name, "the name does not end with the suffix of its unit");
    // The longest unit that fits: a torque in N m is not said to be in m.
    const bool ends_so = unit_at_end_of(name).suffix == std::string_view(f.unit.suffix);
    if (!ends_so) blame(f.name, "the name ends with a unit it does not have");
    if (std::string_view(f.doc).empty()) blame(f.name, "the doc is empty");
    if constexpr (Described<Value>) {
      if (const Violation inner = the_parameters_are_described<Value>()) blame(f.name, inner->c_str());
    }
  });
  if (found) return found;
  if (names.size() != member_count<Params>()) {
    return std::to_string(member_count<Params>()) + " members, but " + std::to_string(names.size()) + " fields";
  }
  if (const Check error = validate(Params{})) return "the defaults are invalid: " + describe(*error);
  return {};
}

/// Values just outside the bounds of a field: what `make` has to refuse.
template <class Value>
std::vector<Value> outside(const Bounds& bounds) {
  if constexpr (std::is_same_v<Value, double>) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    return {bounds.lower_open ? bounds.lower : std::nextafter(bounds.lower, -infinity),
            std::nextafter(bounds.upper, infinity), std::numeric_limits<double>::quiet_NaN(), infinity, -infinity};
  } else {
    std::vector<Value> values;
    if (std::isfinite(bounds.lower)) values.push_back(static_cast<Value>(bounds.lower) - (bounds.lower_open ? 0 : 1));
    if (std::isfinite(bounds.upper)) values.push_back(static_cast<Value>(bounds.upper) + 1);
    return values;
  }
}

/// Pushes each number of `group`, which is a part of `params`, out of its bounds in turn.
template <class E, class Group>
Violation refuses_what_is_outside(const typename E::Params& params, Group& group, const std::string& prefix) {
  Violation found;
  for_each_field<Group>([&](const auto& f) {
    if (found) return;
    using Value = typename std::remove_cvref_t<decltype(f)>::value_type;
    const std::string path = prefix + f.name;
    if constexpr (Described<Value>) {
      found = refuses_what_is_outside<E>(params, group.*f.member, path + ".");
    } else if constexpr (std::is_same_v<Value, double> || std::is_same_v<Value, std::int64_t>) {
      const Value good = group.*f.member;
      for (const Value bad : outside<Value>(f.bounds)) {
        group.*f.member = bad;
        const Result<E> element = E::make(params, Seconds{Subject<E>::dt_s});
        const std::string what = path + " = " + format_number(static_cast<double>(bad));
        if (element) {
          found = "make accepted " + what;
        } else if (element.error().parameter != path) {
          found = "for " + what + " the error names '" + element.error().parameter + "'";
        }
        if (found) break;
      }
      group.*f.member = good;
    }
  });
  return found;
}

template <class E>
Violation invalid_parameters_are_refused_by_name() {
  auto params = Subject<E>::parameters().front();
  for (const double dt_s : {0.0, -1e-3, std::numeric_limits<double>::quiet_NaN()}) {
    const Result<E> element = E::make(params, Seconds{dt_s});
    if (element) return "make accepted a sample time of " + format_number(dt_s) + " s";
    if (element.error().parameter != "dt") return "the error for a bad sample time does not name dt";
  }
  return refuses_what_is_outside<E>(params, params, "");
}

}  // namespace tactus::laws

template <class E>
class ElementLaws : public ::testing::Test {
  static_assert(tactus::Element<E>);
};
TYPED_TEST_SUITE_P(ElementLaws);

TYPED_TEST_P(ElementLaws, ResetEqualsNew) { EXPECT_EQ(tactus::laws::reset_equals_new<TypeParam>(), std::nullopt); }
TYPED_TEST_P(ElementLaws, ACopyContinuesIdentically) {
  EXPECT_EQ(tactus::laws::a_copy_continues_identically<TypeParam>(), std::nullopt);
}
TYPED_TEST_P(ElementLaws, FiniteInGivesFiniteOut) {
  EXPECT_EQ(tactus::laws::finite_in_gives_finite_out<TypeParam>(), std::nullopt);
}
TYPED_TEST_P(ElementLaws, TheHotCallsDoNotAllocate) {
  EXPECT_EQ(tactus::laws::the_hot_calls_do_not_allocate<TypeParam>(), std::nullopt);
}
TYPED_TEST_P(ElementLaws, TheParametersAreDescribed) {
  EXPECT_EQ(tactus::laws::the_parameters_are_described<typename TypeParam::Params>(), std::nullopt);
}
TYPED_TEST_P(ElementLaws, InvalidParametersAreRefusedByName) {
  EXPECT_EQ(tactus::laws::invalid_parameters_are_refused_by_name<TypeParam>(), std::nullopt);
}
REGISTER_TYPED_TEST_SUITE_P(ElementLaws, ResetEqualsNew, ACopyContinuesIdentically, FiniteInGivesFiniteOut,
                            TheHotCallsDoNotAllocate, TheParametersAreDescribed, InvalidParametersAreRefusedByName);
