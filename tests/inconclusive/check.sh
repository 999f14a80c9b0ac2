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

# A machine that stands still for everybody but the test.
status=0
"$program" sh -c 'echo stalled >>"$0"; kill -STOP $PPID; sleep 0.5; kill -CONT $PPID; sleep 0.1; exit 7' "$folder/stalls" 2>"$folder/said" ||
  status=$?
test "$status" = 77 || fail "the status on a late machine is $status"
grep -q '^inconclusive: the machine was late by up to [4-9][0-9][0-9] ms' "$folder/said" || fail 'the lateness is not stated'
test "$(grep -c stalled "$folder/stalls")" = 3 || fail 'it was not run three times'
"$program" sh -c 'test -e "$0" || { : >"$0"; kill -STOP $PPID; sleep 0.5; kill -CONT $PPID; sleep 0.1; exit 7; }' "$folder/once" 2>"$folder/said" ||
  fail 'a test that passes the second time fails'

# Of a program with several cases, those that failed run again, and are named; with TACTUS_CASES these alone run.
cat >"$folder/cases.sh" <<'END'
echo "${GTEST_FILTER:-all}, part ${GTEST_SHARD_INDEX:-none}" >>"$1"
cat >"${GTEST_OUTPUT#xml:}" <<'XML'
<testsuites><testsuite name="Rig">
  <testcase name="passes" value_param="a &gt; b" classname="Rig" />
  <testcase name="comes_late/1" status="run" classname="Buses/Rig"><failure message="x" type=""></failure></testcase>
  <testcase name="is_late" classname="Rig">
    <failure message="late" type=""></failure>
  </testcase>
</testsuite></testsuites>
XML
kill -STOP $PPID; sleep 0.5; kill -CONT $PPID; sleep 0.1; exit 1
END
status=0
GTEST_FILTER='*' GTEST_TOTAL_SHARDS=3 GTEST_SHARD_INDEX=1 "$program" sh "$folder/cases.sh" "$folder/ran" 2>"$folder/said" || status=$?
test "$status" = 77 || fail "the status of several cases on a late machine is $status"
grep -qx 'cases: Buses/Rig.comes_late/1:Rig.is_late' "$folder/said" || fail 'the cases that failed are not named'
printf '%s\n' '*, part 1' 'Buses/Rig.comes_late/1:Rig.is_late, part none' 'Buses/Rig.comes_late/1:Rig.is_late, part none' |
  cmp -s - "$folder/ran" || { cp "$folder/ran" "$folder/said"; fail 'what failed does not run again alone'; }
rm "$folder/ran"
GTEST_FILTER='*' TACTUS_CASES=Rig.is_late "$program" sh "$folder/cases.sh" "$folder/ran" 2>"$folder/said" || :
test "$(head -n 1 "$folder/ran")" = 'Rig.is_late, part none' || fail 'TACTUS_CASES does not choose the cases'

# What a sanitizer reports is no matter of time.
status=0
: >"$folder/runs"
"$program" sh -c 'echo run >>"$0"; kill -STOP $PPID; sleep 0.5; kill -CONT $PPID; sleep 0.1; exit "${ASAN_OPTIONS##*exitcode=}"' \
  "$folder/runs" 2>"$folder/said" || status=$?
test "$status" = 99 || fail "the status of a sanitizer's report is $status"
test "$(grep -c run "$folder/runs")" = 1 || fail 'a report of a sanitizer is run again'

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
