// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/command.hpp>
#include <tactus/mpi/ranks/session.hpp>

#include <iostream>
#include <sstream>

/// The `tactus` command, alone or as a rank of MPI. Only the leading rank prints.
int main(int argc, char** argv) {
  const auto session = tactus::ranks::Session::start(argc, argv);
  if (!session) return tactus::cli::run_command(argc, argv);
  if (session->leads()) return session->end(tactus::cli::run_command(argc, argv, &session->engine()), {});
  std::ostringstream results, messages;
  std::streambuf* const standard_output = std::cout.rdbuf(results.rdbuf());
  std::streambuf* const standard_error = std::cerr.rdbuf(messages.rdbuf());
  const int status = tactus::cli::run_command(argc, argv, &session->engine());
  std::cout.rdbuf(standard_output);
  std::cerr.rdbuf(standard_error);
  return session->end(status, messages.str());
}
