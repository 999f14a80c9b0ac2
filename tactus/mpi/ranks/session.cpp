// SPDX-License-Identifier: Apache-2.0
#include <tactus/mpi/ranks/internal/ranks.hpp>
#include <tactus/mpi/ranks/session.hpp>

#include <csignal>
#include <cstdlib>
#include <string_view>

#include <mpi.h>
#include <unistd.h>

namespace tactus::ranks {

namespace {

/// Whether the environment is that of a rank: of Open MPI's mpirun, or of a launcher with PMIx or PMI, as Slurm's.
bool is_started_by_launcher() {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMIX_RANK", "PMI_RANK"}) {
    if (std::getenv(name) != nullptr) return true;
  }
  return false;
}

/// The launcher ends all ranks if one dies, so the leading one states what to do then.
void state_how_to_continue(int signal) {
  constexpr std::string_view text =
      "tactus: the launcher ends this job, as it does if a rank dies. The same command continues from the tasks that "
      "were finished, if it has --out\n";
  if (::write(STDERR_FILENO, text.data(), text.size()) < 0) _exit(1);
  _exit(128 + signal);
}

}  // namespace

Session::Session() = default;
Session::~Session() = default;

std::unique_ptr<Session> Session::start(int& argc, char**& argv) {
  if (!is_started_by_launcher()) return nullptr;
  int provided = 0;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_FUNNELED, &provided);
  std::unique_ptr<Session> session(new Session);
  session->ranks_ = std::make_unique<Ranks>(MPI_COMM_WORLD);
  if (session->leads() && session->ranks_->processes() > 1) std::signal(SIGTERM, state_how_to_continue);
  return session;
}

tasks::Engine& Session::engine() { return *ranks_; }

bool Session::leads() const { return ranks_->leads(); }

int Session::end(int status, const std::string& messages) {
  if (!leads() && status != 0) ranks_->report_failure(messages);
  ranks_->part();
  MPI_Finalize();
  return status;
}

}  // namespace tactus::ranks
