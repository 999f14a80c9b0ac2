#include <tactus/control/agreed_parameters.hpp>
#include <tactus/link/datagram.hpp>
#include <tactus/runtime/site_misfit.hpp>

namespace tactus::runtime {

namespace {

std::string counted(std::size_t joints) { return joints == 1 ? "1 joint" : std::to_string(joints) + " joints"; }

}  // namespace

std::string describe(const SiteMisfit& misfit, control::SiteRole role) {
  const auto found = control::first_disagreement(misfit.agreement);
  return describe(misfit, role, found ? &*found : nullptr, "start both with the same experiment and the same --set");
}

std::string describe(const SiteMisfit& misfit, control::SiteRole role, const control::Disagreement* found,
                     std::string_view remedy) {
  const std::string other = role == control::SiteRole::master ? "the slave" : "the master";
  if (misfit.other_version != 0) {
    return other + " speaks version " + std::to_string(misfit.other_version) + " of the wire format and this site " +
           std::to_string(link::datagram_version) + ": run the same tactus at both";
  }
  if (misfit.other_joints != 0) {
    return other + " has " + counted(misfit.other_joints) +
           ", and this site another number: drive sides with the same joints at both";
  }
  if (found == nullptr) {
    return other + " works by other parameters, none of which this tactus knows: run the same tactus at both";
  }
  return std::string("the sites are not armed, for ")
      .append(found->key + " is " + found->own + " here and " + found->other + " at " + other + ": ")
      .append(remedy);
}

}  // namespace tactus::runtime
