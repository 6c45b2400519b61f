#!/usr/bin/env bash
# Runs a program with a kernel cache of its own, for ctest, which runs several at once: two programs must not write one cache (pocl issue 586).
#   own_cache.sh NAME COMMAND...     the cache is the folder NAME below POCL_CACHE_DIR, or below build/pocl-cache; it stays for the next run.
#                                    It begins with what RAYA_KERNEL_STORE holds (tests/kernel_cache.hpp)
set -euo pipefail
root=$(dirname "$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")")
POCL_CACHE_DIR=${POCL_CACHE_DIR:-$root/build/pocl-cache}/$1
export POCL_CACHE_DIR
mkdir -p "$POCL_CACHE_DIR"  # PoCL takes no folder that is not there
[[ ! -d ${RAYA_KERNEL_STORE-} ]] || cp -r "$RAYA_KERNEL_STORE/." "$POCL_CACHE_DIR"
export RAYA_TUNED=off  # what a developer's devices were tuned to is no part of a test
exec "${@:2}"
