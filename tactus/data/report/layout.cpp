// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/layout.hpp>
#include <tactus/data/report/shared_limits.hpp>
#include <tactus/data/report/text.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string_view>
#include <utility>

namespace tactus::report {
namespace {

using namespace measure;

constexpr double margin = 8.0;
constexpr double column_gap = 16.0;
constexpr double row_gap = 12.0;
constexpr double group_gap = 24.0;
constexpr double label_gap = 4.0;
constexpr double legend_line = 18.0;
constexpr double bold_font = 1.12 * font;  // what a bold text takes, as the size of a plain one
constexpr double legend_gap = 18.0;

/// The size of every panel: as wide as a page holds in the number of columns.
struct PanelSize {
  double width, height;
};
PanelSize panel_size(const Figure& figure, int columns, int rows) {
  constexpr double category_height = 20.0;
  std::size_t categories = 0;
  for (const Panel& panel : figure.panels) categories = std::max(categories, panel.y.categories.size());
  const double width = columns == 1 ? 620.0 : std::max(110.0, std::floor(920.0 / columns));
  if (categories > 0) return {width, category_height * static_cast<double>(categories)};
  return {width, std::clamp(std::floor(0.62 * width), 90.0, rows > 1 ? 220.0 : 300.0)};
}

/// Widens both axes about their middles until a unit is as long on either, with some room around.
void equal_scales(Limits& x, Limits& y, const PanelSize& size) {
  const double per_px = 1.08 * std::max((x.upper - x.lower) / size.width, (y.upper - y.lower) / size.height);
  const auto widen = [](Limits& limits, double length) {
    const double middle = 0.5 * (limits.lower + limits.upper);
    limits = {middle - 0.5 * length, middle + 0.5 * length};
  };
  widen(x, per_px * size.width);
  widen(y, per_px * size.height);
}

/// As many ticks as there is room for, so that no two labels touch: `room` px for the next label after a `label`.
template <class Room>
void choose_ticks(PlacedAxis& axis, int most, Room&& room) {
  for (; most >= 2; --most) {
    axis.ticks = axis.logarithmic ? logarithmic_ticks(axis.limits.lower, axis.limits.upper, most)
                                  : linear_ticks(axis.limits.lower, axis.limits.upper, most);
    bool fits = true;
    for (std::size_t i = 1; i < axis.ticks.major.size(); ++i) {
      const double distance = std::abs(axis(axis.ticks.major[i]) - axis(axis.ticks.major[i - 1]));
      fits = fits && distance >= room(axis.ticks.labels[i - 1], axis.ticks.labels[i]);
    }
    if (fits) return;
  }
}

/// Category i at the value i, the first on top.
void place_categories(PlacedAxis& axis, const std::vector<std::string>& categories) {
  axis.logarithmic = false;
  axis.limits = {static_cast<double>(categories.size()) - 0.5, -0.5};
  axis.ticks.labels = categories;
  for (std::size_t i = 0; i < categories.size(); ++i) axis.ticks.major.push_back(static_cast<double>(i));
}

std::string name_of(const Axis& axis, int exponent) {
  if (exponent == 0) return with_unit(axis.label, axis.unit);
  const std::string power = power_of_ten(exponent);
  return with_unit(axis.label, axis.unit.empty() ? "×" + power : power + "\u00A0" + axis.unit);
}

double widest(const std::vector<std::string>& labels) {
  double width = 0.0;
  for (const std::string& label : labels) width = std::max(width, text_width(label, tick_font));
  return width;
}

/// Builds a layout step by step; every step needs those before it.
class Builder {
 public:
  explicit Builder(const Figure& figure)
      : figure_(figure),
        columns_(std::max(1, figure.columns)),
        rows_((static_cast<int>(figure.panels.size()) + columns_ - 1) / columns_),
        size_(panel_size(figure, columns_, rows_)) {}

  Layout build() {
    place_axes();
    place_rows();
    place_columns();
    place_legend();
    place_panels();
    place_texts();
    return std::move(layout_);
  }

 private:
  [[nodiscard]] std::size_t index(int row, int column) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) + static_cast<std::size_t>(column);
  }
  [[nodiscard]] double& at(std::vector<double>& values, int i) const { return values[static_cast<std::size_t>(i)]; }

