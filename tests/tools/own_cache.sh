#!/usr/bin/env bash
# Runs a test program with its own kernel cache, and with settings of Open MPI. ctest runs several programs at once, which must not share a cache (pocl issue 586).
#   own_cache.sh NAME COMMAND...     cache: folder NAME in POCL_CACHE_DIR, by default build/pocl-cache. The next run reuses it.
#                                    A new cache is a copy of RAYA_KERNEL_STORE; new kernels are also added to RAYA_KERNEL_STORE
#                                    (tests/kernel_cache.hpp)
set -euo pipefail
root=$(dirname "$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")")
POCL_CACHE_DIR=${POCL_CACHE_DIR:-$root/build/pocl-cache}/$1
export POCL_CACHE_DIR
mkdir -p "$POCL_CACHE_DIR"  # PoCL does not create the folder
store=${RAYA_KERNEL_STORE-}
[[ ! -d $store ]] || cp -rln "$store/." "$POCL_CACHE_DIR"
export RAYA_TUNED=off  # tests must not use a developer's tuning
# Open MPI starts as root, and more ranks than there are cores: versions 4, 5 and 6.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
export OMPI_MCA_rmaps_base_oversubscribe=1 PRTE_MCA_rmaps_default_mapping_policy=:oversubscribe PRTE_MCA_mapby=:oversubscribe
code=0
"${@:2}" || code=$?
[[ ! -d $store ]] || (cd "$POCL_CACHE_DIR" && find . -type f ! -name 'tempfile*' ! -name '*.part*' -exec cp -ln --parents -t "$store" {} +) || true
exit $code
