#!/usr/bin/env bash
# Tests the commit in `raya --version` for a checkout, a checkout with changes, and an archive by `git archive`; other sources have no commit.
set -euo pipefail
root=$(readlink -f "$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../..")
command -v git >/dev/null || { echo "skipped: no git"; exit 77; }
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export HOME=$scratch GIT_CONFIG_NOSYSTEM=1 GIT_AUTHOR_NAME=a GIT_AUTHOR_EMAIL=a GIT_COMMITTER_NAME=a GIT_COMMITTER_EMAIL=a
unset GIT_DIR GIT_WORK_TREE
fail() { echo "FAILED line ${BASH_LINENO[0]}: $1"; exit 1; }
expect() {  # expect FOLDER TEXT: a build from FOLDER has TEXT in --version
    cmake -DROOT="$1" -DOUTPUT="$scratch/commit.cpp" "-DBUILD=Release, a compiler" -P "$root/tools/commit.cmake"
    grep -qF "return \"$2\";" "$scratch/commit.cpp" || fail "no '$2' in: $(<"$scratch/commit.cpp")"
}

checkout=$scratch/checkout
mkdir -p "$checkout/tools"
cp "$root/.gitattributes" "$checkout"
cp "$root/tools/commit.txt" "$checkout/tools"
grep -qF 'Format:%H' "$checkout/tools/commit.txt" || { echo "skipped: these sources come from git archive"; exit 77; }
expect "$checkout" "Release, a compiler"

git init -q "$scratch"  # the repository of another project, in a parent folder of the sources
git -C "$scratch" commit -q --allow-empty -m "of others"
expect "$checkout" "Release, a compiler"

git init -q "$checkout"
git -C "$checkout" add .
git -C "$checkout" commit -q -m first
git -C "$checkout" tag v9.9
first=$(git -C "$checkout" rev-parse HEAD)
expect "$checkout" "commit ${first:0:12}, Release, a compiler"
touch -d '1 hour ago' "$scratch/commit.cpp"
expect "$checkout" "commit ${first:0:12}, Release, a compiler"
[[ -n $(find "$scratch/commit.cpp" -mmin +50) ]] || fail "the file was written without a change: every build would link the program again"

echo "more" >>"$checkout/.gitattributes"
expect "$checkout" "commit ${first:0:12} with changes, Release, a compiler"
git -C "$checkout" commit -q -a -m second
second=$(git -C "$checkout" rev-parse HEAD)
expect "$checkout" "commit ${second:0:12}, Release, a compiler"
git -C "$checkout" worktree add -q "$scratch/worktree" "$first"
expect "$scratch/worktree" "commit ${first:0:12}, Release, a compiler"

mkdir "$scratch/packed"
git -C "$checkout" archive "$first" | tar -x -C "$scratch/packed"
expect "$scratch/packed" "commit ${first:0:12}, Release, a compiler"
echo "the commit: as expected"
