// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/core/result.hpp>
#include <tactus/simulation/tasks/engine.hpp>

#include <memory>
#include <string>

/// Tasks over the ranks of an MPI program. Rank 0 leads: it hands the tasks out on demand, runs tasks itself, and is
/// the only one that reads and writes the file of finished tasks. Every rank computes in one thread; a second thread,
/// which sleeps most of the time, exchanges messages.
namespace tactus::ranks {

/// How long a rank may send no message before the job ends. A rank sends a message at least every half second, also
/// while it computes.
inline constexpr double silence_limit_s = 6.0;

/// MPI in this process, from `start` to `end`. One for each process.
class Session {
 public:
  /// Initialises MPI if a launcher (`mpirun`, `srun --mpi`) has started this process; else returns null.
  static std::unique_ptr<Session> start(int& argc, char**& argv);
  ~Session();

  [[nodiscard]] tasks::Engine& engine();
  [[nodiscard]] bool leads() const;

  /// Ends MPI. To be called once, when the command has ended in this rank. `messages` is what a rank that does not lead
  /// has to report of a command that failed before it could run tasks; the leading rank prints it, and the job fails.
  /// Returns the exit status of this rank.
  int end(int status, const std::string& messages);

 private:
  Session();
  class Ranks;
  std::unique_ptr<Ranks> ranks_;
};

}  // namespace tactus::ranks
