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

expect() {  # expect CODE TEXT...: the exit code, and texts in the output
    local wanted=$1 text
    shift
    if [[ $code != "$wanted" ]]; then echo "FAILED line ${BASH_LINENO[0]}: exit code $code, not $wanted: $out"; exit 1; fi
    for text in "$@"; do
        [[ $out == *"$text"* ]] || { echo "FAILED line ${BASH_LINENO[0]}: no '$text' in: $out"; exit 1; }
    done
}

expect_no_output() { [[ -z $out ]] || { echo "FAILED line ${BASH_LINENO[0]}: unexpected output: $out"; exit 1; }; }

release() { echo "VERSION_CODENAME=$1" >"$machine/os-release"; }  # release NAME
export RAYA_OS_RELEASE=$machine/os-release
release bookworm
line='sudo apt-get update && sudo apt-get install -y --no-install-recommends'

# --print needs no program.
run_setup --print
expect 0 "$line g++ cmake" pocl-opencl-icd catch2
read -ra all <<<"${out#"$line"}"
run_setup --nonsense
expect 2 "unknown option '--nonsense'"
run_setup --studies --nonsense --gpu
expect 2 "unknown option '--nonsense'"
run_setup --gpu --print --package
expect 0 "$line g++ cmake" "oclgrind clang-15 llvm-15 libclc-15 intel-opencl-icd llvm-spirv-15 spirv-tools cvise dpkg-dev lintian help2man"
[[ $out != *debootstrap* ]] || { echo "FAILED: a group that was not named"; exit 1; }

# Each release has its own names, and lacks some packages. Other systems get the newest names.
run_setup --llvm
expect 0 15
while read -r name llvm ocloc; do
    release "$name"
    run_setup --llvm
    [[ $code == 0 && $out == "$llvm" ]] || { echo "FAILED: $name: --llvm: $out"; exit 1; }
    run_setup --gpu --profile --print
    expect 0 "$line g++" " clang-$llvm llvm-$llvm libclc-$llvm $ocloc${ocloc:+ }llvm-spirv-$llvm spirv-tools cvise linux-perf llvm-$llvm"
    [[ $out != *" -"[!-y]* && $out != *oclgrind* ]] || { echo "FAILED: $name: $out"; exit 1; }
done <<<$'trixie 19\nforky 21 intel-ocloc intel-opencl-icd\nresolute 21 intel-ocloc intel-opencl-icd\nother 21 intel-ocloc intel-opencl-icd'
rm "$RAYA_OS_RELEASE"
run_setup --llvm
expect 0 21
release trixie
mock_program dpkg-query "printf '%s installed\n' ${all[*]}"
run_setup --gpu
expect 1 "trixie has no oclgrind intel-ocloc" "neither root nor sudo" "$line clang-19"
run_setup
expect 0
expect_no_output
release bookworm

# Nothing is missing.
mock_program dpkg-query "printf '%s installed\n' ${all[*]}"
run_setup
expect 0
expect_no_output

# Optional groups are installed on request.
run_setup --studies
expect 1 "neither root nor sudo" "$line libsimgrid-dev"
run_setup --bare-root
expect 1 "neither root nor sudo" "$line debootstrap"
run_setup --browser
expect 1 "neither root nor sudo" "$line chromium"
run_setup --gpu
expect 1 "neither root nor sudo" "$line clang-15 llvm-15 libclc-15 intel-opencl-icd llvm-spirv-15 spirv-tools"
run_setup --profile
expect 1 "neither root nor sudo" "$line linux-perf llvm-15"
run_setup --package
expect 1 "neither root nor sudo" "$line dpkg-dev lintian help2man"
run_setup --bare-root --gpu --studies --bare-root
expect 1 "neither root nor sudo" "$line debootstrap clang-15 llvm-15 libclc-15 intel-opencl-icd llvm-spirv-15 spirv-tools cvise libsimgrid-dev"

# Two packages are missing, one of them removed but not purged; neither root nor sudo.
mock_program dpkg-query "printf '%s installed\n' ${all[*]} | { while read -r p s; do [[ \$p == cmake || \$p == catch2 ]] || echo \$p \$s; done; }
echo catch2 config-files; exit 1"
run_setup
expect 1 "neither root nor sudo" "$line cmake catch2"

# The same packages are missing; sudo refuses this user, and there is no terminal for a password.
mock_program sudo 'exit 1'
run_setup
expect 1 "neither root nor sudo" "$line cmake catch2"

# With sudo: tools/setup updates the package lists, then installs exactly the missing packages.
mock_program sudo '[[ $* == "-n true" ]] || echo "sudo $*"'
run_setup
apt='sudo env DEBIAN_FRONTEND=noninteractive apt-get -qq'
expect 0 "$apt update"$'\n'"$apt install -y --no-install-recommends cmake catch2"

# apt-get fails.
mock_program sudo '[[ $* != *apt-get* ]]'
run_setup
expect 1 "apt-get failed" "$line cmake catch2"

# Another program holds apt's locks: the lock of `update` until the third attempt, that of `install` until the second. Then it holds
# them for longer than tools/setup waits.
chmod 777 "$machine"
mock_program sleep "echo \$1 >>$machine/slept"
mock_program sudo '[[ $* == *apt-get* ]] || exit 0
echo "$*" >>"${0%/*}/calls"
mapfile -t calls <"${0%/*}/calls"
case ${#calls[@]} in
    1 | 2) echo "E: Could not get lock /var/lib/apt/lists/lock. It is held by process 7 (apt)" >&2; exit 100 ;;
    4) echo "E: Unable to acquire the dpkg frontend lock (/var/lib/dpkg/lock-frontend), is another process using it?" >&2; exit 100 ;;
    *) echo "sudo $*" ;;
esac'
run_setup
expect 0 "another program holds apt's lock; waiting for it, up to 10 minutes: E: Could not get lock /var/lib/apt/lists/lock" "process 7" \
    "up to 10 minutes: E: Unable to acquire" "$apt update"$'\n' "$apt install -y --no-install-recommends cmake catch2"
[[ $(<"$machine/slept") == $'5\n5\n5' ]] || { echo "FAILED: slept $(<"$machine/slept")"; exit 1; }
mock_program sudo '[[ $* == "-n true" ]] || { echo "E: Could not get lock /a" >&2; exit 100; }'
rm "$machine/slept"
run_setup
expect 1 "update failed" "apt-get failed" "$line cmake catch2"
mapfile -t slept <"$machine/slept"
((${#slept[@]} == 240)) || { echo "FAILED: ${#slept[@]} times 5 s"; exit 1; }

# Not Debian: tools/setup succeeds if the build tools are installed.
rm "$machine/dpkg-query"
run_setup
expect 1 "not a Debian system" libopenimageio-dev "'c++' is missing"
for tool in c++ cmake ninja; do mock_program "$tool" ''; done
run_setup
expect 0 "not a Debian system" libopenimageio-dev

echo "tools/setup: as expected"
