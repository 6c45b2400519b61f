#!/usr/bin/env bash
# Tests tools/portability with mock programs instead of raya and its tests: matrix and exit code for right, wrong and missing results.
#   test_portability.sh RAYA PATCH_KERNELS DEFECTS     the built program, for the kernels under Oclgrind; tests/kernels/patch_kernels.cpp;
#                                                      tests/portability/defects.cpp
set -euo pipefail
raya=$(readlink -f "$1")
patch_kernels=$(readlink -f "$2")
defects=$(readlink -f "$3")
root=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..
build=$(mktemp -d)
trap 'rm -rf "$build"' EXIT
mkdir "$build/tests"

# Mock programs: every implementation has a device; PoCL's basic device renders a wrong image; an unexpected defect occurs without the optimiser.
cat >"$build/raya" <<'RAYA'
#!/usr/bin/env bash
case $1 in
    --version) echo "raya 0.0.0${MOCK_COMMIT:+ (commit $MOCK_COMMIT, Release)}" ;;
    verify)
        [[ $2 == --help ]] && { echo "  --quick"; exit 0; }
        [[ $2 == --list && $RAYA_BUILD_OPTIONS == --il && ! -e $0.spirv ]] && exit 3
        [[ $2 == --list ]] && exit 0
        status=PASS
        [[ ${POCL_WORK_GROUP_METHOD-} == loops ]] && status=FAIL
        [[ -e $0.slow ]] && sleep 20
        while [[ $1 != --timeout ]]; do shift; done
        [[ ! -e $0.timeouts ]] || echo "$2" >>"$0.timeouts"
        while [[ $1 != --only ]]; do shift; done
        layer=${2% }
        [[ $layer == image ]] && check='"name": "groups", "status": "SKIP", "result": "one work-item only"'
        [[ $layer == number ]] && check='"name": "add", "status": "'$status'", "result": "bits differ"'
        echo '{"devices": [{"checks": ['"${check:+{\"layer\": \"$layer\", $check\}}"']}]}' >"$4"
        [[ ! -e $0.crash ]] || kill -SEGV $$ ;;
    devices) printf '0  toy\n   Toy, driver 1\n   OpenCL 3.0\n   cpu\n' ;;
    bench)
        code=0
        [[ ! -e $0.budget ]] || code=4
        while [[ $1 != --report ]]; do shift; done
        echo '{"builds": [{"build_s": 1, "first_launch_s": 0.5}, {"build_s": 0.2, "first_launch_s": 0.1}]}' >"$2"
        ((code == 0)) || echo "raya: trace: 1.5 s to compile, above --limit 1 s" >&2
        exit "$code" ;;
    render)
        while [[ $1 != --report ]]; do shift; done
        [[ -e $0.hash ]] && right=$(<"$0.hash") || right=5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a
        [[ -e $0.reflected ]] && reflected=$(<"$0.reflected") || reflected=5
        echo '{"image": {"hash": "'"${POCL_DEVICES:-$right}"'"}, "walks": 0, "steps": 0, "load": {"per_pe": [7, 8]},
            "rays": {"primary": 400, "primary_hits": 40, "reflected": '"$reflected"', "refracted": 0, "shadow": 0, "shadow_hits": 0},
            "tests": {"sphere": 1, "plane": 2, "polygon": 3, "cone": 4}, "shading": {"hits": 40, "lit": 0, "highlights": 0}}' >"$2" ;;
