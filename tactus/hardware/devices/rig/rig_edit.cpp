// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/configuration/text.hpp>
#include <tactus/data/report/files.hpp>
#include <tactus/hardware/devices/rig/rig.hpp>
#include <tactus/hardware/devices/rig/rig_edit.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>
#include <utility>

namespace tactus::devices {

namespace {

/// Where a value stands, counted from 1.
struct Position {
  std::size_t line = 0, column = 0;
};

/// Of `file:12:5`.
Position position_in(const std::string& place) {
  Position position;
  const auto column = place.rfind(':');
  const auto line = place.rfind(':', column - 1);
  if (column == std::string::npos || line == std::string::npos) return position;
  std::from_chars(place.data() + line + 1, place.data() + column, position.line);
  std::from_chars(place.data() + column + 1, place.data() + place.size(), position.column);
  return position;
}

/// Where a line begins.
std::size_t begin_of(std::string_view text, std::size_t line) {
  std::size_t begin = 0;
  for (; line > 1; --line) begin = std::min(text.find('\n', begin), text.size() - 1) + 1;
  return begin;
}

bool of_a_number(char c) {
  constexpr std::string_view others = "+-._einfax";
  return (c >= '0' && c <= '9') || others.find(c) != std::string_view::npos || (c >= 'A' && c <= 'F');
}

const RigJoint* joint_of(const Rig& rig, const std::string& path) {
  for (const RigPair& pair : rig.pairs()) {
    for (const auto* side : {&pair.leader, &pair.follower}) {
      if (!*side) continue;
      const auto found = std::ranges::find((*side)->joints, path, &RigJoint::path);
      if (found != (*side)->joints.end()) return &*found;
    }
  }
  return nullptr;
}

Error by_hand(const Rig& rig, const RigJoint& joint, const std::string& value) {
  const std::string key = joint.words().offset;
  return rig.locate({.code = ErrorCode::inconsistent,
                     .parameter = join(joint.path, key),
                     .message = "this layout is not changed by a program: write " + key + " = " + value + " yourself",
                     .place = {}});
}

}  // namespace

Result<std::string> with_offset(std::string_view text, const std::string& name, const NewOffset& offset) {
  const auto rig = Rig::parse(text, name);
  if (!rig) return rig.error();
  const RigJoint* one = joint_of(*rig, offset.joint);
  if (one == nullptr) {
    return Error{.code = ErrorCode::missing, .parameter = offset.joint, .message = "is no joint of it", .place = name};
  }
  const std::string key_word = one->words().offset;
  constexpr double step = 1e6;
  const double rounded_rad = std::round(offset.offset_rad * step) / step;
  const std::string value = configuration::toml_float(rounded_rad + 0.0);
  const auto place_of = [&](const char* key) {
    return position_in(
        rig->locate({.code = ErrorCode::failed, .parameter = join(offset.joint, key), .message = {}, .place = {}})
            .place);
  };
  std::string changed(text);
  if (rig->has(join(offset.joint, key_word))) {
    const Position at = place_of(key_word.c_str());
    const std::size_t begin = begin_of(text, at.line) + at.column - 1;
    const auto end = std::find_if_not(text.begin() + static_cast<std::ptrdiff_t>(std::min(begin, text.size())),
                                      text.end(), of_a_number);
    changed.replace(begin, static_cast<std::size_t>(end - text.begin()) - begin, value);
  } else {
    const std::size_t begin = begin_of(text, place_of("motor").line);
    const std::size_t key = text.find_first_not_of(" \t", begin);
    if (key == std::string_view::npos || !text.substr(key).starts_with("motor")) return by_hand(*rig, *one, value);
    const std::size_t end = text.find('\n', begin);
    const bool returns = end != std::string_view::npos && end > 0 && text[end - 1] == '\r';
    const std::string line = std::string(text.substr(begin, key - begin)) + key_word + " = " + value;
    if (end == std::string_view::npos) {
      changed += "\n" + line + "\n";
    } else {
      changed.insert(end + 1, line + (returns ? "\r\n" : "\n"));
    }
  }
  // What a layout of another kind would make of that.
  const auto reread = Rig::parse(changed, name);
  const RigJoint* joint = reread ? joint_of(*reread, offset.joint) : nullptr;
  if (joint == nullptr || joint->joint.offset_rad != rounded_rad) return by_hand(*rig, *one, value);
  return changed;
}

Check write_offsets(const std::filesystem::path& file, const std::vector<NewOffset>& offsets) {
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream content;
  content << stream.rdbuf();
  std::string text = content.str();
  if (!stream) {
    return Error{.code = ErrorCode::missing,
                 .parameter = {},
                 .message = "the file cannot be read: check its permissions",
                 .place = file.string()};
  }
  for (const NewOffset& offset : offsets) {
    auto changed = with_offset(text, file.string(), offset);
    if (!changed) return changed.error();
    text = *std::move(changed);
  }
  return report::rewrite_file(file, text);
}

}  // namespace tactus::devices
