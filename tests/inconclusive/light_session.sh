#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# light_session.sh SCRIPT SCRATCH: what scripts/in-light-session promises.
set -eu
script=$1
folder=$2
rm -rf "$folder"
mkdir "$folder"
fail() { echo "$1" >&2; exit 1; }

status=0
"$script" sh -c 'exit 7' || status=$?
test "$status" = 7 || fail "the status is $status"

# The weight is set just after the start. Without autogroup there is none.
if test -e /proc/self/autogroup; then
  "$script" sh -c 'for i in 1 2 3 4 5 6 7 8 9 10; do grep -q "nice 19" /proc/self/autogroup && exit; sleep 0.2; done; exit 1' ||
    fail 'the session does not count least'
fi

# Beside a session that keeps every core busy it counts as much as any.
if test -e /proc/self/autogroup; then
  "$script" python3 -c 'import os
for _ in range(1, os.cpu_count()):
    if os.fork() == 0: break
while True: pass' &
  busy=$!
  status=0
  "$script" sh -c 'for i in 1 2 3 4 5 6 7 8 9 10 11 12; do grep -q "nice 0" /proc/self/autogroup && exit; sleep 1; done; exit 1' ||
    status=$?
  kill "$busy"
  test "$status" = 0 || fail 'beside a busy session the session still counts least'
fi

# What the command began gets the signal too.
"$script" sh -c 'sleep 60 & echo $! >"$0"; wait' "$folder/child" &
for i in 1 2 3 4 5 6 7 8 9 10; do test -s "$folder/child" || sleep 0.2; done
kill -TERM $!
status=0
wait $! || status=$?
test "$status" = 143 || fail "the status after SIGTERM is $status"
# It ends within two seconds, though perhaps nobody has waited for it yet.
lives() { grep -q '^State:[[:space:]]*[^Z]' "/proc/$(cat "$folder/child")/status" 2>/dev/null; }
for i in 1 2 3 4 5 6 7 8 9 10; do ! lives || sleep 0.2; done
! lives || fail 'a program of the session lives on'