esac
RAYA
cat >"$build/tests/portability_defects" <<DEFECTS
#!/usr/bin/env bash
[[ ! -e \$0.gone ]] || exec "$defects" "" rusticl llvmpipe
echo "long_loop, n = 9: expected failure, 8 instead of 9: a reason"
[[ \${RAYA_BUILD_OPTIONS-} == "" ]]
DEFECTS
cat >"$build/tests/test_number" <<'VECTORS'
#!/usr/bin/env bash
echo "All tests passed ($RAYA_NUMBER_CASES assertions in 2 test cases)"
VECTORS
chmod +x "$build/raya" "$build"/tests/*

fail() { echo "FAILED: $1"; echo "$out"; exit 1; }
matrix() { code=0; out=$("$root/tools/portability" --build "$build" --hashes "$build/renders.csv" "$@" 2>"$build/stderr") || code=$?; }
expect() { [[ $out == *"$1"* ]] || fail "no '$1'"; }  # expect TEXT

# Hashes are written once; then the hashes of every implementation, including the first, are compared with them.
matrix --write-hashes
((code == 0)) || fail "exit code $code of --write-hashes"
expect "20 renders of 17 images, 20 of them new or changed"
real=$root/tests/portability/renders.csv
cut -d, -f1,2 "$real" | diff - <(cut -d, -f1,2 "$build/renders.csv") || fail "$real lacks images; tools/portability --write-hashes"
common=0
while IFS=, read -r scene options hash counts; do
    name="$scene ${options#--format }"
    name=${name/--antialias /}
    known=$(sed -n "s/^${name/supersample/axes}: //p" "$root/host/verify/reference_images.txt")
    [[ -z $known || $known == "$hash" ]] || fail "$name: $hash in $real, $known in host/verify/reference_images.txt"
    rays=$(awk -v name="${name/supersample/axes}: " 'index($0, name) == 1 { here = 1 } here && sub(/^counts ring: /, "") { print; exit }' \
        "$root/host/verify/reference_images.txt" | sed 's/[^0-9]*\([0-9]*\)/\1,/g')
    [[ -z $known || $counts == "$(cut -d, -f1-10 <<<"$rays"),"* ]] || fail "$name: $counts in $real, $rays in host/verify/reference_images.txt"
    common=$((common + ${#known} / 32))
done < <(grep -v '^#' "$real")
((common == 7)) || fail "$common images of $real are in host/verify/reference_images.txt, not 7"
matrix --only "PoCL loopvec" --checks build
((code == 0)) || fail "exit code $code for a compiler within the budget"
expect "| 1.5 s |"
: >"$build/raya.budget"
matrix --only "PoCL loopvec" --checks build
((code == 1)) || fail "exit code $code for a compiler above the budget"
expect "| FAIL 1.5 s |"
expect "above --limit 1 s"
rm "$build/raya.budget"
echo 11111111111111111111111111111111 >"$build/raya.hash"
matrix --only "PoCL loopvec" --checks renders
((code == 1)) || fail "exit code $code for a wrong image"
expect "11111111111111111111111111111111; right: 5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a"
rm "$build/raya.hash"
echo 6 >"$build/raya.reflected"
matrix --only "PoCL loopvec" --checks renders
((code == 1)) || fail "exit code $code for wrong counts"
expect "spheres --format fp32 --accel grid: wrong counts: reflected is 6, right: 5"
rm "$build/raya.reflected"
sed -i '/cones,--format spa22/d' "$build/renders.csv"
matrix --only "PoCL loopvec" --checks renders
((code == 1)) || fail "exit code $code for a missing hash"
expect "right: not in renders.csv, see --write-hashes"
matrix --write-hashes
expect "20 renders of 17 images, 1 of them new or changed"

# The environment of the caller, such as a CI job, has no effect.
export RAYA_BUILD_OPTIONS=-cl-opt-disable POCL_DEVICES=basic OCL_ICD_VENDORS=/nowhere RAYA_NUMBER_CASES=1
matrix --only "PoCL loopvec"
unset RAYA_BUILD_OPTIONS POCL_DEVICES OCL_ICD_VENDORS RAYA_NUMBER_CASES
((code == 0)) || fail "exit code $code where all is right"
expect "| PoCL loopvec | toy | OpenCL 3.0, driver 1 | 1 right | - | - | - | 40000 per format right | 24 right | 1 known |"
expect "PoCL loopvec, image: SKIP groups: one work-item only"
[[ $out == *$'\n'"8 cells: 5 right, 0 FAIL, 3 undecided." ]] || fail "the last line does not count the cells"
expect "PoCL loopvec, defects: long_loop, n = 9: expected failure, 8 instead of 9: a reason"

# Known defects of llvmpipe that do not occur on PoCL are named. Not with a PoCL that has defects of its own, which would be unknown ones of llvmpipe.
if [[ $("$defects") != *": expected failure"* ]]; then
    touch "$build/tests/portability_defects.gone"
    matrix --only "PoCL loopvec" --checks defects
    ((code == 0)) || fail "exit code $code where known defects no longer occur"
    expect "| none, 3 gone |"
    expect "PoCL loopvec, defects: long_loop, n = 100000, 1 x 1 work-items: right, 65535 was expected: Mesa's llvmpipe ends every loop"
    expect "right, a crash was expected"
    rm "$build/tests/portability_defects.gone"
fi

matrix --only PoCL
((code == 1)) || fail "exit code $code where something is wrong"
expect "| PoCL loops | toy | OpenCL 3.0, driver 1 | FAIL 1/1 |"
expect "PoCL loops, number: FAIL add: bits differ"
expect "| PoCL -cl-opt-disable | toy | OpenCL 3.0, driver 1 | 1 right | - | - | - | 40000 per format right | 24 right | FAIL |"
expect "| PoCL basic | toy | OpenCL 3.0, driver 1 | 1 right | - | - | - | 40000 per format right | FAIL 24/24 |"
expect "basic; right: 5a5a5a5a"

# Files for CI. PoCL loops computes wrong numbers; a list of expected failures turns that around; a pattern without a cell causes a warning.
read_junit() {  # read_junit PYTHON_EXPRESSION: prints it for the element `suites`
    python3 -c "import sys, xml.etree.ElementTree as xml; suites = xml.parse(sys.argv[1]).getroot(); print($1)" "$build/junit.xml"
}
ci=(--only PoCL --skip "PoCL*3.0" --checks number,image --junit "$build/junit.xml" --tap "$build/tap")
matrix "${ci[@]}"
((code == 1)) || fail "exit code $code where one cell is wrong"
[[ $(read_junit '[(s.get("name"), s.get("tests"), s.get("failures"), s.get("skipped")) for s in suites][2]') == "('PoCL loops', '2', '1', '1')" ]] ||
    fail "$(<"$build/junit.xml")"
[[ $(read_junit '[c.get("name") for c in suites.iter("testcase") if c.find("failure") is not None]') == "['PoCL loops, number']" ]] ||
    fail "$(<"$build/junit.xml")"
grep -q '^1\.\.12$' "$build/tap" || fail "$(<"$build/tap")"
grep -q '^not ok 5 - PoCL loops, number$' "$build/tap" || fail "$(<"$build/tap")"
grep -q '^# FAIL add: bits differ$' "$build/tap" || fail "$(<"$build/tap")"
grep -q '^ok 6 - PoCL loops, image # SKIP -$' "$build/tap" || fail "$(<"$build/tap")"
printf '# list\nloops*number | bits differ | https://example.org/1\nno such cell | a reason\n' >"$build/expect"
matrix "${ci[@]}" --expect "$build/expect"
((code == 0)) || fail "exit code $code where the wrong cell was expected"
expect "12 cells: 5 right, 0 FAIL, 6 undecided, 1 XFAIL."
expect "PoCL loops, number: FAIL 1/1 (expected: bits differ, https://example.org/1)"
grep -qF "$build/expect:3: \"no such cell\" matches no check" "$build/stderr" || fail "no warning: $(<"$build/stderr")"
[[ $(grep -c "matches no check" "$build/stderr") == 1 ]] || fail "$(<"$build/stderr")"
grep -q '^not ok 5 - PoCL loops, number # TODO FAIL 1/1 (expected: bits differ' "$build/tap" || fail "$(<"$build/tap")"
echo "PoCL basic, number | a reason" >"$build/expect"
matrix "${ci[@]}" --expect "$build/expect" --skip "PoCL loops" --checks number,build
((code == 1)) || fail "exit code $code where a cell passed unexpectedly"
expect "XPASS 1 right"
[[ $(read_junit '[c.find("failure").get("message") for c in suites.iter("testcase") if c.find("failure") is not None]') == \
    "['passed, but --expect lists it as failing (a reason): 1 right']" ]] || fail "$(<"$build/junit.xml")"
echo "PoCL basic, number" >"$build/expect"
matrix --expect "$build/expect"
((code == 2)) || fail "exit code $code of a line without a reason"
grep -qF "$build/expect:1: expected PATTERN | REASON" "$build/stderr" || fail "$(<"$build/stderr")"

# Every cell is in exactly one shard.
for shard in 1/3 2/3 3/3; do
    matrix --only PoCL --skip "3.0 (PyPI)" --checks number,image,build --shard $shard --tap "$build/tap"
    sed -n 's/^.*ok [0-9]* - \([^#]*[^ #]\).*/\1/p' "$build/tap"
