// SPDX-License-Identifier: Apache-2.0
#include <tactus/hardware/wire/port.hpp>
#include <tactus/kernel/core/parameters.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>

// Bit rates beyond the fixed ones are in the kernel's header, which does not go together with <termios.h>.
#include <asm/termbits.h>
#include <fcntl.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/major.h>
#include <net/if.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

namespace tactus::wire {

namespace {

Error port_error(ErrorCode code, const std::string& path, std::string message) {
  return {.code = code, .parameter = {}, .message = std::move(message), .place = path};
}

Error system_error(const std::string& path, const char* what) {
  return port_error(ErrorCode::failed, path,
                    std::string(what) + " failed (" + std::system_category().message(errno) +
                        "): plug the device in again, and read what dmesg reports of it");
}

Error busy(const std::string& path) {
  return port_error(ErrorCode::inconsistent, path,
                    "another program has it open: end that program (fuser -v " + path + " shows which)");
}

Error open_error(const std::string& path) {
  switch (errno) {
    case ENOENT:
    case ENXIO:
    case ENODEV:
      return port_error(ErrorCode::missing, path,
                        "there is no such port: plug the adapter in, and look in /dev/serial/by-id for its name");
    case EACCES:
    case EPERM:
      return port_error(ErrorCode::inconsistent, path,
                        "no right to open it: become a member of the group dialout (sudo usermod -aG dialout $USER) "
                        "and log in again");
    case EBUSY:
      return busy(path);
    default:
      return system_error(path, "open");
  }
}

/// A flag of the terminal that would outlive a client that was killed, since the emulated peer keeps it open.
bool is_pseudo_terminal(int descriptor) {
  struct stat status {};
  if (fstat(descriptor, &status) != 0) return false;
  const auto kind = major(status.st_rdev);
  return kind >= UNIX98_PTY_SLAVE_MAJOR && kind < UNIX98_PTY_SLAVE_MAJOR + UNIX98_PTY_MAJOR_COUNT;
}

/// Raw, 8 data bits, no parity, one stop bit. False, with `errno`, where the terminal refuses.
bool set_raw(int descriptor, unsigned bits_per_s) {
  struct termios2 mode {};
  if (ioctl(descriptor, TCGETS2, &mode) != 0) return false;
  mode.c_iflag = mode.c_oflag = mode.c_lflag = 0;
  mode.c_cflag = CS8 | CREAD | CLOCAL | BOTHER | BOTHER << IBSHIFT;
  mode.c_ispeed = mode.c_ospeed = bits_per_s;
  // One byte is enough for a read to return, so that nothing read means that the other end is gone.
  mode.c_cc[VMIN] = 1;
  mode.c_cc[VTIME] = 0;
  return ioctl(descriptor, TCSETS2, &mode) == 0;
}

/// Whether the bit rate that was taken is near enough, as the middle of a byte's last bit asks for.
bool near_enough(unsigned taken, std::int64_t wanted) {
  constexpr std::int64_t part = 40;
  return std::abs(static_cast<std::int64_t>(taken) - wanted) <= wanted / part;
}

}  // namespace

Result<Port> Port::serial(const std::string& path, std::int64_t bits_per_s) {
  constexpr Bounds rates = between(50.0, 20e6);
  if (!rates.contain(static_cast<double>(bits_per_s))) {
    return out_of_bounds("bits_per_s", static_cast<double>(bits_per_s), rates, units::none);
  }
  Port port(open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC), Kind::terminal, path);
  if (port.descriptor_ < 0) return open_error(path);
  if (isatty(port.descriptor_) == 0) {
    return port_error(ErrorCode::inconsistent, path,
                      "this is no serial port: name one of /dev/serial/by-id, /dev/ttyUSB* or /dev/ttyACM*");
  }
  // The lock keeps programs of the superuser away too, which the flag does not.
  if (flock(port.descriptor_, LOCK_EX | LOCK_NB) != 0) return busy(path);
  if (!is_pseudo_terminal(port.descriptor_) && ioctl(port.descriptor_, TIOCEXCL) != 0) {
    return system_error(path, "TIOCEXCL");
  }
  struct termios2 mode {};
  if (!set_raw(port.descriptor_, static_cast<unsigned>(bits_per_s)) || ioctl(port.descriptor_, TCGETS2, &mode) != 0) {
    return system_error(path, "TCSETS2");
  }
  if (!near_enough(mode.c_ospeed, bits_per_s)) {
    return port_error(ErrorCode::out_of_bounds, path,
                      "the adapter does " + std::to_string(mode.c_ospeed) + " bit/s where " +
                          std::to_string(bits_per_s) +
                          " were asked for: choose a rate that it does, or another adapter");
  }
  if (ioctl(port.descriptor_, TCFLSH, TCIOFLUSH) != 0) return system_error(path, "TCFLSH");
  return port;
}

