#!/bin/sh
# SPDX-License-Identifier: Apache-2.0
# rerun.sh SCRIPT CMAKE SCRATCH: what scripts/rerun-inconclusive does with tests that are inconclusive once, always, or fail
# afterwards, and with one that is skipped for a reason of its own.
set -eu
script=$1
cmake=$2
folder=$3
rm -rf "$folder"
mkdir "$folder"
fail() { echo "$1: $(cat "$folder/said")" >&2; exit 1; }

cat >"$folder/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(sample LANGUAGES NONE)
enable_testing()
function(sample name then)
  add_test(NAME "sample: ${name} (a+b)" COMMAND sh -c
    "if test -e ${CMAKE_BINARY_DIR}/${name}; then ${then}; fi; : >${CMAKE_BINARY_DIR}/${name}; echo 'inconclusive: late by up to 99 ms'; exit 77")
  set_tests_properties("sample: ${name} (a+b)" PROPERTIES SKIP_RETURN_CODE 77)
endfunction()
sample(once "exit 0")
if(AFTERWARDS)
  sample(afterwards "${AFTERWARDS}")
endif()
add_test(NAME cases COMMAND sh -c
  "test -n \"$TACTUS_CASES\" && test \"$TACTUS_CASES\" = A.b:C.d && exit 0; echo 'cases: A.b:C.d'; echo 'inconclusive: late by up to 99 ms'; exit 77")
set_tests_properties(cases PROPERTIES SKIP_RETURN_CODE 77)
add_test(NAME lacks COMMAND sh -c "echo 'SKIPPED: nothing there'; exit 77")
set_tests_properties(lacks PROPERTIES SKIP_RETURN_CODE 77)
END

# rerun AFTERWARDS: leaves the status in `status`.
rerun() {
  rm -rf "$folder/build"
  "$cmake" -S "$folder" -B "$folder/build" -DAFTERWARDS="$1" >"$folder/said" || fail 'the sample does not configure'
  (cd "$folder/build" && ctest >"$folder/said") || fail 'inconclusive tests fail'
  status=0
  "$script" "$folder/build" >"$folder/said" 2>&1 || status=$?
}

rerun ''
test "$status" = 0 || fail "one that passes alone: status $status"
grep -q '^2 real-time tests were inconclusive' "$folder/said" || fail 'it does not say how many'
test "$(grep -c 'alone, run 1: passed' "$folder/said")" = 2 || fail 'each was not run again'
grep -q 'cases: A.b, C.d' "$folder/said" || fail 'the cases are not named'
rerun 'exit 3'
test "$status" = 1 || fail "one that fails alone: status $status"
grep -q 'sample: afterwards (a+b) failed' "$folder/said" || fail 'the failure is not named'
rerun 'echo inconclusive: late by up to 88 ms; exit 77'
grep -q 'alone, run 3: inconclusive' "$folder/said" || fail 'it was not run three times'
if grep -q 'beside other programs' "$folder/said"; then
  test "$status" = 0 || fail "on a busy machine: status $status"
  grep -q 'not known whether it passes' "$folder/said" || fail 'what is not known is not said'
else
  test "$status" = 1 || fail "on an idle machine: status $status"
  grep -q 'inconclusive in each of 3 runs on an idle machine' "$folder/said" || fail 'the reason is not given'
fi