done >"$build/shards"
matrix --only PoCL --skip "3.0 (PyPI)" --checks number,image,build --tap "$build/tap"
sed -n 's/^.*ok [0-9]* - \([^#]*[^ #]\).*/\1/p' "$build/tap" | sort | diff - <(sort "$build/shards") || fail "the shards differ from the whole"
(($(wc -l <"$build/shards") == 18)) || fail "$(<"$build/shards")"
for shard in 0/2 3/2 2 1/2x; do
    matrix --shard $shard
    ((code == 2)) || fail "exit code $code of --shard $shard"
done

# A cell that is wrong in its third run only.
cat >"$build/flaky" <<'FLAKY'
#!/usr/bin/env bash
folder=$(dirname "$0")
[[ $1 != bench ]] || echo run >>"$folder/runs"
[[ $1 != bench ]] || (($(wc -l <"$folder/runs") != 3)) || touch "$folder/raya.budget"
exec "$folder/raya" "$@"
FLAKY
chmod +x "$build/flaky"
matrix --raya "$build/flaky" --only "PoCL loopvec" --checks build --repeat 5
((code == 1)) || fail "exit code $code for a cell that is wrong once"
expect "PoCL loopvec, build: in run 3 of 5"
rm "$build/raya.budget"
: >"$build/runs"
matrix --raya "$build/flaky" --only "PoCL loopvec" --checks build --repeat 2
((code == 0 && $(wc -l <"$build/runs") == 2)) || fail "exit code $code of two right runs"

