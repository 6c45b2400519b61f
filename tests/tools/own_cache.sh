#!/usr/bin/env bash
# Runs a program with a kernel cache of its own, for ctest, which runs several at once: two programs must not write one cache (pocl issue 586).
#   own_cache.sh NAME COMMAND...     the cache is the folder NAME below POCL_CACHE_DIR, or below build/pocl-cache; it stays for the next run.
#                                    It begins with what RAYA_KERNEL_STORE holds and adds to it (tests/kernel_cache.hpp)
set -euo pipefail
root=$(dirname "$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")")
POCL_CACHE_DIR=${POCL_CACHE_DIR:-$root/build/pocl-cache}/$1
export POCL_CACHE_DIR
mkdir -p "$POCL_CACHE_DIR"  # PoCL takes no folder that is not there
store=${RAYA_KERNEL_STORE-}
[[ ! -d $store ]] || cp -rln "$store/." "$POCL_CACHE_DIR"
export RAYA_TUNED=off RAYA_BINARIES=off  # what a developer's devices were tuned to, and kernels compiled before, are no part of a test
code=0
"${@:2}" || code=$?
[[ ! -d $store ]] || (cd "$POCL_CACHE_DIR" && find . -type f ! -name 'tempfile*' ! -name '*.part*' -exec cp -ln --parents -t "$store" {} +) || true
exit $code
