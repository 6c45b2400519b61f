#!/usr/bin/env bash
# Tests tools/gpu_day with a mock raya that renders nothing, in a folder like that of tools/bundle: interruption and resuming; page and exit code for
# steps that are right, wrong, out of time or missing.
set -euo pipefail
root=$(readlink -f "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
day=$scratch/bundle out=$scratch/out
mkdir -p "$day" "$out/steps"
cp -r "$root"/{tools/gpu_day,tools/programs.py,tools/renders.py,tests/portability/gpu_day.csv,scenes} "$day"

fail() { echo "FAILED line ${BASH_LINENO[0]}: $1"; echo "$page"; cat "$scratch/err"; exit 1; }
gpu_day() { code=0; page=$("$day/gpu_day" --out "$out" --small "$@" 2>"$scratch/err") || code=$?; }
expect() {  # expect CODE TEXT...
    [[ $code == "$1" ]] || fail "exit code $code, not $1"
    local text
    for text in "${@:2}"; do [[ $page$(<"$scratch/err") == *"$text"* ]] || fail "no '$text'"; done
}
count_finished() { find "$out/steps" -name '*.txt' | wc -l; }

# Rows that are in both renders.csv and gpu_day.csv must be equal. An image has one hash for all accelerators, machines and numbers of nodes.
common=0
while IFS=, read -r scene options row; do
    found=$(awk -F, -v scene="$scene" -v options="$options" '$1 == scene && $2 == options { sub(/^[^,]*,[^,]*,/, ""); print }' "$day/gpu_day.csv")
    [[ -z $found || $found == "$row" ]] || { echo "FAILED: $scene $options: $row in renders.csv, $found in gpu_day.csv"; exit 1; }
    [[ -z $found ]] || common=$((common + 1))
done < <(grep -v '^#' "$root/tests/portability/renders.csv")
((common == 16)) || { echo "FAILED: $common rows in both lists, not the header and 15"; exit 1; }
ambiguous=$(grep -v '^#' "$day/gpu_day.csv" | sed -E 's/ --(accel|machine|nodes) [^ ,]*//g' | cut -d, -f1-3 | sort -u | cut -d, -f1,2 | uniq -d)
[[ -z $ambiguous ]] || { echo "FAILED: several hashes of $ambiguous"; exit 1; }

cat >"$day/raya" <<'RAYA'
#!/usr/bin/env bash
# The mock raya: its renders have the hashes of right.csv. A file in this folder injects the fault that its name describes.
here=$(dirname "$0")
fault() { [[ -e $here/$1 ]]; }
case $1 in
    --version) echo "raya 0.0.0" ;;
    page) cp "$2" "$4" ;;
    devices) if fault no_device; then echo "raya: no OpenCL device"; exit 3; else echo toy; fi ;;
    verify)
        printf 'toy (Toy, driver 1)\nPASS  number\ntoy: 1 check passed, 0 failed\n'
        ! fault wrong_verify || { echo "FAIL  geometry  grid"; exit 4; } ;;
    generate) : >"${@: -1}" ;;
    bench)
        if [[ $2 == --help-all ]]; then printf 'simulates a PE, 1..1,024; default\n'; exit; fi
        group=10 words="$*"
        [[ $words != *--group* ]] || group=$(sed 's/.*--group \([0-9]*\).*/\1/' <<<"$words")
        printf 'trace  fp32  1  %d  %d  5  1 1 1 1 1 abc\ntrace  e6m15  1  1  2000.5  5  1 1 1 1 1 abc\n' "$group" $((group * 80)) ;;
    render)
        scene=$(basename "$2" .nff)
        report=$6
        read -ra words <<<"${*:7}"
        options=
        for ((i = 0; i < ${#words[@]}; ++i)); do
            case ${words[i]} in
                --format | --antialias | --nodes) options+=" ${words[i]} ${words[i + 1]}" ;;
                --accel | --machine) [[ ${words[i + 1]} =~ ^(grid|bvh|torus)$ ]] && options+=" ${words[i]} ${words[i + 1]}" ;;
                --size) [[ ${words[i + 1]} == 20x20 ]] || options+=" --size ${words[i + 1]}" ;;
            esac
        done
        IFS=, read -r -a n < <(grep -F "$scene,${options# }," "$here/right.csv")
        hash=${n[2]}
        printf '{\n  "rays": {\n    "primary": %d,\n    "primary_hits": %d,\n    "reflected": %d,\n    "refracted": %d,\n    "shadow": %d,\n    "shadow_hits": %d\n  },\n' "${n[@]:3:6}" >"$report"
        printf '  "tests": {\n    "sphere": %d,\n    "plane": %d,\n    "polygon": %d,\n    "cone": %d\n  },\n  "walks": %d,\n  "steps": %d,\n' "${n[@]:9:6}" >>"$report"
        printf '  "shading": {\n    "hits": %d,\n    "lit": %d,\n    "highlights": %d\n  },\n' "${n[@]:15:3}" >>"$report"
        printf '  "load": {\n    "mean": 1.5,\n    "per_pe": [\n      %d,\n      1\n    ],\n    "trace": {\n      "per_pe": [\n        5\n      ]\n    }\n  },\n' $((n[18] - 1)) >>"$report"
        ((n[20] == 0)) || printf '  "torus": {\n    "discarded": %d,\n    "packets": {\n      "primary": {\n        "made": %d,\n        "ended": 1\n      },\n      "return": {\n        "made": 2,\n        "ended": 2\n      }\n    },\n    "hops": %d\n  },\n' "${n[19]}" $((n[20] - 2)) "${n[21]}" >>"$report"
        printf '  "image": {\n    "hash": "%s"\n  },\n  "measured": {\n    "hits": 3\n  }\n}\n' "$hash" >>"$report"
        echo "roof    trace: compute bound"
        echo "image   x.ppm ($hash)" ;;