# A check of verify may take ten build budgets of the implementation.
: >"$build/raya.timeouts"
matrix --only "PoCL loopvec" --checks number
((code == 0)) && [[ $(<"$build/raya.timeouts") == 600 ]] || fail "verify has --timeout $(<"$build/raya.timeouts")"
rm "$build/raya.timeouts"

# Tests matrices without a right cell, where every check is skipped or too slow; then a check that passes and then crashes.
matrix --only "PoCL loopvec" --checks image,machine
((code == 1)) || fail "exit code $code where nothing was decided"
expect "2 cells: 0 right, 0 FAIL, 2 undecided. No right cell: PoCL loopvec."
touch "$build/raya.slow"
matrix --only "PoCL loopvec" --checks number --timeout 1
((code == 1)) || fail "exit code $code where all was too slow"
expect "| too slow |"
expect "PoCL loopvec, number: not done after 1 s"
matrix --only "PoCL loopvec" --checks number,renders --timeout 1
((code == 0)) || fail "exit code $code where one check was too slow"
expect "2 cells: 1 right, 0 FAIL, 1 undecided."
rm "$build/raya.slow"
touch "$build/raya.crash"
matrix --only "PoCL loopvec" --checks number,renders
((code == 1)) || fail "exit code $code where verify crashed after its last check"
expect "number: exit code -11, though no check failed"
rm "$build/raya.crash"

# Kernels as SPIR-V, on an implementation that does not accept it, and on one that does.
llvm=$("$root/tools/setup" --llvm)
if command -v "clang-$llvm" "llvm-spirv-$llvm" >"$build/paths" && (($(wc -l <"$build/paths") == 2)); then
    matrix --only "PoCL, SPIR-V" --list
    expect "PoCL, SPIR-V: no device accepts SPIR-V"
    touch "$build/raya.spirv"
    matrix --only "PoCL, SPIR-V" --checks number,renders,defects
    ((code == 1)) || fail "exit code $code with SPIR-V"
    expect "| PoCL, SPIR-V | toy | OpenCL 3.0, driver 1 | 1 right | 24 right | FAIL |"  # the mock fails with RAYA_BUILD_OPTIONS
    rm "$build/raya.spirv"
fi

