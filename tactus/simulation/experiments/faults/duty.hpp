// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/experiments/faults/outcome.hpp>
#include <tactus/simulation/experiments/faults/params.hpp>
#include <tactus/simulation/experiments/faults/plan.hpp>

#include <limits>
#include <string_view>

/// What the sites owe to an operator when something fails, besides the bounds on harm: that they see it and stop, and
/// by when. One duty for each fault, whether it comes alone, alongside another one or while arming.
namespace tactus::experiments {

struct FaultDuty {
  enum class Kind {
    none,     ///< the bounds on harm are all
    goes_on,  ///< it stops nothing
    latches,  ///< a site ends in hold or fault
    stops     ///< no site is active
  };
  /// At which site it shows.
  enum class Seen { at_its_own, at_the_other, at_each, from_one_to_the_other };

  Kind kind = Kind::none;
  double within_s = 0.0;                                     ///< of its begin
  double lasts_s = std::numeric_limits<double>::infinity();  ///< what shows it
  double needs_s = 0.0;  ///< for so long, by the clock of the site that is to see it
  Seen seen = Seen::at_its_own;
  bool by_packets = false;  ///< what comes, or comes no more, shows it
};

/// What must come of a fault that comes alone, to sites that are supervised so and stepped so often.
FaultDuty duty_of(const FaultPlan& plan, const control::SupervisionParams& supervision, double rate_Hz);
inline FaultDuty duty_of(const FaultPlan& plan, const FaultsParams& params) {
  return duty_of(plan, params.control.supervision, params.servo.rate_Hz);
}

/// The duty that was not done, in words; empty where it was. Of a fault that comes alone.
std::string_view broken_duty(const FaultDuty& duty, const FaultPlan& plan, const FaultOutcome& outcome, double rate_Hz);
std::string_view broken_duty(const FaultPlan& plan, const FaultOutcome& outcome, const FaultsParams& params);
/// Of two at once: the duty of either, put off by what the other takes from the sites to do it. docs/how-to/faults.md
/// argues each term.
std::string_view broken_duty_of_two(const FaultPlan& plan, const FaultOutcome& outcome, const FaultsParams& params);
/// How long after both sites stopped a motor may give a force: of two faults longer than of one, by what a site's clock
/// or process takes longer for its fade.
double release_allowed_s(const FaultPlan& plan, const FaultsParams& params);
/// Of one between arming and following: who has not followed has stopped, and what shows only in use has until then.
std::string_view broken_duty_while_arming(const FaultPlan& plan, const FaultOutcome& outcome,
                                          const FaultsParams& params);

}  // namespace tactus::experiments
