#!/usr/bin/env bash
# Ranks on two hosts that are connected only by TCP make the same image as a single process.
#   tests/tools/test_namespaces.sh RAYA [MPIRUN]      the built program, with raya_mpi.so next to it; Open MPI's launcher, default `mpirun`
# Each host is a network namespace with its own host name, /etc/hosts and disk, so the files of rank 0 do not exist on the other host. Needs root,
# iproute2 and Open MPI; without them the exit code is 77.
set -euo pipefail
raya=$(readlink -f "$1")
scenes=$(dirname "$(readlink -f "${BASH_SOURCE[0]}")")/../../scenes

skip() { echo "skipped: $1"; exit 77; }
((EUID == 0)) || skip "network namespaces need root"
command -v ip >/dev/null || skip "the program ip is missing (Debian: iproute2)"
[[ -e $(dirname "$raya")/raya_mpi.so ]] || skip "raya was built without MPI"
mpirun=$(command -v "${2:-mpirun}") || skip "no ${2:-mpirun}"
# Open MPI's mpirun --version prints "Open MPI", its mpiexec --version "OpenRTE". MPICH is not tested, because MPICH 4.0 sometimes hangs over TCP: in
# MPI_Finalize, one rank waits in a barrier while another rank needs its answer (pmodels/mpich pull request 6596).
[[ $("$mpirun" --version) == *Open* ]] || skip "$mpirun is not Open MPI's"

hosts=("raya-$$-a" "raya-$$-b")  # unique, because this script may run several times at once
scratch=$(mktemp -d)
disk=$scratch/disk  # mount point; on each host it is $scratch/HOST
export POCL_CACHE_DIR=${POCL_CACHE_DIR:-$scratch/kernels}
mkdir -p "$disk" "$POCL_CACHE_DIR"
clean() {
    for host in "${hosts[@]}"; do
        ip netns pids "$host" 2>/dev/null | xargs -r kill -KILL 2>/dev/null || true  # processes of a hanging run
        ip netns del "$host" 2>/dev/null || true
    done
    rm -rf "$scratch"
}
trap clean EXIT
fail() { echo "FAILED: $*"; exit 1; }

for host in "${hosts[@]}"; do
    ip netns add "$host" 2>"$scratch/error" || skip "no network namespaces: $(head -n 1 "$scratch/error")"
    ip -n "$host" link set lo up
done
ip -n "${hosts[0]}" link add link0 type veth peer name link0 netns "${hosts[1]}" 2>"$scratch/error" || skip "no veth: $(head -n 1 "$scratch/error")"
for i in 0 1; do
    ip -n "${hosts[i]}" address add "10.83.18.$((i + 1))/24" dev link0
    ip -n "${hosts[i]}" link set link0 up
done
for host in "${hosts[@]}"; do
    timeout 10 sh -c "until ip -n $host link show link0 | grep -qE 'state (UP|UNKNOWN)'; do sleep 0.1; done" || fail "the link of $host stays down"
done

# Replaces ssh: on_host HOST COMMAND...; like ssh, it joins the words to one command line for the host's shell.
cat >"$scratch/on_host" <<END
#!/bin/sh
export host=\$1
shift
export line="\$*"
exec ip netns exec "\$host" unshare --uts sh -c '
    hostname "\$host" && mount --bind "$scratch/hosts" /etc/hosts && mount --bind "$scratch/\$host" "$disk" && exec sh -c "\$line"'
END
chmod 755 "$scratch/on_host"
printf '%s\n' "127.0.0.1 localhost" "10.83.18.1 ${hosts[0]}" "10.83.18.2 ${hosts[1]}" >"$scratch/hosts"
host_list=${hosts[0]},${hosts[1]}
export OMPI_MCA_plm_rsh_agent=$scratch/on_host PRTE_MCA_plm_ssh_agent=$scratch/on_host OMPI_MCA_pml=ob1 OMPI_MCA_btl=tcp,self
launch="$mpirun --bind-to none --host $host_list"

bytes_on_link() { ip netns exec "${hosts[0]}" cat /sys/class/net/link0/statistics/{r,t}x_bytes | awk '{ bytes += $1 } END { print bytes }'; }

compare() {  # compare NAME REPORT_ALONE REPORT_OF_RANKS BYTES_ON_LINK
    python3 - "$@" "${hosts[@]}" <<'END'
import json, sys
name, carried, hosts = sys.argv[1], int(sys.argv[4]), sys.argv[5:]
alone, found = (json.load(open(path)) for path in sys.argv[2:4])
ranks = found["measured"]["ranks"]
messages, sent = (sum(rank[key] for rank in ranks) for key in ("messages_sent", "bytes_sent"))
print(f"{name}: {messages} messages, {sent} bytes of {carried} on the link, "
      f"rendered in {1000 * found['measured']['render_s']:.1f} ms, alone in {1000 * alone['measured']['render_s']:.1f} ms")
for fault, is_right in {
    "the image differs from that of one process": found["image"]["hash"] == alone["image"]["hash"],
    "the ranks did not run on the two hosts": [rank["host"] for rank in ranks] == hosts,
    "not all messages used the link": carried >= sent > 0,
}.items():
    if not is_right:
        sys.exit(f"FAILED: {name}: {fault}")
END
}

check() {  # check NAME SCENE OPTION...: renders without MPI, then with one rank on each host
    local name=$1 scene=$2 host before
    shift 2
    "$raya" render "$scenes/$scene.nff" "$@" --quiet -o "$scratch/image.pfm" --report "$scratch/alone.json"
    for host in "${hosts[@]}"; do
        mkdir -p "$scratch/$host/cl"
        rm -f "$scratch/$host"/{scene,image,report}.*
        cp -ru "$POCL_CACHE_DIR/." "$scratch/$host/cl"
    done
    cp "$scenes/$scene.nff" "$scratch/${hosts[0]}/scene.nff"
    before=$(bytes_on_link)
    POCL_CACHE_DIR=$disk/kernels timeout 60 "$scratch/on_host" "${hosts[0]}" \
        "$launch -n 2 $raya render $disk/scene.nff $* --quiet -o $disk/image.pfm --report $disk/report.json" || fail "$name: exit code $?"
    cmp "$scratch/image.pfm" "$scratch/${hosts[0]}/image.pfm" || fail "$name: wrong image"
    compare "$name" "$scratch/alone.json" "$scratch/${hosts[0]}/report.json" $(($(bytes_on_link) - before))
}

check ring centre --antialias filter --size 24
check torus planes --machine torus --nodes 2x2x1 --size 16
echo "two hosts over TCP, the same images"
