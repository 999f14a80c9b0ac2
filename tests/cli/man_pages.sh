#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# man_pages.sh TACTUS SCRIPT FOLDER: SCRIPT makes the man pages of TACTUS, and they say what its help does.
set -eu
rm -rf "$3"
"$2" "$1" "$3"
for page in tactus tactus-run tactus-identify-frf tactus-stability-two-port tactus-device-check; do
  grep -q '^\.TH TACTUS' "$3/$page.1"
done
grep -q 'Run an experiment, in virtual or in real time' "$3/tactus-run.1"
grep -q 'overwrite' "$3/tactus-run.1"
test "$(printf "%s\n" "$3"/*.1 | wc -l)" -gt 35
