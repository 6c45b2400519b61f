#!/usr/bin/env bash
# What tools/package makes, installed by apt in a bare Debian, as tools/container/Dockerfile does in its last stage, and how large that is.
#   test_bare_package.sh BUILD    Packages are kept in BUILD/debs for the next run
#   RAYA_THOROUGH=1: with what apt installs by default too, OpenImageIO among it (567 MB more)
# Exit code 77 where there is no such thing: it takes root, debootstrap and the network.
set -euo pipefail
build=$(readlink -f "$1")
root=$(readlink -f "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..")
# shellcheck source=tests/tools/bare_root.sh
source "$root/tests/tools/bare_root.sh"
make_bare_root "$build"
hash=474a384374e81c5144a0e5405232a750
scene=/usr/share/raya/scenes/centre.nff

# The base image has no documents, pages and translations, nor lists of packages; what is installed later has none either.
slim=$bare/etc/dpkg/dpkg.cfg.d/docker
for path in doc man locale info lintian; do
    echo "path-exclude=/usr/share/$path/*" >>"$slim"
done
echo "path-include=/usr/share/doc/*/copyright" >>"$slim"
rm -rf "$bare"/usr/share/{man,locale,info,lintian}/*
find "$bare/usr/share/doc" -type f ! -name copyright -delete

mkdir "$bare/out"
"$root/tools/package" --build "$build" -o "$bare/out"
cp "$root"/tools/container/{install,left_out} "$bare/out"

# The package alone: it starts, and says what is missing.
there sh -c 'apt-get install -qq -y --no-install-recommends /out/raya_*.deb' >"$bare.log" 2>&1 || fail "$(<"$bare.log")"
there raya --version
code=0 told=$(there raya render $scene -o /root/c.ppm 2>&1) || code=$?
[[ $code == 3 && $told == *"apt install pocl-opencl-icd"* ]] || fail "without a driver: $code: $told"

# With PoCL, as in the container.
there apt-get install -qq -y --no-install-recommends --download-only pocl-opencl-icd >"$bare.log" 2>&1 || fail "$(<"$bare.log")"
keep_packages "$build"
there /out/install >"$bare.log" 2>&1 || fail "$(<"$bare.log")"
rm -f "$bare/root/c.ppm"
bytes=$(du -sx --apparent-size --block-size=1 --exclude="$bare/out" "$bare" | cut -f1)  # of files, as images are counted
echo "the container's files: $((bytes / 1000000)) MB"
((bytes < 400000000)) || fail "400 MB or more"
[[ -z $(find "$bare/usr/lib" -name 'libOpenImageIO*') ]] || fail "OpenImageIO is there"
told=$(there raya render $scene -o /root/c.ppm) || fail "render: $told"
[[ $told == *"($hash)"* ]] || fail "another picture: $told"
there raya verify --quick || fail "verify --quick"
code=0 told=$(there raya render $scene -o /root/c.png 2>&1) || code=$?
[[ $code == 2 && $told == *"install OpenImageIO"*"libopenimageio"* ]] || fail "PNG without OpenImageIO: $code: $told"

if [[ -n ${RAYA_THOROUGH-} ]]; then
    cp -n "$build"/debs/*.deb "$bare/var/cache/apt/archives/" 2>/dev/null || mkdir -p "$bare/var/cache/apt/archives"
    there apt-get -qq update
    there sh -c 'apt-get install -qq -y --reinstall /out/raya_*.deb libopenimageio2.4' >"$bare.log" 2>&1 || fail "$(tail "$bare.log")"
    told=$(there raya render $scene -o /root/c.png) || fail "render: $told"
    [[ $told == *"($hash)"* ]] || fail "another PNG: $told"
fi
there sh -c 'apt-get remove -qq -y raya' >"$bare.log" 2>&1 || fail "$(<"$bare.log")"
[[ -z $(find "$bare/usr" -path '*raya*' -print -quit) ]] || fail "left behind: $(find "$bare/usr" -path '*raya*')"
echo "a package in a bare root: as expected"
