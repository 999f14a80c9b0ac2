#!/bin/sh
# own_device.sh PROGRAM EXPERIMENT FOLDER: the example's device at both sites, each in a process of its own, over the
# loopback. Both must follow for seconds, and the wall must be felt.
set -eu
program=$1 experiment=$2 folder=$3
mkdir -p "$folder"
port=$((20000 + $$ % 20000 * 2))
# Standard input that ended would be a person who has gone.
sleep 9 | "$program" run "$experiment" --site slave --peer 127.0.0.1:$port --listen 127.0.0.1:$((port + 1)) \
  --unencrypted --device carriage --duration-s 7 --json >"$folder/slave.json" 2>"$folder/slave.txt" &
sleep 9 | "$program" run "$experiment" --site master --peer 127.0.0.1:$((port + 1)) --listen 127.0.0.1:$port \
  --unencrypted --device carriage --duration-s 6 --arm --json >"$folder/master.json" 2>"$folder/master.txt"
wait
for site in master slave; do
  followed=$(grep -c ' active ' "$folder/$site.txt" || true)
  if [ "$followed" -lt 3 ]; then
    echo "the $site followed in $followed s of 6:"
    cat "$folder/$site.txt"
    exit 1
  fi
done
