// SPDX-License-Identifier: Apache-2.0
#pragma once

/// The interface of the kernel for a browser, or any other program that calls C: two teleoperators of one axis under
/// one hand, as on the live page, and whole runs of the experiment `tapping`. All of it is compiled from the sources of
/// the native build; this file only passes text and numbers.
///
/// One thread calls these functions. Text goes in and out by the buffer that `tactus_text` returns. A function that can
/// fail returns 0 for success, or -1 and leaves a sentence in that buffer.
#ifdef __wasm__
#define TACTUS_EXPORT(name) __attribute__((export_name(#name), visibility("default"))) name
#else
#define TACTUS_EXPORT(name) name
#endif

extern "C" {

/// The buffer, which holds 4096 bytes. Text ends with a zero.
char* TACTUS_EXPORT(tactus_text)();

/// Sets a key of an experiment of the kind `tapping` for one of the two sides (0 or 1): the buffer holds `key=value`,
/// as in `control.force_gain=10`. A loop that runs does not change before `tactus_apply`.
int TACTUS_EXPORT(tactus_set)(int side);

/// Makes the loop of a side with the keys as they are now set. A loop that runs continues where it is, with what has
/// changed, as on the live page. Its wall is 10 mm from the place where the hand rests.
int TACTUS_EXPORT(tactus_apply)(int side);

/// Both loops and the hand start again, at rest at `start_m` from the hand's place of rest.
int TACTUS_EXPORT(tactus_restart)(double start_m);

/// Where the hand is to go, in m from its place of rest, positive toward the wall.
void TACTUS_EXPORT(tactus_aim)(double position_m);

/// Starts the tap of the live page, which is the same every time. `tactus_restart(tactus_tap_start_m())` first gives it
/// the same start.
void TACTUS_EXPORT(tactus_tap)();
double TACTUS_EXPORT(tactus_tap_start_m)();

/// The length of one control cycle in s.
double TACTUS_EXPORT(tactus_cycle_s)();

/// The numbers in a row of `tactus_step`, and the most rows.
int TACTUS_EXPORT(tactus_row)();
int TACTUS_EXPORT(tactus_most_rows)();

/// Steps both loops by `cycles`, at most `tactus_most_rows()`. Returns a row a cycle: time in s, and where the hand
/// means to be in m; then for each side: leader, induced motion, command and follower's tip in m; displayed force,
/// contact force and largest contact force of the cycle in N; the verdict on the contact (0 free, 1 contact, 2 settled,
/// 3 rings), the settling time of that contact so far in s, and 1 if a safety gate has stopped the loop, else 0.
const double* TACTUS_EXPORT(tactus_step)(int cycles);

/// Draws the taps of an experiment with the keys of side 0. Returns their number, or -1.
int TACTUS_EXPORT(tactus_taps)();
/// Runs a tap and returns the number of its cycles. Afterwards `tactus_trace` has a row for each cycle with the sixteen
/// signals of a teleoperator's record, and `tactus_result` has contacts, settled (1 or 0), settling time in s, peak and
/// residual force in N.
int TACTUS_EXPORT(tactus_run_tap)(int tap);
const double* TACTUS_EXPORT(tactus_trace)();
const double* TACTUS_EXPORT(tactus_result)();
}