Port Port::of_another(int descriptor, std::string path) {
  Port port(descriptor, Kind::terminal, std::move(path));
  static_cast<void>(ioctl(descriptor, TCFLSH, TCIFLUSH));
  return port;
}

Result<Port> Port::pseudo_terminal() {
  const std::string multiplexer = "/dev/ptmx";
  Port port(open(multiplexer.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC), Kind::terminal, multiplexer);
  std::array<char, 64> path{};
  if (port.descriptor_ < 0 || grantpt(port.descriptor_) != 0 || unlockpt(port.descriptor_) != 0 ||
      ptsname_r(port.descriptor_, path.data(), path.size()) != 0) {
    return port_error(ErrorCode::failed, multiplexer,
                      "no pseudo-terminal (" + std::system_category().message(errno) +
                          "): close some terminals, or mount devpts at /dev/pts");
  }
  port.path_ = path.data();
  port.kept_open_ = open(path.data(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  constexpr unsigned any_rate = 921'600;
  if (port.kept_open_ < 0 || !set_raw(port.kept_open_, any_rate)) return system_error(port.path_, "open");
  return port;
}

Result<std::pair<Port, Port>> Port::pair() {
  std::array<int, 2> ends{};
  // A stream would join packets.
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    return system_error("socket pair", "socketpair");
  }
  return std::pair{Port(ends[0], Kind::socket, "socket pair"), Port(ends[1], Kind::socket, "socket pair")};
}

Result<Port> Port::can(const std::string& interface, bool flexible) {
  const std::string up = "bring it up: sudo ip link set " + interface + " up type can bitrate 1000000" +
                         (flexible ? " dbitrate 5000000 fd on" : "");
  Port port(socket(PF_CAN, SOCK_RAW | SOCK_NONBLOCK | SOCK_CLOEXEC, CAN_RAW), Kind::socket, interface);
  if (port.descriptor_ < 0) {
    return port_error(ErrorCode::inconsistent, interface,
                      "this kernel gives no CAN socket (" + std::system_category().message(errno) +
                          "): load it (sudo modprobe can_raw), take a kernel with CONFIG_CAN, or a serial CAN adapter");
  }
  sockaddr_can address{};
  address.can_family = AF_CAN;
  address.can_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
  if (address.can_ifindex == 0) {
    return port_error(ErrorCode::missing, interface, "there is no such CAN interface: plug the adapter in, and " + up);
  }
  const can_err_mask_t errors = CAN_ERR_BUSOFF | CAN_ERR_RESTARTED;
  const int on = 1;
  if (setsockopt(port.descriptor_, SOL_CAN_RAW, CAN_RAW_ERR_FILTER, &errors, sizeof(errors)) != 0 ||
      (flexible && setsockopt(port.descriptor_, SOL_CAN_RAW, CAN_RAW_FD_FRAMES, &on, sizeof(on)) != 0)) {
    return system_error(interface, "setsockopt");
  }
  ifreq request{};
  interface.copy(request.ifr_name, IFNAMSIZ - 1);
  if (ioctl(port.descriptor_, SIOCGIFFLAGS, &request) != 0) return system_error(interface, "SIOCGIFFLAGS");
  if ((request.ifr_flags & IFF_UP) == 0) {
    return port_error(ErrorCode::inconsistent, interface, "the interface is down: " + up);
  }
  if (bind(port.descriptor_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    return system_error(interface, "bind");
  }
  return port;
}

std::size_t Port::write(std::span<const std::uint8_t> bytes) const noexcept {
  // The other end of a socket may be gone, which is told by reading and must not kill.
  const ssize_t written = kind_ == Kind::socket ? send(descriptor_, bytes.data(), bytes.size(), MSG_NOSIGNAL)
                                                : ::write(descriptor_, bytes.data(), bytes.size());
  return written > 0 ? static_cast<std::size_t>(written) : 0;
}

std::int64_t Port::bits_per_s() const noexcept {
  struct termios2 mode {};
  return ioctl(kept_open_ >= 0 ? kept_open_ : descriptor_, TCGETS2, &mode) == 0 ? mode.c_ospeed : 0;
}

Port::Port(Port&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      kind_(other.kind_),
      kept_open_(std::exchange(other.kept_open_, -1)),
      path_(std::move(other.path_)) {}

Port& Port::operator=(Port&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(kind_, other.kind_);
  std::swap(kept_open_, other.kept_open_);
  std::swap(path_, other.path_);
  return *this;
}

Port::~Port() {
  if (descriptor_ >= 0) close(descriptor_);
  if (kept_open_ >= 0) close(kept_open_);
}

}  // namespace tactus::wire
