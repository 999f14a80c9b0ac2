#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# own_arm.sh TACTUS PLUGIN EXAMPLES FOLDER: two arms of the driver of examples/own-arm are checked and coupled; a driver that
# throws and one that blocks for 100 ms end in hold with zero force and the reason. Then each arm is driven by a program of
# its own; the follower's is killed, and the leader holds.
set -eu
tactus=$1 plugin=$2 examples=$3 folder=$4
mkdir -p "$folder"
rig=$examples/own-arm/rig.toml
joints=$examples/rigs/joints.toml

fail() {
  echo "$1:"
  cat "$2"
  exit 1
}

"$tactus" --plugin "$plugin" device check "$rig" >"$folder/check.txt"
grep -q '^Clean' "$folder/check.txt" || fail 'the check is not clean' "$folder/check.txt"

# Without the plug-in, and with a file that is none, the error says what to do.
if "$tactus" device check "$rig" >"$folder/without.txt" 2>&1; then fail 'a driver that is not there was found' "$folder/without.txt"; fi
grep -q 'rig.toml:7.*--plugin' "$folder/without.txt" || fail 'the missing driver is not named' "$folder/without.txt"
if "$tactus" --plugin "$rig" device check "$rig" >"$folder/wrong.txt" 2>&1; then fail 'a text was loaded' "$folder/wrong.txt"; fi
grep -q 'cannot be loaded' "$folder/wrong.txt" || fail 'the wrong plug-in is not named' "$folder/wrong.txt"

# Standard input that ended would be an operator who has gone.
rm -f "$folder/hands"
mkfifo "$folder/hands"
exec 9<>"$folder/hands"

# drive RIG NAME [SECONDS]: armed at once, for eight seconds or those given. A plug-in may be named after the command.
drive() {
  "$tactus" run "$joints" --realtime --device "$1" --plugin "$plugin" --arm --duration-s "${3:-8}" \
    --out "$folder/$2" --overwrite >"$folder/$2.txt" 2>&1 <&9 || true
}

# The machine may be busy: a late reading is no subject here.
sed 's/^bus = .*/&\nwatchdog_s = 0.5/' "$rig" >"$folder/patient.toml"
drive "$folder/patient.toml" both
grep -q 'leader active, follower active' "$folder/both.txt" || fail 'the arms were not coupled' "$folder/both.txt"
[ -s "$folder/both/log/log.mcap" ] || fail 'there is no log' "$folder/both.txt"

# A driver that throws is opened again, and `arm` couples the arms once more.
sed 's/^torque_limit_Nm = 5.0.*/&\nfails_after = 4000/' "$folder/patient.toml" >"$folder/throws.toml"
(
  for _ in $(seq 60); do
    sleep 0.2
    if grep -q 'leader hold, follower hold (device)' "$folder/throws.txt" 2>/dev/null; then break; fi
  done
  sleep 1.5
  echo arm >&9
) &
drive "$folder/throws.toml" throws 12
wait
grep -q 'the driver threw in exchange: the robot reported a collision' "$folder/throws.txt" ||
  fail 'the reason of a driver that threw is not printed' "$folder/throws.txt"
sed -n '/leader hold, follower hold (device)/,$p' "$folder/throws.txt" | grep -q 'leader active, follower active' ||
  fail 'a driver that threw did not end in hold, or the arms could not be armed again' "$folder/throws.txt"

sed 's/^torque_limit_Nm = 5.0.*/&\nblocks_after = 6000/' "$rig" >"$folder/blocks.toml"
drive "$folder/blocks.toml" blocks
grep -q 'leader hold, follower hold (device)' "$folder/blocks.txt" ||
  fail 'a driver that blocks did not end in hold with its cause' "$folder/blocks.txt"
grep -q 'not responding for ' "$folder/blocks.txt" || fail 'the reason of a driver that blocks is not printed' "$folder/blocks.txt"

# Each arm by a program of its own, over the network.
port=$((20000 + 2 * ($$ % 10000)))
"$tactus" key "$folder/key" >"$folder/key.txt"
site() {
  exec "$tactus" run "$joints" --site "$1" --device "$folder/patient.toml" --plugin "$plugin" --listen "127.0.0.1:$2" \
    --peer "127.0.0.1:$3" --key "$folder/key" --duration-s 60 --set control.supervision.longest_stall_s=0.5 \
    --set control.supervision.watchdog.timeout_s=0.5 $4 >"$folder/$1.txt" 2>&1 <&9
}
site slave "$port" "$((port + 1))" '' &
slave=$!
site master "$((port + 1))" "$port" --arm &
master=$!
trap 'kill -9 $slave $master 2>/dev/null || true' EXIT
# shows TEXT: within twenty seconds, in the lines of the leader's program.
shows() {
  for _ in $(seq 100); do
    if grep -q "$1" "$folder/master.txt"; then return; fi
    sleep 0.2
  done
  fail "the leader's program does not show '$1'" "$folder/master.txt"
}
shows 'leader active, follower active'
kill -9 $slave
shows 'leader hold.*(timed-out)'
kill -INT $master
wait $master || true
