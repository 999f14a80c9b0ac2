// SPDX-License-Identifier: Apache-2.0
#include "tests/cli/command.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <sstream>

#include "tests/scratch_path.hpp"
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

namespace tactus::cli {

namespace {

namespace fs = std::filesystem;

std::string read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Makes `descriptor` write to `file`. In the child: a failure ends it.
void redirect(int descriptor, const char* file) {
  const int opened = open(file, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (opened < 0 || dup2(opened, descriptor) < 0) _exit(126);
  close(opened);
}

}  // namespace

void Command::SetUp() {
  folder_ = scratch_path();
  streams_ = folder_;
  streams_ += "_streams";
  for (const fs::path& folder : {folder_, streams_}) {
    fs::remove_all(folder);
    fs::create_directories(folder);
  }
}

void Command::TearDown() {
  fs::remove_all(folder_);
  fs::remove_all(streams_);
}

Outcome Command::tactus(const std::vector<std::string>& arguments, StandardOutput output) const {
  std::vector<std::string> words{TACTUS_COMMAND};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const std::string out = (streams_ / "out").string(), err = (streams_ / "err").string();
  fs::remove(out);

  const pid_t child = fork();
  if (child == 0) {
    if (chdir(folder_.c_str()) != 0) _exit(126);
    redirect(STDERR_FILENO, err.c_str());
    switch (output) {
      case StandardOutput::kept:
        redirect(STDOUT_FILENO, out.c_str());
        break;
      case StandardOutput::full:
        redirect(STDOUT_FILENO, "/dev/full");
        break;
      case StandardOutput::closed:
        close(STDOUT_FILENO);
        break;
      case StandardOutput::reader_gone: {
        std::array<int, 2> ends{};
        if (pipe(ends.data()) != 0 || dup2(ends[1], STDOUT_FILENO) < 0) _exit(126);
        close(ends[0]);
        close(ends[1]);
        break;
      }
    }
    execv(argv[0], argv.data());
    _exit(127);
  }
  EXPECT_GT(child, 0) << "fork failed";
  int status = 0;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  return {
      .status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), .out = read(out), .err = read(err)};
}

std::string Command::write(std::string_view name, std::string_view content) const {
  std::ofstream(folder_ / name, std::ios::binary) << content;
  return std::string(name);
}

void Command::make_folder(const fs::path& name) const { fs::create_directories(folder_ / name); }

std::string Command::content(const fs::path& name) const { return read(folder_ / name); }

std::vector<std::string> Command::files() const {
  std::vector<std::string> found;
  for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
    found.push_back(entry.path().lexically_relative(folder_).string());
  }
  std::sort(found.begin(), found.end());
  return found;
}

std::string Command::quick_experiment() const {
  return write("quick.toml",
               "[task]\n"
               "kind = \"tapping\"\n"
               "supervised = false\n"
               "taps = 1\n"
               "observation_s = 0.15\n"
               "\n"
               "[control]\n"
               "force_gain = 2.0\n");
}

}  // namespace tactus::cli
