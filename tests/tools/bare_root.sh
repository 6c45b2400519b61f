# For tests in a minimal Debian: make_bare_root BUILD [RELEASE] makes one in the folder "$bare" (tools/debian_root), by default of this system's release;
# in_root COMMAND... runs a command in it.
# Exit code 77: not root, no debootstrap or no network. BUILD/debs caches packages for the next run.
# shellcheck shell=bash
fail() { echo "FAILED line ${BASH_LINENO[0]}: $1"; exit 1; }
debian_root=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../../tools/debian_root

in_root() { "$debian_root" run "$bare" "$@"; }

keep_packages() { cp -n "$bare"/var/cache/apt/archives/*.deb "$1/debs/" 2>/dev/null || true; }

make_bare_root() {
    mkdir -p "$1/debs"
    scratch=$(mktemp -d -p "$1")
    chmod 755 "$scratch"
    trap 'rm -rf --one-file-system "$scratch"' EXIT
    bare=$scratch/root
    "$debian_root" make "${2:-$(. /etc/os-release && echo "$VERSION_CODENAME")}" "$bare" "$1/debs" || exit
    cp -n "$1"/debs/*.deb "$bare/var/cache/apt/archives/"
}
