#!/usr/bin/env bash
# In a minimal Debian with PoCL: runs verify and a render of the tarball of tools/bundle; then makes the light build with only the packages that
# docs/verify.md names, and runs its verify.
#   test_bare_root.sh BUILD     the build folder, with the light build of the test tools.bundle. BUILD/debs caches packages for the next run
# Needs root, debootstrap and the network; without them the exit code is 77.
set -euo pipefail
build=$(readlink -f "$1")
root=$(readlink -f "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..")
# shellcheck source=tests/tools/bare_root.sh
source "$root/tests/tools/bare_root.sh"
make_bare_root "$build"
in_root apt-get install -qq -y --no-install-recommends pocl-opencl-icd python3 >"$bare/root/log" 2>&1 || fail "$(<"$bare/root/log")"
keep_packages "$build"
[[ -z $(find "$bare/usr/lib" -name 'libfmt.so*' -o -name 'libOpenImageIO*' -o -name 'libxxhash.so*' -o -name 'libOpenCL.so*' -o -name 'libmpi.so*') ]] ||
    echo "note: some libraries that the program contains are also installed"

"$root/tools/bundle" --build "$build/light/examples/raya/src/raya-build" -o "$bare/root/raya.tar.gz"
in_root tar -xzf /root/raya.tar.gz -C /opt
top=$(cd "$bare" && echo opt/raya-*)
in_root "/$top/raya" --version
output=$(in_root "/$top/raya" render "/$top/scenes/centre.nff" -o /root/centre.ppm) || fail "render: $output"
[[ $output == *"(474a384374e81c5144a0e5405232a750)"* ]] || fail "wrong image: $output"
in_root "/$top/raya" verify --quick || fail "verify --quick"
in_root "/$top/gpu_day" --out /root/day --small --stage 1 || fail "gpu_day"

packages=$(sed -n 's/^    apt-get install//p' "$root/docs/verify.md")
# shellcheck disable=SC2086  # several packages
in_root apt-get install -qq -y --no-install-recommends $packages >"$bare/root/log" 2>&1 || fail "$(<"$bare/root/log")"
keep_packages "$build"
mkdir "$bare/root/raya"
git -C "$root" archive HEAD | tar -x -C "$bare/root/raya"
in_root sh -c 'cd /root/raya && cmake -B light -DRAYA_LIGHT=ON && cmake --build light -j2' >"$bare/root/log" 2>&1 || fail "$(<"$bare/root/log")"
in_root /root/raya/light/raya verify --quick || fail "verify --quick of the light build"
echo "a minimal Debian: as expected"
