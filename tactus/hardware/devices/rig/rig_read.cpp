// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/damiao/framing.hpp>
#include <tactus/hardware/devices/damiao/models.hpp>
#include <tactus/hardware/devices/dynamixel/dynamixel_bus.hpp>
#include <tactus/hardware/devices/feetech/feetech_bus.hpp>
#include <tactus/hardware/devices/rig/rig.hpp>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <numbers>
#include <string_view>
#include <utility>

/// The keys of a rig file, and how they get into a rig.
namespace tactus::devices {

namespace {

struct DamiaoSide {
  BusKind bus = BusKind::damiao;
  std::string port;
  damiao::Framing framing = damiao::Framing::usb2can;
  double reply_timeout_s = 0.002, watchdog_s = 0.05;
  static constexpr auto fields() {
    return List{field("bus", &DamiaoSide::bus, "Kind of motors."),
                field("port", &DamiaoSide::port, "Serial port of the adapter, or interface of CAN."),
                field("framing", &DamiaoSide::framing, "How frames of CAN become bytes."),
                field("reply_timeout_s", &DamiaoSide::reply_timeout_s, units::second, between(0.0002, 0.05),
                      "Timeout of a reply; a motor that exceeds it three times in a row is not responding."),
                field("watchdog_s", &DamiaoSide::watchdog_s, units::second, between(0.005, 1.0),
                      "A motor that receives no command for this time disables itself, and one without a reply for "
                      "this time is lost.")};
  }
  void put_into(StatedBus& stated) const {
    stated = {.kind = bus,
              .port = port,
              .framing = name_of(framing),
              .reply_timeout_s = reply_timeout_s,
              .watchdog_s = watchdog_s,
              .motors = {}};
  }
};

struct ServoSide {
  BusKind bus = BusKind::dynamixel;
  std::string port;
  std::int64_t bits_per_s = 1'000'000;
  static constexpr auto fields() {
    return List{field("bus", &ServoSide::bus, "Kind of motors."), field("port", &ServoSide::port, "Serial port."),
                field("bits_per_s", &ServoSide::bits_per_s, between(9600.0, 4e6), "What each servo is set to.")};
  }
  void put_into(StatedBus& stated) const {
    stated = {.kind = bus, .port = port, .bits_per_s = bits_per_s, .motors = {}};
  }
};

struct Inverse3Side {
  BusKind bus = BusKind::inverse3;
  std::string port;
  std::string device;
  static constexpr auto fields() {
    return List{field("bus", &Inverse3Side::bus, "Kind of device."),
                field("port", &Inverse3Side::port, "Where Haply's service listens, HOST:PORT."),
                field("device", &Inverse3Side::device, "Its identifier, as 049D; empty: the first one.")};
  }
  void put_into(StatedBus& stated) const { stated = {.kind = bus, .port = port, .device = device, .motors = {}}; }
};

/// A registered driver, whose own keys stand beside these.
struct PluggedSide {
  std::string bus, port;
  double watchdog_s = 0.05;
  static constexpr auto fields() {
    return List{
        field("bus", &PluggedSide::bus, "Name of a registered driver."),
        field("port", &PluggedSide::port, "Where the device is reached, in the words of its driver."),
        field("watchdog_s", &PluggedSide::watchdog_s, units::second, between(0.005, 1.0),
              "If no reading arrives for this time, the device counts as lost; it removes its torque by itself.")};
  }
  std::shared_ptr<DriverSettings> settings = {};
  void put_into(StatedBus& stated) const {
    stated = {.kind = BusKind::plugged,
              .port = port,
              .watchdog_s = watchdog_s,
              .motors = {},
              .driver = bus,
              .settings = settings};
  }
};

constexpr const char* motor_doc = "Its identifier on the bus.";
constexpr const char* model_doc = "As its maker calls it.";

struct DamiaoMotor {
  std::int64_t motor = 0;
  damiao::Model model = damiao::Model::dm4310;
  std::int64_t feedback_id = -1;
  static constexpr auto fields() {
    return List{field("motor", &DamiaoMotor::motor, between(1.0, 15.0), motor_doc),
                field("model", &DamiaoMotor::model, model_doc),
                field("feedback_id", &DamiaoMotor::feedback_id, between(-1.0, 0x7fe),
                      "The identifier of its feedback, its register MST_ID; -1: `motor` + 16.")};
  }
  void put_into(StatedMotor& stated) const {
    stated = {.id = motor, .model = name_of(model), .feedback_id = feedback_id};
  }
};

struct DynamixelMotor {
  std::int64_t motor = 0;
  dynamixel::DynamixelModel model = dynamixel::DynamixelModel::xl330_m288;
  static constexpr auto fields() {
    return List{field("motor", &DynamixelMotor::motor, between(0.0, 252.0), motor_doc),
                field("model", &DynamixelMotor::model, model_doc)};
  }
  void put_into(StatedMotor& stated) const { stated = {.id = motor, .model = name_of(model)}; }
};

struct FeetechMotor {
  std::int64_t motor = 0;
  feetech::FeetechModel model = feetech::FeetechModel::sts3215;
  double torque_Nm_per_A = 0.0;
  static constexpr auto fields() {
    return List{field("motor", &FeetechMotor::motor, between(0.0, 253.0), motor_doc),
                field("model", &FeetechMotor::model, model_doc),
                field("torque_Nm_per_A", &FeetechMotor::torque_Nm_per_A, Unit{"N m/A", "_Nm_per_A"},
                      positive_up_to(100.0), "Of a servo that takes a current: stall torque over stall current.")};
  }
  void put_into(StatedMotor& stated) const {
    stated = {.id = motor, .model = name_of(model), .torque_Nm_per_A = torque_Nm_per_A};
  }
};

struct PluggedMotor {
  std::int64_t motor = 0;
  std::string model = "motor";
  static constexpr auto fields() {
    return List{field("motor", &PluggedMotor::motor, between(0.0, 1e6), "Its number, in the words of the driver."),
                field("model", &PluggedMotor::model, "Its name in tables.")};
  }
  void put_into(StatedMotor& stated) const { stated = {.id = motor, .model = model}; }
};

enum class Inverse3Model : std::int64_t { inverse3 };
constexpr auto enumerators(Inverse3Model) { return std::array{Enumerator{Inverse3Model::inverse3, "inverse3"}}; }

/// What all joints in m and N have.
struct Sliding {
  std::int64_t sign = 1;
  double offset_m = 0.0, lower_m = 0.0, upper_m = 0.0, velocity_limit_m_per_s = 0.0, force_limit_N = 0.0,
         force_rate_limit_N_per_s = 0.0;
  template <class P>
  static constexpr auto fields_of() {
    constexpr Bounds places = between(-10.0, 10.0);
    return List{field("sign", &P::sign, between(-1.0, 1.0), "1, or -1 where the motor goes against the joint."),
                field("offset_m", &P::offset_m, units::metre, places, "Where the joint is at zero of the motor."),
                field("lower_m", &P::lower_m, units::metre, places, "The joint has no force below that."),
                field("upper_m", &P::upper_m, units::metre, places, "The joint has no force above that."),
                field("velocity_limit_m_per_s", &P::velocity_limit_m_per_s, units::metre_per_second,
                      positive_up_to(100.0), "A joint that is faster loses its force."),
                field("force_limit_N", &P::force_limit_N, units::newton, positive_up_to(100.0),
                      "The largest force, either way."),
                field("force_rate_limit_N_per_s", &P::force_rate_limit_N_per_s, units::newton_per_second,
                      positive_up_to(1e6), "The fastest change of that force.")};
  }
  void put_into(RigJoint& one) const {
    one.joint.sign = sign;
    one.joint.offset_rad = offset_m;
    one.joint.lower_rad = lower_m;
    one.joint.upper_rad = upper_m;
    one.joint.velocity_limit_rad_per_s = velocity_limit_m_per_s;
    one.joint.torque_limit_Nm = force_limit_N;
    one.joint.torque_rate_limit_Nm_per_s = force_rate_limit_N_per_s;
  }
};

/// An axis of an Inverse3.
struct Inverse3Axis : Sliding {
  std::int64_t motor = 0;
  Inverse3Model model = Inverse3Model::inverse3;
  static constexpr auto fields() {
    return joined(List{field("motor", &Inverse3Axis::motor, between(1.0, 3.0), "1 is x, 2 is y, 3 is z."),
                       field("model", &Inverse3Axis::model, model_doc)},
                  fields_of<Inverse3Axis>());
  }
  void put_into(RigJoint& one) const {
    Sliding::put_into(one);
    one.motor = {.id = motor, .model = name_of(model)};
  }
};

/// A motor that turns, as the place of the end of a lever.
struct Lever : Sliding {
  double lever_m = 0.0;
  double temperature_limit_C = MotorJoint{}.temperature_limit_C;
  static constexpr auto fields() {
    return joined(List{field("lever_m", &Lever::lever_m, units::metre, between(0.01, 10.0),
                             "The joint moves by that for each radian of its motor."),
                       field("temperature_limit_C", &Lever::temperature_limit_C, joint_units::degree_celsius,
                             between(20.0, 150.0), "A motor that is hotter loses its power.")},
                  fields_of<Lever>());
  }
  void put_into(RigJoint& one) const {
    Sliding::put_into(one);
    one.joint.gear = 1.0 / lever_m;
    one.joint.temperature_limit_C = temperature_limit_C;
  }
};

/// A struct that the document fills, and where it goes then.
class Filled {
 public:
  template <Described T, class Into>
  Filled(T params, Into& into, const std::string& section, std::vector<Binding>& bindings) {
    auto held = std::make_shared<T>(std::move(params));
    for (Binding& binding : tactus::bind(*held, section)) bindings.push_back(std::move(binding));
    put_ = [held, &into] { held->put_into(into); };
  }
  void put() const { put_(); }

