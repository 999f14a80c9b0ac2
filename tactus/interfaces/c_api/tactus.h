// SPDX-License-Identifier: Apache-2.0
#ifndef TACTUS_H
#define TACTUS_H

/* tactus from C, and from whatever calls C: cancellation in a loop of your own, the commands and their results, logs, a
 * running teleoperator, devices of your own.
 *
 * Handles are numbers that the library gives out; 0 is never one. A handle that was released, or that belongs to another
 * kind of object, is an error (TACTUS_BAD_HANDLE) and not a crash. Release every handle that you get, once.
 *
 * Every function that can fail returns a `tactus_status`. Those with an `error` parameter also leave there why: a handle
 * whose message is the one that the `tactus` command prints, or 0 if all is well. `error` may be NULL.
 *
 * A struct that you pass begins with its size, which the macros TACTUS_..._INIT set. A library that is newer than the
 * header fills only what the header knows. One that is older refuses the struct (TACTUS_BAD_ARGUMENT).
 *
 * Threads: different handles may be used in different threads at the same time, the same handle in one thread at a time.
 * What a function needs beyond that stands at it. No exception leaves the library.
 *
 * Text is UTF-8 and ends with a zero byte. What a view points at belongs to its handle and is valid until that is released.
 */

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define TACTUS_API __attribute__((visibility("default")))

/* The interface that this header describes. A function that is added raises the second number, anything that changes the
 * first. */
#define TACTUS_INTERFACE_MAJOR 0
#define TACTUS_INTERFACE_MINOR 2

typedef int32_t tactus_status;
enum {
  TACTUS_OK = 0,
  TACTUS_OUT_OF_BOUNDS = 1, /* a value outside its bounds, or not finite */
  TACTUS_WRONG_TYPE = 2,    /* a value of another type than the key has */
  TACTUS_UNKNOWN_KEY = 3,   /* a key that does not exist */
  TACTUS_MISSING = 4,       /* a key, file, variable or column that is needed and not there */
  TACTUS_SYNTAX = 5,        /* text that cannot be parsed */
  TACTUS_INCONSISTENT = 6,  /* values that are each fine but contradict one another */
  TACTUS_UNWRITABLE = 7,    /* a place that results cannot be written to */
  TACTUS_FAILED = 8,        /* the job itself failed */
  TACTUS_INTERRUPTED = 9,   /* `progress` ended the command */
  TACTUS_BAD_HANDLE = 10,   /* a handle that was released, never given out, or is of another kind */
  TACTUS_BAD_ARGUMENT = 11  /* NULL where a pointer is needed, or a struct of an unknown size */
};

typedef uint64_t tactus_error;
typedef uint64_t tactus_cancellation;
typedef uint64_t tactus_outcome;
typedef uint64_t tactus_log;
typedef uint64_t tactus_teleoperator;

/* ---- Version ---------------------------------------------------------------------------------------------------- */

/* The version of the library, as "0.1.0". Any thread. */
TACTUS_API const char* tactus_version(void);

/* Checks that the library has the interface of a header: pass TACTUS_INTERFACE_MAJOR and TACTUS_INTERFACE_MINOR. Any thread.
 * Errors: TACTUS_INCONSISTENT. */
TACTUS_API tactus_status tactus_check_interface(int32_t major, int32_t minor, tactus_error* error);

/* ---- Errors ------------------------------------------------------------------------------------------------------ */

/* Texts that do not apply are empty, never NULL. */
typedef struct tactus_error_view {
  size_t struct_size;
  tactus_status status;
  int32_t exit_status;   /* of the command: 1 the job failed, 2 the request was wrong */
  const char* line;      /* "place: parameter: message", which the command prints after its name */
  const char* place;     /* where the value was written: "model.toml:3:11", "--set control.force_gain=-1" */
  const char* parameter; /* the key: "control.model.motor.mass_kg" */
  const char* message;   /* one sentence */
  const char* value;     /* the value that was refused, with its unit: "-0.0075 kg" */
  const char* bounds;    /* what it may be: "must be finite and greater than 0 kg" */
  const char* remedy;    /* what to do about it: the end of the message */
} tactus_error_view;
#define TACTUS_ERROR_VIEW_INIT { sizeof(tactus_error_view), 0, 0, 0, 0, 0, 0, 0, 0, 0 }

