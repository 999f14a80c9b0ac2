// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/identification/axis/bench_knowledge.hpp>
#include <tactus/kernel/core/result.hpp>
#include <tactus/simulation/experiments/tapping/tapping.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

/// What of a teleoperator is known, and how well: rigs drawn from it. Cold: it allocates.
namespace tactus::advice {

/// The keys that a user has given, which nobody changes.
using Conditions = std::set<std::string, std::less<>>;

/// A number that is not known exactly.
struct Uncertain {
  std::string name;  ///< as identification calls it (`motor.mass_kg`), or the key of the mismatch that stands for it
  std::string unit;
  double value = 0.0;
  std::array<double, 2> interval_95{};
};

/// Which uncertain parameters count as known exactly all the same: none, one of them by its index, or all.
struct Known {
  std::optional<std::size_t> one = {};
  bool all = false;
};

/// Parameters with their joint distribution. Those of an identified master are normal in the variable that
/// identification fits (a logarithm, for most) and move the simulated master and its operator: the controller's model
/// stays what was found. Those of a stated error of the model are even and move the model, as `task.model_error` does.
class Knowledge {
 public:
  /// All is known.
  Knowledge() = default;

  /// From what an identification found, with the correlation matrix of `found`, row by row; empty where that is not
  /// known. What `given` holds, and what a teleoperator has no key for, is left out.
  static Knowledge identified(std::span<const identification::FoundParameter> found,
                              std::span<const double> correlation, const Conditions& given);
  /// The same from the results.json of `tactus identify`. Errors: `missing` for a file that cannot be read, `syntax`
  /// for one that holds no parameters with intervals.
  static Result<Knowledge> read(const std::filesystem::path& results, const Conditions& given);
  /// Masses, linkage stiffness and operator damping of the controller's model, each wrong by up to `share`, from 0 to
  /// 0.5.
  static Knowledge wrong_model(double share);

  [[nodiscard]] const std::vector<Uncertain>& parameters() const { return parameters_; }
  /// Whether an identification is behind it.
  [[nodiscard]] bool of_identification() const { return of_identification_; }

  /// By how much of it the controller's model may be wrong, as it was stated; 0 for an identification.
  [[nodiscard]] double stated_error() const { return stated_error_; }

  /// An error unless the controller's model is the one that was identified, to 1 %. `inconsistent`.
  [[nodiscard]] Check fits(const control::MasterModel& model) const;

  /// The rig of a draw: 0 is what is assumed. What is known more is so at the assumed value; the others keep what
  /// their draw has alongside it. Taps of a seed of their own.
  [[nodiscard]] experiments::TappingParams drawn(const experiments::TappingParams& believed, std::uint64_t draw,
                                                 const Known& known = {}) const;

 private:
  enum class Scale { logarithm, odds, linear, even };
  struct Place {
    const char* name;
    const char* key;
    Scale scale;
    void (*put)(experiments::TappingParams& rig, double value);
  };
  static const std::vector<Place>& places();
  void add(const Place& place, Uncertain parameter, double deviation);
  void set_correlation(const std::function<double(std::size_t, std::size_t)>& of);

  std::vector<Uncertain> parameters_;
  std::vector<Place> places_;
  std::vector<double> deviation_;                               ///< of each in its scale
  std::vector<double> covariance_;                              ///< row by row
  std::vector<double> root_;                                    ///< times its transpose: the covariance
  double model_mass_kg_ = 0.0, model_stiffness_N_per_m_ = 0.0;  ///< of the model that was identified, motor and linkage
  bool of_identification_ = false;
  double stated_error_ = 0.0;
};

}  // namespace tactus::advice
