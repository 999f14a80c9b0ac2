// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/socket.hpp>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <ctime>
#include <system_error>
#include <utility>

#include <linux/sock_diag.h>
#include <netdb.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace tactus::link {

namespace {

/// About a hundred short datagrams. A longer queue would only hold older ones.
constexpr int receive_buffer_bytes = 1 << 16;

Error bad_address(std::string_view text, ErrorCode code, const std::string& why) {
  return Error{.code = code,
               .parameter = {},
               .message = why + ": write HOST:PORT, as in 192.168.1.2:7300 or [::1]:7300",
               .place = std::string(text)};
}

Error no_socket(const Address& address, const char* doing) {
  const std::string why = std::system_category().message(errno);
  return Error{.code = ErrorCode::unwritable,
               .parameter = {},
               .message = std::string(doing) + " failed (" + why + "): choose an address of this host and a free port",
               .place = address.text()};
}

template <class Sockaddr>
Sockaddr read_as(const Address& address) noexcept {
  Sockaddr value{};
  std::memcpy(&value, address.data(), std::min(sizeof(value), address.size()));
  return value;
}

}  // namespace

Result<Address> Address::parse(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string_view::npos) return bad_address(text, ErrorCode::syntax, "the address has no port");
  std::string_view host = text.substr(0, colon);
  const std::string_view port_text = text.substr(colon + 1);
  if (host.size() >= 2 && host.front() == '[' && host.back() == ']') {
    host = host.substr(1, host.size() - 2);
  } else if (host.find(':') != std::string_view::npos) {
    return bad_address(text, ErrorCode::syntax, "an IPv6 host is written in brackets");
  }
  if (host.empty()) return bad_address(text, ErrorCode::syntax, "the address has no host");
  unsigned port = 0;
  const auto [end, error] = std::from_chars(port_text.data(), port_text.data() + port_text.size(), port);
  if (error != std::errc() || end != port_text.data() + port_text.size() || port == 0 || port > 65535) {
    return bad_address(text, ErrorCode::out_of_bounds, "the port must be a number from 1 to 65535");
  }

  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_DGRAM;
  hints.ai_flags = AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int status = getaddrinfo(std::string(host).c_str(), std::to_string(port).c_str(), &hints, &found);
  if (status != 0) {
    return bad_address(text, ErrorCode::missing, std::string("the host was not found (") + gai_strerror(status) + ")");
  }
  Address address;
  address.size_ = std::min<std::size_t>(found->ai_addrlen, address.data_.size());
  std::memcpy(address.data_.data(), found->ai_addr, address.size_);
  freeaddrinfo(found);
  return address;
}

Address Address::any_host() const {
  Address any;
  any.size_ = size_;
  const auto fill = [&any](const auto& value) { std::memcpy(any.data_.data(), &value, sizeof(value)); };
  if (!is_ipv6()) {
    sockaddr_in v4{};
    v4.sin_family = AF_INET;
    v4.sin_port = htons(port());
    fill(v4);
  } else {
    sockaddr_in6 v6{};
    v6.sin6_family = AF_INET6;
    v6.sin6_port = htons(port());
    fill(v6);
  }
  return any;
}

bool Address::is_ipv6() const noexcept { return read_as<sockaddr_storage>(*this).ss_family == AF_INET6; }

bool Address::is_loopback() const noexcept {
  if (!is_ipv6()) return ntohl(read_as<sockaddr_in>(*this).sin_addr.s_addr) >> 24 == 127;
  const in6_addr host = read_as<sockaddr_in6>(*this).sin6_addr;
  return std::memcmp(&host, &in6addr_loopback, sizeof(host)) == 0;
}

std::uint16_t Address::port() const noexcept {
  return ntohs(!is_ipv6() ? read_as<sockaddr_in>(*this).sin_port : read_as<sockaddr_in6>(*this).sin6_port);
}