/* Any thread. Errors: TACTUS_BAD_HANDLE, TACTUS_BAD_ARGUMENT. */
TACTUS_API tactus_status tactus_error_read(tactus_error error, tactus_error_view* view);
/* Any thread. 0 is released without an error. Errors: TACTUS_BAD_HANDLE. */
TACTUS_API tactus_status tactus_error_release(tactus_error error);

/* ---- Cancellation of induced leader motion, for a loop of your own ----------------------------------------------- */

/* One axis: where the operator meant the motor to be, from where it is and which force was displayed. Positions in m,
 * forces in N, both positive toward the environment, so a force that pushes the hand back is negative. */
typedef struct tactus_cancellation_options {
  size_t struct_size;
  double sample_time_s;   /* of your control loop, greater than 0 */
  const char* file;       /* TOML file of the model of your device, as `tactus identify quick` writes it; NULL: the
                             leader of the published paper */
  const char* const* set; /* overrides, each "control.model.motor.mass_kg=0.02"; NULL if set_count is 0 */
  size_t set_count;
} tactus_cancellation_options;
#define TACTUS_CANCELLATION_OPTIONS_INIT { sizeof(tactus_cancellation_options), 0.0, 0, 0, 0 }

/* Reads and checks the model, and starts at rest. The file may have the keys `control.model`, `control.cancellation_model`,
 * `control.cancellation_step` and `control.cancellation_friction` of an experiment file. With its overrides it must have every
 * key of the tables `control.model.motor`, `cable`, `drum`, `linkage`, `handle` and `hand`. Any thread; allocates.
 * Errors: those of the file and its values; TACTUS_MISSING for a key that it lacks; TACTUS_BAD_ARGUMENT. `*made` is 0 after an error. */
TACTUS_API tactus_status tactus_cancellation_make(const tactus_cancellation_options* options, tactus_cancellation* made,
                                                  tactus_error* error);
/* One control cycle: the position that the operator meant, from the one measured now; then the model advances under
 * the force that acts on the motor from now to the next cycle. The same as `intended` followed by `advance`.
 * Real-time safe. Errors: TACTUS_BAD_HANDLE, TACTUS_BAD_ARGUMENT; TACTUS_OUT_OF_BOUNDS for a number that is not finite,
 * after which everything is as before the call, as in the functions below. */
TACTUS_API tactus_status tactus_cancellation_step(tactus_cancellation cancellation, double measured_position_m,
                                                  double motor_force_N, double* intended_position_m);
/* The position that the operator meant, for a loop that computes its force from it. Once per cycle, before `advance`.
 * Real-time safe. Errors: TACTUS_BAD_HANDLE, TACTUS_BAD_ARGUMENT, TACTUS_OUT_OF_BOUNDS. */
TACTUS_API tactus_status tactus_cancellation_intended(tactus_cancellation cancellation, double measured_position_m,
                                                      double* intended_position_m);
/* Advances the model by one cycle, under the force that is really displayed. Real-time safe. Errors: TACTUS_BAD_HANDLE,
 * TACTUS_OUT_OF_BOUNDS. */
TACTUS_API tactus_status tactus_cancellation_advance(tactus_cancellation cancellation, double motor_force_N);
/* `count` cycles in one call, equal bit for bit to as many calls of `tactus_cancellation_step`. The result may be written
 * over an input. Errors: TACTUS_BAD_HANDLE, TACTUS_BAD_ARGUMENT, TACTUS_OUT_OF_BOUNDS. */
TACTUS_API tactus_status tactus_cancellation_step_array(tactus_cancellation cancellation, size_t count,
                                                        const double* measured_position_m, const double* motor_force_N,
                                                        double* intended_position_m);
/* How far the displayed force has moved the motor by the model, in m. Real-time safe. Errors: TACTUS_BAD_HANDLE,
 * TACTUS_BAD_ARGUMENT. */
TACTUS_API tactus_status tactus_cancellation_induced(tactus_cancellation cancellation, double* induced_position_m);
/* Back to rest. Real-time safe. Errors: TACTUS_BAD_HANDLE. */
TACTUS_API tactus_status tactus_cancellation_reset(tactus_cancellation cancellation);
/* A second one in the same state, which goes its own way from here. Allocates. Errors: TACTUS_BAD_HANDLE,
 * TACTUS_BAD_ARGUMENT. */
TACTUS_API tactus_status tactus_cancellation_copy(tactus_cancellation cancellation, tactus_cancellation* copy,
                                                  tactus_error* error);
