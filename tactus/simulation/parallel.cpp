#include <tactus/simulation/parallel.hpp>

#include <algorithm>
#include <atomic>
#include <thread>
#include <vector>

namespace tactus::simulation {

void for_each_in_parallel(std::size_t count, const std::function<void(std::size_t)>& work,
                          const std::function<void(double)>& progress, std::size_t threads) {
  std::atomic<std::size_t> next = 0;
  std::atomic<std::size_t> done = 0;
  const auto take = [&] {
    const std::size_t i = next++;
    if (i >= count) return false;
    work(i);
    ++done;
    return true;
  };
  const std::size_t wanted = threads > 0 ? threads : std::thread::hardware_concurrency();
  const std::size_t useful = std::min(wanted, count);
  std::vector<std::jthread> others;
  for (std::size_t i = 1; i < useful; ++i) {
    others.emplace_back([&take] {
      while (take()) {
      }
    });
  }
  while (take()) progress(static_cast<double>(done.load()) / static_cast<double>(count));
  others.clear();  // joins
  progress(1.0);
}

}  // namespace tactus::simulation
