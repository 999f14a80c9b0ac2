#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# read_log.sh LOG: read_log.mjs, or 77 where its packages are not there.
here=$(dirname "$0")
if ! command -v node >/dev/null; then
  echo "SKIPPED: node is not installed"
  echo "The Debian package npm brings it; scripts/install-deps --page installs that."
  exit 77
fi
if [ ! -d "$here/node_modules/@mcap/core" ]; then
  echo "SKIPPED: its packages are missing; get them with: npm ci --ignore-scripts --prefix tests/telemetry/foreign"
  exit 77
fi
exec node "$here/read_log.mjs" "$1"
