#!/usr/bin/env bash
# Checks that the files of tests/fuzz/corpus reach at least 95 % of the branches of raya's file readers.
#   tests/tools/test_reader_coverage.sh BUILD      BUILD: a build of raya. The readers are compiled again in BUILD/reader_coverage.
# Prints the figures of each file. Counts clang's branches of the source. gcov, even with gcovr's --exclude-throw-branches, would also count branches
# of destructor calls, which do not depend on the input. Exit code 77: clang or llvm-cov is missing.
set -euo pipefail
root=$(dirname "$(dirname "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")")")
build=$(readlink -f "$1")
folder=$build/reader_coverage
minimum=95  # percent

say() { echo "test_reader_coverage.sh: $*" >&2; }

llvm=$("$root/tools/setup" --llvm)
for tool in clang++-$llvm llvm-profdata-$llvm llvm-cov-$llvm; do
    command -v $tool >/dev/null || { say "skipped: no $tool (tools/setup --gpu)"; exit 77; }
done
mkdir -p "$folder"
log=$folder/log
{
    cmake -G Ninja -S "$root/tests/fuzz" -B "$folder" -DCMAKE_CXX_COMPILER="clang++-$llvm" -DRAYA_FUZZ=coverage -DRAYA_BUILD="$build" &&
        cmake --build "$folder" -j2
} >"$log" 2>&1 || { cat "$log"; say "cannot build the readers"; exit 1; }
rm -f "$folder"/*.profraw
objects=()
for corpus in "$root"/tests/fuzz/corpus/*; do
    reader=$(basename "$corpus")
    LLVM_PROFILE_FILE=$folder/$reader.profraw "$folder/fuzz_$reader" "$corpus" >"$log" 2>&1 || { cat "$log"; say "$reader: crash"; exit 1; }
    objects+=(-object "$folder/fuzz_$reader")
done
"llvm-profdata-$llvm" merge -o "$folder/all.profdata" "$folder"/*.profraw
mapfile -t files <"$folder/reader_files.txt"
"llvm-cov-$llvm" report --show-branch-summary --show-region-summary=0 --show-functions=0 -instr-profile="$folder/all.profdata" "${objects[@]:1}" \
    "${files[@]}" 2>"$log" | sed 's/   */  /g' | tee "$folder/report"
reached=$(awk '$1 == "TOTAL" { print $NF }' "$folder/report")
awk -v minimum=$minimum -v reached="${reached%\%}" 'BEGIN { exit !(reached >= minimum) }' ||
    { say "the corpus reaches $reached of the branches; expected at least $minimum %"; exit 1; }
