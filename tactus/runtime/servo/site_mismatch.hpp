// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <tactus/kernel/control/agreement.hpp>
#include <tactus/kernel/control/site_supervisor.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace tactus::control {
struct Disagreement;
}

namespace tactus::runtime {

/// How the keys of two sites differ that send each other packets and have no link.
enum class KeyTrouble : std::uint8_t {
  none,
  other_key,   ///< what comes was made with another key
  other_none,  ///< what comes is plain text, and this site has a key
  own_none     ///< what comes is of a site with a key, and this one has no key
};

/// Why two sites that receive packets of each other cannot work together.
struct SiteMismatch {
  control::AgreementCheck agreement = control::AgreementCheck();
  std::uint16_t other_version = 0;  ///< of the wire format; 0 where the sites speak the same
  std::size_t other_joints = 0;     ///< of the other site; 0 where both have as many
  KeyTrouble keys = KeyTrouble::none;
};

/// What an operator has to know of it, in one sentence with the remedy, at the site of this role. Of sites of one axis.
std::string describe(const SiteMismatch& mismatch, control::SiteRole role);
/// The same of others: `found` is what is known to differ, null where nothing is; `remedy` is what fixes that.
std::string describe(const SiteMismatch& mismatch, control::SiteRole role, const control::Disagreement* found,
                     std::string_view remedy);

}  // namespace tactus::runtime
