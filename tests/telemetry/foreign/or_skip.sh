#!/bin/sh
# or_skip.sh PROGRAM ARGUMENT...: runs it; where it is not installed, says so and exits with 77, which CTest shows as
# skipped.
if ! command -v "$1" >/dev/null; then
  echo "SKIPPED: $1 is not installed"
  exit 77
fi
exec "$@"
