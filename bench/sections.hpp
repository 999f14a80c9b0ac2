// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bench/harness.hpp>

/// What is measured, a section each: `add_...` registers the cases that Google Benchmark times, the other function
/// turns their times into findings.
namespace tactus::bench {

/// One tick of the model of induced motion, beside Boost.odeint on the same model: speed and error.
void add_model_tick();
Findings model_tick(const Times& times);

/// One tick of cancellation that estimates the hand, beside one with a fixed hand, in alternating passes.
Findings grip_tick(bool quick);

/// How much longer the slowest ticks of the model take than the usual ones.
Findings tick_tail();

/// One tick of each force estimator.
void add_force_estimators();
Findings force_estimators(const Times& times);

/// A whole successive isolation, the runs on the rig taken as recorded.
Findings isolation();

/// One step of the servo thread in real time, with and without a log, in alternating windows.
Findings servo_step(bool quick);

/// The plants and the closed loop in virtual time.
void add_virtual_time();
Findings virtual_time(const Times& times);

/// One tick of both sites under supervision, of one axis and of 1 to 8 joints.
void add_joints();
Findings joints(const Times& times);

}  // namespace tactus::bench
