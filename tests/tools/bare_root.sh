# For tests that install into a Debian of the smallest set of packages: make_bare_root BUILD, then `there COMMAND...` runs in "$bare".
# Exit code 77 where there is no such thing: it takes root, debootstrap and the network. Packages are kept in BUILD/debs for the next run.
# shellcheck shell=bash
skip() { echo "skipped: $1"; exit 77; }
fail() { echo "FAILED line ${BASH_LINENO[0]}: $1"; exit 1; }

# Commands there, with /proc and /sys, which go when they end.
# shellcheck disable=SC2016  # the variables of the inner shell
there() {
    unshare --mount --pid --fork --kill-child sh -c '
        mount -t proc proc "$0/proc" && mount --rbind /sys "$0/sys" && exec chroot "$0" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin \
            DEBIAN_FRONTEND=noninteractive "$@"' "$bare" "$@"
}

keep_packages() { cp -n "$bare"/var/cache/apt/archives/*.deb "$1/debs/" 2>/dev/null || true; }

make_bare_root() {  # the mirror is that of apt's own sources
    local build=$1 suite=bookworm mirror
    ((EUID == 0)) || skip "not root, who alone can change the root folder"
    command -v debootstrap >/dev/null || skip "no debootstrap (tools/setup --bare-root)"
    # shellcheck disable=SC2016  # apt's own variables
    mirror=$(apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT) $(CREATED_BY)' 2>/dev/null |
        awk -v suite="$suite" '$2 == suite && $3 == "main" && $4 == "Packages" { print $1; exit }')
    [[ -n $mirror ]] || skip "apt's sources have no $suite"
    bare=$(mktemp -d -p "$build")
    chmod 755 "$bare"
    trap 'rm -rf --one-file-system "$bare" "$bare.log"' EXIT
    mkdir -p "$build/debs"
    timeout 400 debootstrap --variant=minbase --cache-dir="$build/debs" "$suite" "$bare" "$mirror" >"$bare.log" 2>&1 ||
        { cp "$bare.log" "$build/bare-root.log"; skip "no network, or debootstrap has another reason: $(tail -n 1 "$bare.log")"; }
    cp -n "$build"/debs/*.deb "$bare/var/cache/apt/archives/"
    there apt-get -qq update || skip "no network"
}
