#include <tactus.h>

#include "use_header.inc"

int use_tactus_from_c99(void);
int use_tactus_from_c99(void) { return use_tactus(); }
