// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/command.hpp>

int main(int argc, char** argv) { return tactus::cli::run_command(argc, argv); }
