#!/usr/bin/env bash
# What tools/bundle packs, in a Debian that has nothing but its smallest set of packages and PoCL: verify and a render there.
#   test_bare_root.sh BUILD     the build folder, with the target `bundled` built. Packages are kept in BUILD/debs for the next run
# Exit code 77 where there is no such thing: it takes root, debootstrap and the network.
set -euo pipefail
build=$(readlink -f "$1")
root=$(readlink -f "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..")
# shellcheck source=tests/tools/bare_root.sh
source "$root/tests/tools/bare_root.sh"
make_bare_root "$build"
there apt-get install -qq -y --no-install-recommends pocl-opencl-icd >"$bare/root/log" 2>&1 || fail "$(<"$bare/root/log")"
keep_packages "$build"
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
