#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# own_device.sh PROGRAM EXPERIMENT FOLDER: the example's device at both sites, in one process, and each in a process of
# its own, over the loopback. Both must follow for seconds, and the wall must be felt.
set -eu
program=$1 experiment=$2 folder=$3
mkdir -p "$folder"

followed() { # LINES PATTERN WHO
  seconds=$(grep -c "$2" "$folder/$1.txt" || true)
  if [ "$seconds" -lt 3 ]; then
    echo "$3 followed in $seconds s of 6:"
    cat "$folder/$1.txt"
    exit 1
  fi
}

# Standard input that ended would be a person who has gone.
sleep 8 | "$program" run "$experiment" --realtime --device carriage --duration-s 6 --arm --json --out "$folder/both" \
  --overwrite >"$folder/both.json" 2>"$folder/both.txt"
followed both 'master *active ' 'in one process the master'
followed both 'slave *active ' 'in one process the slave'
"$program" replay "$folder/both/log" --check >/dev/null

port=$((20000 + $$ % 20000 * 2))
sleep 9 | "$program" run "$experiment" --site slave --peer 127.0.0.1:$port --listen 127.0.0.1:$((port + 1)) \
  --unencrypted --device carriage --duration-s 7 --json >"$folder/slave.json" 2>"$folder/slave.txt" &
sleep 9 | "$program" run "$experiment" --site master --peer 127.0.0.1:$((port + 1)) --listen 127.0.0.1:$port \
  --unencrypted --device carriage --duration-s 6 --arm --json >"$folder/master.json" 2>"$folder/master.txt"
wait
for site in master slave; do
  followed $site ' active ' "the $site"
done
