#!/usr/bin/env bash
# Tests docs/ci/raya-health, the node health check for Slurm, with a mock scontrol: right, wrong, missing and hanging devices.
#   test_health.sh RAYA CL_FAULTS     the built program; tests/cli/cl_faults.cpp
set -euo pipefail
raya=$(readlink -f "$1")
cl_faults=$(readlink -f "$2")
health=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../../docs/ci/raya-health
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
mkdir "$scratch/bin"
printf '#!/bin/sh\nprintf "%%s\\n" "$@" >%q\n' "$scratch/asked" >"$scratch/bin/scontrol"
cat >"$scratch/faulty" <<FAULTY
#!/bin/sh
[ ! -e "$scratch/hangs" ] || exec sleep 20
LD_PRELOAD="$cl_faults" exec "$raya" "\$@"
FAULTY
chmod +x "$scratch/bin/scontrol" "$scratch/faulty"

fail() { echo "FAILED line ${BASH_LINENO[0]}: $1, exit code $code: $out; scontrol: $(cat "$scratch/asked" 2>/dev/null)"; exit 1; }
health() {  # health VARIABLE=VALUE...: sets code and out
    rm -f "$scratch/asked"
    code=0
    out=$(env PATH="$scratch/bin:$PATH" SLURMD_NODENAME=node7 "$@" "$health" --brief --only "machine copies" 2>&1) || code=$?
}
drained() { [[ $(<"$scratch/asked") == $'update\nNodeName=node7\nState=DRAIN\nReason=raya verify: '$1 ]]; }  # drained PATTERN

health RAYA="$raya"
[[ $code == 0 && ! -e $scratch/asked && -z $out ]] || fail "right device"
health RAYA="$scratch/faulty" RAYA_FAULT="clEnqueueCopyBufferRect 1 lost"
[[ $code == 1 ]] && drained "exit code 4: FAIL machine.copies_of_blocks "* || fail "lost copies"
[[ $out == *"got "* ]] || fail "no details"
health RAYA="$raya" OCL_ICD_VENDORS=/nowhere
[[ $code == 1 ]] && drained "exit code 3: raya: "* || fail "no device"
touch "$scratch/hangs"
health RAYA="$scratch/faulty" RAYA_HEALTH_SECONDS=1
[[ $code == 1 ]] && drained "no result after 1 s" || fail "hanging device"
# Slurm's slurmd starts the program without variables.
code=0
out=$(env -i RAYA="$raya" POCL_CACHE_DIR="$scratch/pocl" ${OCL_ICD_VENDORS:+OCL_ICD_VENDORS="$OCL_ICD_VENDORS"} "$health" --only "number.fp32" 2>&1) ||
    code=$?
[[ $code == 0 && -z $out ]] || fail "no variables"
rm "$scratch/bin/scontrol"
health RAYA="$scratch/faulty" RAYA_HEALTH_SECONDS=1
[[ $code == 1 ]] || fail "no scontrol"
echo "raya-health: as expected"
