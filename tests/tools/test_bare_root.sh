#!/usr/bin/env bash
# What tools/bundle packs, in a Debian that has nothing but its smallest set of packages and PoCL: verify and a render there.
#   test_bare_root.sh BUILD     the build folder, with the target `bundled` built. Packages are kept in BUILD/debs for the next run
# The mirror is that of apt's own sources. Exit code 77 where there is no such thing: it takes root, debootstrap and the network.
set -euo pipefail
build=$(readlink -f "$1")
root=$(readlink -f "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..")
skip() { echo "skipped: $1"; exit 77; }
((EUID == 0)) || skip "not root, who alone can change the root folder"
command -v debootstrap >/dev/null || skip "no debootstrap (tools/setup --bare-root)"
suite=bookworm
# shellcheck disable=SC2016  # apt's own variables
mirror=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT) $(CREATED_BY)' 2>/dev/null |
    awk -v suite="$suite" '$2 == suite && $3 == "main" && $4 == "Packages" { print $1; exit }')
[[ -n $mirror ]] || skip "apt's sources have no $suite"

bare=$(mktemp -d -p "$build")
trap 'rm -rf --one-file-system "$bare" "$bare.log"' EXIT
mkdir -p "$build/debs"
fail() { echo "FAILED line ${BASH_LINENO[0]}: $1"; exit 1; }

# Commands there, with /proc and /sys, which go when they end.
# shellcheck disable=SC2016  # the variables of the inner shell
there() {
    unshare --mount --pid --fork --kill-child sh -c '
        mount -t proc proc "$0/proc" && mount --rbind /sys "$0/sys" && exec chroot "$0" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@"' "$bare" "$@"
}

timeout 400 debootstrap --variant=minbase --cache-dir="$build/debs" "$suite" "$bare" "$mirror" >"$bare.log" 2>&1 ||
    { cp "$bare.log" "$build/bare-root.log"; skip "no network, or debootstrap has another reason: $(tail -n 1 "$bare.log")"; }
cp -n "$build"/debs/*.deb "$bare/var/cache/apt/archives/"
there apt-get -qq update || skip "no network"
there env DEBIAN_FRONTEND=noninteractive apt-get install -qq -y --no-install-recommends pocl-opencl-icd >"$bare/root/log" 2>&1 || fail "$(<"$bare/root/log")"
cp -n "$bare"/var/cache/apt/archives/*.deb "$build/debs/" 2>/dev/null || true
[[ -z $(find "$bare/usr/lib" -name 'libfmt.so*' -o -name 'libOpenImageIO*' -o -name 'libxxhash.so*' -o -name 'libOpenCL.so*' -o -name 'libmpi.so*') ]] ||
    echo "note: some of what the program carries is there too"

"$root/tools/bundle" --build "$build" -o "$bare/root/raya.tar.gz"
there tar -xzf /root/raya.tar.gz -C /opt
top=$(cd "$bare" && echo opt/raya-*)
there "/$top/raya" --version
told=$(there "/$top/raya" render "/$top/scenes/centre.nff" -o /root/centre.ppm) || fail "render: $told"
[[ $told == *"(474a384374e81c5144a0e5405232a750)"* ]] || fail "another picture: $told"
there "/$top/raya" verify --quick || fail "verify --quick"
there "/$top/gpu_day" --out /root/day --small --stage 1 || fail "gpu_day"
echo "a bare root: as expected"
