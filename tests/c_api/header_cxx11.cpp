// SPDX-License-Identifier: Apache-2.0
#include "use_header.h"

extern "C" int use_tactus_from_cxx11();
int use_tactus_from_cxx11() { return use_tactus(); }
