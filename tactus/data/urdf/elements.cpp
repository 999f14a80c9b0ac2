// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/file_bytes.hpp>
#include <tactus/data/urdf/elements.hpp>
#include <tactus/data/urdf/urdf.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <set>
#include <span>
#include <string_view>
#include <utility>

#include <tinyxml2.h>

namespace tactus::urdf {
namespace {

using tinyxml2::XMLElement;

constexpr std::size_t most_bytes = std::size_t{4} << 20U;
constexpr std::size_t most_elements = 1000;
constexpr std::size_t longest_quote = 60;

std::string in_quotes(std::string_view text) {
  return "'" + std::string(text.substr(0, longest_quote)) + (text.size() > longest_quote ? "…'" : "'");
}

/// Reads the parts of one file and keeps the first thing that is wrong with it.
class Reader {
 public:
  explicit Reader(std::filesystem::path file) : file_(std::move(file)) {}

  void fail(ErrorCode code, const XMLElement& at, const std::string& message) {
    if (error_) return;
    error_ = Error{.code = code, .parameter = {}, .message = message, .place = place(file_, at.GetLineNum())};
  }
  [[nodiscard]] const Check& error() const { return error_; }

  std::string text(const XMLElement& element, const char* attribute, const std::string& of) {
    const char* found = element.Attribute(attribute);
    if (found != nullptr && *found != '\0') return found;
    fail(ErrorCode::missing, element,
         of + " has no " + in_quotes(attribute) + "; write it as <" + element.Name() + " " + attribute + "=\"...\">");
    return {};
  }

  /// Numbers separated by blanks; what is not written keeps its value.
  void numbers(const XMLElement* element, const char* attribute, const std::string& of, std::span<double* const> into) {
    const char* written = element == nullptr ? nullptr : element->Attribute(attribute);
    if (written == nullptr) return;
    std::string_view rest = written;
    std::size_t count = 0;
    while (true) {
      rest.remove_prefix(std::min(rest.find_first_not_of(" \t\r\n"), rest.size()));
      if (rest.empty()) break;
      const std::string_view word = rest.substr(0, rest.find_first_of(" \t\r\n"));
      rest.remove_prefix(word.size());
      const std::string_view digits = word.front() == '+' ? word.substr(1) : word;
      double value = 0.0;
      const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
      if (failure != std::errc{} || end != digits.data() + digits.size()) {
        fail(ErrorCode::syntax, *element,
             std::string(attribute) + "=" + in_quotes(written) + " of " + of + " holds " + in_quotes(word) +
                 ", which is not a number; write numbers with a decimal point, separated by blanks");
        return;
      }
      if (!std::isfinite(value)) {
        fail(ErrorCode::out_of_bounds, *element,
             std::string(attribute) + "=" + in_quotes(written) + " of " + of + " is not finite; state a number");
        return;
      }
      if (count < into.size()) *into[count] = value;
      ++count;
    }
    if (count == into.size()) return;
    fail(ErrorCode::syntax, *element,
         std::string(attribute) + "=" + in_quotes(written) + " of " + of + " has " + std::to_string(count) +
             " numbers where " + std::to_string(into.size()) + " are needed");
  }
  void number(const XMLElement* element, const char* attribute, const std::string& of, double& into) {
    const std::array<double*, 1> one{&into};
    numbers(element, attribute, of, one);
  }

  arm::JointOrigin origin(const XMLElement& parent, const std::string& of) {
    arm::JointOrigin found;
    const XMLElement* element = parent.FirstChildElement("origin");
    const std::array<double*, 3> xyz{&found.x_m, &found.y_m, &found.z_m};
    const std::array<double*, 3> rpy{&found.roll_rad, &found.pitch_rad, &found.yaw_rad};
    numbers(element, "xyz", of, xyz);
    numbers(element, "rpy", of, rpy);
    return found;
  }

  /// What is wrong with numbers that can be read is left in the result: a body that moves no joint may have it.
  Inertial inertial(const XMLElement& element, const std::string& of) {
    const bool right_before = !error_;
    Inertial found = numbers_of_inertial(element, of);
    if (right_before && error_ && error_->code != ErrorCode::syntax) std::swap(found.fault, error_);
    return found;
  }

