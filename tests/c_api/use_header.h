// SPDX-License-Identifier: Apache-2.0
#ifndef TACTUS_USE_HEADER_H
#define TACTUS_USE_HEADER_H

#include <tactus.h>

/* A loop of a few cycles and a command, as a program of C and of C++11 writes them. Returns the number of the first check
 * that fails, or 0. */
static int use_tactus(void) {
  tactus_cancellation_options options = TACTUS_CANCELLATION_OPTIONS_INIT;
  tactus_error_view view = TACTUS_ERROR_VIEW_INIT;
  tactus_outcome_view printed = TACTUS_OUTCOME_VIEW_INIT;
  tactus_command_options watched = TACTUS_COMMAND_OPTIONS_INIT;
  tactus_log_view log_view = TACTUS_LOG_VIEW_INIT;
  tactus_table_view table_view = TACTUS_TABLE_VIEW_INIT;
  tactus_column_view column_view = TACTUS_COLUMN_VIEW_INIT;
  tactus_joint_driver driver = TACTUS_JOINT_DRIVER_INIT;
  tactus_teleoperator_options pair_options = TACTUS_TELEOPERATOR_OPTIONS_INIT;
  tactus_teleoperator_view pair_view = TACTUS_TELEOPERATOR_VIEW_INIT;
  tactus_teleoperator_report report = TACTUS_TELEOPERATOR_REPORT_INIT;
  tactus_teleoperator pair = 0;
  const char* const words[] = {"schema", "tapping"};
  tactus_cancellation cancellation = 0;
  tactus_outcome outcome = 0;
  tactus_error error = 0;
  double intended_m = 0.0;

  if (tactus_check_interface(TACTUS_INTERFACE_MAJOR, TACTUS_INTERFACE_MINOR, &error) != TACTUS_OK) return 1;
  if (tactus_cancellation_make(&options, &cancellation, &error) != TACTUS_OUT_OF_BOUNDS) return 2;
  if (tactus_error_read(error, &view) != TACTUS_OK || view.remedy[0] == '\0') return 3;
  if (tactus_error_release(error) != TACTUS_OK) return 4;
  options.sample_time_s = 200e-6;
  if (tactus_cancellation_make(&options, &cancellation, &error) != TACTUS_OK || error != 0) return 5;
  if (tactus_cancellation_step(cancellation, 0.01, -0.5, &intended_m) != TACTUS_OK) return 6;
  if (!(intended_m >= 0.01 && intended_m <= 0.01)) return 7; /* at rest all motion is intended */
  if (tactus_cancellation_release(cancellation) != TACTUS_OK) return 8;
  if (tactus_command(words, 2, &watched, &outcome, &error) != TACTUS_OK) return 9;
  if (tactus_outcome_read(outcome, &printed) != TACTUS_OK || printed.results[0] != '{') return 10;
  if (tactus_outcome_release(outcome) != TACTUS_OK) return 11;
  if (tactus_log_read(0, &log_view) != TACTUS_BAD_HANDLE) return 12;
  if (tactus_log_table(0, 0, &table_view) != TACTUS_BAD_HANDLE) return 13;
  if (tactus_log_column(0, 0, 0, &column_view) != TACTUS_BAD_HANDLE) return 14;
  if (tactus_joint_driver_register(&driver, 0) != TACTUS_BAD_ARGUMENT) return 15;
  if (tactus_teleoperator_start(&pair_options, &pair, 0) != TACTUS_BAD_ARGUMENT || pair != 0) return 16;
  if (tactus_teleoperator_read(pair, &pair_view) != TACTUS_BAD_HANDLE) return 17;
  if (tactus_teleoperator_report_read(pair, &report) != TACTUS_BAD_HANDLE) return 18;
  return 0;
}

#endif
