// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/architecture.hpp>
#include <tactus/kernel/core/spelling.hpp>

#include <algorithm>
#include <vector>

/// The architectures of this library, in the order in which they are listed: a line here, and in the folder
/// `architectures` the function that it names, which makes the `Architecture`.
#define TACTUS_ARCHITECTURES(NAME)             \
  NAME(position_force_architecture)            \
  NAME(position_position_architecture)         \
  NAME(projection_architecture)                \
  NAME(shared_compliant_architecture)          \
  NAME(four_channel_architecture)              \
  NAME(four_channel_cancellation_architecture) \
  NAME(wave_variables_architecture)            \
  NAME(time_domain_passivity_architecture)     \
  NAME(energy_tank_architecture)

namespace tactus::control {

#define TACTUS_DECLARE(name) Architecture name();
TACTUS_ARCHITECTURES(TACTUS_DECLARE)
#undef TACTUS_DECLARE

namespace {

std::vector<Architecture>& registry() {
#define TACTUS_MADE(name) name(),
  static std::vector<Architecture> all{TACTUS_ARCHITECTURES(TACTUS_MADE)};
#undef TACTUS_MADE
  return all;
}

Error unknown_architecture(const std::string& name) {
  std::vector<std::string_view> names;
  std::string list;
  for (const Architecture& architecture : registry()) {
    names.push_back(architecture.name);
    list += (list.empty() ? "" : ", ") + std::string(architecture.name);
  }
  const std::string_view meant = nearest_word(name, names);
  std::string message = "'";
  message += name + "' is no architecture: write one of " + list;
  if (!meant.empty()) message += "; did you mean '" + std::string(meant) + "'?";
  return {.code = ErrorCode::out_of_bounds, .parameter = "architecture", .message = message, .place = {}};
}

/// Whether the group of `architecture` can have its name in a file.
Check check_group(const Architecture& architecture) {
  const OwnKeys& keys = architecture.keys;
  const std::string_view group = keys.group;
  const auto refused = [&](const std::string& why) {
    std::string message = "the group '";
    message.append(group).append("' of the architecture ").append(architecture.name).append(" ").append(why);
    return Error{.code = ErrorCode::inconsistent, .parameter = {}, .message = message, .place = {}};
  };
  const bool bare = !group.empty() && std::all_of(group.begin(), group.end(), [](char letter) {
    return (letter >= 'a' && letter <= 'z') || (letter >= '0' && letter <= '9') || letter == '_';
  });
  if (!bare) return refused("has no name that a file can hold: write small letters, digits and underscores");
  bool common = false;
  for_each_field<ControlParams>([&](const auto& f) { common = common || group == f.name; });
  if (common) return refused("bears the name of a key that every architecture has: give it another one");
  for (const Architecture& other : registry()) {
    if (other.keys.make == nullptr || other.name == architecture.name) continue;
    const bool same_name = group == other.keys.group, same_type = *keys.type == *other.keys.type;
    if (same_name == same_type) continue;
    const std::string owner = std::string("that ").append(other.name);
    if (same_name) return refused(std::string("bears the name of the one ") + owner + " has: give it another one");
    return refused(std::string("has the type of '") + other.keys.group + "', " + owner +
                   " has: give it that name or a type of its own");
  }
  return {};
}

/// Puts the estimator that `params` ask for, if any, in place of the slave's force sensor.
Check estimate_slave_force(const ControlParams& params, const Architecture& architecture, Seconds dt,
                           Controllers& controllers) {
  if (params.slave_force.source == SlaveForceSource::sensor) return {};
  if (!architecture.uses_tip_force) {
    return Error{.code = ErrorCode::inconsistent,
                 .parameter = "slave_force.source",
                 .message = "the architecture " + std::string(architecture.name) +
                            " does not use the slave's tip force: leave the source at sensor, or choose another one",
                 .place = {}};
  }
  const auto force = SlaveForce::make(params.slave_force, dt);
  if (!force) return under("slave_force", force.error());
  controllers.slave = std::make_unique<EstimatingSlave>(*force, std::move(controllers.slave));
  return {};
}

/// All that the sites of one joint are made of.
struct Parts {
  Controllers controllers;
  MasterGates master;
  SlaveGates slave;
};

Result<Parts> make_parts(const ControlParams& params, Seconds dt) {
  if (auto error = validate(params)) return *std::move(error);
  const Architecture* chosen = find_architecture(params.architecture);
  if (chosen == nullptr) return unknown_architecture(params.architecture);
  auto controllers = chosen->make(params, dt);
  if (!controllers) return controllers.error();
  if (auto error = estimate_slave_force(params, *chosen, dt, *controllers)) return *std::move(error);
  const auto gate = SafetyGate::make(params.gate, dt);
  if (!gate) return under("gate", gate.error());
  const auto handle_gate = ForceGate::make(params.handle_gate, dt);
  if (!handle_gate) return under("handle_gate", handle_gate.error());
  const auto slave_gate = SafetyGate::make(params.slave_gate, dt);
  if (!slave_gate) return under("slave_gate", slave_gate.error());
  return Parts{*std::move(controllers), {*gate, *handle_gate}, *slave_gate};
}

/// One controller for each joint, none of which knows of the others.
template <class Input, class Output>
class IndependentJoints final : public SiteController<Joints<Input>, Joints<Output>> {
 public:
  using OfOneJoint = std::vector<std::unique_ptr<SiteController<Input, Output>>>;
  explicit IndependentJoints(OfOneJoint joints) : joints_(std::move(joints)) {}

