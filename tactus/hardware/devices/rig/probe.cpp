// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/devices/damiao/framing.hpp>
#include <tactus/hardware/devices/dynamixel/dynamixel_bus.hpp>
#include <tactus/hardware/devices/dynamixel/packet.hpp>
#include <tactus/hardware/devices/feetech/packet.hpp>
#include <tactus/hardware/devices/rig/probe.hpp>
#include <tactus/hardware/wire/latency_timer.hpp>
#include <tactus/hardware/wire/talk.hpp>

#include <algorithm>
#include <array>
#include <fstream>
#include <map>
#include <span>
#include <system_error>

namespace tactus::devices {

namespace {

namespace fs = std::filesystem;

constexpr std::int64_t damiao_bits_per_s = 921'600;
constexpr std::array<std::int64_t, 4> common_rates{57'600, 1'000'000, 2'000'000, 4'000'000};

/// Says one thing and keeps what comes.
class Question final : public wire::WireEnd {
 public:
  explicit Question(std::vector<std::uint8_t> said) : said_(std::move(said)) {}
  void hear(std::span<const std::uint8_t> bytes, std::int64_t) noexcept override {
    constexpr std::size_t most = 8192;
    const std::size_t room = std::min(bytes.size(), most - heard_.size());
    heard_.insert(heard_.end(), bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(room));
  }
  std::span<const std::uint8_t> say(std::int64_t) noexcept override {
    if (done_) return {};
    done_ = true;
    return said_;
  }
  [[nodiscard]] std::int64_t wakes_ns() const noexcept override { return done_ ? wire::never_ns : 0; }
  [[nodiscard]] const std::vector<std::uint8_t>& heard() const { return heard_; }

 private:
  std::vector<std::uint8_t> said_, heard_;
  bool done_ = false;
};

Result<std::vector<std::uint8_t>> ask(const std::string& path, std::int64_t bits_per_s,
                                      std::vector<std::uint8_t> question, std::int64_t wait_ns) {
  auto port = wire::Port::serial(path, bits_per_s);
  if (!port) return port.error();
  Question asked(std::move(question));
  const std::int64_t until_ns = wire::monotonic_ns() + wait_ns;
  if (Check error = wire::talk(asked, *port, [until_ns] { return wire::monotonic_ns() > until_ns; })) return *error;
  return asked.heard();
}

void append(std::vector<std::uint8_t>& all, std::span<const std::uint8_t> bytes) {
  all.insert(all.end(), bytes.begin(), bytes.end());
}

void note(Answering& found, std::int64_t id, std::string model, std::string said) {
  const auto same = [id](const StatedMotor& motor) { return motor.id == id; };
  if (std::ranges::any_of(found.bus.motors, same)) return;
  found.bus.motors.push_back({.id = id, .model = std::move(model)});
  found.said.push_back(std::move(said));
}

/// All servos are pinged at once: each tells its id and its model.
void find_dynamixel(std::span<const std::uint8_t> bytes, Answering& found) {
  constexpr std::size_t ping_answer = 4;  // error, model, firmware
  PacketFinder<dynamixel::PacketFormat> finder;
  finder.hear(bytes, [&found](std::span<const std::uint8_t> packet) {
    dynamixel::Heard heard;
    dynamixel::decode(packet, heard);
    if (heard.instruction != dynamixel::Instruction::status || heard.parameters().size() != ping_answer) return;
    const std::int64_t number = little_endian(heard.parameters().subspan(1, 2));
    std::string model;
    for (const auto& [one, word] : enumerators(dynamixel::DynamixelModel{})) {
      if (dynamixel::servo_model(one).number == number) model = word;
    }
    note(found, heard.id, model, model.empty() ? "model number " + std::to_string(number) : model);
  });
}

/// Each servo is pinged by its id, since nobody but one may answer.
void find_feetech(std::span<const std::uint8_t> bytes, Answering& found) {
  constexpr std::size_t answer_bytes = 6;
  constexpr std::uint8_t ping = 1;
  PacketFinder<feetech::PacketFormat> finder;
  finder.hear(bytes, [&](std::span<const std::uint8_t> packet) {
    // The echo of a ping is an answer with error 1.
    if (packet.size() != answer_bytes || packet[4] == ping) return;
    note(found, packet[2], {}, "Feetech servo");
  });
}

void find_damiao(std::span<const std::uint8_t> bytes, damiao::Framing framing, Answering& found) {
  damiao::FrameReader reader(framing);
  reader.take(bytes, [&found](const damiao::CanFrame& frame) {
    constexpr std::uint8_t number = 0x0f;
    if (frame.size == 8) note(found, frame.data[0] & number, {}, "Damiao motor");
  });
}

std::string line_of(const fs::path& file) {
  std::ifstream stream(file);
  std::string line;
  std::getline(stream, line);
  return line;
}

}  // namespace

std::vector<FoundPort> list_ports(const fs::path& device, const fs::path& system) {
  std::vector<FoundPort> found;
  std::error_code none;
  std::map<std::string, std::string> names;
  for (const auto& entry : fs::directory_iterator(device / "serial/by-id", none)) {
    std::error_code broken;
    const fs::path real = fs::canonical(entry.path(), broken);
    if (!broken) names[real.string()] = entry.path().string();
  }
  for (const auto& entry : fs::directory_iterator(device, none)) {
    const std::string file = entry.path().filename().string();
    if (!file.starts_with("ttyUSB") && !file.starts_with("ttyACM")) continue;
    FoundPort& port = found.emplace_back();
    port.path = entry.path().string();
    std::error_code broken;
    port.name = names[fs::canonical(entry.path(), broken).string()];
    if (const Check slow = wire::check_latency_timer(port.path, system)) port.remark = slow->message;
  }
  constexpr const char* arphrd_can = "280";
  for (const auto& entry : fs::directory_iterator(system / "class/net", none)) {
    if (line_of(entry.path() / "type") != arphrd_can) continue;
    FoundPort& port = found.emplace_back();
    port.path = entry.path().filename().string();
    if (line_of(entry.path() / "operstate") == "down") {
      port.remark = "it is down: sudo ip link set " + port.path + " up type can bitrate 1000000";
    }
  }
  std::ranges::sort(found, {}, &FoundPort::path);
  return found;
}

Result<std::vector<Answering>> probe(const std::string& port) {
  std::vector<Answering> all;
  const auto try_it = [&](StatedBus bus, std::vector<std::uint8_t> question, std::int64_t wait_ns,
                          const auto& find) -> Check {
    const std::int64_t rate = bus.kind == BusKind::damiao ? damiao_bits_per_s : bus.bits_per_s;
    const auto heard = ask(port, rate, std::move(question), wait_ns);
    if (!heard) return heard.error().code == ErrorCode::out_of_bounds ? Check{} : heard.error();
    Answering found;
    found.bus = std::move(bus);
    find(*heard, found);
    if (!found.bus.motors.empty()) all.push_back(std::move(found));
    return std::nullopt;
  };
  for (const std::int64_t rate : common_rates) {
    std::vector<std::uint8_t> question;
    append(question, dynamixel::encode(dynamixel::broadcast, dynamixel::Instruction::ping, {}).bytes());
    // Each has 14 bytes, one after the other by its id.
    constexpr std::int64_t wait_ns = 150'000'000;
    const StatedBus bus{.kind = BusKind::dynamixel, .port = port, .bits_per_s = rate, .motors = {}};
    if (Check error = try_it(bus, std::move(question), wait_ns, find_dynamixel)) return *error;
  }
  std::vector<std::uint8_t> pings;
  constexpr std::uint8_t most_feetech = 16;
  for (std::uint8_t id = 1; id <= most_feetech; ++id)
    append(pings, feetech::encode(id, feetech::Instruction::ping, {}).bytes());
  const StatedBus feetech{.kind = BusKind::feetech, .port = port, .motors = {}};
  if (Check error = try_it(feetech, std::move(pings), 200'000'000, find_feetech)) return *error;
  for (const damiao::Framing framing : {damiao::Framing::usb2can, damiao::Framing::slcan}) {
    std::vector<std::uint8_t> frames;
    append(frames, damiao::opening(framing).view());
    constexpr std::uint16_t most_damiao = 15;
    for (std::uint16_t id = 1; id <= most_damiao; ++id)
      append(frames, damiao::wrap(framing, damiao::refresh_frame(id)).view());
    const StatedBus bus{.kind = BusKind::damiao, .port = port, .framing = name_of(framing), .motors = {}};
    const auto find = [framing](std::span<const std::uint8_t> bytes, Answering& found) {
      find_damiao(bytes, framing, found);
    };
    if (Check error = try_it(bus, std::move(frames), 200'000'000, find)) return *error;
  }
  return all;
}

}  // namespace tactus::devices
