#include <tactus/control/agreed_parameters.hpp>
#include <tactus/link/datagram.hpp>
#include <tactus/runtime/site_misfit.hpp>

namespace tactus::runtime {

std::string describe(const SiteMisfit& misfit, control::SiteRole role) {
  const std::string other = role == control::SiteRole::master ? "the slave" : "the master";
  if (misfit.other_version != 0) {
    return other + " speaks version " + std::to_string(misfit.other_version) + " of the wire format and this site " +
           std::to_string(link::datagram_version) + ": run the same tactus at both";
  }
  const auto found = control::first_disagreement(misfit.agreement);
  if (!found) {
    return other + " works by other parameters, none of which this tactus knows: run the same tactus at both";
  }
  return "the sites are not armed, for " + found->key + " is " + found->own + " here and " + found->other + " at " +
         other + ": start both with the same experiment and the same --set";
}

}  // namespace tactus::runtime