/* 0 is released without an error. Frees memory. Errors: TACTUS_BAD_HANDLE. */
TACTUS_API tactus_status tactus_cancellation_release(tactus_cancellation cancellation);

/* ---- Commands ---------------------------------------------------------------------------------------------------- */

typedef struct tactus_command_options {
  size_t struct_size;
  /* Called in the thread of the command with the share of the work that is done, 0 to 1, at most fifty times a second;
   * commands that take no time never call it. Anything but 0 ends the command before its next piece of work. It must
   * neither run another command nor open a log. NULL: the command runs to its end. */
  int32_t (*progress)(double done, void* user);
  void* user; /* passed on to `progress` */
} tactus_command_options;
#define TACTUS_COMMAND_OPTIONS_INIT { sizeof(tactus_command_options), 0, 0 }

typedef struct tactus_outcome_view {
  size_t struct_size;
  int32_t exit_status; /* of the command; 1 for `replay --check` if the log does not repeat */
  const char* results; /* what the command prints to standard output: JSON with `--json`, else text */
  size_t results_size; /* in bytes, without the zero at the end */
  const char* messages; /* what it prints to standard error, notes for instance */
  size_t messages_size;
} tactus_outcome_view;
#define TACTUS_OUTCOME_VIEW_INIT { sizeof(tactus_outcome_view), 0, 0, 0, 0, 0 }

/* Runs one command of tactus in this thread, as `tactus WORDS...` does, and keeps what it prints. `words` are for instance
 * {"run", "tapping.toml", "--json"}; `options` may be NULL. Files that the options name are read and written.
 *
 * These are refused (TACTUS_INCONSISTENT), because they need a process of their own: `device`, `doctor`, `emulate`,
 * `plant`, `relay`, `serve`, `--plugin`, and every run at the real clock.
 *
 * Any thread; commands of several threads run one after the other. Errors: those of the command, with its message;
 * TACTUS_INTERRUPTED, TACTUS_BAD_ARGUMENT. `*outcome` is 0 after an error. */
TACTUS_API tactus_status tactus_command(const char* const* words, size_t count, const tactus_command_options* options,
                                        tactus_outcome* outcome, tactus_error* error);
/* Errors: TACTUS_BAD_HANDLE, TACTUS_BAD_ARGUMENT. */
TACTUS_API tactus_status tactus_outcome_read(tactus_outcome outcome, tactus_outcome_view* view);
/* 0 is released without an error. Errors: TACTUS_BAD_HANDLE. */
TACTUS_API tactus_status tactus_outcome_release(tactus_outcome outcome);

/* ---- Logs and recordings ------------------------------------------------------------------------------------------ */

typedef struct tactus_log_view {
  size_t struct_size;
  size_t tables;
  int32_t complete;          /* 1; 0: the writer of the log was stopped, or bytes are missing at its end */
  int32_t damaged_elsewhere; /* 1: a checksum or a record outside of the chunks is wrong */
  uint64_t damaged_chunks;   /* that were left out */
} tactus_log_view;
#define TACTUS_LOG_VIEW_INIT { sizeof(tactus_log_view), 0, 0, 0, 0 }

typedef struct tactus_table_view {
  size_t struct_size;
  const char* name;         /* of a log the topic; of a MATLAB file the variable; of a text table the file */
  size_t rows;
  size_t columns;
  uint64_t missing;         /* messages of a log that its sequence numbers show to be missing */
  const uint64_t* times_ns; /* of each row of a log, in ns; NULL in a recording, whose times are a column */
} tactus_table_view;
#define TACTUS_TABLE_VIEW_INIT { sizeof(tactus_table_view), 0, 0, 0, 0, 0 }

typedef struct tactus_column_view {
  size_t struct_size;
  const char* name; /* with the suffix of its unit in a log: "displayed_force_N" */
  const char* unit; /* "N", or empty */
  const char* doc;  /* its meaning, or empty */
  const double* values;
  size_t rows;
} tactus_column_view;
#define TACTUS_COLUMN_VIEW_INIT { sizeof(tactus_column_view), 0, 0, 0, 0, 0 }

/* Reads a log of tactus (`.mcap`, or the folder that holds it) or a recording (`.csv`, `.tsv`, `.txt`, `.mat`) into memory.
 * `topic` selects one topic of a log; NULL: all of them. A column of a recording that is not numbers is left out.
 * Any thread; waits while a command runs. Errors: those of the file. `*made` is 0 after an error. */
