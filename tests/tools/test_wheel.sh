#!/usr/bin/env bash
# For the Python of a Debian release: makes a wheel in a Debian with raya's packages; then, in a minimal one with only Python and PoCL, installs it with
# pip and runs program, module and a study.
#   test_wheel.sh BUILD RELEASE     the wheel is written to BUILD/wheels; BUILD/debs caches packages for the next run
# Needs root, debootstrap and the network with the Python Package Index; without them the exit code is 77.
set -euo pipefail
build=$(readlink -f "$1")
root=$(readlink -f "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..")
# shellcheck source=tests/tools/bare_root.sh
source "$root/tests/tools/bare_root.sh"
make_bare_root "$build" "$2"
mkdir -p "$build/wheels" "$scratch/build"
certificates=/root/certificates.crt  # this system's, which may know a proxy
"$debian_root" make "$2" "$scratch/builder" "$build/debs"
cp -n "$build"/debs/*.deb "$scratch/builder/var/cache/apt/archives/"
for folder in "$bare" "$scratch/builder"; do cp /etc/ssl/certs/ca-certificates.crt "$folder$certificates"; done
"$debian_root" run --project "$root" "$scratch/build" "$scratch/builder" env PIP_CERT="$certificates" /raya/tools/package --wheel >"$scratch/log" 2>&1 || fail "$(<"$scratch/log")"
cp -n "$scratch"/builder/var/cache/apt/archives/*.deb "$build/debs/" 2>/dev/null || true
wheel=$(echo "$scratch"/build/raya-*.whl)
(($(stat -c %s "$wheel") < 40000000)) || fail "$wheel has 40 MB or more"

packages=(pocl-opencl-icd python3 python3-venv)
in_root apt-get install -qq -y --no-install-recommends "${packages[@]}" >"$scratch/log" 2>&1 || fail "$(<"$scratch/log")"
keep_packages "$build"
cp "$wheel" "$root/scenes/centre.nff" "$bare/root"
in_root sh -c "cd /root && python3 -m venv venv && venv/bin/pip install -q --cert $certificates raya-*.whl" >"$scratch/log" 2>&1 || fail "$(<"$scratch/log")"
output=$(in_root /root/venv/bin/raya render /root/centre.nff -o /root/c.png) || fail "render: $output"
[[ $output == *"(474a384374e81c5144a0e5405232a750)"* ]] || fail "wrong image: $output"
output=$(in_root /root/venv/bin/python3 -c 'import raya; print(raya.render("/root/centre.nff").hash)') || fail "import raya"
[[ $output == *474a384374e81c5144a0e5405232a750* ]] || fail "wrong image: $output"
in_root sh -c 'PATH=/root/venv/bin:$PATH raya study fig8 -o /root/study' >"$scratch/log" 2>&1 || fail "$(<"$scratch/log")"
cp "$wheel" "$build/wheels"
echo "$(basename "$wheel"), $(($(stat -c %s "$wheel") / 1000)) kB: as expected"
