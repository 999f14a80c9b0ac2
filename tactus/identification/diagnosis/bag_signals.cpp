// SPDX-License-Identifier: Apache-2.0
#include <tactus/data/recording/limits.hpp>
#include <tactus/data/recording/names.hpp>
#include <tactus/data/recording/resample.hpp>
#include <tactus/data/recording/time_base.hpp>
#include <tactus/data/telemetry/ros_bag.hpp>
#include <tactus/identification/diagnosis/bag_signals.hpp>
#include <tactus/identification/diagnosis/columns.hpp>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string_view>
#include <utility>

namespace tactus::diagnosis {
namespace {

using telemetry::Bag;
using telemetry::BagSignal;

Error wrong_bag(ErrorCode code, const SignalRoles& roles, std::string message) {
  return {.code = code, .parameter = {}, .message = std::move(message), .place = roles.file.string()};
}

bool has_any(const std::string& topic, std::initializer_list<std::string_view> words) {
  const std::string small = lower(topic);
  return std::any_of(words.begin(), words.end(),
                     [&](std::string_view word) { return small.find(word) != std::string::npos; });
}

/// The one topic of joint positions that is called like a leader or a follower; empty for none and for several.
std::string topic_of(const Bag& bag, bool leader) {
  std::string found;
  for (const BagSignal& signal : bag.signals) {
    if (signal.quantity != "position" || signal.topic == found) continue;
    if (!(leader ? has_any(signal.topic, {"leader", "master"})
                 : has_any(signal.topic, {"follower", "slave", "puppet"})) ||
        has_any(signal.topic, {"command", "desired", "target", "goal"})) {
      continue;
    }
    if (!found.empty()) return {};
    found = signal.topic;
  }
  return found;
}

std::vector<std::string> joints_of(const Bag& bag, const std::string& topic) {
  std::vector<std::string> joints;
  for (const BagSignal& signal : bag.signals) {
    if (signal.topic == topic && signal.quantity == "position") joints.push_back(signal.joint);
  }
  return joints;
}

const BagSignal* find(const Bag& bag, const std::string& topic, const std::string& joint, std::string_view quantity) {
  const auto found = std::find_if(bag.signals.begin(), bag.signals.end(), [&](const BagSignal& signal) {
    return signal.topic == topic && signal.joint == joint && signal.quantity == quantity;
  });
  return found == bag.signals.end() ? nullptr : &*found;
}

/// How roughly a joint moves: the rms of second differences.
double roughness(const BagSignal* signal) {
  if (signal == nullptr || signal->values.size() < 3) return 0.0;
  const auto& y = signal->values;
  double squares = 0.0;
  for (std::size_t i = 2; i < y.size(); ++i) squares += std::pow(y[i] - 2.0 * y[i - 1] + y[i - 2], 2);
  return std::sqrt(squares / static_cast<double>(y.size() - 2));
}

std::string listed(const std::vector<std::string>& names) {
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  return all;
}

std::string signals_of(const Bag& bag) {
  constexpr std::size_t most_named = 12;
  std::vector<std::string> names;
  for (const BagSignal& signal : bag.signals) {
    if (names.size() < most_named) names.push_back(signal.name());
  }
  const std::size_t more = bag.signals.size() - names.size();
  return listed(names) + (more > 0 ? " and " + std::to_string(more) + " more" : "");
}

/// A joint of the leader and the one of the follower that it leads; either may be empty.
struct JointPair {
  std::string leader, follower;
};

Result<JointPair> choose_joint(const SignalRoles& roles, const Bag& bag, const std::string& leader,
                               const std::string& follower, std::vector<std::string>& notes) {
  const std::vector<std::string> of_leader = joints_of(bag, leader), of_follower = joints_of(bag, follower);
  std::vector<JointPair> pairs;
  const bool by_name = std::any_of(of_leader.begin(), of_leader.end(), [&](const std::string& joint) {
    return std::find(of_follower.begin(), of_follower.end(), joint) != of_follower.end();
  });
  for (std::size_t i = 0; i < of_leader.size(); ++i) {
    const bool has_it = std::find(of_follower.begin(), of_follower.end(), of_leader[i]) != of_follower.end();
    if (by_name && has_it) pairs.push_back({of_leader[i], of_leader[i]});
    if (!by_name && of_follower.size() == of_leader.size()) pairs.push_back({of_leader[i], of_follower[i]});
    if (of_follower.empty()) pairs.push_back({of_leader[i], ""});
  }
  for (const std::string& joint : of_follower) {
    if (of_leader.empty()) pairs.push_back({"", joint});
  }
  if (pairs.empty()) {
    return wrong_bag(ErrorCode::inconsistent, roles,
                     "no joint of " + leader + " (" + listed(of_leader) + ") is in " + follower + " (" +
                         listed(of_follower) + "): name positions with --master-position and --slave-position");
  }
  const auto named = std::find_if(pairs.begin(), pairs.end(), [&](const JointPair& pair) {
    return pair.leader == roles.joint || pair.follower == roles.joint;
  });
  if (!roles.joint.empty() && named == pairs.end()) {
    return wrong_bag(
        ErrorCode::missing, roles,
        "there is no joint '" + roles.joint + "': it has " + listed(of_leader.empty() ? of_follower : of_leader));
  }
  if (!roles.joint.empty() || pairs.size() == 1) return named == pairs.end() ? pairs.front() : *named;
  const auto rough = [&](const JointPair& pair) {
    return roughness(find(bag, leader, pair.leader, "position")) +
           roughness(find(bag, follower, pair.follower, "position"));
  };
  const auto roughest = std::max_element(pairs.begin(), pairs.end(),
                                         [&](const JointPair& a, const JointPair& b) { return rough(a) < rough(b); });
  std::vector<std::string> names;
  for (const JointPair& pair : pairs) names.push_back(pair.leader.empty() ? pair.follower : pair.leader);
  notes.push_back("joint '" + (roughest->leader.empty() ? roughest->follower : roughest->leader) +
                  "' moves most roughly and was taken, of " + listed(names) + "; name another with --joint");
  return *roughest;
}

double variance(const std::vector<double>& values) {
  double mean = 0.0, squares = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  for (const double value : values) squares += (value - mean) * (value - mean);
  return squares / static_cast<double>(values.size());
}

/// The component of the force at the follower's tip that changes most; null where no topic, or more than one, has one.
const BagSignal* tip_force_of(const Bag& bag) {
  std::vector<std::string> topics, of_follower;
  for (const BagSignal& signal : bag.signals) {
    if (signal.quantity != "force.x") continue;
    topics.push_back(signal.topic);
    if (has_any(signal.topic, {"follower", "slave", "puppet", "tip", "env"})) of_follower.push_back(signal.topic);
  }
  const std::vector<std::string>& chosen = of_follower.size() == 1 ? of_follower : topics;
  if (chosen.size() != 1 || has_any(chosen.front(), {"leader", "master", "hand"})) return nullptr;
  const BagSignal* most = nullptr;
  for (const char* component : {"force.x", "force.y", "force.z"}) {
    const BagSignal* const one = find(bag, chosen.front(), "", component);
    if (one != nullptr && (most == nullptr || variance(one->values) > variance(most->values))) most = one;
  }
  return most;
}

/// A signal and the role that it plays.
struct Chosen {
  Role role;
  const BagSignal* signal;
  bool named;  ///< by the caller, so that its sign is theirs
};

Result<std::vector<Chosen>> choose(const SignalRoles& roles, const Bag& bag, std::vector<std::string>& notes) {
  std::vector<Chosen> chosen;
  for (const Role role : all_roles) {
    const std::string& name = roles.names[index_of(role)];
    if (name.empty()) continue;
    const auto found = std::find_if(bag.signals.begin(), bag.signals.end(), [&](const BagSignal& signal) {
      return signal.name() == name || signal.name() == "/" + name;
    });
    if (found == bag.signals.end()) {
      return wrong_bag(ErrorCode::missing, roles, "the bag has no '" + name + "'; it has: " + signals_of(bag));
    }
    chosen.push_back({role, &*found, true});
  }
  const std::string leader = topic_of(bag, true), follower = topic_of(bag, false);
  const bool position_named =
      std::any_of(chosen.begin(), chosen.end(), [](const Chosen& c) { return is_position(c.role); });
  if (position_named) return chosen;
  if (leader.empty() && follower.empty()) {
    return wrong_bag(
        ErrorCode::missing, roles,
        "no topic of joint states, or more than one, is called like a leader or a follower: name positions "
        "with --master-position and --slave-position as TOPIC/JOINT.position; it has: " +
            signals_of(bag));
  }
  const Result<JointPair> joint = choose_joint(roles, bag, leader, follower, notes);
  if (!joint) return joint.error();
  const auto add = [&](Role role, const BagSignal* signal) {
    const bool is_chosen = std::any_of(chosen.begin(), chosen.end(), [&](const Chosen& c) { return c.role == role; });
    if (signal != nullptr && !is_chosen) chosen.push_back({role, signal, false});
  };
  add(Role::master_position, find(bag, leader, joint->leader, "position"));
  add(Role::slave_position, find(bag, follower, joint->follower, "position"));
  add(Role::displayed_force, find(bag, leader, joint->leader, "effort"));
  add(Role::slave_force, find(bag, follower, joint->follower, "effort"));
  // Along one joint a force at the tip is that of the joint; of an arm of several it is not.
  if (joints_of(bag, follower).size() == 1) add(Role::tip_force, tip_force_of(bag));
  return chosen;
}

Check check_signal(const SignalRoles& roles, const BagSignal& signal) {
  constexpr double longest_pause_steps = 10.0, longest_pause_s = 0.03;
  const auto& t = signal.time_s;
  if (t.size() < 3) {
    return wrong_bag(ErrorCode::inconsistent, roles, signal.name() + " has fewer than three messages");
  }
  const double step_s = (t.back() - t.front()) / static_cast<double>(t.size() - 1);
  for (std::size_t i = 0; i < t.size(); ++i) {
    const std::string where = "message " + std::to_string(i + 1) + " of " + signal.name();
    if (!(std::fabs(signal.values[i]) <= recording::largest_value)) {
      return wrong_bag(ErrorCode::inconsistent, roles,
                       where + " is not finite, or is beyond 1e30, which is no measurement: cut the bag there");
    }
    if (i == 0) continue;
    if (!(t[i] > t[i - 1])) {
      return wrong_bag(ErrorCode::inconsistent, roles,
                       where + " is not later than the one before: does more than one node publish the topic?");
    }
    if (t[i] - t[i - 1] > std::max(longest_pause_steps * step_s, longest_pause_s)) {
      return wrong_bag(ErrorCode::inconsistent, roles,
                       where + " comes " + recording::significant(t[i] - t[i - 1]) +
                           " s after the one before, where the mean step is " + recording::significant(step_s) +
                           " s: cut the bag there, or record again");
    }
  }
  return std::nullopt;
}

/// -1 to 1: of means over a quarter of a second, since what oscillates has a phase between the two.
double slow_correlation(const std::vector<double>& x, const std::vector<double>& y, double sample_time_s) {
  constexpr double stretch_s = 0.25;
  const auto stretch = std::max<std::size_t>(1, static_cast<std::size_t>(stretch_s / sample_time_s));
  double n = 0.0, sx = 0.0, sy = 0.0, xx = 0.0, yy = 0.0, xy = 0.0;
  for (std::size_t first = 0; first + stretch <= x.size(); first += stretch) {
    double mean_x = 0.0, mean_y = 0.0;
    for (std::size_t i = first; i < first + stretch; ++i) {
      mean_x += x[i] / static_cast<double>(stretch);
      mean_y += y[i] / static_cast<double>(stretch);
    }
    n += 1.0, sx += mean_x, sy += mean_y;
    xx += mean_x * mean_x, yy += mean_y * mean_y, xy += mean_x * mean_y;
  }
  if (n < 3.0) return 0.0;
  const double squares = (xx - sx * sx / n) * (yy - sy * sy / n);
  return squares > 0.0 ? (xy - sx * sy / n) / std::sqrt(squares) : 0.0;
}

/// Turns forces so that they count as `Role` says. The leader shows what the follower's motor pushes with, so the two
/// go together; an effort as ROS has it, toward a growing position, goes against the follower's. The axes of a sensor
/// are its own: its force goes with the displayed one.
void turn_forces(BagChannels& made) {
  constexpr double surely_alike = 0.2;
  const auto channel = [&](Role role) -> BagChannel* {
    const auto found = std::find_if(made.channels.begin(), made.channels.end(),
                                    [role](const BagChannel& c) { return c.role == role; });
    return found == made.channels.end() || found->named ? nullptr : &*found;
  };
  const auto turn = [](BagChannel& one) {
    for (double& value : one.values) value = -value;
  };
  BagChannel* const displayed = channel(Role::displayed_force);
  BagChannel* const tip = channel(Role::tip_force);
  const BagChannel* const slave = channel(Role::slave_force);
  if (displayed != nullptr) {
    const bool alike =
        slave != nullptr && slow_correlation(displayed->values, slave->values, made.sample_time_s) > surely_alike;
    if (!alike) turn(*displayed);
    made.notes.push_back("'" + displayed->name + "' was taken for the displayed force, " +
                         (alike ? "as it is, for it goes with the follower's effort"
                                : "turned round, so that it counts where it pushes the hand back") +
                         "; --displayed-force-sign -1 turns it");
  }
  if (tip != nullptr) {
    const bool against =
        displayed != nullptr && slow_correlation(tip->values, displayed->values, made.sample_time_s) < 0.0;
    if (against) turn(*tip);
    made.notes.push_back("'" + tip->name + "' changes most and was taken for the tip force" +
                         (against ? ", turned round so that it goes with the displayed force" : ""));
  }
}

}  // namespace

Result<BagChannels> read_bag_channels(const SignalRoles& roles) {
  const auto bag = telemetry::read_bag(roles.file);
  if (!bag) return bag.error();
  BagChannels made;
  const auto chosen = choose(roles, *bag, made.notes);
  if (!chosen) return chosen.error();
  double first_s = 0.0, last_s = 1e300, step_s = 1e300;
  for (const Chosen& one : *chosen) {
    if (Check wrong = check_signal(roles, *one.signal)) return *std::move(wrong);
    const auto& t = one.signal->time_s;
    first_s = std::max(first_s, t.front());
    last_s = std::min(last_s, t.back());
    step_s = std::min(step_s, (t.back() - t.front()) / static_cast<double>(t.size() - 1));
    const std::optional<double> jitter_s = recording::jitter_of(t);
    constexpr double worth_telling = 0.1;
    if (jitter_s && *jitter_s > worth_telling * step_s)
      made.jitter_s = std::max(made.jitter_s.value_or(0.0), *jitter_s);
  }
  if (!(last_s > first_s)) {
    return wrong_bag(ErrorCode::inconsistent, roles, "the signals share no time: record all topics together");
  }
  made.sample_time_s = step_s;
  const auto count = 1 + static_cast<std::size_t>((last_s - first_s) / step_s + 1e-9);
  const auto at_common_steps = [&](const BagSignal& signal) {
    return recording::at_steps(signal.time_s, signal.values, first_s, step_s, count);
  };
  std::vector<std::string> used_topics;
  for (const Chosen& one : *chosen) {
    BagChannel channel{.role = one.role,
                       .name = one.signal->name(),
                       .unit = one.signal->unit,
                       .named = one.named,
                       .values = at_common_steps(*one.signal),
                       .step = resolution_of(one.role, one.signal->values)};
    const BagSignal* const velocity = find(*bag, one.signal->topic, one.signal->joint, "velocity");
    if (is_position(one.role) && velocity != nullptr && !check_signal(roles, *velocity)) {
      channel.velocity = at_common_steps(*velocity);
      channel.velocity_name = velocity->name();
    }
    used_topics.push_back(one.signal->topic);
    made.channels.push_back(std::move(channel));
  }
  turn_forces(made);
  std::vector<std::string> unused = bag->ignored;
  for (const BagSignal& signal : bag->signals) {
    if (std::find(used_topics.begin(), used_topics.end(), signal.topic) != used_topics.end()) continue;
    used_topics.push_back(signal.topic);
    unused.push_back(signal.topic);
  }
  if (!unused.empty()) made.notes.push_back("topics not used: " + listed(unused));
  if (!bag->complete) made.notes.push_back("the bag has no end: what its recorder had not written yet is missing");
  if (bag->damaged_chunks > 0) {
    made.notes.push_back(std::to_string(bag->damaged_chunks) + " damaged chunks of the bag were left out");
  }
  return made;
}

}  // namespace tactus::diagnosis
