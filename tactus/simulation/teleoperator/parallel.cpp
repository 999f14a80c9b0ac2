// SPDX-License-Identifier: Apache-2.0
#include <tactus/simulation/teleoperator/parallel.hpp>

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace tactus::simulation {

void for_each_in_parallel(std::size_t count, const std::function<void(std::size_t)>& work,
                          const std::function<void(double)>& progress, std::size_t threads) {
  std::atomic<std::size_t> next = 0;
  std::atomic<std::size_t> done = 0;
  std::atomic<bool> failed = false;
  std::exception_ptr failure;
  const auto take = [&] {
    const std::size_t i = next++;
    if (i >= count) return false;
    work(i);
    ++done;
    return true;
  };
  // The first failure, as a lack of memory, is kept, and nobody begins anything more.
  const auto guarded = [&](const auto& body) noexcept {
    try {
      body();
    } catch (...) {
      if (!failed.exchange(true)) failure = std::current_exception();
      next = count;
    }
  };
  const std::size_t wanted = threads > 0 ? threads : std::thread::hardware_concurrency();
  const std::size_t useful = std::min(wanted, count);
  std::vector<std::jthread> others;
  try {
    for (std::size_t i = 1; i < useful; ++i) {
      others.emplace_back([&] {
        guarded([&] {
          while (take()) {
          }
        });
      });
    }
  } catch (const std::exception&) {
    // No more threads to be had: those that there are do the work.
  }
  guarded([&] {
    while (take()) progress(static_cast<double>(done.load()) / static_cast<double>(count));
  });
  others.clear();  // joins
  if (failure) std::rethrow_exception(failure);
  progress(1.0);
}

}  // namespace tactus::simulation