  void place_axes() {
    const auto columns = static_cast<std::size_t>(columns_);
    auto [x, y, x_group, y_group] = shared_limits(figure_, columns);
    const std::size_t count = figure_.panels.size();
    for (std::size_t i = 0; i < count; ++i) {
      const Panel& panel = figure_.panels[i];
      if (panel.equal_scales) equal_scales(x[i], y[i], size_);
      PlacedAxis across{x[i], {}, is_logarithmic(panel.x), 0.0, size_.width, true, {}};
      PlacedAxis up{y[i], {}, is_logarithmic(panel.y), size_.height, 0.0, true, {}};
      choose_ticks(across, static_cast<int>(size_.width / 25.0), [](const std::string& a, const std::string& b) {
        return 0.5 * (text_width(a, tick_font) + text_width(b, tick_font)) + 8.0;
      });
      if (panel.y.categories.empty()) {
        choose_ticks(up, static_cast<int>(size_.height / 22.0),
                     [](const std::string&, const std::string&) { return tick_font + 2.0; });
      } else {
        place_categories(up, panel.y.categories);
      }
      across.labelled = i + columns >= count || x_group[i + columns] != x_group[i];
      up.labelled = i % columns == 0 || y_group[i - 1] != y_group[i];
      across.name = name_of(panel.x, across.ticks.exponent);
      up.name = name_of(panel.y, up.ticks.exponent);
      layout_.panels.push_back({&panel, static_cast<int>(i / columns), static_cast<int>(i % columns),
                                Rectangle{0, 0, size_.width, size_.height}, std::move(across), std::move(up)});
    }
  }

  /// Tops of the rows, counted from the lower edge of a legend above.
  void place_rows() {
    double y = margin;
    std::size_t title_lines = 0;
    for (const std::string& title : figure_.column_titles) {
      title_lines = std::max(title_lines, wrap(title, size_.width, bold_font).size());
    }
    titles_bottom_ = y + static_cast<double>(title_lines) * line_height;
    y = titles_bottom_ + (title_lines > 0 ? label_gap : 0.0);
    std::vector<bool> starts_group(static_cast<std::size_t>(rows_) + 1, false);
    int row_of_group = 0;
    for (const RowGroup& group : figure_.row_groups) {
      if (row_of_group > 0 && row_of_group < rows_) starts_group[static_cast<std::size_t>(row_of_group)] = true;
      row_of_group += std::max(0, group.rows);
    }
    for (int row = 0; row < rows_; ++row) {
      std::size_t panel_title_lines = 0;
      bool labelled = false;
      for (const PlacedPanel& panel : layout_.panels) {
        if (panel.row != row) continue;
        if (!panel.panel->title.empty()) {
          panel_title_lines = std::max(panel_title_lines, wrap(panel.panel->title, size_.width, bold_font).size());
        }
        labelled = labelled || panel.x.labelled;
      }
      if (row > 0) y += starts_group[static_cast<std::size_t>(row)] ? group_gap : row_gap;
      y += static_cast<double>(panel_title_lines) * line_height + (panel_title_lines > 0 ? label_gap : 0.0);
      tops_.push_back(y);
      y += size_.height;
      if (labelled) y += tick_length + tick_font + line_height + 2 * label_gap;
    }
    panels_bottom_ = y;
  }

  /// Left edges of the columns, behind the bands of the row groups and the labels of the y axes.
  void place_columns() {
    double x = margin;
    std::size_t band_lines = 0;
    int row = 0;
    for (const RowGroup& group : figure_.row_groups) {
      const int last = std::min(row + group.rows, rows_) - 1;
      if (last < row) continue;
      const double height = at(tops_, last) + size_.height - at(tops_, row);
      bands_.push_back({wrap(group.label, height, bold_font), at(tops_, row), height});
      band_lines = std::max(band_lines, bands_.back().lines.size());
      row = last + 1;
    }
    band_width_ = static_cast<double>(band_lines) * line_height;
    if (band_lines > 0) x += band_width_ + 3 * label_gap;
    for (int column = 0; column < columns_; ++column) {
      double labels = 0.0;
      std::size_t name_lines = 0;
      bool labelled = false;
      for (const PlacedPanel& panel : layout_.panels) {
        if (panel.column != column || !panel.y.labelled) continue;
        labelled = true;
        labels = std::max(labels, widest(panel.y.ticks.labels));
        if (!panel.y.name.empty()) name_lines = std::max(name_lines, wrap(panel.y.name, size_.height, font).size());
      }
      if (column > 0) x += column_gap;
      if (labelled) x += tick_length + labels + 3 * label_gap + static_cast<double>(name_lines) * line_height;
      label_widths_.push_back(labels);
      lefts_.push_back(x);
      x += size_.width;
    }
    layout_.width = x + margin + label_gap;
  }

