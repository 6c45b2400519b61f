#!/usr/bin/env bash
# Tests tools/package: contents and dependencies of the package, Debian's checks, reproducible bytes. Exit code 77: no packaging tools.
#   test_package.sh BUILD
set -euo pipefail
build=$(readlink -f "$1")
root=$(readlink -f "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..")
for tool in cpack dpkg-shlibdeps dpkg-deb help2man; do
    command -v "$tool" >/dev/null || { echo "skipped: no $tool"; exit 77; }
done
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fail() { echo "FAILED line ${BASH_LINENO[0]}: $1"; exit 1; }
package() { code=0; out=$(env -u DEBEMAIL -u DEBFULLNAME "$root/tools/package" "$@" 2>&1) || code=$?; }
expect() { [[ $code == "$1" && $out == *"$2"* ]] || fail "exit code $code: $out"; }  # expect CODE TEXT

mkdir "$scratch"/{one,two,whole}
package --build "$build" -o "$scratch/one"
expect 0 "$scratch/one/raya_"
deb=$(echo "$scratch"/one/raya_*_*.deb)
version=$("$build/raya" --version | cut -d' ' -f2)
[[ $deb == */raya_${version}_$(dpkg --print-architecture).deb ]] || fail "the package is called $deb"
if command -v lintian >/dev/null; then
    [[ $out != *"lintian is not installed"* ]] || fail "lintian is installed: $out"
else
    expect 0 "lintian is not installed"
fi
package --build "$build" -o "$scratch/two"
expect 0 "raya_"
cmp "$deb" "$scratch"/two/raya_*.deb || fail "the same build gives a different package"

# The package depends on the program's libraries, recommends OpenImageIO, assimp and a driver, and suggests MPI.
field() { dpkg-deb -f "$deb" "$1"; }
[[ $(field Version) == "$version" ]] || fail "version $(field Version)"
[[ $(field Depends) == *ocl-icd-libopencl1* && $(field Depends) != *openimageio* && $(field Depends) != *mpi* ]] || fail "Depends: $(field Depends)"
[[ $(field Recommends) == *"libassimp"*"libopenimageio"*"pocl-opencl-icd | opencl-icd" ]] || fail "Recommends: $(field Recommends)"
[[ ! -e $build/raya_mpi.so || $(field Suggests) == *mpi* ]] || fail "Suggests: $(field Suggests)"
[[ $(field Maintainer) == "the raya authors <raya@example.org>" ]] || fail "Maintainer: $(field Maintainer)"

dpkg-deb -x "$deb" "$scratch/whole"
for file in bin/raya lib/raya/raya_pictures.so lib/raya/raya_import share/man/man1/raya.1.gz share/man/man1/raya-render.1.gz share/raya/scenes/centre.nff \
    share/bash-completion/completions/raya share/doc/raya/copyright \
    share/doc/raya/changelog.gz share/doc/raya/licences/libcli11-dev include/raya/number/number.clh share/pkgconfig/raya-number.pc; do
    [[ -s $scratch/whole/usr/$file ]] || fail "no /usr/$file"
done
zcat "$scratch/whole/usr/share/doc/raya/changelog.gz" | head -n 1 | grep -q "^raya ($version) " || fail "changelog.gz has another version"
[[ $(PKG_CONFIG_PATH=$scratch/whole/usr/share/pkgconfig pkg-config --modversion raya-number) == "$version" ]] || fail "another version of raya-number"

# The packager becomes the package's maintainer. Bad options, and a folder that is not a build: no file is written.
code=0 out=$(DEBFULLNAME="A Packer" DEBEMAIL=packer@debian.example "$root/tools/package" --build "$build" -o "$scratch/two" 2>&1) || code=$?
expect 0 "raya_"
[[ $(dpkg-deb -f "$scratch"/two/raya_*.deb Maintainer) == "A Packer <packer@debian.example>" ]] || fail "the package has another maintainer"
package --nonsense
expect 2 "unknown option"
package --build "$build" -o "$scratch/none"
expect 2 "is not a folder"
package --build "$scratch" -o "$scratch"
expect 3 "no $scratch/raya"
[[ -z $(find "$scratch" -mindepth 1 -name 'tmp.*') && -z $(find "$scratch" -maxdepth 1 -name '*.deb') ]] || fail "temporary files were left"
# An error that lintian detects: a package without a copyright file.
if command -v lintian >/dev/null; then
    mkdir -p "$scratch/bad"
    cp -a "$scratch/whole" "$scratch/bad/files"
    dpkg-deb -e "$deb" "$scratch/bad/files/DEBIAN"
    rm "$scratch/bad/files/usr/share/doc/raya/copyright"
    dpkg-deb --root-owner-group -b "$scratch/bad/files" "$scratch/bad/raya.deb" >/dev/null
    ! lintian --fail-on error --allow-root "$scratch/bad/raya.deb" >/dev/null || fail "lintian accepts a package without a copyright file"
fi
echo "tools/package: as expected"
