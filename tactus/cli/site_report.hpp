#pragma once

#include <tactus/cli/site_loop.hpp>
#include <tactus/runtime/servo_thread.hpp>

#include <string>

namespace tactus::cli {

/// The head of the lines that `second_line` makes.
std::string second_head(const std::string& site);
/// One second in one line.
std::string second_line(const SiteSecond& second);

/// All of a run as tables.
std::string site_text(const std::string& site, const SiteTotals& totals, const runtime::ServoReport& servo);
/// All of a run as one JSON document.
std::string site_json(const std::string& site, const SiteTotals& totals, const runtime::ServoReport& servo);

}  // namespace tactus::cli
