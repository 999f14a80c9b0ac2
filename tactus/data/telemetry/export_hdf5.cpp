// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/hdf5_file.hpp>
#include <tactus/data/telemetry/export.hpp>
#include <tactus/data/telemetry/export_parts.hpp>

#include <array>
#include <string>

namespace tactus::telemetry {

Check export_hdf5(const LogContent& content, const std::filesystem::path& file) {
  if (auto error = refuse_empty(content, file)) return error;
  report::Hdf5File hdf;
  const std::vector<std::string> names = names_of(content.tables);
  for (std::size_t one = 0; one < content.tables.size(); ++one) {
    const ExportColumns table(content.tables[one], content.start_unix_ns);
    for (std::size_t i = 0; i < table.columns.size(); ++i) {
      const Column& column = table.columns[i];
      const std::array<std::size_t, 1> rows{table.values[i].size()};
      report::Hdf5File::Attributes attributes{
          {"unit", column.unit}, {"site", column.site}, {"frame", column.frame}, {"sign", column.sign}};
      if (!table.codes[i].words.empty()) attributes.emplace_back("codes", text_of(table.codes[i]));
      hdf.add_numbers(names[one] + "/" + column.name, rows, table.values[i], attributes);
    }
    hdf.describe_group(names[one], about_channel(content.tables[one]));
    if (const auto condition = condition_of(content.summary, content.tables[one].topic)) {
      hdf.describe_group(names[one], {{"condition", condition->label}});
      hdf.describe_group(names[one], condition->set);
    }
  }
  for (const auto& [key, value] : about(content.summary)) hdf.add_text("about/" + key, value);
  return hdf.write(file);
}

}  // namespace tactus::telemetry
