# SPDX-License-Identifier: Apache-2.0
# make_map.sh TACTUS FOLDER [LAUNCHER...]: the map that all tests of this folder make. The shell becomes the command, so that
# who kills the one kills the other.
tactus=$1
out=$2
shift 2
exec "$@" "$tactus" stability map "$(dirname "$0")/quick_map.toml" --vary control.cancellation=off,on \
  --vary control.force_gain=0.5:30:60 --vary 'environment.stiffness_N_per_m=1e3:1e5:80[log]' --out "$out" >/dev/null
