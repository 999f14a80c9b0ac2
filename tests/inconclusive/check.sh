#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# check.sh PROGRAM SCRATCH: what or_inconclusive does where the machine is on time and where it is late.
set -eu
program=$1
folder=$2
rm -rf "$folder"
mkdir "$folder"
fail() { echo "$1: $(cat "$folder/said")" >&2; exit 1; }

"$program" sh -c : || fail 'a test that passes fails'

# A busy machine may be late by itself, so this is tried until it was not; the kernel's figure counts the last ten seconds.
tries=0
until grep -q '^failed: the machine was late by up to 1\?[0-9] ms, and' "$folder/said" 2>/dev/null; do
  tries=$((tries + 1))
  [ "$tries" -le 40 ] || { echo 'inconclusive: the machine was busy in each of 40 tries'; exit 77; }
  [ "$tries" = 1 ] || sleep 1
  status=0
  : >"$folder/runs"
  "$program" sh -c 'echo run >>"$0"; exit 7' "$folder/runs" 2>"$folder/said" || status=$?
done
test "$status" = 7 || fail "a failure on a machine that was on time has the status $status"

# A machine that stands still for everybody but the test.
status=0
"$program" sh -c 'echo stalled >>"$0"; kill -STOP $PPID; sleep 0.5; kill -CONT $PPID; sleep 0.1; exit 7' "$folder/stalls" 2>"$folder/said" ||
  status=$?
test "$status" = 77 || fail "the status on a late machine is $status"
grep -q '^inconclusive: the machine was late by up to [4-9][0-9][0-9] ms' "$folder/said" || fail 'the lateness is not stated'
test "$(grep -c stalled "$folder/stalls")" = 3 || fail 'it was not run three times'
"$program" sh -c 'test -e "$0" || { : >"$0"; kill -STOP $PPID; sleep 0.5; kill -CONT $PPID; sleep 0.1; exit 7; }' "$folder/once" 2>"$folder/said" ||
  fail 'a test that passes the second time fails'
