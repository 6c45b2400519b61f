#!/usr/bin/env bash
# Tests the light build (docs/verify.md) and tools/bundle: the packed program runs without raya's build dependencies; tools/bundle refuses a program
# that needs other libraries.
#   test_bundle.sh BUILD     the build folder. The light build is made as in a checkout of PoCL (docs/ci/pocl), in BUILD/light
set -euo pipefail
build=$(readlink -f "$1")
root=$(readlink -f "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fail() { echo "FAILED line ${BASH_LINENO[0]}: $1"; exit 1; }
bundle() { code=0; out=$("$root/tools/bundle" "$@" 2>&1) || code=$?; }
expect() { [[ $code == "$1" && $out == *"$2"* ]] || fail "exit code $code: $out"; }  # expect CODE TEXT

mkdir -p "$build/light/pocl/examples/raya"
cp "$root/docs/ci/pocl/CMakeLists.txt" "$build/light/pocl/examples/raya"
cat >"$build/light/pocl/CMakeLists.txt" <<'EOF'
cmake_minimum_required(VERSION 3.25)
project(pocl NONE)
enable_testing()
include(ExternalProject)
set(TESTS_USE_ICD ON)
set(TESTSUITE_BASEDIR ${PROJECT_BINARY_DIR}/examples)
add_custom_target(prepare_examples)
add_subdirectory(examples/raya)
EOF
light=$build/light/examples/raya/src/raya-build
if ! cmake -S "$build/light/pocl" -B "$build/light" -DRAYA_SOURCE="$root" >"$scratch/log" 2>&1 ||
    ! CMAKE_BUILD_PARALLEL_LEVEL=2 cmake --build "$build/light" --target prepare_examples >"$scratch/log" 2>&1 ||
    ! ctest --test-dir "$build/light" -L raya --output-on-failure >"$scratch/log" 2>&1 ||
    ! RAYA=$light/raya TEST_TYPE=smoke TOTAL_SHARDS=32 python3 "$root/docs/ci/therock/test_raya.py" >"$scratch/log" 2>&1; then
    fail "$(<"$scratch/log")"
fi
[[ $(tail -n 1 "$scratch/log") == "failed tests: none" ]] || fail "$(<"$scratch/log")"
! grep -E '^(OpenImageIO|assimp|Imath|pybind11|Catch2)\w*:' "$light/CMakeCache.txt" || fail "the light build looks for these libraries"
bundle --build "$light" -o "$scratch/one.tar.gz"
expect 0 "one.tar.gz: "
bundle --build "$light" -o "$scratch/two.tar.gz"
cmp "$scratch"/{one,two}.tar.gz || fail "a second run makes another tarball"
(($(stat -c %s "$scratch/one.tar.gz") < 20000000)) || fail "the tarball has 20 MB or more"
glibc=$(grep -oE 'glibc [0-9.]+' <<<"$out")
oldest=2.34  # RHEL 9's; on systems newer than Debian 12, programs need a newer one
system=$(getconf GNU_LIBC_VERSION | cut -d' ' -f2)
[[ $system == 2.36 ]] || oldest=$system
[[ $(printf '%s\n' "$glibc" "glibc $oldest" | sort -V | head -n 1) == "$glibc" ]] || fail "needs $glibc, newer than $oldest"

# Runs the program unpacked in another folder, in an empty environment except for the driver's variables. LD_DEBUG lists the loaded libraries.
mkdir "$scratch/away" "$scratch/home"
tar -xzf "$scratch/one.tar.gz" -C "$scratch/away"
top=$(echo "$scratch"/away/raya-*)
found=$(grep -rlaP "(?<![\w.~}\x00-])\Q$root\E/" "$top" || true)  # a whole path: /raya/ also ends many others
[[ -z $found ]] || fail "the path of the sources is in: $found"
grep -q "$glibc or newer" "$top/README.md" || fail "README.md has another glibc than $glibc"
run_unpacked() {  # run_unpacked COMMAND...: sets code, out and loaded
    rm -f "$scratch"/loaded.*
    code=0
    out=$(cd "$scratch/home" && env -i HOME="$scratch/home" PATH=/usr/bin:/bin POCL_CACHE_DIR="$POCL_CACHE_DIR" LD_DEBUG=files \
        LD_DEBUG_OUTPUT="$scratch/loaded" "$@" 2>&1) || code=$?
    loaded=$(sed -n 's/.*calling init: //p' "$scratch"/loaded.* | sort -u)
}
run_unpacked "$top/raya" --version
expect 0 "raya "
other_libraries=$(grep -vE "^($top/lib/libOpenCL\.so\.1|.*/(libc|libm|ld-linux-x86-64)\.so\.[0-9]+)$" <<<"$loaded" || true)
[[ -z $other_libraries ]] || fail "raya --version loads $other_libraries"
grep -qF "$top/lib/libOpenCL.so.1" <<<"$loaded" || fail "raya does not load its own OpenCL loader: $loaded"
run_unpacked "$top/raya" render "$top/scenes/centre.nff" -o "$scratch/home/centre.ppm"
expect 0 "(474a384374e81c5144a0e5405232a750)"
loaded=$(grep -vF "$POCL_CACHE_DIR/" <<<"$loaded")  # without compiled kernels
! grep -E "$root/|raya_|OpenImageIO|libmpi|libfmt|libxxhash" <<<"$loaded" || fail "a render loads these libraries"
[[ $(head -c 15 "$scratch/home/centre.ppm") == $'P6\n256 256\n255' ]] || fail "the image is not a PPM"
run_unpacked "$top/raya" render "$top/scenes/centre.nff" -o "$scratch/home/centre.png"
expect 0 "(474a384374e81c5144a0e5405232a750)"
run_unpacked "$top/raya" render "$top/scenes/centre.nff" -o "$scratch/home/centre.exr"
expect 2 "there is no file '$top/raya_pictures.so"
run_unpacked "$top/gpu_day" --out "$scratch/day"
expect 0 "| 5 | large pictures"

# Two ranks, if a launcher of the module's MPI is installed; then an error of a rank, which the module forwards.
if [[ -e $top/raya_mpi.so ]] && ldd "$top/raya_mpi.so" | grep -q 'libmpi.* => /' && mpirun=$(command -v mpirun); then
    # shellcheck disable=SC2046  # several words: the settings of own_cache.sh
    launch=(env $(env | grep -E "^(OMPI|PRTE)_") "$mpirun" -n 2 "$top/raya" render)
    run_unpacked "${launch[@]}" "$top/scenes/centre.nff" -o "$scratch/home/ranks.ppm"
    expect 0 "ranks   2 on 1 host"
    cmp "$scratch"/home/{centre,ranks}.ppm || fail "two ranks render another image"
    run_unpacked "${launch[@]}" "$top/scenes/centre.nff" -o "$scratch/home/ranks.ppm" --device "no such device"
    expect 3 "no OpenCL device matches"
fi

# Bad options, and a build that cannot be packed: no file is written.
mkdir "$scratch/build"
bundle --nonsense
expect 2 "unknown option"
bundle --build "$build" -o "$scratch/none/x.tar.gz"
expect 2 "does not exist"
bundle --build "$scratch/build" -o "$scratch/x.tar.gz"
expect 3 "no $scratch/build/raya"
ln -s "$build/raya" "$scratch/build"
bundle --build "$scratch/build" -o "$scratch/x.tar.gz"
expect 4 "needs libfmt.so"
[[ ! -e $scratch/x.tar.gz ]] || fail "a tarball was written"
[[ -z $(find "$scratch" -mindepth 1 -name 'tmp.*') ]] || fail "temporary files were left"
echo "tools/bundle: as expected, for $glibc"