TACTUS_API tactus_status tactus_log_open(const char* path, const char* topic, tactus_log* made, tactus_error* error);
/* Errors: TACTUS_BAD_HANDLE, TACTUS_BAD_ARGUMENT. */
TACTUS_API tactus_status tactus_log_read(tactus_log log, tactus_log_view* view);
/* Tables and columns count from 0. Errors: TACTUS_BAD_HANDLE, TACTUS_BAD_ARGUMENT, TACTUS_OUT_OF_BOUNDS. */
TACTUS_API tactus_status tactus_log_table(tactus_log log, size_t table, tactus_table_view* view);
TACTUS_API tactus_status tactus_log_column(tactus_log log, size_t table, size_t column, tactus_column_view* view);
/* 0 is released without an error. Errors: TACTUS_BAD_HANDLE. */
TACTUS_API tactus_status tactus_log_release(tactus_log log);

/* ---- A device of your own ----------------------------------------------------------------------------------------- */

/* Command to one motor for one cycle. Units are rad, rad/s and N m at the output of the motor's gear, in the motor's own
 * sense of rotation. */
typedef struct tactus_motor_command {
  double torque_Nm;
  double law_position_rad; /* a law that the drive runs in addition: stiffness (position - its own) + damping (velocity - its own) */
  double law_velocity_rad_per_s;
  double law_stiffness_Nm_per_rad; /* 0 unless the driver states a largest one, as damping */
  double law_damping_Nms_per_rad;
  int32_t enabled; /* 0: the motor must have no torque */
  int32_t reserved;
} tactus_motor_command;

/* What one motor reports. Each is as the driver left it a cycle before, at first 0. */
typedef struct tactus_motor_reading {
  double position_rad;
  double velocity_rad_per_s;
  double torque_Nm;
  double temperature_C; /* NaN: not reported */
  int32_t enabled;      /* 1: the drive has power */
  int32_t reserved;
} tactus_motor_reading;

/* A driver of an arm or handle that is reached by calls that block. Each side of a rig whose file states `bus = "NAME"` gets
 * a device of its own: `make`, `open`, then `exchange` again and again, `close`, `release`. A rig is opened twice: once to
 * ask its motors, then to drive them.
 *
 * Threads: `make` and `release` are called in a thread that starts or ends a teleoperator; `open`, `exchange` and `close` in
 * a thread of the device's own, one after another. They may block and allocate. A reading is stamped when `exchange`
 * returns; while it blocks, readings age, and after `watchdog_s` of the rig file both sites hold with zero force.
 *
 * A function that returns anything but 0 failed: it writes why, with the remedy, as text with a zero at its end into `why`.
 * That ends the device: `close` is called, and both sites hold with the reason.
 *
 * **The device must remove its torque by itself when `exchange` is no longer called**: the program may be killed at any
 * time. */
typedef struct tactus_joint_driver {
  size_t struct_size;
  const char* name;    /* the word after `bus =` */
  const char* summary; /* one line */
  double cycle_s;      /* shortest time from one `exchange` to the next, 0.00001 to 1 */
  double torque_limit_Nm;          /* largest of each motor; 0: not known */
  double velocity_limit_rad_per_s; /* largest that the readings can represent; 0: not known */
  double velocity_step_rad_per_s;  /* step of a velocity that is measured, not derived from positions; 0: there is none */
  double stiffness_limit_Nm_per_rad; /* of the law that the drive runs; both 0: it runs none */
  double damping_limit_Nms_per_rad;
  void* user; /* passed on to `make` */
  /* `motors` has the key `motor` of each of the `count` joints of the rig file; `port` is as written there, or empty.
   * Nothing is opened. `*device` is passed on to the others. */
  int32_t (*make)(void* user, const char* port, const int64_t* motors, size_t count, void** device, char* why,
                  size_t why_size);
  int32_t (*open)(void* device, char* why, size_t why_size);
  int32_t (*exchange)(void* device, const tactus_motor_command* commands, tactus_motor_reading* readings, size_t motors,
                      char* why, size_t why_size);
  void (*close)(void* device);   /* removes all torque; called once after `open`, whether or not that succeeded */
  void (*release)(void* device); /* frees it */
} tactus_joint_driver;
#define TACTUS_JOINT_DRIVER_INIT { sizeof(tactus_joint_driver), 0, 0, 0.001, 0.0, 0.0, 0.0, 0.0, 0.0, 0, 0, 0, 0, 0, 0 }

