#!/usr/bin/env bash
# Tests tools/run with mock cmake and setup: it prints the progress of a build, to a terminal and to a file, but not if the build has few steps.
set -euo pipefail
tools=$(readlink -f "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../../tools")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
fail() { echo "FAILED line ${BASH_LINENO[0]}: $1"; exit 1; }

mkdir -p "$scratch"/{tools,bin,tests}
sed 's/pause=30/pause=0.5/' "$tools/run" >"$scratch/tools/run"
echo '#!/bin/sh' >"$scratch/tools/setup"
cat >"$scratch/bin/cmake" <<'CMAKE'
#!/usr/bin/env bash
[[ $1 == --build ]] || { touch build/build.ninja; exit 0; }
steps=$(<steps)
echo "[1/2] Re-running CMake..."
((steps <= 4)) || sleep 0.5
echo "[7/$steps] Building one.cpp"
((steps <= 4)) || sleep 1.5
[[ ! -e broken ]] || { echo "one.cpp:1: error"; exit 1; }
echo "[$steps/$steps] Linking"
printf '#!/bin/sh\necho "raya $*"\n' >build/raya
chmod +x build/raya
CMAKE
printf '#!/bin/sh\necho 2\n' >"$scratch/bin/nproc"
chmod +x "$scratch"/{tools,bin}/*
touch "$scratch"/{CMakePresets.json,CMakeLists.txt,tests/CMakeLists.txt}

run() { code=0; out=$(PATH=$scratch/bin:$PATH "$scratch/tools/run" devices 2>&1) || code=$?; }

echo 300 >"$scratch/steps"
run
[[ $code == 0 && $out == "building raya: 300 steps on 2 cores, about 12 min"$'\n'"building raya: [7/300] after "*$'\n'"raya devices" ]] || fail "$out"
[[ $out != *Linking* ]] || fail "ninja's output is printed: $out"
echo 2 >"$scratch/steps"
run
[[ $code == 0 && $out == "raya devices" ]] || fail "unexpected output: $out"
touch "$scratch/broken"
run
[[ $code == 1 && $out == *"one.cpp:1: error"*"tools/run: cannot build raya: "* ]] || fail "$out"
rm "$scratch/broken"
echo 30 >"$scratch/steps"
out=$(PATH=$scratch/bin:$PATH python3 -c 'import pty, sys; sys.exit(pty.spawn(sys.argv[1:]))' "$scratch/tools/run" devices </dev/null | tr -d '\r')
[[ $out == "building raya: 30 steps on 2 cores, about 2 min"$'\n'*$'\e[K[7/30] Building one.cpp'*$'\e[K'"raya devices" ]] || fail "$out"
echo "tools/run: as expected"
