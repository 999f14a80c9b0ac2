#pragma once

#include <tactus/control/agreement.hpp>
#include <tactus/control/site_supervisor.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace tactus::control {
struct Disagreement;
}

namespace tactus::runtime {

/// Why two sites that hear each other cannot work together.
struct SiteMisfit {
  control::AgreementCheck agreement = control::AgreementCheck();
  std::uint16_t other_version = 0;  ///< of the wire format; 0 where the sites speak the same
  std::size_t other_joints = 0;     ///< of the other site; 0 where both have as many
};

/// What a person has to know of it, in one sentence with the remedy, at the site of this role. Of sites of one axis.
std::string describe(const SiteMisfit& misfit, control::SiteRole role);
/// The same of others: `found` is what is known to differ, null where nothing is; `remedy` is what mends that.
std::string describe(const SiteMisfit& misfit, control::SiteRole role, const control::Disagreement* found,
                     std::string_view remedy);

}  // namespace tactus::runtime
