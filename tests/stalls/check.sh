#!/bin/sh
# check.sh PROGRAM SCRATCH: what again_after_stall does where the machine keeps time and where it does not.
set -eu
program=$1
folder=$2
rm -rf "$folder"
mkdir "$folder"
fail() { echo "$1: $(cat "$folder/said")" >&2; exit 1; }

"$program" sh -c : || fail 'a test that passes fails'
status=0
"$program" sh -c 'echo run >>"$0"; exit 7' "$folder/runs" 2>"$folder/said" || status=$?
test "$status" = 7 || fail "the status is $status"
test "$(grep -c run "$folder/runs")" = 1 || fail 'a machine that kept time is no excuse'

# A machine that stands still for everybody but the test.
status=0
"$program" sh -c 'echo stalled >>"$0"; kill -STOP $PPID; sleep 0.5; kill -CONT $PPID; sleep 0.1; exit 7' "$folder/stalls" 2>"$folder/said" ||
  status=$?
test "$status" = 7 || fail "the status after stalls is $status"
test "$(grep -c stalled "$folder/stalls")" = 3 || fail 'it was not run three times'
"$program" sh -c 'test -e "$0" || { : >"$0"; kill -STOP $PPID; sleep 0.5; kill -CONT $PPID; sleep 0.1; exit 7; }' "$folder/once" 2>"$folder/said" ||
  fail 'a test that passes the second time fails'