/* Adds a driver, or replaces the one of the same name; the struct is copied, the functions must stay. Any thread; waits
 * while a command runs. Errors: TACTUS_OUT_OF_BOUNDS; TACTUS_INCONSISTENT for the name of a built-in bus;
 * TACTUS_BAD_ARGUMENT. */
TACTUS_API tactus_status tactus_joint_driver_register(const tactus_joint_driver* driver, tactus_error* error);

/* ---- A running teleoperator ---------------------------------------------------------------------------------------- */

/* Leader and follower of a rig file, supervised as by `tactus run EXPERIMENT --realtime --device RIG`: your program has the
 * screen and the operator's buttons, tactus has the servo thread.
 *
 * Threads: all functions but `release` may be called from any thread, also for the same handle at the same time; they wait
 * for one another and never hold up the servo thread. `tactus_teleoperator_read` alone is one thread at a time for a
 * handle, since it leaves text there. None is real-time safe. */
typedef struct tactus_teleoperator_options {
  size_t struct_size;
  const char* experiment; /* TOML file of the kind tapping (joint by joint) or arm-tapping (two arms) */
  const char* rig;        /* FILE.toml, or FILE.toml:PAIR */
  const char* const* set; /* overrides of the experiment; NULL if set_count is 0 */
  size_t set_count;
  const char* log_folder; /* in which every control cycle goes into log.mcap; NULL: no log */
  int32_t rehearsal;      /* 1: emulated motors in place of those of the rig file, as by `tactus rehearse`, and relaxed timeouts */
  int32_t priority;       /* of the servo thread under SCHED_FIFO, 1 to 99 */
  double hand_reach_rad;  /* of a rehearsal of two arms: a hand moves each joint of the leader so far; 0: it holds it still */
  double hand_after_s;    /* since the arms are carried by their motors */
} tactus_teleoperator_options;
#define TACTUS_TELEOPERATOR_OPTIONS_INIT { sizeof(tactus_teleoperator_options), 0, 0, 0, 0, 0, 0, 80, 0.0, 4.0 }

typedef int32_t tactus_site_state;
enum {
  TACTUS_SITE_CONFIGURE = 0, /* no power yet */
  TACTUS_SITE_ALIGN = 1,     /* checks its motors, without being coupled */
  TACTUS_SITE_ARMED = 2,     /* ready, the dead-man switch is released */
  TACTUS_SITE_ACTIVE = 3,    /* coupled */
  TACTUS_SITE_HOLD = 4,      /* zero force, until it is armed again */
  TACTUS_SITE_FAULT = 5      /* zero force, until `clear` */
};

typedef struct tactus_teleoperator_view {
  size_t struct_size;
  int32_t running; /* 1 while the servo thread runs */
  tactus_site_state leader_state;
  tactus_site_state follower_state;
  int32_t reserved;
  const char* leader_cause; /* why a site holds or has a fault, as "dead-man", "device"; constant text */
  const char* follower_cause;
  const char* line; /* one sentence for a person: states, what is wrong, what to do; of the last whole second */
  size_t joints;    /* of each side, at most 8 */
  int64_t cycle;    /* number of the newest control cycle, missed ones counted */
  int64_t time_ns;  /* its deadline on CLOCK_MONOTONIC; 0: there was none yet */
} tactus_teleoperator_view;
#define TACTUS_TELEOPERATOR_VIEW_INIT { sizeof(tactus_teleoperator_view), 0, 0, 0, 0, 0, 0, 0, 0, 0, 0 }

/* One joint of a side in one control cycle. rad, rad/s and N m for a joint that turns; m, m/s and N for one that slides. */
typedef struct tactus_joint_sample {
  double position;
  double velocity;        /* as the drive reports it */
  double torque;          /* as the drive reports it, of its motor */
  double command;         /* torque commanded to the motor */
  double external_torque; /* of the environment on the follower's joint, in its positive sense, as its controller estimates
                             it; at the leader the one received. 0 for an architecture that sends none */
} tactus_joint_sample;

