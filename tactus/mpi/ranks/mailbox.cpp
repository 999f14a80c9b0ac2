// SPDX-License-Identifier: Apache-2.0
#include <tactus/mpi/ranks/internal/mailbox.hpp>

#include <utility>

namespace tactus::ranks {

namespace {

bool is_complete(MPI_Request& request) {
  int done = 0;
  MPI_Test(&request, &done, MPI_STATUS_IGNORE);
  return done != 0;
}

}  // namespace

void Mailbox::send(int rank, Kind kind, std::string bytes) {
  Transfer& transfer = leaving_.emplace_back(Transfer{.message = {rank, kind, std::move(bytes)}});
  MPI_Isend(transfer.message.bytes.data(), static_cast<int>(transfer.message.bytes.size()), MPI_BYTE, rank,
            static_cast<int>(kind), ranks_, &transfer.request);
}

std::optional<Message> Mailbox::receive() {
  std::erase_if(leaving_, [](Transfer& transfer) { return is_complete(transfer.request); });
  for (;;) {
    int there = 0;
    MPI_Message handle = MPI_MESSAGE_NULL;
    MPI_Status status{};
    MPI_Improbe(MPI_ANY_SOURCE, MPI_ANY_TAG, ranks_, &there, &handle, &status);
    if (there == 0) break;
    int size = 0;
    MPI_Get_count(&status, MPI_BYTE, &size);
    Transfer& transfer =
        arriving_.emplace_back(Transfer{.message = {status.MPI_SOURCE, static_cast<Kind>(status.MPI_TAG),
                                                    std::string(static_cast<std::size_t>(size), '\0')}});
    MPI_Imrecv(transfer.message.bytes.data(), size, MPI_BYTE, &handle, &transfer.request);
  }
  for (auto transfer = arriving_.begin(); transfer != arriving_.end(); ++transfer) {
    if (!is_complete(transfer->request)) continue;
    Message message = std::move(transfer->message);
    arriving_.erase(transfer);
    return message;
  }
  return std::nullopt;
}

bool Mailbox::sent() {
  std::erase_if(leaving_, [](Transfer& transfer) { return is_complete(transfer.request); });
  return leaving_.empty();
}

}  // namespace tactus::ranks
