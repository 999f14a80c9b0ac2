#include <tactus/core/parameters.hpp>
#include <tactus/report/files.hpp>
#include <tactus/telemetry/export.hpp>
#include <tactus/telemetry/export_parts.hpp>

namespace tactus::telemetry {

namespace {

/// `displayed_force [N]` for `displayed_force_N`.
std::string head_of(const Column& column) {
  if (column.unit.empty()) return column.name;
  const Unit unit = unit_at_end_of(column.name);
  std::string name = column.name;
  if (unit.symbol == column.unit) name.resize(name.size() - std::string_view(unit.suffix).size());
  return name + " [" + column.unit + "]";
}

}  // namespace

Check export_csv(const LogTable& original, const std::filesystem::path& file) {
  const LogTable table = with_time(original);
  std::string text;
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    if (i != 0) text += ',';
    text += head_of(table.columns[i]);
  }
  text += '\n';
  for (std::size_t row = 0; row < table.times_ns.size(); ++row) {
    for (std::size_t i = 0; i < table.values.size(); ++i) {
      if (i != 0) text += ',';
      text += format_number(table.values[i][row]);
    }
    text += '\n';
  }
  return report::write_file(file, text);
}

}  // namespace tactus::telemetry
