// again_after_stall PROGRAM [ARGUMENT...]: runs a test that keeps time. Where it fails and the machine stood still
// meanwhile, as a shared one does now and then, it is run again, up to three times in all. A test that fails on a
// machine that kept time has failed. Whether it kept time is not the test's word: this process sleeps for 10 ms at a
// time and looks how long that took.

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <thread>

#include <sys/wait.h>
#include <unistd.h>

namespace {

using Clock = std::chrono::steady_clock;

constexpr auto nap = std::chrono::milliseconds(10);
/// Longer than a thread waits for its turn beside six tests on two cores.
constexpr auto stall = std::chrono::milliseconds(150);
constexpr int most_runs = 3;

struct Run {
  int status = 0;  ///< as a shell has it
  Clock::duration stood_still{};
};

Run run(char** command) {
  auto before = Clock::now();
  const pid_t child = fork();
  if (child == 0) {
    execvp(command[0], command);
    std::perror(command[0]);
    _exit(127);
  }
  if (child < 0) {
    std::perror("fork");
    return {.status = 126};
  }
  Run done;
  int ended = 0;
  const auto look = [&] {
    const auto now = Clock::now();
    done.stood_still = std::max(done.stood_still, now - before - nap);
    before = now;
  };
  while (waitpid(child, &ended, WNOHANG) == 0) {
    std::this_thread::sleep_for(nap);
    look();
  }
  look();
  done.status = WIFEXITED(ended) ? WEXITSTATUS(ended) : 128 + WTERMSIG(ended);
  return done;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fputs("usage: again_after_stall PROGRAM [ARGUMENT...]\n", stderr);
    return 2;
  }
  for (int runs = 1;; ++runs) {
    const Run done = run(argv + 1);
    if (done.status == 0) return 0;
    const bool again = done.stood_still >= stall && runs < most_runs;
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(done.stood_still).count();
    std::fprintf(stderr, "again_after_stall: the machine stood still for up to %lld ms meanwhile%s\n",
                 static_cast<long long>(ms), again ? "; once more" : "");
    if (!again) return done.status;
  }
}
