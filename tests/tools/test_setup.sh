#!/usr/bin/env bash
# Tests tools/setup on simulated machines with missing packages: dpkg-query and sudo are mock programs. Nothing is installed.
set -euo pipefail
setup=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../../tools/setup
machine=$(mktemp -d)  # PATH of the tested script: a folder with all programs that it can find
trap 'rm -rf "$machine"' EXIT
chmod 755 "$machine"
ln -s "$(command -v env)" "$(command -v bash)" "$machine"

mock_program() {  # mock_program NAME BODY
    printf '#!%s\n%s\n' "$(command -v bash)" "$2" >"$machine/$1"
    chmod 755 "$machine/$1"
}

# Runs tools/setup with ARGS as an unprivileged user; sets out and code. The script is read from stdin: that user may have no access to its folder.
run_setup() {
    local as_nobody=()
    ((EUID != 0)) || as_nobody=("$(command -v setpriv)" --reuid=65534 --regid=65534 --clear-groups)
    code=0
    out=$(PATH=$machine "${as_nobody[@]}" "$machine/bash" -s -- "$@" <"$setup" 2>&1) || code=$?
}

expect() {  # expect CODE TEXT...: the exit code, and texts in the output; no text: no output
    local text is_right=1
    [[ $code == "$1" && (-n ${2-} || -z $out) ]] || is_right=
    for text in "${@:2}"; do [[ $out == *"$text"* ]] || is_right=; done
    [[ -n $is_right ]] || { echo "FAILED line ${BASH_LINENO[0]}: exit code $code: $out"; exit 1; }
}

release() { echo "VERSION_CODENAME=$1" >"$machine/os-release"; }  # release NAME
export RAYA_OS_RELEASE=$machine/os-release
release bookworm
line='sudo apt-get update && sudo apt-get install -y --no-install-recommends'

# --print needs no program.
run_setup --print
expect 0 "$line g++ cmake" pocl-opencl-icd catch2
read -ra all <<<"${out#"$line"}"
run_setup --gpu --nonsense
expect 2 "unknown option '--nonsense'"
run_setup --gpu --print --package
expect 0 "$line g++ cmake" "oclgrind clang-15 llvm-15 libclc-15 intel-opencl-icd llvm-spirv-15 spirv-tools cvise dpkg-dev lintian help2man"

# Each release has its own names, and lacks some packages. Other systems get the newest names.
while read -r name llvm ocloc; do
    release "$name"
    run_setup --llvm
    expect 0 "$llvm"
    run_setup --gpu --profile --print
    expect 0 "$line g++" " clang-tidy clang-$llvm llvm-$llvm libclc-$llvm $ocloc${ocloc:+ }llvm-spirv-$llvm spirv-tools cvise linux-perf llvm-$llvm"
done <<<$'trixie 19\nforky 21 intel-ocloc intel-opencl-icd\nother 21 intel-ocloc intel-opencl-icd'
release trixie
mock_program dpkg-query "printf '%s installed\n' ${all[*]}"
run_setup --gpu
expect 1 "trixie has no oclgrind intel-ocloc" "neither root nor sudo" "$line clang-19"
run_setup
expect 0
release bookworm
run_setup
expect 0
run_setup --bare-root --gpu
expect 1 "neither root nor sudo" "$line debootstrap clang-15 llvm-15 libclc-15 intel-opencl-icd llvm-spirv-15 spirv-tools cvise"

# Two packages are missing, one of them removed but not purged: neither root nor sudo; sudo that refuses this user; sudo; apt-get that fails.
mock_program dpkg-query "printf '%s installed\n' ${all[*]} | { while read -r p s; do [[ \$p == cmake || \$p == catch2 ]] || echo \$p \$s; done; }
echo catch2 config-files; exit 1"
run_setup
expect 1 "neither root nor sudo" "$line cmake catch2"
mock_program sudo 'exit 1'
run_setup
expect 1 "neither root nor sudo" "$line cmake catch2"
mock_program sudo '[[ $* == "-n true" ]] || echo "sudo $*"'
run_setup
apt='sudo env DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=600'
expect 0 "$apt update"$'\n'"$apt install -y --no-install-recommends cmake catch2"
mock_program sudo '[[ $* != *apt-get* ]]'
run_setup
expect 1 "update failed" "apt-get failed" "$line cmake catch2"

# Not Debian: tools/setup succeeds if the build tools are installed.
rm "$machine/dpkg-query"
run_setup
expect 1 "not a Debian system" libopenimageio-dev "'c++' is missing"
for tool in c++ cmake ninja; do mock_program "$tool" ''; done
run_setup
expect 0 "not a Debian system" libopenimageio-dev
echo "tools/setup: as expected"
