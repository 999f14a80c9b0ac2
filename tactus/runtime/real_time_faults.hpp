#pragma once

#include <tactus/core/result.hpp>
#include <tactus/runtime/servo_thread.hpp>
#include <tactus/simulation/experiment.hpp>

namespace tactus::runtime {

/// The table of faults in virtual time, and after it the first `task.real_time_seeds` plans of each row again at the
/// real clock: the same sites, devices and plans, stepped by a servo thread, several runs side by side in each tick.
/// Ticks that the machine misses are a stall of both sites in each of these runs, and are judged as such. No cut lasts
/// longer than a second.
///
/// Errors: those of the experiment `faults` and of the servo thread.
Result<simulation::Outcome> run_faults_in_real_time(const simulation::Request& request, const ServoThreadParams& servo,
                                                    const simulation::Progress& progress);

}  // namespace tactus::runtime
