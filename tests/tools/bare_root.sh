# For tests in a minimal Debian: make_bare_root BUILD installs one in the folder "$bare"; in_root COMMAND... runs a command in that Debian.
# Needs root, debootstrap and the network; without them the exit code is 77. BUILD/debs caches packages for the next run.
# shellcheck shell=bash
skip() { echo "skipped: $1"; exit 77; }
fail() { echo "FAILED line ${BASH_LINENO[0]}: $1"; exit 1; }

# Runs a command in the root folder $bare, with /proc and /sys mounted while it runs.
# shellcheck disable=SC2016  # variables of the inner shell
in_root() {
    unshare --mount --pid --fork --kill-child sh -c '
        mount -t proc proc "$0/proc" && mount --rbind /sys "$0/sys" && exec chroot "$0" env -i HOME=/root PATH=/usr/sbin:/usr/bin:/sbin:/bin \
            DEBIAN_FRONTEND=noninteractive "$@"' "$bare" "$@"
}

keep_packages() { cp -n "$bare"/var/cache/apt/archives/*.deb "$1/debs/" 2>/dev/null || true; }

make_bare_root() {  # takes the packages from the mirror that apt's sources name
    local build=$1 suite=bookworm mirror
    ((EUID == 0)) || skip "chroot needs root"
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
        { cp "$bare.log" "$build/bare-root.log"; skip "debootstrap failed, perhaps without a network: $(tail -n 1 "$bare.log")"; }
    cp -n "$build"/debs/*.deb "$bare/var/cache/apt/archives/"
    in_root apt-get -qq update || skip "no network"
}
