// SPDX-License-Identifier: Apache-2.0
#include <tactus/analysis/stability/map_hdf5.hpp>
#include <tactus/data/report/hdf5_file.hpp>

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace tactus::stability {

Check write_hdf5(const std::filesystem::path& path, const MapResult& map) {
  report::Hdf5File file;
  std::vector<std::size_t> shape;
  for (const MapAxis& axis : map.axes) {
    report::Hdf5File::Attributes attributes{{"unit", axis.unit}};
    std::string words;
    for (const std::string& word : axis.words) words += (words.empty() ? "" : ",") + word;
    if (!words.empty()) attributes.emplace_back("words", std::move(words));
    const std::array<std::size_t, 1> count{axis.values.size()};
    file.add_numbers("axes/" + std::to_string(shape.size()) + "-" + axis.key, count, axis.values, attributes);
    shape.push_back(axis.values.size());
  }
  const auto column = [&](const char* name, const report::Hdf5File::Attributes& attributes, auto&& value_of) {
    std::vector<double> numbers;
    numbers.reserve(map.points.size());
    for (const PointResult& point : map.points) numbers.push_back(value_of(point));
    file.add_numbers(name, shape, numbers, attributes);
  };
  column("verdict", {{"unit", ""}, {"words", "0 settled, 1 ringing, 2 limit-cycle, 3 diverged"}},
         [](const PointResult& p) { return static_cast<double>(p.verdict); });
  column("settling_time", {{"unit", "s"}}, [](const PointResult& p) { return p.settling_time_s; });
  column("contacts", {{"unit", ""}}, [](const PointResult& p) { return p.contacts; });
  column("peak_force", {{"unit", "N"}}, [](const PointResult& p) { return p.peak_force_N; });
  column("residual_rms", {{"unit", "N"}}, [](const PointResult& p) { return p.residual_rms_N; });
  return file.write(path);
}

}  // namespace tactus::stability
