// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/runtime/servo/site_link.hpp>

#include <nlohmann/json.hpp>

namespace tactus::cli {

/// What a site's report says of its link.
nlohmann::ordered_json link_json(const runtime::LinkTotals& totals);

}  // namespace tactus::cli
