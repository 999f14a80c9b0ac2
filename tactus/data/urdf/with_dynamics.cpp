// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/urdf/elements.hpp>
#include <tactus/data/urdf/urdf.hpp>

#include <algorithm>
#include <array>
#include <cstdio>
#include <initializer_list>

#include <tinyxml2.h>

namespace tactus::urdf {
namespace {

using tinyxml2::XMLElement;

/// Digits that read back as the same number.
std::string exact(std::initializer_list<double> values) {
  std::string text;
  std::array<char, 32> buffer{};
  for (const double value : values) {
    std::snprintf(buffer.data(), buffer.size(), "%.17g", value);
    text += text.empty() ? "" : " ";
    text += buffer.data();
  }
  return text;
}

void put_body(XMLElement& link, const arm::Body& body) {
  XMLElement* inertial = link.InsertNewChildElement("inertial");
  inertial->InsertNewChildElement("origin")->SetAttribute(
      "xyz", exact({body.centre_x_m, body.centre_y_m, body.centre_z_m}).c_str());
  inertial->InsertNewChildElement("mass")->SetAttribute("value", exact({body.mass_kg}).c_str());
  XMLElement* inertia = inertial->InsertNewChildElement("inertia");
  inertia->SetAttribute("ixx", exact({body.xx_kg_m2}).c_str());
  inertia->SetAttribute("ixy", exact({body.xy_kg_m2}).c_str());
  inertia->SetAttribute("ixz", exact({body.xz_kg_m2}).c_str());
  inertia->SetAttribute("iyy", exact({body.yy_kg_m2}).c_str());
  inertia->SetAttribute("iyz", exact({body.yz_kg_m2}).c_str());
  inertia->SetAttribute("izz", exact({body.zz_kg_m2}).c_str());
}

/// Writes the axis and the range of a joint that counts the other way than the file states.
void reverse_element(XMLElement& joint, const Joint& stated) {
  XMLElement* axis = joint.FirstChildElement("axis");
  if (axis == nullptr) axis = joint.InsertNewChildElement("axis");
  axis->SetAttribute("xyz", exact({-stated.axis.x, -stated.axis.y, -stated.axis.z}).c_str());
  XMLElement* limit = joint.FirstChildElement("limit");
  if (limit == nullptr || !stated.has_range) return;
  limit->SetAttribute("lower", exact({-stated.limits.upper_rad}).c_str());
  limit->SetAttribute("upper", exact({-stated.limits.lower_rad}).c_str());
}

}  // namespace

Result<std::string> with_dynamics(const std::filesystem::path& file, const Arm& arm, const std::string& comment) {
  tinyxml2::XMLDocument document;
  const auto text = text_of(file);
  if (!text) return text.error();
  if (Check wrong = load(*text, file, document)) return *std::move(wrong);
  const auto stated = read_elements(*text, file);
  if (!stated) return stated.error();
  XMLElement* robot = document.RootElement();
  for (XMLElement* link = robot->FirstChildElement("link"); link != nullptr; link = link->NextSiblingElement("link")) {
    const std::string name = link->Attribute("name") != nullptr ? link->Attribute("name") : "";
    for (std::size_t j = 0; j < arm.frames.size(); ++j) {
      const auto& body = arm.frames[j];
      if (std::none_of(body.begin(), body.end(), [&](const LinkFrame& frame) { return frame.name == name; })) continue;
      while (XMLElement* old = link->FirstChildElement("inertial")) link->DeleteChild(old);
      if (body.front().name == name) put_body(*link, arm.params.joints[j].body);
    }
  }
  for (XMLElement* joint = robot->FirstChildElement("joint"); joint != nullptr;
       joint = joint->NextSiblingElement("joint")) {
    const char* name = joint->Attribute("name");
    const auto found = std::find(arm.joints.begin(), arm.joints.end(), name != nullptr ? name : "");
    if (found == arm.joints.end()) continue;
    const arm::JointParams& params = arm.params.joints[static_cast<std::size_t>(found - arm.joints.begin())];
    const auto before = std::ranges::find(stated->joints, *found, &Joint::name);
    if (before != stated->joints.end() &&
        params.axis.x * before->axis.x + params.axis.y * before->axis.y + params.axis.z * before->axis.z < 0.0) {
      reverse_element(*joint, *before);
    }
    const arm::JointFriction& friction = params.friction;
    XMLElement* dynamics = joint->FirstChildElement("dynamics");
    if (dynamics == nullptr) dynamics = joint->InsertNewChildElement("dynamics");
    dynamics->SetAttribute("damping", exact({friction.viscous_N_m_s_per_rad}).c_str());
    dynamics->SetAttribute("friction", exact({friction.coulomb_N_m}).c_str());
  }
  robot->InsertFirstChild(document.NewComment((" " + comment + " ").c_str()));
  tinyxml2::XMLPrinter printer;
  document.Print(&printer);
  return std::string(printer.CStr());
}

}  // namespace tactus::urdf