esac
RAYA
chmod +x "$day/raya"
cp "$day/gpu_day.csv" "$day/right.csv"

# gpu_day is killed while it runs: finished steps must not run again.
"$day/gpu_day" --out "$out" --small --all >"$scratch/page" 2>"$scratch/err" &
for ((i = 0; i < 20000; ++i)); do
    (($(count_finished) < 6)) || break
    sleep 0.05
done
kill -TERM $! || { page=$(<"$scratch/page") && fail "gpu_day finished before it could be killed"; }
wait $! && { page='' && fail "exit code 0 of a killed run"; }
before=$(count_finished)
first=$(cd "$out/steps" && md5sum verify-quick.txt devices.txt)
gpu_day
expect 0 "| 1 | devices, verify --quick | 2 | 0 | 0" "hashes (not done)"
gpu_day --next
expect 0 "| 3 | hashes | 16 | 0 | 0" "verify --full | 2 | 0" "torus: 4 of 4 right" "large pictures, goals, ranks (not done)"
(($(count_finished) > before)) || fail "nothing ran after it was killed"
[[ $(cd "$out/steps" && md5sum verify-quick.txt devices.txt) == "$first" ]] || fail "finished steps ran again"
gpu_day --all
expect 0 "None of the steps that ran" "64 x 64, 30 spheres" "balls 2, bvh" "roofline, tuning | 1" "goals, ranks |" "torus-spa22: "
[[ $page != *"not done"* && $page != *"not measured"* ]] || fail "the page is not complete"
[[ $page == "$(<"$out/page.md")" ]] || fail "page.md differs from the printed page"
[[ -s $out/page.html ]] || fail "there is no page.html"
right=$(python3 -c 'import json, sys; print(sum(step["verdict"] == "right" for step in json.load(sys.stdin)["steps"]))' <"$out/report.json")
[[ $right == $(grep -l '^\[stage ., [0-9]* s\] right$' "$out"/steps/*.txt | wc -l) ]] || fail "report.json has other steps"
(($(wc -l <"$out/page.md") < 130)) || fail "page.md has 130 lines or more"

# A wrong count; then a wrong hash.
sed -i 's/^\(cones,--format spa22 --accel bvh,[^,]*,400,400\),[0-9]*,/\1,11,/' "$day/gpu_day.csv"
rm "$out"/steps/hash-bvh-cones-spa22.*
gpu_day --stage 3
expect 4 "bvh: 3 of 4 right" "- hash-bvh-cones-spa22: wrong counts: reflected is 106, right: 11"
sed 's/^\(cones,--format spa22 --accel bvh\),.*/\1,11111111111111111111111111111111/' "$day/right.csv" >"$day/gpu_day.csv"
rm "$out"/steps/hash-bvh-cones-spa22.*
gpu_day --stage 3
expect 4 "| 3 | hashes | 15 | 1 | 0" "bvh: 3 of 4 right" "- hash-bvh-cones-spa22: wrong image b2cf660716baa62806768b79dbedff7b; right: 11111111111111111111111111111111"
expect 4 "fp32, trace kernel | 5000 | 5120 | reached" "a third of the fp32 rate | 1706.67 | 2000.5 | reached" "1000 | 800 | missed"

# Each fault in a new folder: the page names the failed step, and the other steps run.
run_with_fault() { out=$scratch/$1; touch "$day/$1"; gpu_day "${@:2}"; rm "$day/$1"; }
cp "$day/right.csv" "$day/gpu_day.csv"
run_with_fault no_device --all
expect 3 "no device: raya: no OpenCL device" "devices: exit code 3"
[[ $(count_finished) == 1 ]] || fail "steps ran without a device"
run_with_fault wrong_verify --all
expect 4 "- verify-full-2: exit code 4" "FAIL  geometry  grid" "| 3 | hashes | 16 | 0 | 0" "| 1 | devices, verify --quick | 1 | 1 | 0"

# Bad options.
gpu_day --nonsense
expect 2 "gpu_day: "
code=0 page=$("$day/gpu_day" --all 2>"$scratch/err") || code=$?
expect 2 "required: --out"
echo "tools/gpu_day: as expected"
