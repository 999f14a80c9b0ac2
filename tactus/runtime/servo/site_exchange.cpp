// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/servo/site_exchange.hpp>

namespace tactus::runtime {

Result<SiteCommand> SiteExchange::ask(std::string_view line, control::SiteRole role, RequestSource source) {
  auto command = parse_site_command(line, role, settable, source);
  if (!command || ask(*command)) return command;
  return Error{.code = ErrorCode::failed,
               .parameter = {},
               .message = "sixteen requests wait already for the servo thread: wait for a control cycle",
               .place = {}};
}

}  // namespace tactus::runtime
