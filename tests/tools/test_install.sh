#!/usr/bin/env bash
# Tests an installation by `cmake --install`: raya runs without the sources, from any folder, with its modules; pkg-config finds the number layer.
#   test_install.sh BUILD
set -euo pipefail
build=$(readlink -f "$1")
root=$(readlink -f "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fail() { echo "FAILED line ${BASH_LINENO[0]}: $1"; exit 1; }

cmake --install "$build" --prefix "$scratch/first place" >"$scratch/log" || fail "$(<"$scratch/log")"
mv "$scratch/first place" "$scratch/prefix"
prefix=$scratch/prefix
inputs=$(ninja -C "$build" -t inputs raya)  # tools/run builds only raya; an installation must work after it
for file in "$prefix"/lib/raya/*; do
    grep -qx "$(basename "$file")" <<<"$inputs" || fail "tools/run does not build $file"
done
mkdir "$scratch/home"
run_installed() {  # run_installed COMMAND...: runs the command without the build's environment; sets code and out
    code=0
    out=$(cd "$scratch/home" && env -i HOME="$scratch/home" PATH="$prefix/bin:/usr/bin:/bin" POCL_CACHE_DIR="$POCL_CACHE_DIR" "$@" 2>&1) || code=$?
}
expect() { [[ $code == "$1" && $out == *"$2"* ]] || fail "exit code $code: $out"; }  # expect CODE TEXT

# No text file contains a path of the sources or the build. (Programs contain such paths only in debugging information.)
found=$(grep -rIlP "(?<![\w.~}-])(\Q$root\E/|\Q$build\E)" "$prefix" || true)  # a whole path: /raya/ also ends many others
[[ -z $found ]] || fail "the path of the sources is in: $found"
! objdump -p "$prefix/bin/raya" "$prefix"/lib/raya/*.so | grep -E "R(UN)?PATH.*($root|$build)" || fail "the search path of libraries leads to the build"

# The program, its modules, scenes and documents.
run_installed raya --version
expect 0 "raya "
run_installed raya render "$prefix/share/raya/scenes/centre.nff" -o centre.png
expect 0 "(474a384374e81c5144a0e5405232a750)"
[[ $(head -c 4 "$scratch/home/centre.png" | tail -c 3) == PNG ]] || fail "no PNG"
if [[ -d $prefix/lib/python3 ]]; then  # the Python module, alone and in `raya study`
    run_installed env PYTHONPATH="$prefix/lib/python3/dist-packages" /usr/bin/python3 -c \
        "import raya; r = raya.render('$prefix/share/raya/scenes/centre.nff'); print(r.hash, raya.program()); open('r.png', 'wb').write(r.png)"
    expect 0 "474a384374e81c5144a0e5405232a750 $prefix/bin/raya"
    run_installed raya study fig8 "$prefix/share/raya/scenes/centre.nff" --size 17 -q -o study
    expect 0 ""
    [[ -s $scratch/home/study/index.html ]] || fail "there is no document: $out"
    chmod o+w "$prefix/lib/python3/dist-packages/raya"
    run_installed raya study fig8 "$prefix/share/raya/scenes/centre.nff" --size 17 -q -o study
    expect 2 "refused to run '$prefix/lib/python3/dist-packages': other users may write"
    chmod o-w "$prefix/lib/python3/dist-packages/raya"
fi
cmp "$root/tools/raya.bash" "$prefix/share/bash-completion/completions/raya" || fail "the installed completion differs"
if command -v help2man >/dev/null; then
    grep -q 'fold.fR cyclic|block' "$prefix/share/man/man1/raya-render.1" && [[ -s $prefix/share/man/man1/raya.1 ]] || fail "no manual pages"
fi
for scene in "$root"/scenes/*.nff; do
    cmp "$scene" "$prefix/share/raya/scenes/$(basename "$scene")" || fail "no $scene"
done
doc=$prefix/share/doc/raya
[[ $(<"$doc/LICENSE") == *"the raya authors"* ]] || fail "no licence"
while IFS=: read -r page link; do  # [..](LINK) in a page, without #.. and addresses
    [[ -e $(dirname "$page")/${link%%#*} ]] || fail "$page has a link to $link, which does not exist"
done < <(grep -roP --include='*.md' '\]\(\K(?!https?:|#)[^)]+' "$doc")

# The number layer in another project: a copy of the example, and a kernel with the options of pkg-config.
export PKG_CONFIG_PATH=$prefix/share/pkgconfig
pkg-config --validate raya-number || fail "pkg-config does not know raya-number"
[[ $(pkg-config --modversion raya-number) == "$("$build/raya" --version | cut -d' ' -f2)" ]] || fail "pkg-config has another version of raya-number"
options=$(pkg-config --cflags raya-number)
mkdir "$scratch/other"
cp "$doc"/kernels/number/example/harmonic.* "$scratch/other"
[[ -z $(find "$prefix/include" -type f ! -name '*.clh') ]] || fail "include contains other files than headers"
# shellcheck disable=SC2046  # several arguments
(cd "$scratch/other" && ${CXX:-c++} -std=c++17 -O1 harmonic.cpp -o harmonic $(pkg-config --libs OpenCL))
# shellcheck disable=SC2086  # several arguments
code=0 out=$(cd "$scratch/other" && env POCL_CACHE_DIR="$POCL_CACHE_DIR" ./harmonic $options 2>&1) || code=$?
expect 0 "8191 terms, sum 9.848633"
[[ $out == *"64 terms, sum 5.0625"* && $out == *"512 terms, sum 7.085938"* ]] || fail "other sums: $out"
code=0 out=$(cd "$scratch/other" && ./harmonic 2>&1) || code=$?
expect 1 "OpenCL error"  # without pkg-config's options the kernel does not find number/number.clh

# Meshes, with and without the program that reads them.
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >"$scratch/home/t.obj"
run_installed raya info t.obj
expect 0 "t.obj: 1 object: 1 polygon"
if [[ -d $prefix/lib/python3 ]]; then
    run_installed env PYTHONPATH="$prefix/lib/python3/dist-packages" /usr/bin/python3 -c "import raya; print(raya.load('t.obj').objects)"
    expect 0 "1"
fi
mv "$prefix/lib/raya/raya_import" "$scratch"
run_installed raya info t.obj
expect 2 "t.obj: cannot read meshes: there is no file '$prefix/lib/raya/raya_import'"
mv "$scratch/raya_import" "$prefix/lib/raya"

# Without the image module, raya refuses to write OpenEXR, with a remedy, and still writes PPM.
rm "$prefix/lib/raya/raya_pictures.so"
run_installed raya render "$prefix/share/raya/scenes/centre.nff" -o centre.exr
expect 2 "there is no file '$prefix/lib/raya/raya_pictures.so"
expect 2 "name a .pfm file instead"
run_installed raya render "$prefix/share/raya/scenes/centre.nff" -o centre.ppm
expect 0 "(474a384374e81c5144a0e5405232a750)"
echo "an installation: as expected"
