#include <tactus/simulation/parallel.hpp>

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace tactus::simulation {

void for_each_in_parallel(std::size_t count, const std::function<void(std::size_t)>& work,
                          const std::function<void(double)>& progress) {
  std::atomic<std::size_t> next = 0;
  std::atomic<std::size_t> done = 0;
  const auto take = [&] {
    const std::size_t i = next++;
    if (i >= count) return false;
    work(i);
    ++done;
    return true;
  };
  const std::size_t useful = std::min<std::size_t>(std::thread::hardware_concurrency(), count);
  std::vector<std::jthread> threads;
  for (std::size_t i = 1; i < useful; ++i) {
    threads.emplace_back([&take] {
      while (take()) {
      }
    });
  }
  while (take()) progress(static_cast<double>(done.load()) / static_cast<double>(count));
  threads.clear();  // joins
  progress(1.0);
}

}  // namespace tactus::simulation