std::string Address::text() const {
  std::array<char, NI_MAXHOST> host{};
  const auto storage = read_as<sockaddr_storage>(*this);
  const auto* generic = reinterpret_cast<const sockaddr*>(&storage);
  if (getnameinfo(generic, static_cast<socklen_t>(size_), host.data(), host.size(), nullptr, 0, NI_NUMERICHOST) != 0) {
    return "?";
  }
  std::string text = is_ipv6() ? "[" : "";
  text.append(host.data()).append(is_ipv6() ? "]:" : ":").append(std::to_string(port()));
  return text;
}

Socket::Socket(int descriptor, bool on_loopback)
    : descriptor_(descriptor), on_loopback_(on_loopback), packets_(std::make_unique<Packets>()) {}
Socket::Socket(Socket&& other) noexcept
    : descriptor_(std::exchange(other.descriptor_, -1)),
      on_loopback_(other.on_loopback_),
      packets_(std::move(other.packets_)) {}
Socket& Socket::operator=(Socket&& other) noexcept {
  std::swap(descriptor_, other.descriptor_);
  std::swap(on_loopback_, other.on_loopback_);
  std::swap(packets_, other.packets_);
  return *this;
}
Socket::~Socket() {
  if (descriptor_ >= 0) close(descriptor_);
}

Result<Socket> Socket::open(const Address& local, const Address& peer) {
  const auto local_storage = read_as<sockaddr_storage>(local), peer_storage = read_as<sockaddr_storage>(peer);
  const int descriptor = socket(local_storage.ss_family, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (descriptor < 0) return no_socket(local, "making a socket");
  Socket made(descriptor, false);
  setsockopt(descriptor, SOL_SOCKET, SO_RCVBUF, &receive_buffer_bytes, sizeof(receive_buffer_bytes));
  if (bind(descriptor, reinterpret_cast<const sockaddr*>(&local_storage), static_cast<socklen_t>(local.size())) != 0) {
    return no_socket(local, "listening");
  }
  if (connect(descriptor, reinterpret_cast<const sockaddr*>(&peer_storage), static_cast<socklen_t>(peer.size())) != 0) {
    return no_socket(peer, "reaching the peer");
  }
  Address bound;
  auto size = static_cast<socklen_t>(bound.data_.size());
  sockaddr_storage name{};
  if (getsockname(descriptor, reinterpret_cast<sockaddr*>(&name), &size) != 0) return no_socket(local, "listening");
  bound.size_ = std::min<std::size_t>(size, bound.data_.size());
  std::memcpy(bound.data_.data(), &name, bound.size_);
  made.on_loopback_ = peer.is_loopback() && bound.is_loopback();
  return made;
}

std::span<const Received> Socket::receive() noexcept {
  std::size_t taken = 0;
  for (; taken < packets_at_once; ++taken) {
    Received& packet = (*packets_)[taken];
    const ssize_t size = recv(descriptor_, packet.data.data(), Received::longest, MSG_DONTWAIT | MSG_TRUNC);
    if (size < 0) break;
    packet.size = static_cast<std::size_t>(size) <= Received::longest ? static_cast<std::size_t>(size) : 0;
  }
  return {packets_->data(), taken};
}

std::uint64_t Socket::dropped() const noexcept {
  std::array<std::uint32_t, SK_MEMINFO_VARS> about{};
  socklen_t size = sizeof(about);
  return getsockopt(descriptor_, SOL_SOCKET, SO_MEMINFO, about.data(), &size) == 0 ? about[SK_MEMINFO_DROPS] : 0;
}

bool Socket::send(std::span<const std::byte> bytes) const noexcept {
  return ::send(descriptor_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL) ==
         static_cast<ssize_t>(bytes.size());
}

void Socket::wait(double longest_s) const noexcept {
  pollfd one{.fd = descriptor_, .events = POLLIN, .revents = 0};
  const auto longest_ns = static_cast<std::int64_t>(longest_s * 1e9);
  const timespec longest{.tv_sec = longest_ns / 1'000'000'000, .tv_nsec = longest_ns % 1'000'000'000};
  ppoll(&one, 1, &longest, nullptr);
}

std::int64_t monotonic_ns() noexcept {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return std::int64_t{now.tv_sec} * 1'000'000'000 + now.tv_nsec;
}

}  // namespace tactus::link
