#!/usr/bin/env bash
# Tests tools/run and tools/build with mock cmake and setup: only the first build, and one that fails, print their output.
set -euo pipefail
tools=$(readlink -f "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../../tools")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fail() { echo "FAILED line ${BASH_LINENO[0]}: $1"; exit 1; }

mkdir -p "$scratch"/{tools,bin}
cp "$tools"/{run,build} "$scratch/tools"
echo '#!/bin/sh' >"$scratch/tools/setup"
cat >"$scratch/bin/cmake" <<'CMAKE'
#!/usr/bin/env bash
[[ $1 == --build ]] || { touch build/build.ninja; exit 0; }
echo "[7/300] Building one.cpp"
[[ ! -e broken ]] || { echo "one.cpp:1: error"; exit 1; }
printf '#!/bin/sh\necho "raya $*"\n' >build/raya
chmod +x build/raya
CMAKE
chmod +x "$scratch"/{tools,bin}/*
touch "$scratch/CMakePresets.json"
umask 002

run() { code=0; out=$(cd "$scratch/bin" && PATH=$scratch/bin:$PATH "$scratch/tools/run" devices 2>&1) || code=$?; }

run
[[ $code == 0 && $out == "[7/300] Building one.cpp"$'\n'"raya devices" ]] || fail "$out"
[[ $(stat -c %A "$scratch/build/raya") == -rwxr-xr-x ]] || fail "other users may write the program"
run
[[ $code == 0 && $out == "raya devices" ]] || fail "unexpected output: $out"
touch "$scratch/broken"
run
[[ $code == 1 && $out == *"one.cpp:1: error"*"tools/run: cannot build raya: "* ]] || fail "$out"
echo "tools/run: as expected"
