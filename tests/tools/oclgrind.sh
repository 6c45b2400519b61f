#!/usr/bin/env bash
# Every kernel under Oclgrind, an OpenCL implementation that watches each memory access: data races, values that were never
# set, wrong API calls, accesses outside a buffer, more than 32 KB of local memory.
#   tests/tools/oclgrind.sh RAYA      RAYA: the built program
# Renders each scene of scenes/ with one and four lanes, one and four work-items, on different arrays. Oclgrind's log must
# stay empty (its exit code is 0 all the same) and every image must be the one that the default device makes.
set -euo pipefail
raya=$(readlink -f "$1")
root=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export POCL_CACHE_DIR=$scratch

size=9x6
scenes=(centre spheres mirrors glass polygons cones planes)
runs=(
    "--lanes 1 --group 1 --pes 54"
    "--lanes 4 --group 1 --pes 4 --fold block"
    "--lanes 1 --group 4 --pes 4 --mapping column"
    "--lanes 4 --group 4 --pes 2 --offset 5"
)

# Unoptimised, as Oclgrind 21.10 knows neither the `freeze` nor the `noalias.scope.decl` that the optimiser makes.
# The check for values that were never set does not know clEnqueueFillBuffer: raya clears what it adds to by a write.
under_oclgrind() {
    env -u RAYA_DEVICE oclgrind --build-options -cl-opt-disable --data-races --uninitialized --check-api \
        --local-mem-size 32768 --log "$scratch/log" "$raya" "$@"
}

fail() { echo "FAILED: $*"; exit 1; }

hash_of_report() { grep -o '"hash": "[0-9a-f]*"' "$scratch/report.json"; }

check_scene() {  # check_scene NAME
    local scene=$1 wanted options found
    local render=(render "$root/scenes/$scene.nff" -o "$scratch/image.pfm" --report "$scratch/report.json" --quiet --size "$size")
    "$raya" "${render[@]}" --lanes 1 --group 1 --pes 54
    wanted=$(hash_of_report)
    for options in "${runs[@]}"; do
        rm -f "$scratch/log" "$scratch/report.json"
        # shellcheck disable=SC2086  # several words
        under_oclgrind "${render[@]}" $options || fail "$scene $options: exit code $?"
        [[ -e $scratch/log ]] || fail "$scene $options: Oclgrind left no log"
        [[ ! -s $scratch/log ]] || { head -n 40 "$scratch/log"; fail "$scene $options: Oclgrind found faults"; }
        found=$(hash_of_report)
        [[ $found == "$wanted" ]] || fail "$scene $options: image $found, the default device's $wanted"
    done
}

# The check itself must be able to fail: a kernel with a fault, made by replacing a line of trace.cl, must be reported.
check_fault() {  # check_fault OLD NEW REPORT
    rm -rf "$scratch/kernels" "$scratch/log"
    cp -r "$root/kernels" "$scratch/kernels"
    local kernel=$scratch/kernels/ring/trace.cl
    grep -qF -- "$1" "$kernel" || fail "trace.cl has no '$1' any more; give this check another fault"
    local text
    text=$(<"$kernel")
    printf '%s\n' "${text/"$1"/"$2"}" >"$kernel"
    under_oclgrind render "$root/scenes/planes.nff" -o "$scratch/image.pfm" --quiet --size 4 --pes 2 --lanes 1 --group 4 \
        --kernel-dir "$scratch/kernels" || true
    grep -qF -- "$3" "$scratch/log" || fail "with '$2' in place of '$1' Oclgrind does not report '$3'"
}

check_fault "barrier(CLK_LOCAL_MEM_FENCE);" "" "data race"
check_fault "store.totals[e] = 0;" ";" "Uninitialized value"
check_fault "pixels + (size_t)pe * capacity * 3" "pixels + (size_t)pe * capacity * 4" "Invalid write"

for scene in "${scenes[@]}"; do check_scene "$scene"; done
echo "Oclgrind: ${#scenes[@]} scenes, ${#runs[@]} runs each: nothing to report, the same images"
