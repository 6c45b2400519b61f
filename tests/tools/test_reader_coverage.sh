#!/usr/bin/env bash
# The files of tests/fuzz/corpus reach at least 95 % of the branches of raya's readers of files:
#   tests/tools/test_reader_coverage.sh BUILD [GCOVR ARGS]    BUILD: a build of raya. The readers are compiled again, without optimisation, in
#                                                             BUILD/reader_coverage; e.g. --html-details FILE
# Prints the figure of each file. Exit code 77: no gcovr (tools/setup).
set -euo pipefail
root=$(dirname "$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")")
build=$(readlink -f "$1")
shift
folder=$build/reader_coverage
least=95  # percent

say() { echo "test_reader_coverage.sh: $*" >&2; }

command -v gcovr >/dev/null || { say "no gcovr (Debian: gcovr); branches were not counted"; exit 77; }
mkdir -p "$folder"
log=$folder/log
{
    cmake -G Ninja -S "$root/tests/fuzz" -B "$folder" -DCMAKE_CXX_COMPILER=g++ -DRAYA_FUZZ=coverage -DRAYA_BUILD="$build" &&
        cmake --build "$folder" -j2
} >"$log" 2>&1 || { cat "$log"; say "the readers could not be built"; exit 1; }
find "$folder" -name '*.gcda' -delete
for corpus in "$root"/tests/fuzz/corpus/*; do
    "$folder/fuzz_$(basename "$corpus")" "$corpus" >"$log" 2>&1 || { cat "$log"; say "a find"; exit 1; }
done
filters=()
while read -r file; do filters+=(--filter "${file//./\\.}\$"); done <"$folder/reader_files.txt"
cd "$root"
gcovr --root . --object-directory "$folder" "${filters[@]}" --exclude-throw-branches --branches --fail-under-branch $least "$@" "$folder"
