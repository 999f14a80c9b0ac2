// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/analysis/advice/knowledge.hpp>
#include <tactus/simulation/experiments/gain_limit.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

/// Trying configurations on rigs that may be the one.
namespace tactus::advice {

/// Which rigs a gain is tried on. Numbers apart give draws apart.
struct Draws {
  std::uint64_t first = 0;
  std::size_t rigs = 1;
  std::int64_t taps = 32;  ///< on each rig
  Known known = {};
  bool coarse = true;  ///< plants in steps of 20 µs, where the file has shorter ones: within 1 % (the contest's)
};

/// Grips of an operator, over the one of the file.
inline constexpr std::array own_grip{1.0};
inline constexpr std::array any_grip{1.0, 0.25, 4.0};

/// Rigs on which a gain is tried, each with taps of its own.
class Trial {
 public:
  /// Draws that make no rig, as a cable too stiff for the plants' steps, are passed over. Errors: why the rig that is
  /// assumed, or too many of the draws, can not be.
  static Result<Trial> make(const Knowledge& knowledge, const experiments::TappingParams& believed, const Draws& draws,
                            std::span<const double> grips = own_grip);

  /// Whether `experiments::taps_settle` on every rig. The rig that failed last is tried first, which changes no answer.
  bool settles(double gain);
  /// The rig on which the last gain that did not settle failed; before that, the first.
  [[nodiscard]] const experiments::TappingParams& failed_last() const { return rigs_.front(); }
  /// `experiments::find_gain_limit` over `settles`.
  experiments::GainLimit limit(double lowest, double highest, double resolution = experiments::gain_resolution);
  /// Of all taps on all rigs at this gain.
  [[nodiscard]] experiments::TappingMetrics metrics(double gain) const;

  [[nodiscard]] const std::vector<experiments::TappingParams>& rigs() const { return rigs_; }

 private:
  std::vector<experiments::TappingParams> rigs_;
};

}  // namespace tactus::advice
