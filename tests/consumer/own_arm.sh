#!/bin/sh
# own_arm.sh TACTUS PLUGIN EXAMPLES FOLDER: two arms of the driver of examples/own-arm are checked and coupled; a driver that
# throws and one that blocks for 100 ms end in hold with zero force and the reason.
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

# drive RIG NAME: armed at once, for eight seconds. Standard input that ended would be an operator who has gone.
drive() {
  sleep 12 | "$tactus" --plugin "$plugin" run "$joints" --realtime --device "$1" --arm --duration-s 8 \
    --out "$folder/$2" --overwrite >"$folder/$2.txt" 2>&1 || true
}

# The machine may be busy: a late reading is no subject here.
sed 's/^bus = .*/&\nwatchdog_s = 0.5/' "$rig" >"$folder/patient.toml"
drive "$folder/patient.toml" both
grep -q 'leader active, follower active' "$folder/both.txt" || fail 'the arms were not coupled' "$folder/both.txt"
[ -s "$folder/both/log/log.mcap" ] || fail 'there is no log' "$folder/both.txt"

sed 's/^torque_limit_Nm = 5.0.*/&\nfails_after = 5000/' "$folder/patient.toml" >"$folder/throws.toml"
drive "$folder/throws.toml" throws
grep -q 'the driver threw in exchange: the robot reported a collision' "$folder/throws.txt" ||
  fail 'the reason of a driver that threw is not printed' "$folder/throws.txt"

sed 's/^torque_limit_Nm = 5.0.*/&\nblocks_after = 6000/' "$rig" >"$folder/blocks.toml"
drive "$folder/blocks.toml" blocks
grep -q 'hold' "$folder/blocks.txt" || fail 'a driver that blocks did not end in hold' "$folder/blocks.txt"
