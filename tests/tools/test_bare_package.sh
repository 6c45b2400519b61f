#!/usr/bin/env bash
# Installs the package of tools/package by apt in a minimal Debian, as in the last stage of tools/container/Dockerfile, and checks its size.
#   test_bare_package.sh BUILD    BUILD/debs caches packages for the next run
#   RAYA_THOROUGH=1: also with recommended packages, such as OpenImageIO (567 MB more)
# Needs root, debootstrap and the network; without them the exit code is 77.
set -euo pipefail
build=$(readlink -f "$1")
root=$(readlink -f "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..")
# shellcheck source=tests/tools/bare_root.sh
source "$root/tests/tools/bare_root.sh"
make_bare_root "$build"
hash=474a384374e81c5144a0e5405232a750
scene=/usr/share/raya/scenes/centre.nff

# As in the Dockerfile's base image, packages are installed without documentation, manual pages and translations.
slim=$bare/etc/dpkg/dpkg.cfg.d/docker
for path in doc man locale info lintian; do
    echo "path-exclude=/usr/share/$path/*" >>"$slim"
done
echo "path-include=/usr/share/doc/*/copyright" >>"$slim"
rm -rf "$bare"/usr/share/{man,locale,info,lintian}/*
find "$bare/usr/share/doc" -type f ! -name copyright -delete

mkdir "$bare/out"
"$root/tools/package" --build "$build" -o "$bare/out"
cp "$root"/tools/container/{install,dpkg_excludes} "$bare/out"

# Without recommended packages: raya starts, and its message names the missing driver.
in_root sh -c 'apt-get install -qq -y --no-install-recommends /out/raya_*.deb' >"$bare.log" 2>&1 || fail "$(<"$bare.log")"
in_root raya --version
code=0 output=$(in_root raya render $scene -o /root/c.ppm 2>&1) || code=$?
[[ $code == 3 && $output == *"apt install pocl-opencl-icd"* ]] || fail "without a driver: $code: $output"

# With PoCL, as in the container.
in_root apt-get install -qq -y --no-install-recommends --download-only pocl-opencl-icd >"$bare.log" 2>&1 || fail "$(<"$bare.log")"
keep_packages "$build"
in_root /out/install >"$bare.log" 2>&1 || fail "$(<"$bare.log")"
rm -f "$bare/root/c.ppm"
bytes=$(du -sx --apparent-size --block-size=1 --exclude="$bare/out" "$bare" | cut -f1)  # sum of file sizes, as container tools report image sizes
echo "the container's files: $((bytes / 1000000)) MB"
((bytes < 400000000)) || fail "the container needs 400 MB or more"
[[ -z $(find "$bare/usr/lib" -name 'libOpenImageIO*') ]] || fail "OpenImageIO is installed"
output=$(in_root raya render $scene -o /root/c.ppm) || fail "render: $output"
[[ $output == *"($hash)"* ]] || fail "wrong image: $output"
in_root raya verify --quick || fail "verify --quick"
code=0 output=$(in_root raya render $scene -o /root/c.exr 2>&1) || code=$?
[[ $code == 2 && $output == *"install OpenImageIO"*"libopenimageio"* ]] || fail "EXR without OpenImageIO: $code: $output"

if [[ -n ${RAYA_THOROUGH-} ]]; then
    cp -n "$build"/debs/*.deb "$bare/var/cache/apt/archives/" 2>/dev/null || mkdir -p "$bare/var/cache/apt/archives"
    in_root apt-get -qq update
    in_root sh -c 'apt-get install -qq -y --reinstall /out/raya_*.deb $(dpkg-deb -f /out/raya_*.deb Recommends | grep -o "libopenimageio[^ ,]*")' >"$bare.log" 2>&1 || fail "$(tail "$bare.log")"
    output=$(in_root raya render $scene -o /root/c.exr) || fail "render: $output"
    [[ $output == *"($hash)"* ]] || fail "wrong EXR: $output"
fi
in_root sh -c 'apt-get remove -qq -y raya' >"$bare.log" 2>&1 || fail "$(<"$bare.log")"
[[ -z $(find "$bare/usr" -path '*raya*' -print -quit) ]] || fail "left behind: $(find "$bare/usr" -path '*raya*')"
echo "a package in a minimal Debian: as expected"
