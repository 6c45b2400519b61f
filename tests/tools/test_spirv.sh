#!/usr/bin/env bash
# Compiles every kernel to SPIR-V as raya does with --il (host/cl/kernel_source.cpp), validates it with spirv-val for OpenCL 1.2, and looks for uses of
# what clspv does not support (clspv_limits.py).
#   tests/tools/test_spirv.sh       exit code 77: clang, llvm-spirv or spirv-tools is missing (tools/setup --gpu)
set -euo pipefail
root=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..
llvm=$("$root/tools/setup" --llvm)
for tool in clang-$llvm llvm-spirv-$llvm spirv-val spirv-dis; do
    command -v "$tool" >/dev/null || { echo "skipped: no $tool"; exit 77; }
done
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/modules"
scene=(-DRAYA_GROUP=32 -DRAYA_BOUNCES=8 -DRAYA_POLYGONS=1 -DRAYA_PATCHES=1 -DRAYA_CONES=1 -DRAYA_BVH_STACK=15)
limits=("$root/tests/tools/clspv_limits.py")

# module FILE MODULE OPTION...: compiles a kernel
module() {
    "clang-$llvm" -x cl -target spir64 -O2 -Xclang -disable-llvm-passes -emit-llvm -cl-std=CL1.2 -I "$root" "${scene[@]}" "${@:3}" -c "$1" -o "$2.bc"
    "llvm-spirv-$llvm" --spirv-max-version=1.1 "$2.bc" -o "$2"
}

for kernel in "$root"/kernels/*/*.cl; do
    words_local=1 accels=(0) lane_counts=(1 16)
    case $kernel in
        */ring/trace.cl) accels=(0 1 2) ;;
        */checks/hits.cl) accels=(0 1 2) words_local=0 ;;
        */ring/filter.cl | */ring/contrast.cl | */torus/compose.cl) lane_counts=(1) ;;  # one pixel at a time
    esac
    for lanes in "${lane_counts[@]}"; do
        exact=$((lanes > 1))  # with one lane, as on clvk: division is refined and fma() is emulated
        for format in "8 23" "6 15"; do
            for accel in "${accels[@]}"; do
                name="$(basename "$kernel"), $lanes lanes, format $format, accelerator $accel"
                module "$kernel" "$scratch/modules/$name" -DRAYA_LANES="$lanes" -DRAYA_EXPONENT_BITS="${format% *}" \
                    -DRAYA_FRACTION_BITS="${format#* }" -DRAYA_ACCEL="$accel" -DRAYA_WORDS_LOCAL="$words_local" \
                    -DRAYA_EXACT_DIVIDE="$exact" -DRAYA_EXACT_FMA="$exact"
                spirv-val --target-env opencl1.2 "$scratch/modules/$name" || { echo "FAILED: $name"; exit 1; }
                rm "$scratch/modules/$name.bc"
            done
        done
    done
done
files=("$scratch"/modules/*)
((${#files[@]} >= 40)) || { echo "FAILED: only ${#files[@]} modules"; exit 1; }
"${limits[@]}" "${files[@]}" || { echo "FAILED: clspv does not support these modules"; exit 1; }
truncate -s -8 "${files[0]}"
! spirv-val --target-env opencl1.2 "${files[0]}" 2>"$scratch/errors" || { echo "FAILED: a truncated module is valid"; exit 1; }

# Faults, each found as TEXT.
# fault TEXT SOURCE OPTION...
fault() {
    echo "$2" >"$scratch/fault.cl"
    module "$scratch/fault.cl" "$scratch/fault.spv" "${@:3}"
    [[ $("${limits[@]}" "$scratch/fault.spv") == *": $1"* ]] || { echo "FAILED: not found: $1: $("${limits[@]}" "$scratch/fault.spv")"; exit 1; }
}
fault "capability Float64" "kernel void k(global float* a) { a[0] = (double)a[1] * a[2]; }"
fault "capability Int16" "kernel void k(global short* a) { a[0] = a[1]; }"
fault "capability GenericPointer" "kernel void k(global int* a) { int* b = a; *b = 1; }" -cl-std=CL2.0
fault "capability Int64Atomics" "#pragma OPENCL EXTENSION cl_khr_int64_base_atomics : enable
    kernel void k(volatile global long* a) { atom_add(a, 1); }"
fault "function sin" "kernel void k(global float* a) { a[0] = sin(a[1]); }"
fault "function printf" "kernel void k() { printf(\"1\"); }"
fault "pointer to a pointer" "kernel void k(global int* a) { global int* local b[2]; b[get_local_id(0)] = a; barrier(1); *b[0] = 1; }"
fault "pointer to a pointer" "struct s { int n; global int* a[3]; }; kernel void k(global struct s* a) { *a->a[1] = 1; }"
fault "conversion between" "kernel void k(global int* a) { a[0] = (size_t)a; }"
fault "conversion between" "kernel void k(local int* a) { *(local int*)((size_t)a & ~3u) = 1; }"
fault "packed struct" "struct __attribute__((packed)) s { char c; float f; }; kernel void k(global struct s* a) { a->f = 1; }"
fault "program-scope variable %n" "global int n; kernel void k(global int* a) { a[0] = n; }" -cl-std=CL2.0
fault "recursion in %g" "int g(int n); int f(int n) { return n ? g(n - 1) : 1; } int g(int n) { return f(n); }
    kernel void k(global int* a) { a[0] = g(a[0]); }"
echo "SPIR-V: ${#files[@]} modules are valid, and within the limits of clspv"
