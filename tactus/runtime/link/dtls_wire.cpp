// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/dtls_wire.hpp>

#include <algorithm>
#include <cstring>

#include <openssl/bio.h>

namespace tactus::link {

namespace {

int wire_write(BIO* bio, const char* data, int size) {
  BIO_clear_retry_flags(bio);
  const auto* wire = static_cast<const DtlsWire*>(BIO_get_data(bio));
  // What the kernel does not take is lost, as it could be further on; DTLS sends again what matters.
  const auto bytes = std::as_bytes(std::span(data, static_cast<std::size_t>(size)));
  if (!bytes.empty() && bytes[0] == message_record) {
    wire->socket->send(bytes);
  } else if (wire->frames != nullptr) {
    wire->frames->send(wire->own, wire->other, bytes);
  }
  return size;
}

int wire_read(BIO* bio, char* data, int size) {
  BIO_clear_retry_flags(bio);
  auto* wire = static_cast<DtlsWire*>(BIO_get_data(bio));
  if (wire->packet.empty()) {
    BIO_set_retry_read(bio);
    return -1;
  }
  const std::size_t count = std::min(wire->packet.size(), static_cast<std::size_t>(size));
  std::memcpy(data, wire->packet.data(), count);
  wire->packet = {};
  return static_cast<int>(count);
}

long wire_control(BIO*, int command, long, void*) {
  switch (command) {
    case BIO_CTRL_FLUSH:
      return 1;
    case BIO_CTRL_DGRAM_QUERY_MTU:
    case BIO_CTRL_DGRAM_GET_FALLBACK_MTU:
      return DtlsWire::mtu_bytes;
    default:
      return 0;
  }
}

int wire_create(BIO* bio) {
  BIO_set_init(bio, 1);
  return 1;
}

}  // namespace

BIO_METHOD* new_wire_method() noexcept {
  BIO_METHOD* method = BIO_meth_new(BIO_get_new_index() | BIO_TYPE_SOURCE_SINK, "tactus wire");
  const bool good = method != nullptr && BIO_meth_set_write(method, wire_write) == 1 &&
                    BIO_meth_set_read(method, wire_read) == 1 && BIO_meth_set_ctrl(method, wire_control) == 1 &&
                    BIO_meth_set_create(method, wire_create) == 1;
  if (good) return method;
  BIO_meth_free(method);
  return nullptr;
}

BIO* new_wire(BIO_METHOD* method, DtlsWire& wire) noexcept {
  BIO* bio = BIO_new(method);
  if (bio != nullptr) BIO_set_data(bio, &wire);
  return bio;
}

}  // namespace tactus::link
