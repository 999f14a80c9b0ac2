// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/mpi/ranks/internal/computing_thread.hpp>
#include <tactus/mpi/ranks/internal/mailbox.hpp>
#include <tactus/mpi/ranks/session.hpp>
#include <tactus/simulation/tasks/engine.hpp>

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <mpi.h>

namespace tactus::ranks {

/// Counts for how long a rank has been silent, in the time that this rank itself has been running: a machine that
/// pauses all ranks makes none of them silent.
class Silence {
 public:
  void heard() { silent_s_ = 0.0; }
  /// Adds the time since the last call, half a second of it at most.
  void pass(double elapsed_s) { silent_s_ += elapsed_s < 0.5 ? elapsed_s : 0.5; }
  [[nodiscard]] double lasted_s() const { return silent_s_; }

 private:
  double silent_s_ = 0.0;
};

/// All ranks as an engine. Every call is from the thread that initialised MPI.
class Session::Ranks final : public tasks::Engine {
 public:
  explicit Ranks(MPI_Comm ranks);

  [[nodiscard]] std::size_t processes() const override { return static_cast<std::size_t>(size_); }
  [[nodiscard]] bool leads() const override { return rank_ == 0; }
  Check run(const tasks::Job& job, const tasks::TaskList& list, const tasks::Take& take,
            const tasks::Progress& progress) override;
  Check serve(const tasks::Job& job) override;
  void finish() override;

  /// In a rank that does not lead: reports why its command failed, and waits for the end of the job.
  void report_failure(const std::string& messages);
  /// The last exchange of messages, after which MPI can be finalised.
  void part();

 private:
  using Clock = std::chrono::steady_clock;
  class Hand;
  struct Rank {
    bool ready = false, gone = false;
    std::string name;
    std::size_t in_flight = 0;
    Silence silence;
  };

  [[nodiscard]] std::string name_of(int rank) const;
  /// Runs the list of a job with this hash; `own` runs the tasks of this rank.
  [[nodiscard]] Check hand_out(std::uint64_t job, ComputingThread& own, const tasks::TaskList& list,
                               const tasks::Take& take, const tasks::Progress& progress);
  [[nodiscard]] Check receive_ready(const Message& message, std::uint64_t job);
  void stay_in_touch();
  void wait_for_end();
  void follow(bool& ended);
  [[noreturn]] void give_up(int rank) const;
  [[noreturn]] void leave_at_once();

  int rank_ = 0, size_ = 1;
  Mailbox mailbox_;
  std::vector<Rank> others_;  ///< by rank; in a rank that does not lead only the leading one is of use
  bool ended_ = false;        ///< the end has been sent, or received
  bool led_ = false;          ///< a message of the leading rank has arrived
  Clock::time_point now_ = Clock::now(), last_sent_{};
};

}  // namespace tactus::ranks