 private:
  std::function<void()> put_;
};

/// The coarsest step in which motors of a bus report their velocity, in rad/s or m/s at the motor. All of them measure
/// it by themselves: none is derived from the position here.
double velocity_step_of(std::string_view kind) {
  if (kind == name_of(BusKind::damiao)) return 2.0 * 45.0 / 4095.0;  // 12 bits of the widest range
  if (kind == name_of(BusKind::inverse3)) return 0.001;
  constexpr double rad_per_s_of_rpm = 2.0 * std::numbers::pi / 60.0;
  return (kind == name_of(BusKind::feetech) ? 0.732 : 0.229) * rad_per_s_of_rpm;
}

/// `arm`, `leader`, `elbow`, `motor` of `arm.leader.elbow.motor`.
std::vector<std::string_view> parts_of(std::string_view path) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    parts.push_back(path.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

/// That a bus without a registered driver is a built-in one.
Check check_built_in(const std::string& kind, const std::string& side) {
  std::string all;
  for (const auto& entry : enumerators(BusKind{})) {
    if (entry.name == kind) return std::nullopt;
    all += (all.empty() ? "" : ", ") + std::string(entry.name);
  }
  for (const DriverKind& driver : driver_kinds()) all += ", " + driver.name;
  return Error{.code = ErrorCode::unknown_key,
               .parameter = join(side, "bus"),
               .message = "'" + kind + "' is not a bus that tactus can drive; write one of " + all +
                          ", or load the driver with `tactus --plugin FILE.so`",
               .place = {}};
}

/// The element of that path, added where there is none.
template <class T>
T& named(std::vector<T>& all, std::string T::*name, std::string_view wanted) {
  const auto found = std::ranges::find(all, wanted, name);
  if (found != all.end()) return *found;
  T& added = all.emplace_back();
  added.*name = wanted;
  return added;
}

}  // namespace

/// Fills sides and joints with what is written.
Check Rig::read() {
  // Which sections there are.
  for (const std::string& key : document_.keys()) {
    const auto parts = parts_of(key);
    constexpr std::size_t of_side = 3, of_joint = 4;
    if (parts.size() < of_side || parts.size() > of_joint) continue;
    const bool leads = parts[1] == "leader";
    if (!leads && parts[1] != "follower") continue;
    RigPair& pair = named(pairs_, &RigPair::name, parts[0]);
    auto& side = leads ? pair.leader : pair.follower;
    if (!side) side.emplace().path = join(parts[0], parts[1]);
    if (parts.size() == of_joint) named(side->joints, &RigJoint::path, section_of(key));
  }
  std::vector<Binding> bindings;
  std::vector<Filled> filled;
  const auto fill = [&](auto params, auto& into, const std::string& path) {
    filled.emplace_back(std::move(params), into, path, bindings);
  };
  for (RigPair& pair : pairs_) {
    for (auto* side : {&pair.leader, &pair.follower}) {
      if (!*side) continue;
      RigSide& here = **side;
      const auto kind = document_.text_at(join(here.path, "bus"));
      if (!kind) {
        Error error = kind.error();
        if (error.code == ErrorCode::missing) error.place.clear();
        return error;
      }
      const bool damiao = *kind == name_of(BusKind::damiao), feetech = *kind == name_of(BusKind::feetech);
      const bool inverse3 = *kind == name_of(BusKind::inverse3);
      const DriverKind* driver = find_driver(*kind);
      if (driver == nullptr) {
        if (Check unknown = check_built_in(*kind, here.path)) return unknown;
      }
      if (driver != nullptr) {
        PluggedSide plugged;
        plugged.settings = driver->settings();
        plugged.settings->append_to(bindings, here.path);
        fill(std::move(plugged), here.bus, here.path);
      } else if (damiao) {
        fill(DamiaoSide{}, here.bus, here.path);
      } else if (inverse3) {
        fill(Inverse3Side{}, here.bus, here.path);
      } else {
        fill(ServoSide{}, here.bus, here.path);
      }
      for (RigJoint& joint : here.joints) {
        if (driver != nullptr) {
          fill(PluggedMotor{}, joint.motor, joint.path);
        } else if (damiao) {
          fill(DamiaoMotor{}, joint.motor, joint.path);
        } else if (feetech) {
          fill(FeetechMotor{}, joint.motor, joint.path);
        } else if (inverse3) {
          fill(Inverse3Axis{}, joint, joint.path);
        } else {
          fill(DynamixelMotor{}, joint.motor, joint.path);
        }
        const bool lever = !inverse3 && has(join(joint.path, "lever_m"));
        joint.slides = inverse3 || lever;
        if (lever) fill(Lever{}, joint, joint.path);
        if (!joint.slides) append_bindings(joint.joint, joint.path, bindings);
      }
    }
  }
  if (Check error = document_.read(bindings)) return error;
  for (const Filled& one : filled) one.put();
  for (RigPair& pair : pairs_) {
    for (std::optional<RigSide>* side : {&pair.leader, &pair.follower}) {
      if (!*side) continue;
      const auto kind = document_.text_at(join((*side)->path, "bus"));
      if ((*side)->bus.kind == BusKind::plugged) continue;  // its driver states it
      for (RigJoint& joint : (*side)->joints) joint.joint.velocity_step_rad_per_s = velocity_step_of(*kind);
    }
  }
  return std::nullopt;
}

}  // namespace tactus::devices
