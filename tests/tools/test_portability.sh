#!/usr/bin/env bash
# Tests tools/portability with mock programs instead of raya and its tests: matrix and exit code for right, wrong and missing results.
set -euo pipefail
root=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..
build=$(mktemp -d)
trap 'rm -rf "$build"' EXIT
mkdir "$build/tests"

# Mock programs: every implementation has a device; PoCL's basic device renders a wrong image; an unexpected defect occurs without the optimiser.
cat >"$build/raya" <<'RAYA'
#!/usr/bin/env bash
case $1 in
    --version) echo "raya 0.0.0" ;;
    verify)
        [[ $2 == --help ]] && { echo "  --quick"; exit 0; }
        [[ $2 == --list && $RAYA_BUILD_OPTIONS == --il ]] && exit 3
        [[ $2 == --list ]] && exit 0
        status=PASS
        [[ ${POCL_WORK_GROUP_METHOD-} == loops ]] && status=FAIL
        [[ -e $0.slow ]] && sleep 20
        while [[ $1 != --timeout ]]; do shift; done
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
cat >"$build/tests/portability_defects" <<'DEFECTS'
#!/usr/bin/env bash
echo "long_loop, n = 9: expected failure, 8 instead of 9: a reason"
[[ ${RAYA_BUILD_OPTIONS-} == "" ]]
DEFECTS
cat >"$build/tests/test_number" <<'VECTORS'
#!/usr/bin/env bash
echo "All tests passed ($RAYA_NUMBER_CASES assertions in 2 test cases)"
VECTORS
chmod +x "$build/raya" "$build"/tests/*

fail() { echo "FAILED: $1"; echo "$out"; exit 1; }
matrix() { code=0; out=$("$root/tools/portability" --build "$build" --hashes "$build/renders.csv" "$@" 2>"$build/stderr") || code=$?; }
expect() {  # expect CODE TEXT...
    ((code == $1)) || fail "exit code $code, not $1"
    local text
    for text in "${@:2}"; do [[ $out == *"$text"* ]] || fail "no '$text'"; done
}

# Hashes are written once; then the hashes of every implementation, including the first, are compared with them.
matrix --write-hashes
expect 0 "20 renders of 17 images, 20 of them new or changed"
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

# A fault in one check of one implementation. The mock raya reads the fault from a file.
one_fault() {  # one_fault FILE CONTENT CHECK TEXT...: exit code 1
    echo "$2" >"$build/raya.$1"
    matrix --only "PoCL loopvec" --checks "$3"
    rm "$build/raya.$1"
    expect 1 "${@:4}"
}
one_fault budget "" build "| FAIL 1.5 s |" "above --limit 1 s"
one_fault hash 11111111111111111111111111111111 renders "wrong image 11111111111111111111111111111111; right: 5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a5a"
one_fault reflected 6 renders "spheres --format fp32 --accel grid: wrong counts: reflected is 6, right: 5"
one_fault crash "" number,renders "number: exit code -11, though no check failed"
sed -i '/cones,--format spa22/d' "$build/renders.csv"
matrix --only "PoCL loopvec" --checks renders
expect 1 "right: not in renders.csv, see --write-hashes"
matrix --write-hashes
expect 0 "20 renders of 17 images, 1 of them new or changed"

# The environment of the caller, such as a CI job, has no effect.
export RAYA_BUILD_OPTIONS=-cl-opt-disable POCL_DEVICES=basic OCL_ICD_VENDORS=/nowhere RAYA_NUMBER_CASES=1
matrix --only "PoCL loopvec"
unset RAYA_BUILD_OPTIONS POCL_DEVICES OCL_ICD_VENDORS RAYA_NUMBER_CASES
expect 0 "| PoCL loopvec | toy | OpenCL 3.0, driver 1 | 1 right | - | - | - | 40000 per format right | 24 right | 1 known |" \
    "PoCL loopvec, image: SKIP groups: one work-item only" $'\n'"8 cells: 5 right, 0 FAIL, 3 undecided." \
    "PoCL loopvec, defects: long_loop, n = 9: expected failure, 8 instead of 9: a reason"

matrix --only PoCL
expect 1 "| PoCL loops | toy | OpenCL 3.0, driver 1 | FAIL 1/1 |" "PoCL loops, number: FAIL add: bits differ" \
    "| PoCL -cl-opt-disable | toy | OpenCL 3.0, driver 1 | 1 right | - | - | - | 40000 per format right | 24 right | FAIL |" \
    "| PoCL basic | toy | OpenCL 3.0, driver 1 | 1 right | - | - | - | 40000 per format right | FAIL 24/24 |" "basic; right: 5a5a5a5a"

# Files for CI. PoCL loops computes wrong numbers; a list of expected failures turns that around; a pattern without a cell causes a warning.
read_junit() {  # read_junit PYTHON_EXPRESSION: prints it for the element `suites`
    python3 -c "import sys, xml.etree.ElementTree as xml; suites = xml.parse(sys.argv[1]).getroot(); print($1)" "$build/junit.xml"
}
ci=(--only PoCL --skip "PoCL*3.0" --checks number,image --junit "$build/junit.xml")
matrix "${ci[@]}"
expect 1
[[ $(read_junit '[(s.get("name"), s.get("tests"), s.get("failures"), s.get("skipped")) for s in suites][2]') == "('PoCL loops', '2', '1', '1')" ]] ||
    fail "$(<"$build/junit.xml")"
[[ $(read_junit '[c.get("name") for c in suites.iter("testcase") if c.find("failure") is not None]') == "['PoCL loops, number']" ]] ||
    fail "$(<"$build/junit.xml")"
printf '# list\nloops*number | bits differ | https://example.org/1\nno such cell | a reason\n' >"$build/expect"
matrix "${ci[@]}" --expect "$build/expect"
expect 0 "12 cells: 5 right, 0 FAIL, 6 undecided, 1 XFAIL." "PoCL loops, number: FAIL 1/1 (expected: bits differ, https://example.org/1)"
[[ $(grep "matches no check" "$build/stderr") == *"$build/expect:3: \"no such cell\" matches no check" ]] || fail "$(<"$build/stderr")"
echo "PoCL basic, number | a reason" >"$build/expect"
matrix "${ci[@]}" --expect "$build/expect" --skip "PoCL loops" --checks number,build
expect 1 "XPASS 1 right"
echo "PoCL basic, number" >"$build/expect"
matrix --expect "$build/expect"
expect 2
grep -qF "$build/expect:1: expected PATTERN | REASON" "$build/stderr" || fail "$(<"$build/stderr")"

# Every cell is in exactly one shard.
names() { read_junit '"\n".join(c.get("name") for c in suites.iter("testcase"))'; }
for shard in 1/3 2/3 3/3; do
    matrix --only PoCL --skip "3.0 (PyPI)" --checks number,image,build --shard $shard --junit "$build/junit.xml"
    names
done >"$build/shards"
matrix --only PoCL --skip "3.0 (PyPI)" --checks number,image,build --junit "$build/junit.xml"
names | sort | diff - <(sort "$build/shards") || fail "the shards differ from the whole"
(($(wc -l <"$build/shards") == 18)) || fail "$(<"$build/shards")"

# Matrices without a right cell, where every check is skipped or too slow.
matrix --only "PoCL loopvec" --checks image,machine
expect 1 "2 cells: 0 right, 0 FAIL, 2 undecided. No right cell: PoCL loopvec."
touch "$build/raya.slow"
matrix --only "PoCL loopvec" --checks number --timeout 1
expect 1 "| too slow |" "PoCL loopvec, number: not done after 1 s"
rm "$build/raya.slow"
matrix --only "no such implementation"
expect 1

# Bad options. --write is refused if only a part of the matrix is requested.
for bad in "--shard 3/2" "--checks renders,nonsense" "--root trixie --list" "--write --only PoCL" "--write --shard 1/2"; do
    # shellcheck disable=SC2086  # several words
    matrix $bad
    expect 2
done
echo "tools/portability: as expected"
