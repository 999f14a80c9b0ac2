// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <utility>

namespace tactus::runtime {

/// A file in memory that other processes may shorten meanwhile.
///
/// To touch a page that its file does not have any more ends a process (SIGBUS), and no process can keep another one of
/// its user from cutting a file of /dev/shm: only memory without a name can be sealed against that. So the first touch
/// finds zeros put in the place of the whole mapping and continues with them, on whatever thread: memory that was kept
/// ready is moved there, which allocates nothing and takes one system call.
///
/// The handler of SIGBUS that does so is installed with the first mapping and stays. What is not one of its mappings'
/// goes to the handler that was there before.
class SharedMapping {
 public:
  /// Reads and writes of the first `bytes` of the file, all of it there from now on. None where the system does not
  /// give it, or there are too many already; errno states why.
  static std::optional<SharedMapping> map(int file, std::size_t bytes);
  SharedMapping(SharedMapping&& other) noexcept : place_(std::exchange(other.place_, none)) {}
  SharedMapping& operator=(SharedMapping&&) = delete;
  ~SharedMapping();

  [[nodiscard]] void* data() const noexcept;
  /// Whether it was found shortened: it is shared with nobody any more, and was all zeros when that began. Any thread.
  /// Real-time safe.
  [[nodiscard]] bool is_cut() const noexcept;

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);
  explicit SharedMapping(std::size_t place) : place_(place) {}

  std::size_t place_;  ///< in the list that the handler looks through
};

}  // namespace tactus::runtime
