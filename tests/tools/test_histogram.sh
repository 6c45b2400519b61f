#!/usr/bin/env bash
# Tests tools/instruction_counts --histogram: Oclgrind's counts of calls equal raya's counters of the same events.
set -euo pipefail
command -v oclgrind >/dev/null || { echo "skipped: no oclgrind"; exit 77; }
raya=$(readlink -f "$1")
root=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..

fail() { echo "FAILED: $1"; echo "$out"; exit 1; }
histogram() { out=$("$root/tools/instruction_counts" --raya "$raya" --histogram "$@" 2>&1) || fail "exit code $? of $*"; }
number() { awk -v line="$1" 'index($0, "  " line " ") == 1 { print $NF }' <<<"$out"; }

histogram trace "$root/scenes/centre.nff"
[[ $(number "rays primary") == 64 ]] || fail "8 x 8 pixels have 64 primary rays"
# One lane, one sphere at a time, so that each test is one call.
[[ $(number "call closest_approach()") == "$(number "tests sphere")" ]] || fail "calls of closest_approach() are not the tests that raya counted"
histogram add_neighbours "$root/scenes/planes.nff"
[[ $out == *"kernel add_neighbours, "*"fadd"* ]] || fail "no additions in add_neighbours"
histogram trace_voxel "$root/scenes/planes.nff"
[[ $out == *"kernel trace_voxel, "* && $(number "rays primary") == 64 ]] || fail "no rays on the torus"
! out=$("$root/tools/instruction_counts" --raya "$raya" --histogram nosuch 2>&1) || fail "an unknown kernel is accepted"
[[ $out == *"no kernel 'nosuch'"* ]] || fail "no message on the unknown kernel"
echo "instruction histograms: as counted"