  void place_legend() {
    std::vector<LegendEntry>& entries = layout_.legend;
    int rule_count = 0;
    for (const Panel& panel : figure_.panels) {
      for (const Line& line : panel.lines) {
        const bool known = std::any_of(entries.begin(), entries.end(), [&](const LegendEntry& entry) {
          return entry.line != nullptr && entry.line->name == line.name && entry.line->colour == line.colour &&
                 entry.line->dash == line.dash && entry.line->width_px == line.width_px;
        });
        if (!known && !line.name.empty()) entries.push_back({&line, nullptr, nullptr, -1, {}});
      }
      for (const Bars& bars : panel.bars) {
        const bool known = std::any_of(entries.begin(), entries.end(), [&](const LegendEntry& entry) {
          return entry.bars != nullptr && entry.bars->name == bars.name && entry.bars->colour == bars.colour;
        });
        if (!known && !bars.name.empty()) entries.push_back({nullptr, &bars, nullptr, -1, {}});
      }
    }
    for (const Panel& panel : figure_.panels) {
      for (const Rule& rule : panel.rules) {
        if (!rule.label.empty() && rule_style(entries, rule) < 0)
          entries.push_back({nullptr, nullptr, &rule, rule_count++, {}});
      }
    }
    const double left = at(lefts_, 0);
    double x = left;
    double y = 0.5 * legend_line;
    for (LegendEntry& entry : entries) {
      const double width = swatch + label_gap + text_width(text_of(entry), font);
      if (x > left && x + width > layout_.width - margin) {
        x = left;
        y += legend_line;
      }
      entry.at = {x, y};
      x += width + legend_gap;
    }
    const double height = entries.empty() ? 0.0 : y + 0.5 * legend_line + label_gap;
    const bool above = figure_.legend == Figure::Legend::above;
    for (LegendEntry& entry : entries) entry.at.y += above ? margin : panels_bottom_ + label_gap;
    offset_ = above ? height : 0.0;
    layout_.height = panels_bottom_ + height + margin;
  }

  void place_panels() {
    for (double& top : tops_) top += offset_;
    for (PlacedPanel& panel : layout_.panels) {
      panel.frame.left = at(lefts_, panel.column);
      panel.frame.top = at(tops_, panel.row);
      panel.x.begin = panel.frame.left;
      panel.x.end = panel.frame.right();
      panel.y.begin = panel.frame.bottom();
      panel.y.end = panel.frame.top;
    }
  }

