// SPDX-License-Identifier: Apache-2.0
// squares COUNT [REFUSED]: sums the squares below COUNT over all ranks, a task each, in two lists. The task REFUSED
// fails.
#include <tactus/mpi/ranks/session.hpp>
#include <tactus/simulation/tasks/work.hpp>

#include <cstdlib>
#include <iostream>
#include <string>
#include <string_view>

namespace {

using namespace tactus;

int sum_squares(tasks::Engine& engine, std::size_t count, std::size_t refused) {
  auto work = tasks::Work::begin(
      {.engine = &engine, .folder = {}},
      {.description = "squares", .run = [refused](std::string_view key) -> Result<std::string> {
         const std::size_t number = std::stoul(std::string(key));
         if (number == refused) {
           return Error{.code = ErrorCode::failed, .parameter = {}, .message = "no square", .place = std::string(key)};
         }
         // A long value, which no rank can send before another one receives it.
         return std::to_string(number * number) + std::string(number % 7 == 0 ? 100'000 : 0, ' ');
       }});
  if (!work || !work->leads()) return 0;
  for (const std::size_t half : {count / 2, count}) {
    std::size_t sum = 0;
    const auto error = work->run(
        {.count = half, .key = [](std::size_t i) { return std::to_string(i); }},
        [&sum](std::size_t, std::string_view value, tasks::Origin) -> Check {
          sum += std::stoul(std::string(value));
          return {};
        },
        [](double) {});
    if (error) {
      std::cout << describe(*error) << "\n";
      return 1;
    }
    std::cout << sum << "\n";
  }
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const auto session = tactus::ranks::Session::start(argc, argv);
  if (!session || argc < 2) return 2;
  const std::size_t count = std::stoul(argv[1]);
  return session->end(sum_squares(session->engine(), count, argc > 2 ? std::stoul(argv[2]) : count), {});
}
