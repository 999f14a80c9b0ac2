# SPDX-License-Identifier: Apache-2.0
# ranks.sh TACTUS FOLDER: two ranks of Open MPI give the map of FOLDER/whole, byte for byte. Exits with 77 where Open
# MPI is not installed.
set -eu
if ! mpirun --version 2>/dev/null | grep -q 'Open MPI'; then
  echo 'SKIPPED: mpirun of Open MPI is not installed'
  echo 'The Debian package openmpi-bin runs this test; scripts/install-deps --checks installs it.'
  exit 77
fi
sh "$(dirname "$0")/make_map.sh" "$1" "$2/ranks" mpirun --allow-run-as-root --oversubscribe --mca plm isolated -n 2
cmp "$2/whole/map.csv" "$2/ranks/map.csv"
cmp "$2/whole/map.h5" "$2/ranks/map.h5"