/* How a teleoperator went, once it was stopped. */
typedef struct tactus_teleoperator_report {
  size_t struct_size;
  double duration_s;
  int64_t cycles;
  int64_t active_cycles;
  int64_t armings; /* times that the leader came to be armed, also by releasing the dead-man switch */
  int64_t holds;
  int64_t missed;       /* deadlines that no cycle answered */
  int64_t late;         /* cycles that ended after the next deadline */
  int64_t late_own;     /* of them, those that tactus caused, not the machine */
  double latest_start_s; /* longest time from a deadline to the start of its cycle */
  uint64_t log_dropped; /* records that came faster than they were written */
} tactus_teleoperator_report;
#define TACTUS_TELEOPERATOR_REPORT_INIT { sizeof(tactus_teleoperator_report), 0.0, 0, 0, 0, 0, 0, 0, 0, 0.0, 0 }

/* Reads the files, asks all motors and starts the servo thread; no motor has power until `arm`. Blocks for some seconds.
 * Errors: those of the files, with their line; TACTUS_FAILED with all that is wrong with the motors; TACTUS_INCONSISTENT
 * for motors that need the guard process of the command; TACTUS_BAD_ARGUMENT. `*made` is 0 after an error. */
TACTUS_API tactus_status tactus_teleoperator_start(const tactus_teleoperator_options* options, tactus_teleoperator* made,
                                                   tactus_error* error);
/* What the operator does: "arm", "press" and "release" (the dead-man switch), "clutch", "unclutch", "stop" (emergency stop),
 * "clear" (leave a fault); the marks of an episode in the log, "start", "keep" and "discard"; "tare" (of two arms), and
 * "set force_gain 2". Errors: TACTUS_SYNTAX for another word; TACTUS_OUT_OF_BOUNDS for a gain beyond what the experiment
 * allows; TACTUS_INCONSISTENT if its sites cannot do that; TACTUS_FAILED if it has ended, or too many words wait;
 * TACTUS_BAD_HANDLE, TACTUS_BAD_ARGUMENT. */
TACTUS_API tactus_status tactus_teleoperator_press(tactus_teleoperator teleoperator, const char* word,
                                                   tactus_error* error);
/* The text of the view is valid until the next call for this handle. Errors: TACTUS_BAD_HANDLE, TACTUS_BAD_ARGUMENT. */
TACTUS_API tactus_status tactus_teleoperator_read(tactus_teleoperator teleoperator, tactus_teleoperator_view* view);
/* Name of a joint, which is valid until the handle is released; `*turns` is 0 for one that slides. Errors:
 * TACTUS_BAD_HANDLE, TACTUS_BAD_ARGUMENT, TACTUS_OUT_OF_BOUNDS. */
TACTUS_API tactus_status tactus_teleoperator_joint(tactus_teleoperator teleoperator, size_t joint, const char** name,
                                                   int32_t* turns);
/* Both sides in one and the same control cycle, the newest: `joints` elements each, as the view has them. `*time_ns` is its
 * deadline on CLOCK_MONOTONIC, 0 before the first one, when all numbers are 0. Errors: TACTUS_BAD_HANDLE,
 * TACTUS_BAD_ARGUMENT, TACTUS_OUT_OF_BOUNDS for another number of joints. */
TACTUS_API tactus_status tactus_teleoperator_newest(tactus_teleoperator teleoperator, size_t joints,
                                                    tactus_joint_sample* leader, tactus_joint_sample* follower,
                                                    int64_t* time_ns);
/* Forces fall to zero, the motors lose their power, the log is closed. Blocks for a second, for five at most. Stopping
 * twice is no error. Errors: TACTUS_FAILED for a motor that did not report that it is off; TACTUS_UNWRITABLE of the log;
 * TACTUS_BAD_HANDLE. */
TACTUS_API tactus_status tactus_teleoperator_stop(tactus_teleoperator teleoperator, tactus_error* error);
/* After `stop`. Errors: TACTUS_INCONSISTENT if it was not stopped; TACTUS_BAD_HANDLE, TACTUS_BAD_ARGUMENT. */
TACTUS_API tactus_status tactus_teleoperator_report_read(tactus_teleoperator teleoperator,
                                                         tactus_teleoperator_report* report);
/* Stops it, if that was not done, and frees it; no other call for this handle may be under way. 0 is released without an
 * error. Errors: TACTUS_BAD_HANDLE. */
TACTUS_API tactus_status tactus_teleoperator_release(tactus_teleoperator teleoperator);

#ifdef __cplusplus
}
#endif

#endif
