// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/parameters.hpp>

#include <array>
#include <cstddef>

namespace tactus::control {

/// What became of a tare: the identification of the force that a controller's model of gravity lacks.
enum class TareState {
  none,       ///< nobody asked for one, or the controller cannot
  under_way,  ///< the site moves its device to and fro, and nothing else may
  done,       ///< its result acts
  stopped,    ///< the site was asked for something else meanwhile, and the result before still acts
  still,      ///< a joint did not follow the motion: it is blocked, touches something, or rubs too much
  too_large   ///< a joint lacks more than a payload or a wrong mass explains
};
constexpr auto enumerators(TareState) {
  return std::array{Enumerator{TareState::none, "none"},   Enumerator{TareState::under_way, "under-way"},
                    Enumerator{TareState::done, "done"},   Enumerator{TareState::stopped, "stopped"},
                    Enumerator{TareState::still, "still"}, Enumerator{TareState::too_large, "too-large"}};
}

/// The same with what it judged; of `still` the joint and its travel either way, over the wanted one; of `too_large`
/// the joint and the force in N that it lacks.
struct TareReport {
  TareState state = TareState::none;
  std::size_t joint = 0;
  double value = 0.0;
};

}  // namespace tactus::control