  /// Lines of text stacked so that the last one stands on `at`; rotated lines are stacked to the left.
  void add_lines(const std::vector<std::string>& lines, Point at, const char* anchor, const char* style, bool rotated) {
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const double back = static_cast<double>(lines.size() - 1 - i) * line_height;
      const Point place = rotated ? Point{at.x - back, at.y} : Point{at.x, at.y - back};
      layout_.texts.push_back({lines[i], place, anchor, style, rotated});
    }
  }

  void place_texts() {
    const double y = titles_bottom_ + offset_ - 0.25 * font;
    for (int column = 0; column < columns_ && index(0, column) < figure_.column_titles.size(); ++column) {
      const auto lines = wrap(figure_.column_titles[index(0, column)], size_.width, bold_font);
      add_lines(lines, {at(lefts_, column) + 0.5 * size_.width, y}, "middle", "title", false);
    }
    for (const Band& band : bands_) {
      const double top = band.top + offset_;
      const double used = static_cast<double>(band.lines.size()) * line_height;
      const double baseline = margin + 0.5 * (band_width_ + used) - 0.25 * font;
      add_lines(band.lines, {baseline, top + 0.5 * band.height}, "middle", "title", true);
      layout_.group_bars.push_back({margin + band_width_ + label_gap, top, 1.5, band.height});
    }
    for (const PlacedPanel& panel : layout_.panels) place_texts(panel);
  }

  void place_texts(const PlacedPanel& panel) {
    const Rectangle& frame = panel.frame;
    if (!panel.panel->title.empty()) {
      add_lines(wrap(panel.panel->title, frame.width, bold_font), {frame.left, frame.top - label_gap - 1.0}, "start",
                "title", false);
    }
    if (panel.y.labelled && !panel.y.name.empty()) {
      const double x = frame.left - tick_length - at(label_widths_, panel.column) - 2.5 * label_gap;
      add_lines(wrap(panel.y.name, frame.height, font), {x, frame.top + 0.5 * frame.height}, "middle", "name", true);
    }
    if (panel.x.labelled && !panel.x.name.empty() && !continues(panel, -1)) {
      const PlacedPanel* last = &panel;
      while (continues(*last, 1)) ++last;
      const double y = frame.bottom() + tick_length + tick_font + label_gap + 0.85 * line_height;
      add_lines({panel.x.name}, {0.5 * (frame.left + last->frame.right()), y}, "middle", "name", false);
    }
  }

  /// Whether the neighbour in the row (`step` −1 or 1) shares the name of its x axis with this panel.
  [[nodiscard]] bool continues(const PlacedPanel& panel, int step) const {
    const std::ptrdiff_t neighbour = &panel - layout_.panels.data() + step;
    if (figure_.share_x == Sharing::none || neighbour < 0 || neighbour >= std::ssize(layout_.panels)) return false;
    const PlacedPanel& other = layout_.panels[static_cast<std::size_t>(neighbour)];
    return other.row == panel.row && other.x.labelled && other.x.name == panel.x.name;
  }

  struct Band {
    std::vector<std::string> lines;
    double top, height;
  };

  const Figure& figure_;
  int columns_;
  int rows_;
  PanelSize size_;
  Layout layout_{};
  std::vector<double> tops_;
  std::vector<double> lefts_;
  std::vector<double> label_widths_;
  std::vector<Band> bands_;
  double band_width_ = 0.0;
  double titles_bottom_ = 0.0;
  double panels_bottom_ = 0.0;
  double offset_ = 0.0;
};

}  // namespace

double text_width(const std::string& text, double font_px) {
  // The widths of DejaVu Sans, one of the widest faces in use, in ems by kind of character.
  const auto width_of = [](char character) {
    const auto among = [&](std::string_view kind) { return kind.find(character) != std::string_view::npos; };
    if (among("ijlI.,:;'| ")) return 0.33;
    if (among("frt()[]/-")) return 0.42;
    if (among("mwMW%")) return 0.98;
    if (among("+=<>")) return 0.84;
    return character >= 'A' && character <= 'Z' ? 0.72 : 0.64;
  };
  double ems = 0.0;
  std::string beyond_ascii;
  for (const char character : text) {
    if (static_cast<unsigned char>(character) < 0x80) {
      ems += width_of(character);
    } else {
      beyond_ascii += character;
    }
  }
  return font_px * (ems + 0.84 * static_cast<double>(display_width(beyond_ascii)));
}

std::vector<std::string> wrap(const std::string& text, double width, double font_px) {
  std::vector<std::string> lines{""};
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    std::string& line = lines.back();
    if (line.empty()) {
      line = word;
    } else if (text_width(line + " " + word, font_px) <= width) {
      line += " " + word;
    } else {
      lines.push_back(word);
    }
    begin = end + 1;
  }
  return lines;
}

double PlacedAxis::operator()(double value) const {
  if (logarithmic && !(value > 0.0)) return std::numeric_limits<double>::quiet_NaN();
  const auto even = [&](double v) { return logarithmic ? std::log10(v) : v; };
  const double fraction = (even(value) - even(limits.lower)) / (even(limits.upper) - even(limits.lower));
  return begin + fraction * (end - begin);
}

int rule_style(const std::vector<LegendEntry>& legend, const Rule& rule) {
  const auto found = std::find_if(legend.begin(), legend.end(), [&](const LegendEntry& entry) {
    return entry.rule != nullptr && entry.rule->label == rule.label && entry.rule->direction == rule.direction;
  });
  return found == legend.end() ? -1 : found->rule_style;
}

const std::string& text_of(const LegendEntry& entry) {
  if (entry.line != nullptr) return entry.line->name;
  return entry.bars != nullptr ? entry.bars->name : entry.rule->label;
}

Layout lay_out(const Figure& figure) { return Builder(figure).build(); }

}  // namespace tactus::report
