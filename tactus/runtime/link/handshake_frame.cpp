// SPDX-License-Identifier: Apache-2.0
#include <tactus/runtime/link/handshake_frame.hpp>
#include <tactus/runtime/link/internal/bytes.hpp>

#include <algorithm>
#include <string>
#include <utility>

#include <openssl/core_names.h>
#include <openssl/crypto.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/kdf.h>
#include <openssl/params.h>

namespace tactus::link {

namespace {

/// The same in every version of the format, so that sites of two versions can tell each other so.
constexpr const char* purpose = "tactus: tags of hand-shakes";

/// Wiped when it goes.
struct TagKey {
  std::array<unsigned char, 16> bytes{};
  TagKey() = default;
  TagKey(const TagKey&) = default;
  TagKey& operator=(const TagKey&) = default;
  ~TagKey() { OPENSSL_cleanse(bytes.data(), bytes.size()); }
};
using Tag = std::array<std::byte, frame_tag_bytes>;

bool derive(Key key, TagKey& derived) {
  EVP_KDF* const hkdf = EVP_KDF_fetch(nullptr, "HKDF", nullptr);
  EVP_KDF_CTX* const context = hkdf != nullptr ? EVP_KDF_CTX_new(hkdf) : nullptr;
  std::string digest = "SHA256", info = purpose;
  const std::array params{OSSL_PARAM_construct_utf8_string(OSSL_KDF_PARAM_DIGEST, digest.data(), 0),
                          OSSL_PARAM_construct_octet_string(OSSL_KDF_PARAM_KEY, key.secret.data(), Key::bytes),
                          OSSL_PARAM_construct_octet_string(OSSL_KDF_PARAM_INFO, info.data(), info.size()),
                          OSSL_PARAM_construct_end()};
  const bool good =
      context != nullptr && EVP_KDF_derive(context, derived.bytes.data(), derived.bytes.size(), params.data()) == 1;
  EVP_KDF_CTX_free(context);
  EVP_KDF_free(hkdf);
  return good;
}

}  // namespace

class FrameTags::Mac {
 public:
  explicit Mac(const TagKey& key) : key_(key) {
    EVP_MAC* const siphash = EVP_MAC_fetch(nullptr, "SIPHASH", nullptr);
    if (siphash != nullptr) context_ = EVP_MAC_CTX_new(siphash);
    EVP_MAC_free(siphash);
  }
  Mac(const Mac&) = delete;
  Mac& operator=(const Mac&) = delete;
  ~Mac() { EVP_MAC_CTX_free(context_); }

  bool make(std::span<const std::byte> bytes, Tag& tag) noexcept {
    std::size_t size = 0;
    return context_ != nullptr && EVP_MAC_init(context_, key_.bytes.data(), key_.bytes.size(), nullptr) == 1 &&
           EVP_MAC_update(context_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()) == 1 &&
           EVP_MAC_final(context_, reinterpret_cast<unsigned char*>(tag.data()), &size, tag.size()) == 1 &&
           size == tag.size();
  }

 private:
  TagKey key_;
  EVP_MAC_CTX* context_ = nullptr;
};

bool is_a_frame(std::span<const std::byte> bytes) noexcept {
  return bytes.size() >= shortest_frame_bytes && bytes.size() <= longest_frame_bytes &&
         Reader(bytes.data()).get<std::uint32_t>() == frame_magic;
}

FrameTags::FrameTags(std::unique_ptr<Mac> mac, SiteRole own_site, std::size_t joints)
    : mac_(std::move(mac)), own_site_(own_site), joints_(static_cast<std::uint8_t>(joints)) {}
FrameTags::FrameTags(FrameTags&&) noexcept = default;
FrameTags& FrameTags::operator=(FrameTags&&) noexcept = default;
FrameTags::~FrameTags() = default;

Result<FrameTags> FrameTags::make(const Key& key, SiteRole own_site, std::size_t joints) {
  TagKey derived;
  bool good = derive(key, derived);
  auto mac = std::make_unique<Mac>(derived);
  Tag trial{};
  good = good && mac->make({}, trial);
  ERR_clear_error();
  if (good) return FrameTags(std::move(mac), own_site, joints);
  return Error{.code = ErrorCode::failed,
               .parameter = {},
               .message = "OpenSSL cannot do HKDF and SipHash: install OpenSSL 3 with its default provider",
               .place = {}};
}

std::span<const std::byte> FrameTags::write(const HandshakeFrame& frame, FrameBytes& bytes) noexcept {
  Writer head(bytes.data());
  head.put(frame_magic);
  head.put(frame.version);
  head.put(site_byte(own_site_));
  head.put(static_cast<std::uint8_t>(joints_ - 1));  // 0 of one axis
  head.put(frame.session);
  head.put(frame.peer);
  head.put(frame.number);
  std::copy(frame.records.begin(), frame.records.end(), bytes.begin() + frame_head_bytes);
  const std::size_t tag_at = frame_head_bytes + frame.records.size();
  Tag tag{};
  mac_->make({bytes.data(), tag_at}, tag);
  std::copy(tag.begin(), tag.end(), bytes.begin() + static_cast<std::ptrdiff_t>(tag_at));
  return {bytes.data(), tag_at + frame_tag_bytes};
}

FrameTags::Verdict FrameTags::read(std::span<const std::byte> bytes, HandshakeFrame& frame) noexcept {
  if (bytes.size() < shortest_frame_bytes || bytes.size() > longest_frame_bytes) return Verdict::none;
  Reader head(bytes.data());
  const SiteRole other = own_site_ == SiteRole::master ? SiteRole::slave : SiteRole::master;
  if (head.get<std::uint32_t>() != frame_magic) return Verdict::none;
  const auto version = head.get<std::uint16_t>();
  if (head.get<std::uint8_t>() != site_byte(other)) return Verdict::none;
  const std::size_t tag_at = bytes.size() - frame_tag_bytes;
  Tag tag{};
  if (!mac_->make(bytes.first(tag_at), tag) || CRYPTO_memcmp(tag.data(), &bytes[tag_at], frame_tag_bytes) != 0) {
    return Verdict::forged;
  }
  frame.version = version;
  if (version != datagram_version) return Verdict::version;
  frame.joints = static_cast<std::uint8_t>(head.get<std::uint8_t>() + 1);
  frame.session = head.get<std::uint64_t>();
  frame.peer = head.get<std::uint64_t>();
  frame.number = head.get<std::uint64_t>();
  frame.records = bytes.subspan(frame_head_bytes, tag_at - frame_head_bytes);
  return frame.joints == joints_ ? Verdict::genuine : Verdict::joints;
}

}  // namespace tactus::link
