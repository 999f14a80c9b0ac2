// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/core/units.hpp>

double sample_rate_Hz(tactus::Seconds sample_time) { return 1.0 / sample_time.value; }

double explicit_duration() { return sample_rate_Hz(tactus::Seconds(0.0005)); }

#ifdef TACTUS_WRONG_USE
double rate_taken_for_a_duration() { return sample_rate_Hz(2000.0); }
#endif