  Inertial numbers_of_inertial(const XMLElement& element, const std::string& of) {
    Inertial found;
    found.line = element.GetLineNum();
    found.origin = origin(element, "the inertial of " + of);
    const XMLElement* mass = element.FirstChildElement("mass");
    const XMLElement* inertia = element.FirstChildElement("inertia");
    if (mass == nullptr || mass->Attribute("value") == nullptr) {
      fail(ErrorCode::missing, element, "the inertial of " + of + " has no mass; add <mass value=\"...\"/> in kg");
      return found;
    }
    number(mass, "value", "the mass of " + of, found.mass_kg);
    if (found.mass_kg < 0.0) {
      fail(ErrorCode::out_of_bounds, *mass,
           of + " has a mass of " + rounded_number(found.mass_kg) + " kg; a mass must be at least 0 kg");
    }
    if (inertia == nullptr) {
      fail(ErrorCode::missing, element,
           "the inertial of " + of + " has no <inertia>; add one with ixx, iyy, izz and the products, 0 for a point");
      return found;
    }
    arm::Body& to = found.moments;
    const std::array<std::pair<const char*, double*>, 6> moments{{{"ixx", &to.xx_kg_m2},
                                                                  {"iyy", &to.yy_kg_m2},
                                                                  {"izz", &to.zz_kg_m2},
                                                                  {"ixy", &to.xy_kg_m2},
                                                                  {"ixz", &to.xz_kg_m2},
                                                                  {"iyz", &to.yz_kg_m2}}};
    for (const auto& [attribute, into] : moments) number(inertia, attribute, "the inertia of " + of, *into);
    return found;
  }

  Joint joint(const XMLElement& element) {
    Joint found;
    found.line = element.GetLineNum();
    found.name = text(element, "name", "a joint");
    const std::string of = "joint " + in_quotes(found.name);
    found.type = text(element, "type", of);
    found.parent = linked(element, "parent", of);
    found.child = linked(element, "child", of);
    found.mimics = element.FirstChildElement("mimic") != nullptr;
    found.origin = origin(element, of);
    found.axis = {1.0, 0.0, 0.0};  // what URDF takes where none is written
    const std::array<double*, 3> axis{&found.axis.x, &found.axis.y, &found.axis.z};
    numbers(element.FirstChildElement("axis"), "xyz", "the axis of " + of, axis);
    const XMLElement* limit = element.FirstChildElement("limit");
    if (found.type != "continuous") {
      found.has_range =
          limit != nullptr && (limit->Attribute("lower") != nullptr || limit->Attribute("upper") != nullptr);
      number(limit, "lower", "the limit of " + of, found.limits.lower_rad);
      number(limit, "upper", "the limit of " + of, found.limits.upper_rad);
    }
    number(limit, "velocity", "the limit of " + of, found.limits.velocity_rad_per_s);
    // What URDF takes where only one of the two is written.
    if (found.has_range && limit->Attribute("lower") == nullptr) found.limits.lower_rad = 0.0;
    if (found.has_range && limit->Attribute("upper") == nullptr) found.limits.upper_rad = 0.0;
    number(limit, "effort", "the limit of " + of, found.limits.effort_N_m);
    const XMLElement* dynamics = element.FirstChildElement("dynamics");
    number(dynamics, "damping", "the dynamics of " + of, found.damping);
    number(dynamics, "friction", "the dynamics of " + of, found.friction);
    if (found.damping < 0.0 || found.friction < 0.0) {
      fail(ErrorCode::out_of_bounds, *dynamics,
           of + " has damping " + rounded_number(found.damping) + " and friction " + rounded_number(found.friction) +
               "; neither may be less than 0");
    }
    return found;
  }

 private:
  std::string linked(const XMLElement& joint, const char* child, const std::string& of) {
    const XMLElement* element = joint.FirstChildElement(child);
    if (element != nullptr) return text(*element, "link", std::string("the ") + child + " of " + of);
    fail(ErrorCode::missing, joint, of + " has no <" + child + " link=\"...\"/>; add it");
    return {};
  }

