// SPDX-License-Identifier: Apache-2.0
#include <tactus/interfaces/cli/guard_page.hpp>

#include <new>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tactus::cli {

std::optional<MappedGuardPage> MappedGuardPage::create() {
  MappedGuardPage made(memfd_create("tactus-guard", MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (made.descriptor_ < 0 || ftruncate(made.descriptor_, sizeof(GuardPage)) != 0) return std::nullopt;
  // Neither process can shorten it, which would end the other one by SIGBUS.
  if (fcntl(made.descriptor_, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW) != 0 || !made.map()) return std::nullopt;
  new (made.page_) GuardPage;
  return made;
}

std::optional<MappedGuardPage> MappedGuardPage::adopt(int descriptor) {
  MappedGuardPage made(descriptor);
  const int seals = fcntl(descriptor, F_GET_SEALS);
  struct stat status {};
  if (seals < 0 || (seals & F_SEAL_SHRINK) == 0 || fstat(descriptor, &status) != 0 ||
      status.st_size != static_cast<off_t>(sizeof(GuardPage)) || !made.map()) {
    return std::nullopt;
  }
  return made;
}

MappedGuardPage::~MappedGuardPage() {
  if (page_ != nullptr) munmap(page_, sizeof(GuardPage));
  if (descriptor_ >= 0) close(descriptor_);
}

bool MappedGuardPage::map() {
  void* memory = mmap(nullptr, sizeof(GuardPage), PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, 0);
  if (memory == MAP_FAILED) return false;
  page_ = static_cast<GuardPage*>(memory);
  return true;
}

}  // namespace tactus::cli
