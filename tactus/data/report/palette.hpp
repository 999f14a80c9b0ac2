// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace tactus::report {

/// Colours of one scheme, as `#rrggbb`.
struct Palette {
  const char* surface;
  const char* text;
  const char* muted;  ///< ticks, units, captions
  const char* frame;
  const char* grid;
  const char* accent;                 ///< links, focus
  std::array<const char*, 8> series;  ///< colour slots of lines
};

// The slots were found by a search that maximised the smallest CIE76 distance between any two, as seen with normal
// colour vision and with the three dichromacies (Machado, Oliveira and Fernandes 2009, severity 1), while every slot
// keeps a contrast of 3:1 with its surface (WCAG 2.1, 1.4.11). The tests hold them to both.
inline constexpr Palette light_palette{
    "#ffffff",
    "#16191d",
    "#565e68",
    "#8a929b",
    "#e4e7ea",
    "#162fbe",
    {"#162fbe", "#ef6812", "#28864d", "#b8359c", "#7a4202", "#5575ff", "#919191", "#111111"}};
inline constexpr Palette dark_palette{
    "#14171a",
    "#e8eaed",
    "#a5adb6",
    "#6b737c",
    "#2b3036",
    "#add2ff",
    {"#3d78fd", "#dc7327", "#1ee799", "#b663b5", "#ecd428", "#add2ff", "#858585", "#f5f6f7"}};

}  // namespace tactus::report
