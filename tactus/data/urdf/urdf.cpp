// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/urdf/elements.hpp>
#include <tactus/data/urdf/urdf.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace tactus::urdf {
namespace {

using arm::LinkPose;
using arm::Matrix3;
using arm::Vector3;

LinkPose pose_of(const arm::JointOrigin& origin) {
  return {arm::rotation_of(origin), Vector3(origin.x_m, origin.y_m, origin.z_m)};
}

LinkPose after(const LinkPose& first, const LinkPose& second) {
  return {first.rotation * second.rotation, first.position_m + first.rotation * second.position_m};
}

/// The body in the frame that `frame` is given in.
arm::Body placed(const Inertial& inertial, const LinkPose& frame) {
  const LinkPose at = after(frame, pose_of(inertial.origin));
  const arm::Body& m = inertial.moments;
  Matrix3 inertia;
  inertia << m.xx_kg_m2, m.xy_kg_m2, m.xz_kg_m2, m.xy_kg_m2, m.yy_kg_m2, m.yz_kg_m2, m.xz_kg_m2, m.yz_kg_m2, m.zz_kg_m2;
  const Matrix3 turned = at.rotation * inertia * at.rotation.transpose();
  return {.mass_kg = inertial.mass_kg,
          .centre_x_m = at.position_m.x(),
          .centre_y_m = at.position_m.y(),
          .centre_z_m = at.position_m.z(),
          .xx_kg_m2 = turned(0, 0),
          .yy_kg_m2 = turned(1, 1),
          .zz_kg_m2 = turned(2, 2),
          .xy_kg_m2 = turned(0, 1),
          .xz_kg_m2 = turned(0, 2),
          .yz_kg_m2 = turned(1, 2)};
}

/// An origin with this pose; the turns as roll, pitch and yaw.
arm::JointOrigin origin_of(const LinkPose& pose) {
  const Matrix3& r = pose.rotation;
  const double across = std::hypot(r(0, 0), r(1, 0));
  arm::JointOrigin origin{.x_m = pose.position_m.x(), .y_m = pose.position_m.y(), .z_m = pose.position_m.z()};
  origin.pitch_rad = std::atan2(-r(2, 0), across);
  if (across > 1e-9) {
    origin.roll_rad = std::atan2(r(2, 1), r(2, 2));
    origin.yaw_rad = std::atan2(r(1, 0), r(0, 0));
  } else {
    origin.roll_rad = std::atan2(-r(1, 2), r(1, 1));
  }
  return origin;
}

bool moves(const Joint& joint) { return joint.type != "fixed"; }

/// Walks from link to link and gathers what belongs to one body.
class Walk {
 public:
  Walk(const Robot& robot, const std::filesystem::path& file) : robot_(robot), file_(file) {
    for (std::size_t i = 0; i < robot.joints.size(); ++i) children_[robot.joints[i].parent].push_back(i);
  }

  [[nodiscard]] Error error(ErrorCode code, int line, std::string message) const {
    return {.code = code, .parameter = {}, .message = std::move(message), .place = place(file_, line)};
  }

  Result<std::string> root() const {
    std::set<std::string> moved;
    for (const Joint& joint : robot_.joints) {
      if (moved.insert(joint.child).second) continue;
      return error(ErrorCode::inconsistent, joint.line,
                   "link '" + joint.child + "' is the child of two joints; an arm is a tree, so remove one");
    }
    std::string found;
    for (const Link& link : robot_.links) {
      if (moved.count(link.name) != 0) continue;
      if (!found.empty()) {
        return error(ErrorCode::inconsistent, link.line,
                     "the links '" + found + "' and '" + link.name +
                         "' are both the child of no joint; join them or remove one");
      }
      found = link.name;
    }
    if (!found.empty()) return found;
    return error(ErrorCode::inconsistent, robot_.joints.front().line,
                 "every link is the child of a joint: the joints go in a circle, so there is no base");
  }

  /// The joints that lead to `tip`.
  Result<std::set<std::size_t>> path_to(const std::string& tip) const {
    if (robot_.link_by_name.count(tip) == 0) {
      return error(ErrorCode::missing, 0, "has no link '" + tip + "'; name one of its links as the tip");
    }
    std::set<std::size_t> path;
    std::string at = tip;
    for (std::size_t steps = 0; steps <= robot_.joints.size(); ++steps) {
      const auto joint = std::find_if(robot_.joints.begin(), robot_.joints.end(),
                                      [&](const Joint& candidate) { return candidate.child == at; });
      if (joint == robot_.joints.end()) break;
      path.insert(static_cast<std::size_t>(joint - robot_.joints.begin()));
      at = joint->parent;
    }
    return path;
  }

