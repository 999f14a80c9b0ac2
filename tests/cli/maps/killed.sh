# SPDX-License-Identifier: Apache-2.0
# killed.sh TACTUS FOLDER: kill -9 in mid-map, three times, each time a few blocks further; then the same command gives
# the map of FOLDER/whole, byte for byte.
set -eu
here=$(dirname "$0")
out=$2/killed
rm -rf "$out"
block=17000 # bytes that a block of 512 points takes, and a little more
for blocks in 1 4 8; do
  sh "$here/make_map.sh" "$1" "$out" &
  map=$!
  size=0
  while [ "$size" -lt $((blocks * block)) ]; do
    kill -0 "$map" 2>/dev/null || { echo "the map was finished before it could be killed"; exit 1; }
    sleep 0.005
    [ ! -e "$out/tasks.partial" ] || size=$(wc -c <"$out/tasks.partial")
  done
  kill -9 "$map"
  wait "$map" 2>/dev/null || true
  [ ! -e "$out/map.csv" ] || { echo "a killed map left results"; exit 1; }
done
sh "$here/make_map.sh" "$1" "$out"
cmp "$2/whole/map.csv" "$out/map.csv"
cmp "$2/whole/map.h5" "$out/map.h5"
[ ! -e "$out/tasks.partial" ] || { echo "the finished map left its file of finished tasks"; exit 1; }
resumed=$(sed -n 's/.*"resumed_points": \([0-9]*\).*/\1/p' "$out/results.json")
echo "$resumed of 9600 points were there from the killed runs"
[ "$resumed" -ge $((8 * 512)) ]
