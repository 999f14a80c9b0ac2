// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/runtime/link/datagram.hpp>

#include <cstddef>
#include <cstdint>

namespace tactus::link {

/// What a socket lets in is decided by the kernel before it wakes or costs this program anything: a packet that cannot
/// be one of the link by its size and first bytes is dropped where it arrives, and counted by `Socket::dropped`. What
/// passes is judged as if there were no filter.

/// Lets in frames of the other site's hand-shakes, and records of DTLS 1.2 (RFC 6347, Sec. 4.1) with `message_bytes` of
/// content in epoch 1, the only one that has content where nobody renegotiates, with `least` or a higher number. While
/// `least` is 0 there is no link, and plain text gets in too, so that its site can be informed of the key. In place of
/// what the socket let in before. False where the kernel has no such filter.
bool admit_records(int descriptor, SiteRole own_site, std::size_t message_bytes, std::uint64_t least) noexcept;

}  // namespace tactus::link
