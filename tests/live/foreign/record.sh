#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# record.sh TACTUS FOLDER: lets mcap-record record from `tactus serve` and compares with our log; 77 where the packages
# are not there.
here=$(cd "$(dirname "$0")" && pwd)
tactus=$1
folder=$2
if ! command -v node >/dev/null; then
  echo "SKIPPED: node is not installed"
  echo "The Debian package npm brings it; scripts/install-deps --page installs that."
  exit 77
fi
if [ ! -d "$here/node_modules/@foxglove/ws-protocol-examples" ]; then
  echo "SKIPPED: its packages are missing; get them with: npm ci --ignore-scripts --prefix tests/live/foreign"
  exit 77
fi
rm -rf "$folder"
mkdir -p "$folder"
"$tactus" serve --port 0 --out "$folder/session" --set plant.longest_step_s=2e-5 >"$folder/said" &
server=$!
recorder=''
trap 'kill $server $recorder 2>/dev/null' EXIT
url=''
for _ in $(seq 300); do
  url=$(sed -n 's/.*\(ws:.*\)/\1/p' "$folder/said")
  [ -n "$url" ] && break
  sleep 0.1
done
if [ -z "$url" ]; then
  echo "the server did not start"
  exit 1
fi
# The recorder misses for ever what arrives in the turn of its event loop in which the connection is made, as it can on a
# busy machine: it is then started again.
for _ in 1 2 3 4 5; do
  node "$here/node_modules/@foxglove/ws-protocol-examples/dist/cjs/ws-protocol-examples/src/index.js" \
    mcap-record "$url" -o "$folder/recorded.mcap" 2>"$folder/recorder_said" &
  recorder=$!
  for _ in $(seq 100); do
    grep -q 'subscribing to /right/teleoperator' "$folder/recorder_said" && break 2
    sleep 0.1
  done
  kill "$recorder"
done
if ! grep -q 'subscribing to /right/teleoperator' "$folder/recorder_said"; then
  echo "the recorder did not subscribe"
  exit 1
fi
sleep 2
# The recorder ends when the server does.
kill -TERM "$server"
wait "$server" || exit 1
wait "$recorder" || exit 1
node "$here/read_recording.mjs" "$folder/recorded.mcap" "$folder/session/log/log.mcap"
