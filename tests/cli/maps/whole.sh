# SPDX-License-Identifier: Apache-2.0
# whole.sh TACTUS FOLDER: makes the map that the other tests of this folder compare with, in FOLDER/whole, by one
# process that nobody kills.
set -eu
rm -rf "$2"
mkdir -p "$2"
sh "$(dirname "$0")/make_map.sh" "$1" "$2/whole"
