#!/usr/bin/env bash
# Runs every kernel under Oclgrind, an OpenCL implementation that detects data races, uninitialised values, wrong API calls, accesses outside a
# buffer, and more than 32 KB of local memory.
#   tests/tools/oclgrind.sh RAYA PATCH_KERNELS      the built program; tests/kernels/patch_kernels.cpp
# Renders each scene of scenes/ with one and four lanes and work-items, on several arrays, and one scene with antialiasing.
# Oclgrind's log must stay empty (its exit code is always 0), and every image must be that of the default device. By default it runs one scene
# and one injected fault; with RAYA_THOROUGH=1, all of them.
set -euo pipefail
command -v oclgrind >/dev/null || { echo "skipped: no oclgrind"; exit 77; }
raya=$(readlink -f "$1")
patch_kernels=$(readlink -f "$2")
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
# Options of the exchange between PEs; tested only with the first scene, because the exchange does not depend on objects.
exchanges=(
    "--antialias filter --pes 9 --offset 2 --group 4"
    "--antialias filter --pes 4 --fold block"
    "--antialias supersample --pes 9 --offset 2 --lanes 4 --group 4"
    "--antialias supersample --points diagonals --pes 20 --lanes 1 --threshold 0.5"
)

thorough=${RAYA_THOROUGH-}
if [[ -z $thorough ]]; then
    scenes=(polygons)
    runs=("${runs[3]}")
    exchanges=("${exchanges[2]}")
fi

# Kernels are compiled unoptimised: Oclgrind 21.10 supports neither `freeze` nor `noalias.scope.decl`, which LLVM's optimiser emits.
# The check for uninitialised values does not support clEnqueueFillBuffer, so raya clears buffers by writes. It does not track buffer
# copies either, so the check is off for renders with rotations.
watch_values=--uninitialized
under_oclgrind() {
    # shellcheck disable=SC2086  # may be empty
    env -u RAYA_DEVICE oclgrind --build-options -cl-opt-disable --data-races $watch_values --check-api \
        --local-mem-size 32768 --log "$scratch/log" "$raya" "$@"
}

fail() { echo "FAILED: $*"; exit 1; }

hash_of_report() { grep -o '"hash": "[0-9a-f]*"' "$scratch/report.json"; }

check_run() {  # check_run SCENE OPTIONS DEFAULT_OPTIONS: compares the image with that of the default device. SCENE: a name in scenes/, or a file
    local scene=$1 options=$2 file=$1 expected found
    [[ -e $file ]] || file=$root/scenes/$scene.nff
    local render=(render "$file" -o "$scratch/image.pfm" --report "$scratch/report.json" --quiet --size "$size")
    # shellcheck disable=SC2086  # several words
    "$raya" "${render[@]}" $3
    expected=$(hash_of_report)
    rm -f "$scratch/log" "$scratch/report.json"
    # shellcheck disable=SC2086
    under_oclgrind "${render[@]}" $options || fail "$scene $options: exit code $?"
    [[ -e $scratch/log ]] || fail "$scene $options: Oclgrind left no log"
    [[ ! -s $scratch/log ]] || { head -n 40 "$scratch/log"; fail "$scene $options: Oclgrind found faults"; }
    found=$(hash_of_report)
    [[ $found == "$expected" ]] || fail "$scene $options: image $found, on the default device $expected"
}

# Oclgrind must report an injected fault.
check_fault() {  # check_fault FILE FIND REPLACE REPORT OPTION...
    rm -rf "$scratch/kernels" "$scratch/log"
    "$patch_kernels" "$scratch/kernels" "$1" "$2" "$3"
    under_oclgrind render "$root/scenes/planes.nff" -o "$scratch/image.pfm" --quiet --size 4 --lanes 1 --group 4 \
        --kernel-dir "$scratch/kernels" "${@:5}" || true
    grep -qF -- "$4" "$scratch/log" || fail "with '$3' instead of '$2' Oclgrind does not report '$4'"
}

check_fault ring/pixel_store.clh "pixels + 3 * first" "pixels + 4 * first" "Invalid write" --pes 2
if [[ -n $thorough ]]; then
    check_fault ring/trace.cl $'barrier(CLK_LOCAL_MEM_FENCE);\n    pixel_store store;' "pixel_store store;" "data race" --pes 2
    check_fault ring/pixel_store.clh "store->totals[e].all = (wide_count)(0);" ";" "Uninitialized value" --pes 2
    check_fault ring/filter.cl "own_sums = sums + (size_t)group * capacity * 3;"$'\n    const uint end = min(capacity, raya_share_size(block' \
        "own_sums = sums + (size_t)(group + 1) * capacity * 3;"$'\n    const uint end = min(capacity, raya_share_size(block' \
        "Invalid read" --pes 2 --antialias filter
fi

for scene in "${scenes[@]}"; do
    for options in "${runs[@]}"; do check_run "$scene" "$options" "--lanes 1 --group 1 --pes 54"; done
done
# A BVH of more than one level: spheres, polygons of 3, 4, 6 and 10 corners, patches and cones, some of them mirrors.
if [[ -n $thorough ]]; then
    "$raya" generate balls --level 3 -o "$scratch/balls.nff"
    { cat "$root/scenes/polygons.nff"; awk 'FNR == 1 { objects = 0 } /^f / { objects = 1 } objects' "$root/scenes/cones.nff" "$scratch/balls.nff"; } >"$scratch/kinds.nff"
    for lanes in 1 4; do check_run "$scratch/kinds.nff" "--machine grande --accel bvh --lanes $lanes --group 3 --pes 2" "--machine grande"; done
    check_fault bvh/descent.clh "p->top[lane] = 0;" ";" "uninitialized value" --machine grande --accel bvh --pes 2
fi
watch_values=
for options in "${exchanges[@]}"; do
    # The expected image: the same antialiasing on one PE of the machine `grande`.
    method=$(sed -E 's/--(pes|offset|group|lanes|fold) [a-z0-9]+//g' <<<"$options")
    check_run "${scenes[0]}" "$options" "$method --machine grande --format spa22 --pes 1"
done
if [[ -n $thorough ]]; then
    check_fault torus/inject.cl $'*next = end;\n        node_barrier();' "*next = end;" "data race" --machine torus --nodes 2x1x1
    check_fault torus/route.cl $'goal = RAYA_STAYS;\n        node_barrier();' "goal = RAYA_STAYS;" "data race" --machine torus --nodes 2x1x1
    check_fault torus/node.clh "starts[slot + 1] - first" "starts[slot + 1] + first" "Invalid write" --machine torus --nodes 2x1x1
    check_fault torus/accept.cl $'vote(votes, goal);\n        node_barrier();' "vote(votes, goal);" "data race" --machine torus --nodes 2x1x1
fi
# Tests nodes with several work-items, rays that wait for free queue entries, and both values of --inject.
size=6
[[ -z $thorough ]] || check_run cones "--machine torus --nodes 2x2x1 --lanes 4 --group 3 --queue 200" "--machine grande"
check_run planes "--machine torus --nodes 2x1x2 --lanes 1 --group 4 --inject root --links torus2d" "--machine grande"
# Tests a ray pool, from which idle lanes take their next rays.
size=4
check_run glass "--machine grande --accel grid --lanes 4 --group 3 --pes 2" "--machine grande"
echo "Oclgrind: ${#scenes[@]} scenes, ${#runs[@]} runs each, ${#exchanges[@]} of the exchange, the torus, the grid${thorough:+ and the BVH}: no reports, the same images"
