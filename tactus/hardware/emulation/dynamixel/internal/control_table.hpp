// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

/// The control table of the X series, and what its models differ in. Source: ROBOTIS e-Manual.
namespace tactus::emulation::dynamixel {

struct Field {
  std::size_t address, bytes;
  bool writable;
  std::int64_t lowest, highest;  ///< both included; of a goal the servo's own limit comes on top
};
inline constexpr std::int64_t any = std::int64_t{1} << 31;
inline constexpr std::array<Field, 50> fields{{
    {0, 2, false, 0, 0},       {2, 4, false, 0, 0},      {6, 1, false, 0, 0},       {7, 1, true, 0, 252},
    {8, 1, true, 0, 6},        {9, 1, true, 0, 254},     {10, 1, true, 0, 5},       {11, 1, true, 0, 16},
    {12, 1, true, 0, 255},     {13, 1, true, 2, 22},     {20, 4, true, -any, any},  {24, 4, true, 0, 1023},
    {31, 1, true, 0, 100},     {32, 2, true, 31, 160},   {34, 2, true, 31, 160},    {36, 2, true, 0, 885},
    {38, 2, true, 0, 0},       {44, 4, true, 0, 2047},   {48, 4, true, 0, 4095},    {52, 4, true, 0, 4095},
    {63, 1, true, 0, 255},     {64, 1, true, 0, 1},      {65, 1, true, 0, 1},       {68, 1, true, 0, 2},
    {69, 1, false, 0, 0},      {70, 1, false, 0, 0},     {76, 2, true, 0, 16383},   {78, 2, true, 0, 16383},
    {80, 2, true, 0, 16383},   {82, 2, true, 0, 16383},  {84, 2, true, 0, 16383},   {88, 2, true, 0, 16383},
    {90, 2, true, 0, 16383},   {98, 1, true, 0, 127},    {100, 2, true, -885, 885}, {102, 2, true, -any, any},
    {104, 4, true, -any, any}, {108, 4, true, 0, 32767}, {112, 4, true, 0, 32767},  {116, 4, true, -any, any},
    {120, 2, false, 0, 0},     {122, 1, false, 0, 0},    {123, 1, false, 0, 0},     {124, 2, false, 0, 0},
    {126, 2, false, 0, 0},     {128, 4, false, 0, 0},    {132, 4, false, 0, 0},     {136, 4, false, 0, 0},
    {140, 4, false, 0, 0},     {144, 2, false, 0, 0},
}};
inline constexpr Field temperature{146, 1, false, 0, 0};

/// Torque of one unit of current as stall torque over stall current, and the largest current limit.
struct Make {
  std::int64_t number;
  std::int64_t highest_current;
  double unit_A, stall_torque_Nm, stall_current_A;
};
inline constexpr std::array<Make, 6> makes{{{1190, 1750, 1.0e-3, 0.215, 1.47},
                                            {1200, 1750, 1.0e-3, 0.52, 1.47},
                                            {1220, 910, 1.0e-3, 0.92, 0.80},
                                            {1240, 2352, 1.0e-3, 0.93, 1.80},
                                            {1020, 1193, 2.69e-3, 4.1, 2.3},
                                            {1030, 1193, 2.69e-3, 3.0, 2.3}}};

inline const Field* field_at(std::size_t address) noexcept {
  if (address == temperature.address) return &temperature;
  const auto found = std::ranges::find(fields, address, &Field::address);
  return found == fields.end() ? nullptr : &*found;
}

/// `makes.size()` where the number is none of theirs.
inline std::size_t make_of(std::int64_t number) noexcept {
  return static_cast<std::size_t>(std::ranges::find(makes, number, &Make::number) - makes.begin());
}

}  // namespace tactus::emulation::dynamixel
