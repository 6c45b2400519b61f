#!/usr/bin/env bash
# Compiles every kernel to SPIR-V with clang and llvm-spirv, and validates it with spirv-val for OpenCL 1.2.
#   tests/tools/test_spirv.sh       exit code 77: clang-15, llvm-spirv-15 or spirv-val is missing (tools/setup --gpu)
# Kernels are compiled unoptimised, to SPIR-V 1.0, because of defects of llvm-spirv-15: see docs/porting.md.
set -euo pipefail
root=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..
for tool in clang-15 llvm-spirv-15 spirv-val; do
    command -v $tool >/dev/null || { echo "skipped: no $tool"; exit 77; }
done
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
scene=(-DRAYA_GROUP=32 -DRAYA_BOUNCES=8 -DRAYA_POLYGONS=1 -DRAYA_PATCHES=1 -DRAYA_CONES=1 -DRAYA_BVH_STACK=15)

# module FILE OPTION...: makes $scratch/module.spv
module() {
    clang-15 -x cl -cl-std=CL1.2 -target spir64-unknown-unknown -O0 -Xclang -finclude-default-header -D__OPENCL_VERSION__=120 \
        -I "$root" "${scene[@]}" "${@:2}" -emit-llvm -c "$1" -o "$scratch/module.bc"
    llvm-spirv-15 --spirv-max-version=1.0 "$scratch/module.bc" -o "$scratch/module.spv"
}

modules=0
for kernel in "$root"/kernels/*/*.cl; do
    words_local=1 accels=(0) lane_counts=(1 16)
    case $kernel in
        */ring/trace.cl) accels=(0 1 2) ;;
        */checks/hits.cl) accels=(0 1 2) words_local=0 ;;
        */ring/filter.cl | */ring/contrast.cl | */torus/compose.cl) lane_counts=(1) ;;  # one pixel at a time
    esac
    for lanes in "${lane_counts[@]}"; do
        for format in "8 23" "6 15"; do
            for accel in "${accels[@]}"; do
                module "$kernel" -DRAYA_LANES="$lanes" -DRAYA_EXPONENT_BITS="${format% *}" -DRAYA_FRACTION_BITS="${format#* }" \
                    -DRAYA_ACCEL="$accel" -DRAYA_WORDS_LOCAL="$words_local"
                spirv-val --target-env opencl1.2 "$scratch/module.spv" ||
                    { echo "FAILED: ${kernel#"$root"/}, $lanes lanes, format $format, accelerator $accel"; exit 1; }
                modules=$((modules + 1))
            done
        done
    done
done
((modules >= 40)) || { echo "FAILED: only $modules modules"; exit 1; }
truncate -s -8 "$scratch/module.spv"
! spirv-val --target-env opencl1.2 "$scratch/module.spv" 2>"$scratch/errors" || { echo "FAILED: a truncated module is valid"; exit 1; }
echo "SPIR-V: $modules modules are valid"
