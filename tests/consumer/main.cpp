// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/core/parameters.hpp>

#include <iostream>

struct Handle {
  double mass_kg = 0.15;
  static constexpr auto fields() {
    return tactus::List{
        tactus::field("mass_kg", &Handle::mass_kg, tactus::units::kilogram, tactus::positive, "Moving mass.")};
  }
};

// Succeeds when a sound handle is accepted and a handle without mass is refused.
int main() {
  const tactus::Check none = tactus::validate(Handle{});
  const tactus::Check error = tactus::validate(Handle{.mass_kg = 0.0});
  if (error) std::cout << tactus::describe(*error) << '\n';
  return !none && error ? 0 : 1;
}
