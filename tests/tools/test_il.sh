#!/usr/bin/env bash
# Tests --il: kernels built from SPIR-V.
#   test_il.sh RAYA SPIRV_ON_POCL BUILD     the program; the library made of tests/cli/spirv_on_pocl.cpp; the build folder
# Exit code 77: no clang or llvm-spirv (tools/setup --gpu), or no PoCL. Intel's runtime is also tested if tools/portability --setup
# has fetched it.
set -euo pipefail
raya=$(readlink -f "$1") library=$(readlink -f "$2") build=$(readlink -f "$3")
root=$(dirname "$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")")
llvm=$("$root/tools/setup" --llvm)
for tool in clang-$llvm llvm-spirv-$llvm; do
    command -v $tool >/dev/null || { echo "skipped: no $tool"; exit 77; }
done
export OCL_ICD_VENDORS=/etc/OpenCL/vendors/pocl.icd
[[ -e $OCL_ICD_VENDORS ]] || { echo "skipped: no PoCL"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

fail() { echo "FAILED: $1"; echo "$out"; exit 1; }
run() { code=0; out=$(env "${variables[@]}" "$raya" "$@" 2>&1) || code=$?; }  # run ARGUMENT...: sets `out` and `code`
expect() { [[ $out == *"$1"* ]] || fail "no '$1'"; }                         # expect TEXT
render=(render "$root/scenes/mirrors.nff" --format fp32 --lanes 1 --size 20 --bounces 4 -o "$scratch/x.pfm" --report "$scratch/report.json")
hash_of() { sed -n 's/.*"hash": "\(.*\)".*/\1/p' "$scratch/report.json"; }

# A device that does not accept SPIR-V. From PoCL 5 on, PoCL does.
variables=(A=)
preload=()
run verify --list --il
if ((code == 3)); then
    ln -s "$library" "$scratch/spirv.so"  # LD_PRELOAD knows no blanks
    preload=("LD_PRELOAD=$scratch/spirv.so")
    run verify --il
    ((code == 3)) || fail "exit code $code of verify on a device that does not accept SPIR-V"
    expect "SPIR-V"
    expect "remedy: "
fi
run "${render[@]}"
((code == 0)) || fail "exit code $code from source"
from_source=$(hash_of)

# The same image and the same answers as from source; faults in the SPIR-V are found, so it is really used.
variables=(A= "${preload[@]}")
run "${render[@]}" --il
((code == 0)) || fail "exit code $code of a render"
[[ $(hash_of) == "$from_source" && $from_source =~ ^[0-9a-f]{32}$ ]] || fail "image $(hash_of), from source: $from_source"
grep -q '"build_options": ".* --il"' "$scratch/report.json" || fail "the report does not mention --il"
[[ $out != *warning* ]] || fail "a warning"
crashes=()
((${#preload[@]} > 0)) || crashes=(--skip "torus2d 3x2x2 root")  # PoCL 7.1: docs/defects.md
run verify --brief --lanes 1 --il "${crashes[@]}"
((code == 0)) || fail "exit code $code of verify"
expect "checks passed, 0 failed, 0 skipped"
if ((${#preload[@]} > 0)); then
    variables+=("RAYA_SPIRV_FAULT=129 131")  # OpFAdd, OpFSub
    run verify --brief --lanes 1 --il --only "number fp32"
    ((code == 4)) || fail "exit code $code of verify with a fault"
    expect "run raya verify without --il"
    run "${render[@]}" --il
    ((code != 0)) || [[ $(hash_of) != "$from_source" ]] || fail "the image is right in spite of a fault"
fi

# Missing compilers; a kernel with an error.
mkdir "$scratch/bin"
ln -s "$(command -v clang-$llvm)" "$scratch/bin"
variables=(A= "${preload[@]}" "PATH=$scratch/bin")
run "${render[@]}" --il
((code == 3)) || fail "exit code $code without llvm-spirv-$llvm"
expect "cannot run llvm-spirv-$llvm; remedy: install clang-$llvm and llvm-spirv-$llvm (tools/setup --gpu)"
variables=(A= "${preload[@]}")
cp -r "$root/kernels" "$scratch"
echo "int x = ;" >>"$scratch/kernels/ring/trace.cl"
run "${render[@]}" --il --kernel-dir "$scratch/kernels"
((code == 3)) || fail "exit code $code of a kernel with an error"
expect "building program 'ring/trace.cl': clang-$llvm ended with exit code 1"
expect "ring/trace.cl:"
tested="PoCL${preload:+ with a library that accepts SPIR-V}"
if [[ -e $build/implementations/intel-cpu.icd ]]; then
    variables=("OCL_ICD_VENDORS=$build/implementations/intel-cpu.icd")
    run "${render[@]}" --il
    [[ $(hash_of) == "$from_source" ]] || fail "Intel CPU: image $(hash_of), from source: $from_source"
    run verify --brief --lanes 1 --il
    ((code == 0)) || fail "exit code $code of verify on Intel CPU"
    tested+=", Intel CPU"
fi
echo "--il: the bits are those from source on $tested"
