// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/standard_output.hpp>
#include <tactus/interfaces/cli/streams.hpp>

#include <poll.h>
#include <unistd.h>

namespace tactus::cli {

bool reader_is_gone(int descriptor) {
  pollfd end{.fd = descriptor, .events = POLLOUT, .revents = 0};
  return poll(&end, 1, 0) == 1 && (end.revents & POLLERR) != 0;
}

Check flush_standard_output() {
  if (result_stream().flush() || reader_is_gone(STDOUT_FILENO)) return std::nullopt;
  return Error{.code = ErrorCode::unwritable,
               .parameter = {},
               .message = "the output could not be written: give it a place with room",
               .place = "standard output"};
}

}  // namespace tactus::cli
