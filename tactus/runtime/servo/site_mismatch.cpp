// SPDX-License-Identifier: Apache-2.0
#include <tactus/kernel/control/agreed_parameters.hpp>
#include <tactus/runtime/link/datagram.hpp>
#include <tactus/runtime/servo/site_mismatch.hpp>

namespace tactus::runtime {

namespace {

std::string counted(std::size_t joints) { return joints == 1 ? "1 joint" : std::to_string(joints) + " joints"; }

}  // namespace

std::string describe(const SiteMismatch& mismatch, control::SiteRole role) {
  const auto found = control::first_disagreement(mismatch.agreement);
  return describe(mismatch, role, found ? &*found : nullptr, "start both with the same experiment and the same --set");
}

std::string describe(const SiteMismatch& mismatch, control::SiteRole role, const control::Disagreement* found,
                     std::string_view remedy) {
  const std::string other = role == control::SiteRole::master ? "the slave" : "the master";
  switch (mismatch.keys) {
    case KeyTrouble::none:
      break;
    case KeyTrouble::other_key:
      return "what comes from the address of " + other +
             " was made with another key: give both sites the same key file (--key)";
    case KeyTrouble::other_none:
      return other + " sends plain text, and this site has a key: start both with --key and the same file";
    case KeyTrouble::own_none:
      return other + " has a key, and this site sends plain text: start both with --key and the same file";
  }
  if (mismatch.other_version != 0) {
    return other + " speaks version " + std::to_string(mismatch.other_version) + " of the wire format and this site " +
           std::to_string(link::datagram_version) + ": run the same tactus at both";
  }
  if (mismatch.other_joints != 0) {
    return other + " has " + counted(mismatch.other_joints) +
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
