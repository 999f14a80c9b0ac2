#ifndef TACTUS_H
#define TACTUS_H

/* tactus from C, and from whatever calls C: cancellation in a loop of your own, the commands and their results, logs.
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
#define TACTUS_INTERFACE_MINOR 1

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
 * `control.cancellation_step` and `control.cancellation_friction` of an experiment file. Any thread; allocates.
 * Errors: those of the file and its values; TACTUS_BAD_ARGUMENT. `*made` is 0 after an error. */
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

#ifdef __cplusplus
}
#endif

#endif
