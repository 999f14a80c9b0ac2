// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <list>
#include <optional>
#include <string>
#include <vector>

#include <mpi.h>

namespace tactus::ranks {

/// What a message between two ranks is for.
enum class Kind {
  ready = 1,  ///< to the leading rank: hash of the job and name of the rank; it can run tasks
  task,       ///< to a rank: number and key
  value,      ///< to the leading rank: number, duration and value
  failed,     ///< to the leading rank: the error of a task, or of the command
  alive,      ///< in both directions: nothing else to send
  end,        ///< to a rank: the job has ended
  gone,       ///< to the leading rank: this rank sends nothing more
};

struct Message {
  int rank = 0;  ///< from which it comes
  Kind kind = Kind::alive;
  std::string bytes;
};

/// Messages to and from other ranks. No call waits for another rank, so a rank that has stopped blocks no other one.
/// For one thread.
class Mailbox {
 public:
  explicit Mailbox(MPI_Comm ranks) : ranks_(ranks) {}
  Mailbox(const Mailbox&) = delete;
  Mailbox& operator=(const Mailbox&) = delete;

  void send(int rank, Kind kind, std::string bytes = {});
  /// The next message that has arrived as a whole, if there is one.
  std::optional<Message> receive();
  /// Whether everything that was sent has left this rank.
  [[nodiscard]] bool sent();

 private:
  struct Transfer {
    Message message;
    MPI_Request request = MPI_REQUEST_NULL;
  };

  MPI_Comm ranks_;
  std::list<Transfer> leaving_, arriving_;  // their bytes must stay where they are
};

}  // namespace tactus::ranks