  /// What is fixed together, seen from the frame of its first link.
  struct Group {
    arm::BodyVector body = arm::BodyVector::Zero();
    bool has_body = false;
    std::vector<LinkFrame> frames;
    std::vector<Error> impossible;  ///< bodies that cannot be
    std::vector<std::pair<std::size_t, LinkPose>>
        onward;  ///< joints that move, and the frames of the links they are on
  };

  /// `path`: the only joints that move; none: all that are not fixed.
  Result<Group> group(const std::string& first, const std::set<std::size_t>* path) const {
    Group found;
    std::vector<std::pair<std::string, LinkPose>> open{{first, LinkPose{}}};
    for (std::size_t visited = 0; !open.empty(); ++visited) {
      const auto [name, pose] = open.back();
      open.pop_back();
      if (visited > robot_.links.size()) {
        return error(ErrorCode::inconsistent, 0, "its fixed joints go in a circle at link '" + name + "'");
      }
      const Link& link = robot_.links[robot_.link_by_name.at(name)];
      found.frames.push_back({name, pose.position_m});
      if (link.inertial) {
        const arm::Body body = placed(*link.inertial, pose);
        if (link.inertial->fault) {
          found.impossible.push_back(*link.inertial->fault);
        } else if (Check wrong = arm::check(link.inertial->moments)) {
          found.impossible.push_back(error(wrong->code, link.inertial->line, "link '" + name + "': " + wrong->message));
        }
        found.body += arm::linear_parameters(body);
        found.has_body = true;
      }
      const auto children = children_.find(name);
      if (children == children_.end()) continue;
      for (const std::size_t index : children->second) {
        const Joint& joint = robot_.joints[index];
        const bool moving = path == nullptr ? moves(joint) : moves(joint) && path->count(index) != 0;
        if (moving) {
          found.onward.emplace_back(index, pose);
        } else {
          open.emplace_back(joint.child, after(pose, pose_of(joint.origin)));
        }
      }
    }
    return found;
  }

 private:
  const Robot& robot_;
  const std::filesystem::path& file_;
  std::map<std::string, std::vector<std::size_t>> children_;
};

Check check_joint(const Walk& walk, const Joint& joint) {
  if (joint.mimics) {
    return walk.error(ErrorCode::inconsistent, joint.line,
                      "joint '" + joint.name +
                          "' mimics another; every joint of the chain must move by itself, so make it fixed, or name a "
                          "link before it with --tip");
  }
  if (joint.type == "revolute" || joint.type == "continuous" || joint.type == "prismatic") {
    if (joint.axis.x != 0.0 || joint.axis.y != 0.0 || joint.axis.z != 0.0) return {};
    return walk.error(ErrorCode::inconsistent, joint.line,
                      "the axis of joint '" + joint.name + "' is 0 0 0; state its direction");
  }
  return walk.error(ErrorCode::inconsistent, joint.line,
                    "joint '" + joint.name + "' is '" + joint.type +
                        "'; a joint of the chain must be revolute, continuous, prismatic or fixed");
}

/// A limit of 0 is what exporters write where nobody entered one.
Check take_limits(const Walk& walk, const Joint& joint, Arm& into, arm::JointLimits& limits) {
  const bool slides = joint.type == "prismatic";
  const std::string of = "joint '" + joint.name + "'";
  const std::string unit = slides ? " m" : " rad";
  if (limits.lower_rad > limits.upper_rad) {
    return walk.error(ErrorCode::inconsistent, joint.line,
                      of + " has the limits lower=" + rounded_number(limits.lower_rad) + " and upper=" +
                          rounded_number(limits.upper_rad) + unit + ", which leave no position; exchange them");
  }
  const auto doubt = [&](const std::string& why) {
    into.doubtful_limits.push_back(describe(walk.error(ErrorCode::inconsistent, joint.line, of + why)));
  };
  const arm::JointLimits unstated;
  if (limits.lower_rad == limits.upper_rad) {
    doubt(" has a range from " + rounded_number(limits.lower_rad) + " to " + rounded_number(limits.upper_rad) + unit +
          ", in which it cannot move: its range counts as not stated; write lower and upper");
    limits.lower_rad = unstated.lower_rad;
    limits.upper_rad = unstated.upper_rad;
  } else if (joint.type != "continuous" && !joint.has_range) {
    doubt(" states no range; write <limit lower=\"\" upper=\"\" velocity=\"\" effort=\"\"/>");
  }
  if (limits.effort_N_m == 0.0) {
    doubt(std::string(" has an effort limit of 0 ") + (slides ? "N" : "N m") +
          ", with which it cannot move: it counts as not stated; write effort");
    limits.effort_N_m = unstated.effort_N_m;
  }
  if (limits.velocity_rad_per_s == 0.0) {
    doubt(" has a velocity limit of 0" + unit +
          "/s, with which it cannot move: it counts as not stated; write velocity");
    limits.velocity_rad_per_s = unstated.velocity_rad_per_s;
  }
  return {};
}

arm::JointParams params_of(const Joint& joint, const LinkPose& frame, const arm::BodyVector& body) {
  arm::JointParams params;
  params.kind = joint.type == "prismatic" ? arm::JointKind::prismatic : arm::JointKind::revolute;
  params.origin = origin_of(after(frame, pose_of(joint.origin)));
  params.axis = joint.axis;
  params.body = arm::body_of(body);
  params.friction.coulomb_N_m = joint.friction;
  params.friction.viscous_N_m_s_per_rad = joint.damping;
  params.limits = joint.limits;
  return params;
}

}  // namespace