  std::filesystem::path file_;
  Check error_;
};

/// What tinyxml2 found, on one line.
Error not_xml(const std::filesystem::path& file, const tinyxml2::XMLDocument& document) {
  return {.code = ErrorCode::syntax,
          .parameter = {},
          .message = std::string("is not whole XML (") + tinyxml2::XMLDocument::ErrorIDToName(document.ErrorID()) +
                     "); is the file cut off?",
          .place = place(file, document.ErrorLineNum())};
}

/// The first element of xacro at or below `root`, in the order of the file; null where there is none. Comments and
/// texts may hold what they like.
const XMLElement* first_macro(const XMLElement& root) {
  const XMLElement* at = &root;
  while (at != nullptr) {
    if (std::string_view(at->Name()).starts_with("xacro:")) return at;
    const XMLElement* next = at->FirstChildElement();
    while (next == nullptr && at != nullptr && at != &root) {
      next = at->NextSiblingElement();
      if (next != nullptr) break;
      const tinyxml2::XMLNode* const parent = at->Parent();
      at = parent == nullptr ? nullptr : parent->ToElement();
    }
    at = next;
  }
  return nullptr;
}

void read_links(const XMLElement& robot, Reader& reader, Robot& into) {
  for (const XMLElement* e = robot.FirstChildElement("link"); e != nullptr; e = e->NextSiblingElement("link")) {
    Link link{.name = reader.text(*e, "name", "a link"), .inertial = {}, .line = e->GetLineNum()};
    if (const XMLElement* inertial = e->FirstChildElement("inertial")) {
      link.inertial = reader.inertial(*inertial, "link " + in_quotes(link.name));
    }
    if (!into.link_by_name.emplace(link.name, into.links.size()).second) {
      reader.fail(ErrorCode::inconsistent, *e, "there are two links " + in_quotes(link.name) + "; rename one");
    }
    if (into.links.size() == most_elements) {
      reader.fail(ErrorCode::out_of_bounds, *e, "more than 1000 links; describe the arm alone");
    }
    if (reader.error()) return;
    into.links.push_back(std::move(link));
  }
}

void read_joints(const XMLElement& robot, Reader& reader, Robot& into) {
  std::set<std::string> names;
  for (const XMLElement* e = robot.FirstChildElement("joint"); e != nullptr; e = e->NextSiblingElement("joint")) {
    Joint joint = reader.joint(*e);
    if (!names.insert(joint.name).second) {
      reader.fail(ErrorCode::inconsistent, *e, "there are two joints " + in_quotes(joint.name) + "; rename one");
    }
    for (const std::string* link : {&joint.parent, &joint.child}) {
      if (into.link_by_name.count(*link) != 0) continue;
      reader.fail(ErrorCode::missing, *e,
                  "joint " + in_quotes(joint.name) + " names the link " + in_quotes(*link) +
                      ", which the file does not have; correct the name or add the link");
    }
    if (into.joints.size() == most_elements) {
      reader.fail(ErrorCode::out_of_bounds, *e, "more than 1000 joints; describe the arm alone");
    }
    if (reader.error()) return;
    into.joints.push_back(std::move(joint));
  }
}

}  // namespace

std::string place(const std::filesystem::path& file, int line) {
  return line > 0 ? file.string() + ":" + std::to_string(line) : file.string();
}

Result<std::string> text_of(const std::filesystem::path& file) {
  std::error_code failure;
  if (!std::filesystem::exists(file, failure)) {
    return Error{ErrorCode::missing, {}, "does not exist; name a URDF file", file.string()};
  }
  if (!std::filesystem::is_regular_file(file, failure)) {
    return Error{ErrorCode::wrong_type, {}, "is not a file; name a URDF file", file.string()};
  }
  Result<std::string> bytes = recording::file_bytes(file, most_bytes);
  if (!bytes) {
    Error error = bytes.error();
    error.place = file.string();
    return error;
  }
  return bytes;
}

Check load(const std::string& text, const std::filesystem::path& file, tinyxml2::XMLDocument& into) {
  if (into.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) return not_xml(file, into);
  const XMLElement* root = into.RootElement();
  if (root == nullptr || std::string_view(root->Name()) != "robot") {
    return Error{ErrorCode::syntax, {}, "is no URDF: its outermost element must be <robot>", file.string()};
  }
  if (const XMLElement* macro = first_macro(*root)) {
    return Error{ErrorCode::syntax,
                 {},
                 "is xacro, from which URDF is made, for it has the element <" +
                     std::string(macro->Name()).substr(0, longest_quote) +
                     ">: run `xacro FILE > arm.urdf` of ROS first",
                 place(file, macro->GetLineNum())};
  }
  return {};
}

Result<Robot> read_elements(const std::string& text, const std::filesystem::path& file) {
  tinyxml2::XMLDocument document;
  if (Check wrong = load(text, file, document)) return *std::move(wrong);
  const XMLElement* root = document.RootElement();
  Reader reader(file);
  Robot robot;
  if (const char* name = root->Attribute("name")) robot.name = name;
  read_links(*root, reader, robot);
  if (!reader.error()) read_joints(*root, reader, robot);
  if (reader.error()) return *reader.error();
  if (robot.links.empty()) {
    return Error{ErrorCode::missing, {}, "has no <link>; name the URDF of an arm", file.string()};
  }
  return robot;
}

}  // namespace tactus::urdf
