// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/simulation/experiments/faults/outcome.hpp>
#include <tactus/simulation/experiments/faults/params.hpp>
#include <tactus/simulation/experiments/faults/plan.hpp>

#include <string_view>
#include <vector>

/// The rows of the table of faults: what is done, what must come of it, and what shows that this is no accident.
namespace tactus::experiments {

/// The rule of a row that a run broke, in words; empty where it kept all.
using FaultRule = std::string_view (*)(const FaultPlan&, const FaultOutcome&, const FaultsParams&);

/// The same plans without what defends against them: most of these runs must not survive.
struct FaultControl {
  std::string_view off;  ///< what is switched off, or as loose as its bounds allow; empty where a row has no control
  void (*switch_off)(simulation::Teleoperator::Params&, FaultPlan&) = nullptr;
  /// Which plans can show it; all without a condition.
  bool (*shows)(const FaultPlan&, const FaultsParams&) = nullptr;
};

struct FaultRow {
  FaultKind kind;
  std::string_view id;
  std::string_view name;
  std::string_view injected;
  std::string_view expected;
  FaultRule rule = nullptr;  ///< besides those that hold for every run
  FaultControl control{};
  void (*prepare)(simulation::Teleoperator::Params&) =
      nullptr;            ///< what the row's teleoperator has and others have not
  bool resumes = true;    ///< false: somebody may have to move a device back before the sites follow again
  bool monitored = true;  ///< false: the passivity monitor as loose as its bounds allow
};

/// Every row, or the one with the id `only`.
std::vector<FaultRow> fault_rows(std::string_view only = {});

/// Of the rules that hold for every run, in words, the one that was broken: no bound on harm among them.
std::string_view broken_rule_of_all(const FaultOutcome& outcome);
/// The bound on harm that was broken, in words; what may continue for `release_s` after both sites stopped.
std::string_view broken_bound(const FaultOutcome& outcome, const HarmBounds& bounds, double release_s);
/// Of a run in which nothing goes wrong.
std::string_view tripped_on_clean_data(const FaultOutcome& outcome);
inline constexpr std::string_view not_resumed = "not active again after clearing and arming";

/// The parameters of a row: those given, or with the monitor as loose as it can be.
simulation::Teleoperator::Params params_of(const FaultRow& row, const FaultsParams& params);

/// The rule that a run broke, in words; empty where it kept everything that its row asks for.
std::string_view broken_rule(const FaultRow& row, const FaultPlan& plan, const FaultOutcome& outcome,
                             const FaultsParams& params);

}  // namespace tactus::experiments
