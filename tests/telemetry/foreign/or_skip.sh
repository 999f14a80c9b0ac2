#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# or_skip.sh PACKAGE PROGRAM ARGUMENT...: runs the program. Where it is not installed, or says with a status of 77 that it
# lacks what the Debian package PACKAGE brings, this says what to install and exits with 77, which CTest shows as skipped.
package=$1
shift
status=77
if command -v "$1" >/dev/null; then
  status=0
  "$@" || status=$?
else
  echo "SKIPPED: $1 is not installed"
fi
[ "$status" != 77 ] || echo "The Debian package $package runs this test; scripts/install-deps --checks installs it."
exit "$status"