Result<Arm> read(const std::filesystem::path& file, const std::string& tip) {
  const Result<std::string> text = text_of(file);
  return text ? parse(*text, file, tip) : text.error();
}

Result<Arm> parse(const std::string& text, const std::filesystem::path& file, const std::string& tip) {
  const Result<Robot> robot = read_elements(text, file);
  if (!robot) return robot.error();
  const Walk walk(*robot, file);
  const Result<std::string> root = walk.root();
  if (!root) return root.error();
  std::set<std::size_t> path;
  if (!tip.empty()) {
    Result<std::set<std::size_t>> found = walk.path_to(tip);
    if (!found) return found.error();
    path = *std::move(found);
  }
  Arm made{.name = robot->name, .base = *root};
  std::vector<arm::JointParams> joints;
  Result<Walk::Group> group = walk.group(*root, tip.empty() ? nullptr : &path);
  if (group) {
    for (const Error& wrong : group->impossible) {
      made.warnings.push_back(describe(wrong) + " (this body moves no joint, so it does not count)");
    }
  }
  while (group && !group->onward.empty()) {
    const auto [index, frame] = group->onward.front();
    const Joint& joint = robot->joints[index];
    if (group->onward.size() > 1) {
      const Joint& other = robot->joints[group->onward[1].first];
      return walk.error(ErrorCode::inconsistent, other.line,
                        "the arm branches: joints '" + joint.name + "' and '" + other.name +
                            "' both move what is behind link '" + joint.parent +
                            "'; name the link at which the arm ends with --tip");
    }
    if (Check wrong = check_joint(walk, joint)) return *std::move(wrong);
    if (joints.size() == most_joints) {
      return walk.error(ErrorCode::inconsistent, joint.line,
                        "joint '" + joint.name +
                            "' is the ninth that moves; up to 8 are read, so end the arm before it "
                            "with --tip, or make joints fixed");
    }
    group = walk.group(joint.child, tip.empty() ? nullptr : &path);
    if (!group) break;
    if (!group->has_body) {
      const Link& link = robot->links[robot->link_by_name.at(joint.child)];
      return walk.error(ErrorCode::missing, link.line,
                        "link '" + link.name + "', which joint '" + joint.name +
                            "' moves, has no <inertial>, nor has anything fixed to it; add mass, centre and inertia");
    }
    if (!group->impossible.empty()) return group->impossible.front();
    joints.push_back(params_of(joint, frame, group->body));
    if (Check wrong = take_limits(walk, joint, made, joints.back().limits)) return *std::move(wrong);
    made.joints.push_back(joint.name);
    made.links.push_back(joint.child);
    made.frames.push_back(group->frames);
  }
  if (!group) return group.error();
  if (joints.empty()) {
    return walk.error(ErrorCode::missing, 0,
                      tip.empty() ? "has no joint that moves; name the URDF of an arm"
                                  : "has no moving joint between '" + *root + "' and '" + tip + "'; name another tip");
  }
  made.params.joints = Joints<arm::JointParams>(joints.size());
  std::copy(joints.begin(), joints.end(), made.params.joints.begin());
  // A product with rounding may leave a moment of a point mass just below zero.
  for (arm::JointParams& joint : made.params.joints) {
    for (double arm::Body::*moment : {&arm::Body::xx_kg_m2, &arm::Body::yy_kg_m2, &arm::Body::zz_kg_m2}) {
      joint.body.*moment = std::max(0.0, joint.body.*moment);
    }
  }
  const Result<arm::Chain> chain = arm::Chain::make(made.params);
  if (!chain) {
    Error error = chain.error();
    error.place = file.string();
    return error;
  }
  return made;
}

}  // namespace tactus::urdf
