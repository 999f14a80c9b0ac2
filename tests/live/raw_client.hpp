// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

/// A client that shares no line with the server: plain sockets, and WebSocket frames (RFC 6455) put together by hand.
namespace tactus::live {

/// A request that subscribes to a channel so many times, with numbers from 1.
inline std::string subscribe_often(const std::string& channel, int times) {
  std::string request = R"({"op":"subscribe","subscriptions":[)";
  for (int id = 1; id <= times; ++id) {
    if (id > 1) request += ',';
    request += R"({"id":)" + std::to_string(id) + R"(,"channelId":)" + channel + "}";
  }
  return request + "]}";
}

class RawClient {
 public:
  explicit RawClient(std::uint16_t port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    sockaddr generic{};
    std::memcpy(&generic, &address, sizeof address);
    connected_ = socket_ >= 0 && ::connect(socket_, &generic, sizeof address) == 0;
  }
  RawClient(RawClient&& other) noexcept
      : socket_(std::exchange(other.socket_, -1)), connected_(other.connected_), bytes_(std::move(other.bytes_)) {}
  RawClient& operator=(RawClient&&) = delete;
  ~RawClient() {
    if (socket_ >= 0) ::close(socket_);
  }

  [[nodiscard]] bool connected() const { return connected_; }

  bool send(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }

  /// Everything until the other side closes, or until it has been silent for so long.
  std::string receive_all(int silence_ms = 2000) {
    while (receive_some(silence_ms)) {
    }
    return std::exchange(bytes_, {});
  }

  /// Shakes hands under a subprotocol; true where the server agreed to it.
  bool open(std::uint16_t port, const std::string& subprotocol = "foxglove.websocket.v1",
            const std::string& more = "") {
    send("GET / HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
         "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: " +
         subprotocol + "\r\n" + more + "\r\n");
    std::size_t end = std::string::npos;
    while ((end = bytes_.find("\r\n\r\n")) == std::string::npos && receive_some(30000)) {
    }
    if (end == std::string::npos) return false;
    const std::string head = bytes_.substr(0, end);
    bytes_.erase(0, end + 4);
    // The accept value of this key is the example of RFC 6455, section 1.3.
    return head.starts_with("HTTP/1.1 101 ") && head.find("s3pPLMBiTxaQ9kYGzzhZRbK+xOo=") != std::string::npos &&
           head.find("Sec-WebSocket-Protocol: " + subprotocol) != std::string::npos;
  }

  static std::string frame(unsigned char opcode, std::string_view content) {
    std::string bytes;
    bytes += static_cast<char>(0x80 | opcode);
    if (content.size() < 126) {
      bytes += static_cast<char>(0x80 | content.size());
    } else {
      bytes += static_cast<char>(0x80 | 126);
      bytes += static_cast<char>(content.size() >> 8);
      bytes += static_cast<char>(content.size() & 0xff);
    }
    constexpr std::array<unsigned char, 4> mask{0x12, 0x34, 0x56, 0x78};
    for (const unsigned char byte : mask) bytes += static_cast<char>(byte);
    for (std::size_t i = 0; i < content.size(); ++i) {
      bytes += static_cast<char>(static_cast<unsigned char>(content[i]) ^ mask[i % 4]);
    }
    return bytes;
  }
  bool say(std::string_view text) const { return send(frame(1, text)); }
  bool say_binary(std::string_view content) const { return send(frame(2, content)); }

  struct Message {
    bool binary = false;
    std::string content;
  };
  /// The next text or binary message; pings and the like are passed over. None after a silence or the end.
  std::optional<Message> next(int silence_ms = 5000) {
    while (true) {
      if (const auto message = take()) {
        if (message->first == 1 || message->first == 2) return Message{message->first == 2, message->second};
        if (message->first == 8) return std::nullopt;
        continue;
      }
      if (!receive_some(silence_ms)) return std::nullopt;
    }
  }
  /// The next text message that contains `part`.
  std::optional<std::string> text_with(std::string_view part, int silence_ms = 5000) {
    while (const auto message = next(silence_ms)) {
      if (!message->binary && message->content.find(part) != std::string::npos) return message->content;
    }
    return std::nullopt;
  }

  /// A receive buffer so small that the sender soon has to wait.
  void read_little() const {
    const int size = 2048;
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &size, sizeof size);
  }

 private:
  bool receive_some(int silence_ms) {
    pollfd waiting{.fd = socket_, .events = POLLIN, .revents = 0};
    if (::poll(&waiting, 1, silence_ms) <= 0) return false;
    std::array<char, 65536> chunk;
    const ssize_t count = ::recv(socket_, chunk.data(), chunk.size(), 0);
    if (count <= 0) return false;
    bytes_.append(chunk.data(), static_cast<std::size_t>(count));
    return true;
  }

  /// A whole frame off the front of what has arrived: opcode and content.
  std::optional<std::pair<int, std::string>> take() {
    const auto at = [this](std::size_t i) { return static_cast<std::uint64_t>(static_cast<unsigned char>(bytes_[i])); };
    if (bytes_.size() < 2) return std::nullopt;
    std::uint64_t length = at(1) & 0x7f;
    std::size_t head = 2;
    const std::size_t more = length == 126 ? 2 : length == 127 ? 8 : 0;
    if (bytes_.size() < head + more) return std::nullopt;
    if (more > 0) {
      length = 0;
      for (std::size_t i = 0; i < more; ++i) length = length << 8 | at(head + i);
      head += more;
    }
    if (bytes_.size() < head + length) return std::nullopt;
    std::pair<int, std::string> frame{static_cast<int>(at(0) & 0x0f), bytes_.substr(head, length)};
    bytes_.erase(0, head + length);
    return frame;
  }

  int socket_;
  bool connected_ = false;
  std::string bytes_;
};

}  // namespace tactus::live