# --resume: what was right on the same commit does not run again; a failed cell, and everything on another commit, does.
export MOCK_COMMIT=0123456789ab
for run in "0 right" "1 wrong" "1 wrong --resume" "0 right --resume" "0 wrong --resume" "1 wrong --resume 987654321abc"; do
    read -r wanted image resume commit <<<"$run"
    rm -f "$build/raya.hash"
    [[ $image == right ]] || echo 11111111111111111111111111111111 >"$build/raya.hash"
    MOCK_COMMIT=${commit:-$MOCK_COMMIT} matrix --only "PoCL loopvec" --checks renders $resume
    ((code == wanted)) || fail "exit code $code of a run with $run"
done
unset MOCK_COMMIT
rm "$build/raya.hash"

# Oclgrind: a render without a fault; then a kernel that makes the same image but also writes beyond a buffer.
if command -v oclgrind >/dev/null; then
    "$patch_kernels" "$build/kernels"
    mv "$build/raya" "$build/mock_raya"
    cat >"$build/raya" <<RAYA
#!/usr/bin/env bash
"$build/mock_raya" "\$@" || exit
[[ \$1 != render ]] || exec "$raya" render "$root/scenes/planes.nff" -o "$build/x.pfm" --quiet --size 2 --pes 1 --lanes 1 --kernel-dir "$build/kernels"
RAYA
    chmod +x "$build/raya"
    matrix --only oclgrind --checks renders,defects
    ((code == 0)) || fail "exit code $code where Oclgrind has nothing to report"
    expect "| 3 right | 1 known |"
    "$patch_kernels" "$build/kernels" ring/trace.cl "open_store(&store);" "open_store(&store); pixels[1 << 26] = 0;"
    matrix --only oclgrind --checks renders,defects
    ((code == 1)) || fail "exit code $code where Oclgrind reports a write beyond a buffer"
    expect "| FAIL | 1 known |"
    expect "Oclgrind, renders: spheres --format fp32 --lanes 1: found by Oclgrind: Invalid write of size 4 at global memory address"
fi

matrix --only "no such implementation"
((code == 1)) || fail "exit code $code where nothing ran"
matrix --checks defects --list
((code == 0)) || fail "exit code $code of --list"
expect "Oclgrind: "
# If a GPU driver is installed, its row replaces this one, even without a GPU.
ls /etc/OpenCL/vendors | grep -vqE '^(pocl|rusticl|mesa)[.]icd$' || expect "GPU: "

# --write is refused if only a part of the matrix is requested.
page=$(<"$root/docs/portability.md")
for part in "--only PoCL" "--checks renders" "--only PoCL --checks defects" "--skip PoCL" "--shard 1/2"; do
    # shellcheck disable=SC2086  # several words
    matrix --write $part
    ((code == 2)) || fail "exit code $code of --write $part"
    grep -q "would lose" "$build/stderr" || fail "no reason for refusing --write $part"
done
[[ $page == "$(<"$root/docs/portability.md")" ]] || fail "docs/portability.md was written"
for other in "--list" "--junit x.xml"; do
    # shellcheck disable=SC2086  # several words
    matrix --root trixie $other
    ((code == 2)) || fail "exit code $code of --root with $other"
done
# The page's rows of --root: a known failure is marked and explained, an unknown one is not.
rows=$(python3 -B - "$root/tools" <<'EOF'
import importlib.machinery, importlib.util, sys
sys.path.insert(0, sys.argv[1])
loader = importlib.machinery.SourceFileLoader("portability", sys.argv[1] + "/portability")
portability = importlib.util.module_from_spec(importlib.util.spec_from_loader("portability", loader))
loader.exec_module(portability)
saved = {"devices": {"PoCL loops": ["a CPU", "6.0"]}, "cells": {"PoCL loops, image": ["FAIL 2/23", 3, ["two"]], "PoCL loops, machine": ["FAIL 1/25", 4, []]}}
print(portability.rows_of_root("trixie", saved, ["number", "machine", "image"]))
EOF
)
[[ $rows == *"['trixie: PoCL loops', 'a CPU', '6.0', '', 'FAIL 1/25', 'XFAIL 2/23', '7']"*"- trixie: PoCL loops, image: two"*"image: FAIL 2/23 (expected: "* ]] ||
    fail "rows of --root: $rows"
matrix --checks renders,nonsense
((code == 2)) || fail "exit code $code of an unknown check"
echo "tools/portability: as expected"
