#pragma once

#include <tactus/control/agreement.hpp>
#include <tactus/control/site_supervisor.hpp>

#include <cstdint>
#include <string>

namespace tactus::runtime {

/// Why two sites that hear each other cannot work together.
struct SiteMisfit {
  control::AgreementCheck agreement = control::AgreementCheck();
  std::uint16_t other_version = 0;  ///< of the wire format; 0 where the sites speak the same
};

/// What a person has to know of it, in one sentence with the remedy, at the site of this role.
std::string describe(const SiteMisfit& misfit, control::SiteRole role);

}  // namespace tactus::runtime
