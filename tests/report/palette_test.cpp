// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/report/palette.hpp>

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

namespace tactus::report {
namespace palette_test {

using Triple = std::array<double, 3>;
using Matrix = std::array<Triple, 3>;

Triple times(const Matrix& matrix, const Triple& v) {
  Triple product{};
  for (std::size_t i = 0; i < 3; ++i) product[i] = matrix[i][0] * v[0] + matrix[i][1] * v[1] + matrix[i][2] * v[2];
  return product;
}

/// Linear sRGB (IEC 61966-2-1).
Triple linear(const char* hex) {
  Triple rgb{};
  for (std::size_t i = 0; i < 3; ++i) {
    const double value = std::stoi(std::string(hex).substr(1 + 2 * i, 2), nullptr, 16) / 255.0;
    rgb[i] = value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
  }
  return rgb;
}

double luminance(const char* hex) {
  const Triple rgb = linear(hex);
  return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

/// WCAG 2.1 contrast ratio.
double contrast(const char* a, const char* b) {
  const auto [low, high] = std::minmax({luminance(a), luminance(b)});
  return (high + 0.05) / (low + 0.05);
}

/// CIE 1976 L*a*b* under D65.
Triple lab(Triple rgb) {
  for (double& value : rgb) value = std::clamp(value, 0.0, 1.0);
  constexpr Matrix to_xyz{{{0.4124, 0.3576, 0.1805}, {0.2126, 0.7152, 0.0722}, {0.0193, 0.1192, 0.9505}}};
  const Triple xyz = times(to_xyz, rgb);
  const auto f = [](double t) { return t > 0.008856 ? std::cbrt(t) : 7.787 * t + 16.0 / 116.0; };
  const double x = f(xyz[0] / 0.9505);
  const double y = f(xyz[1]);
  const double z = f(xyz[2] / 1.089);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

// Machado, Oliveira and Fernandes (2009), severity 1.
constexpr Matrix normal{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
constexpr Matrix protanopia{
    {{0.152286, 1.052583, -0.204868}, {0.114503, 0.786281, 0.099216}, {-0.003882, -0.048116, 1.051998}}};
constexpr Matrix deuteranopia{
    {{0.367322, 0.860646, -0.227968}, {0.280085, 0.672501, 0.047413}, {-0.011820, 0.042940, 0.968881}}};
constexpr Matrix tritanopia{
    {{1.255528, -0.076749, -0.178779}, {-0.078411, 0.930809, 0.147602}, {0.004733, 0.691367, 0.303900}}};

TEST(Palette, EverySlotStandsOutFromItsSurface) {
  for (const Palette& palette : {light_palette, dark_palette}) {
    for (const char* slot : palette.series) EXPECT_GE(contrast(slot, palette.surface), 3.0) << slot;
    EXPECT_GE(contrast(palette.text, palette.surface), 7.0);
    EXPECT_GE(contrast(palette.muted, palette.surface), 4.5);
    EXPECT_GE(contrast(palette.accent, palette.surface), 4.5);
  }
}

TEST(Palette, SlotsStayApartForTheColourBlind) {
  for (const Palette& palette : {light_palette, dark_palette}) {
    for (const Matrix& vision : {normal, protanopia, deuteranopia, tritanopia}) {
      for (std::size_t i = 0; i < palette.series.size(); ++i) {
        for (std::size_t j = 0; j < i; ++j) {
          const Triple a = lab(times(vision, linear(palette.series[i])));
          const Triple b = lab(times(vision, linear(palette.series[j])));
          EXPECT_GE(std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]), 20.0)
              << palette.series[i] << " and " << palette.series[j];
        }
      }
    }
  }
}

}  // namespace palette_test
}  // namespace tactus::report
