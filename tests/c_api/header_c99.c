#include "use_header.h"

int use_tactus_from_c99(void);
int use_tactus_from_c99(void) { return use_tactus(); }