  Joints<Output> respond(const Joints<Input>& input) noexcept override {
    Joints<Output> output(joints_.size());
    for (std::size_t joint = 0; joint < joints_.size(); ++joint) output[joint] = joints_[joint]->respond(input[joint]);
    return output;
  }
  void applied(Joints<double> motor_force_N) noexcept override {
    for (std::size_t joint = 0; joint < joints_.size(); ++joint) joints_[joint]->applied(motor_force_N[joint]);
  }
  void reset() noexcept override {
    for (const auto& joint : joints_) joint->reset();
  }
  [[nodiscard]] std::optional<double> force_gain() const noexcept override { return joints_.front()->force_gain(); }
  void set_force_gain(double gain) noexcept override {
    for (const auto& joint : joints_) joint->set_force_gain(gain);
  }
  [[nodiscard]] std::unique_ptr<SiteController<Joints<Input>, Joints<Output>>> clone() const override {
    OfOneJoint copies;
    for (const auto& joint : joints_) copies.push_back(joint->clone());
    return std::make_unique<IndependentJoints>(std::move(copies));
  }

 private:
  OfOneJoint joints_;
};

}  // namespace

std::span<const Architecture> architectures() { return registry(); }

const Architecture* find_architecture(std::string_view name) {
  const auto& all = registry();
  const auto found = std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == name; });
  return found == all.end() ? nullptr : &*found;
}

std::vector<OwnKeys> registered_keys() {
  std::vector<OwnKeys> all;
  for (const Architecture& architecture : registry()) {
    const OwnKeys& keys = architecture.keys;
    if (keys.make == nullptr) continue;
    const bool shared =
        std::any_of(all.begin(), all.end(), [&](const OwnKeys& other) { return *other.type == *keys.type; });
    if (!shared) all.push_back(keys);
  }
  return all;
}

Check register_architecture(const Architecture& architecture) {
  if (architecture.keys.make != nullptr) {
    if (auto error = check_group(architecture)) return error;
  }
  auto& all = registry();
  const auto same =
      std::find_if(all.begin(), all.end(), [&](const auto& other) { return other.name == architecture.name; });
  if (same != all.end()) {
    *same = architecture;
  } else {
    all.push_back(architecture);
  }
  return {};
}

Result<Sites> make_sites(const ControlParams& params, Seconds dt) {
  auto parts = make_parts(params, dt);
  if (!parts) return parts.error();
  return Sites{MasterSite(std::move(parts->controllers.master), parts->master),
               SlaveSite(std::move(parts->controllers.slave), parts->slave)};
}

Result<JointSites> make_sites(const JointParams auto& params, Seconds dt) {
  std::vector<std::unique_ptr<MasterController>> masters;
  std::vector<std::unique_ptr<SlaveController>> slaves;
  std::optional<Joints<MasterGates>> master_gates;
  std::optional<Joints<SlaveGates>> slave_gates;
  for (std::size_t joint = 0; joint < params.size(); ++joint) {
    auto parts = make_parts(params[joint], dt);
    if (!parts) return under_joint<Joints<ControlParams>>(joint, parts.error());
    masters.push_back(std::move(parts->controllers.master));
    slaves.push_back(std::move(parts->controllers.slave));
    if (!master_gates) master_gates.emplace(params.size(), parts->master);
    if (!slave_gates) slave_gates.emplace(params.size(), parts->slave);
    (*master_gates)[joint] = parts->master;
    (*slave_gates)[joint] = parts->slave;
  }
  if (!master_gates) {
    return Error{.code = ErrorCode::out_of_bounds,
                 .parameter = "joints",
                 .message = "does not exist: a device has 1 to " + std::to_string(most_joints),
                 .place = {}};
  }
  using Master = IndependentJoints<MasterInput, MasterOutput>;
  using Slave = IndependentJoints<SlaveInput, SlaveOutput>;
  return JointSites{JointMasterSite(std::make_unique<Master>(std::move(masters)), *master_gates),
                    JointSlaveSite(std::make_unique<Slave>(std::move(slaves)), *slave_gates)};
}

template Result<JointSites> make_sites(const Joints<ControlParams>&, Seconds);

}  // namespace tactus::control
