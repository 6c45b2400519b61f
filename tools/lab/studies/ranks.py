"""Renders on 1 to {ranks} ranks

How many MPI ranks are worth having, and from where on do they talk more than they trace?

- Ring: {scene} at {size} x {size} with the 3 x 3 filter; a PE for each column, or for each rank where there are more
  ranks than columns; p = 16, beyond that round(sqrt(P)). Torus: {torus_scene} at {torus_size} x {torus_size} on 8 x 8 x
  8 nodes, a voxel each, queues of 1024 packets.
- A rank is one core of this machine's CPU, or a device of its own where that is no CPU. One rank is measured: what its
  device takes for tracing, for all else, and the rest of the render, which is rank 0's host.
- Ring on R ranks: tracing / R times (1 + u) of the ranks' segments, by the pixels' modelled cycles; all else / R; each
  rotation alpha + beta for the block of one PE; pixels and loads of all ranks come to rank 0 one after another; the
  scene goes out in log2 R rounds.
- Torus on R ranks: bricks as `raya render` cuts them. In each superstep tracing is that of the rank with most modelled
  cycles, all else goes with the nodes of the largest brick; faces take alpha for each message and beta for each byte
  that a rank sends or receives, whichever is more, of the rank with most; the status of all nodes goes to every rank in
  log2 R rounds. Supersteps, cycles and words of links are counted in one render.
- More than 512 ranks have a torus with a node for each, assumed: nodes are cut further, so supersteps grow with its
  side, a node's cycles in one shrink with its voxel and its words with a face of that, and rank 0's host looks at so
  many more nodes.
- Times of the model do not include what commands to the device cost beyond one rank's, collisions of messages, or
  waiting for a rank that is late for another reason.
- Networks: alpha and beta fitted to a ping-pong of `raya ping` (minimum of up to 300 turns for each of nine lengths, 1
  B to 4 MB), two that are assumed, and one that is given, where it is (`--network`). Measured: `mpirun -n R raya
  render`, up to {turns} of each in turn after a warm-up, none after {enough} s of them, one thread a rank; the model is
  compared with the minimum. """
import json
import os
import resource
import shlex
import shutil
import subprocess
import tempfile

import numpy as np
import pandas as pd
import raya
from raya.lab import Comparison, Page, Plot, Series, Table, one_of, series_by, study
from raya.lab.laboratory import Measured, format_for
from raya.lab.voxels import NO_LIMIT, even_scene, near_cube, powers, sides_text

MOST, TURNS, ENOUGH_S, QUIET = 65_536, 3, 5, 0.05
SIDES, QUEUE, STATUS_WORDS = (8, 8, 8), 1024, raya.STATUS_WORDS
PARTS = ("compute", "host", "exchange", "collect", "broadcast")
LAUNCHER = shlex.split(os.environ.get("RAYA_MPIRUN", "mpirun --bind-to none"))


def lacks():
    if not LAUNCHER or shutil.which(LAUNCHER[0]) is None:
        return (f"cannot start {LAUNCHER[0] if LAUNCHER else 'RAYA_MPIRUN'}; remedy: install openmpi-bin or mpich, of "
                "the MPI that raya was built with, or name another launcher in RAYA_MPIRUN")
    return ""


def mpirun(ranks, threads, arguments):
    """What `raya` prints on so many ranks."""
    settings = {"OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_ALLOW_RUN_AS_ROOT": "1",
                "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    words = LAUNCHER + ["-n", str(ranks), "env", f"POCL_MAX_PTHREAD_COUNT={threads}", raya.program(), *arguments]
    run = subprocess.run(words, env={**os.environ, **settings}, capture_output=True, text=True)
    if run.returncode:
        said = [line for line in run.stderr.splitlines() if line.strip()]
        own = [line for line in said if line.startswith("raya: ")]
        raise raya.InputError(f"{ranks} ranks: {(own or said or ['failed'])[-1]}")
    return run.stdout


def render_on_ranks(ranks, arguments):
    """The report of a render on so many ranks of one thread each."""
    with tempfile.TemporaryDirectory(prefix="raya-ranks-") as folder:
        report = os.path.join(folder, "report.json")
        mpirun(ranks, 1, ["render", *arguments, "--quiet", "-o", os.path.join(folder, "image.pfm"), "--report", report])
        with open(report, encoding="utf-8") as file:
            return json.load(file)


def look_around():
    """(numbers of ranks that are measured, processors that each of these has, ping-pong)"""
    here, ping = {1: 1}, None
    ranks = 2
    while ranks <= min(max(2 * os.cpu_count(), 4), 16):
        one = json.loads(mpirun(ranks, 1, ["ping"]))
        ping = ping or one
        hosts = {}
        for place in one["ranks"]:
            hosts.setdefault(place["host"], [0, place["cores"]])[0] += place["threads"]
        here[ranks] = sum(min(threads, cores) for threads, cores in hosts.values())
        ranks *= 2
    return here, ping


def rounds(ranks):
    return (ranks - 1).bit_length()


class Ring:
    """A ring with the filter: as many PEs as the image has columns, or as ranks where these are more."""

    name, label = "ring", "trace"

    def __init__(self, lab, scene, file, size):
        costs = lab.costs(scene, size)
        self.arguments = [file, "--machine", "grande", "--accel", "none", "--antialias", "filter", "--format",
                          format_for(scene), "--size", str(size)]
        self.ranks = powers(min(MOST, size * size))
        self.parts = []
        for ranks in self.ranks:
            pes = max(size, ranks)
            offset = (round(pes**0.5) if ranks > size else 16) % size
            loads = np.bincount(raya.ranks_of_pes(pes, ranks), raya.loads(costs.trace, pes=pes, offset=offset))
            self.parts.append({"pes": pes, "u": loads.max() / loads.mean() - 1,
                               "rotations": raya.exchange_rotations(size, size, pes=pes, offset=offset),
                               "block": 12 * raya.largest_share(size, size, pes=pes, offset=offset),
                               "image": 12 * size * size, "scene": 4 * costs.job_words})
        self.arrays = [f"{part['pes']} PEs" for part in self.parts]

    def predict(self, i, one, network, processors):
        """Seconds by what they are spent on."""
        part, ranks, (alpha, beta) = self.parts[i], self.ranks[i], network
        parts = dict.fromkeys(PARTS, 0.0)
        parts.update(compute=(one["trace"] * (1 + part["u"]) + one["rest"]) / processors, host=one["host"])
        if ranks > 1:
            parts["exchange"] = part["rotations"] * (alpha + beta * part["block"])
            parts["collect"] = 2 * (ranks - 1) * alpha + beta * part["image"] * (1 - 1 / ranks)
            parts["broadcast"] = rounds(ranks) * (alpha + beta * part["scene"])
        return parts


class Torus:
    """A torus of 8 x 8 x 8 nodes, counted in one render; beyond as many ranks, tori whose nodes have been cut
    further."""

    name, label = "torus", "trace_voxel"

    def __init__(self, lab, scene, file, size):
        sides = sides_text(SIDES)
        self.arguments = [file, "--machine", "torus", "--nodes", sides, "--voxels", sides, "--queue", str(QUEUE),
                          "--size", str(size)]
        self.ranks = powers(MOST)
        result = lab.render(scene, machine="torus", size=size, nodes=sides, voxels=sides, queue=QUEUE, packets=True,
                            pe_memory=NO_LIMIT)
        nodes = int(np.prod(SIDES))
        status, words = 4 * STATUS_WORDS * nodes, 4 * result.copied_words
        counted = {ranks: {**bricks(result, ranks), "status": status, "scene": words, "host": 1}
                   for ranks in powers(nodes)}
        self.parts = [counted[r] if r <= nodes else cut_further(counted[nodes], r // nodes) for r in self.ranks]
        self.arrays = [f"{sides} nodes" if r <= nodes else f"{sides_text(near_cube(r))} nodes, assumed"
                       for r in self.ranks]

    def predict(self, i, one, network, processors):
        part, ranks, (alpha, beta) = self.parts[i], self.ranks[i], network
        busiest = one["trace"] * part["cycles"] / part["all"] + one["rest"] * part["most"] / part["nodes"]
        parts = dict.fromkeys(PARTS, 0.0)
        parts.update(compute=busiest * ranks / processors, host=one["host"] * part["host"])
        if ranks > 1:
            others = 1 - 1 / ranks
            parts["exchange"] = part["messages"] * alpha + part["bytes"] * beta
            parts["collect"] = part["supersteps"] * (rounds(ranks) * alpha + beta * part["status"] * others)
            parts["broadcast"] = (ranks - 1) * alpha + beta * part["scene"] * others
        return parts


def bricks(result, ranks):
    """Sums over the supersteps, each of the rank that has most in it. What the nodes of a brick send over one of their
    links to the same rank is one message."""
    rank_of, ends = raya.ranks_of_nodes(SIDES, ranks), raya.link_ends(SIDES)
    cycles, words = result.step_cycles, result.step_link_words
    by_rank = np.stack([cycles[:, rank_of == rank].sum(1) for rank in range(ranks)], 1)
    source, target = np.repeat(rank_of[:, None], 6, 1), rank_of[ends]
    link = np.broadcast_to(np.arange(6), ends.shape)
    node, way = np.nonzero(source != target)
    face = (source[node, way].astype(np.int64) * ranks + target[node, way]) * 6 + link[node, way]
    faces, index = np.unique(face, return_inverse=True)
    sums = np.zeros((len(words), len(faces)))  # [superstep, face]
    np.add.at(sums.T, index, words[:, node, way].T.astype(float))
    sums = 4 * sums
    most = {"messages": 0.0, "bytes": 0.0}
    if len(faces):
        for name, values in (("messages", (sums > 0).astype(float)), ("bytes", sums)):
            ways = [np.stack([values[:, end == rank].sum(1) for rank in range(ranks)], 1)
                    for end in (faces // 6 // ranks, faces // 6 % ranks)]
            most[name] = np.maximum(*ways).max(1).sum()
    return {"nodes": len(rank_of), "most": np.bincount(rank_of).max(), "supersteps": len(cycles),
            "cycles": float(by_rank.max(1).sum()), "all": float(cycles.sum()), **most}


def cut_further(part, times):
    """The torus of so many times as many nodes, each of whose nodes has been cut into so many, a rank for each."""
    side = times ** (1 / 3)
    change = {"nodes": times, "supersteps": side, "cycles": 1 / times, "messages": side, "bytes": 1 / side**2,
              "status": times, "host": side * times}
    return {name: value * change.get(name, 1) for name, value in part.items()}


def work_of(machine, report):
    """What one rank took, measured: tracing, all else on the device, and the rest of the render."""
    commands = report["measured"]["commands"]
    device = 1e-9 * sum(c["total_ns"] for c in commands)
    trace = 1e-9 * sum(c["total_ns"] for c in commands if c["label"] == machine.label)
    return {"trace": trace, "rest": device - trace, "host": max(0.0, report["measured"]["render_s"] - device)}


def measure(machine, here, device):
    """{ranks: (seconds of each render, report of the fastest)}"""
    first = render_on_ranks(1, machine.arguments)  # which builds the kernels
    if first["device"]["name"] != device:
        raise raya.InputError(f"study ranks runs on the default devices of its ranks, here {first['device']['name']}, "
                              f"and was given {device}: leave --device out, or name the device in RAYA_DEVICE")
    trials = {ranks: ([], None) for ranks in here}
    for _ in range(TURNS):
        for ranks, (seconds, best) in trials.items():
            if sum(seconds) >= ENOUGH_S:
                continue
            report = render_on_ranks(ranks, machine.arguments)
            s = report["measured"]["render_s"]
            trials[ranks] = (seconds + [s], report if not seconds or s < min(seconds) else best)
    return trials


def processor_time():
    """(busy, all) seconds of all processors; of this process and those that it ran to their end."""
    with open("/proc/stat", encoding="utf-8") as file:
        ticks = [int(word) / os.sysconf("SC_CLK_TCK") for word in file.readline().split()[1:9]]
    own = sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(ticks) - ticks[3] - ticks[4], sum(ticks), own


@study("ranks", one_scene=True, lacks=lacks)
def ranks(lab, scenes):
    on_ring, on_torus = one_of(scenes), scenes[0] if scenes else even_scene(8320)
    size = lab.size(512)
    with tempfile.TemporaryDirectory(prefix="raya-study-") as folder:
        files = [os.path.join(folder, name) for name in ("ring.nff", "torus.nff")]
        for scene, file in zip((on_ring, on_torus), files):
            scene.save(file)
        before = processor_time()
        here, ping = look_around()
        machines = [kind(lab, scene, file, size) for kind, scene, file in
                    zip((Ring, Torus), (on_ring, on_torus), files)]
        trials = [measure(machine, here, lab.session.device["name"]) for machine in machines]
        busy, whole, own = (b - a for a, b in zip(before, processor_time()))
    own_network = ping["alpha_s"], ping["beta_s_per_byte"]
    networks = {"this host": (own_network, f"fitted to the ping-pong, {ping['library']}"),
                "10 GbE": ((30e-6, 0.8e-9), "assumed: 10 Gbit/s of IEEE 802.3ae; 30 us, about what TCP takes"),
                "InfiniBand HDR": ((1e-6, 0.04e-9), "assumed: 200 Gbit/s of a 4x port; 1 us, an adapter's 0.6 us and "
                                   "what MPI adds")}
    if lab.network:
        networks["given"] = lab.network, "given with --network"
    rows, checks = [], []
    for machine, trial in zip(machines, trials):
        one = work_of(machine, trial[1][1])
        one_s = sum(machine.predict(0, one, (0, 0), 1).values())
        for name, (network, _) in networks.items():
            for i, count in enumerate(machine.ranks):
                parts = machine.predict(i, one, network, count)
                total = sum(parts.values())
                rows.append({"machine": machine.name, "network": name, "ranks": count, "array": machine.arrays[i],
                             **{f"{part} (ms)": 1e3 * seconds for part, seconds in parts.items()},
                             "time (ms)": 1e3 * total, "speed-up": one_s / total,
                             "communication (%)": 100 * sum(parts[p] for p in PARTS[2:]) / total})
        on_processors = trial[1][1]["device"]["platform"] == "Portable Computing Language"
        for i, (count, (seconds, _)) in enumerate(trial.items()):
            cores = here[count] if on_processors else count
            parts = machine.predict(i, one, own_network, cores)
            predicted = 1e3 * (sum(parts.values()) - parts["broadcast"])
            time = Measured(min(seconds), float(np.median(seconds)), max(seconds), len(seconds))
            checks.append({"machine": machine.name, "ranks": count, "cores": cores, "predicted (ms)": predicted,
                           "measured, best (ms)": 1e3 * time.least, "median (ms)": 1e3 * time.median,
                           "largest (ms)": 1e3 * time.largest, "predicted / measured": predicted / time.least / 1e3,
                           "remark": "ranks share cores" if cores < count else
                           "the model rests on it" if count == 1 else ""})
    rows, checks = pd.DataFrame(rows), pd.DataFrame(checks)
    summary = pd.DataFrame([summary_of(*one) for one in rows.groupby(["machine", "network"], sort=False)])
    others = min(max((busy - own) / whole, 0), 1) if whole > 0 else 0
    return Page({"scene": on_ring.name, "torus_scene": on_torus.name, "size": size, "torus_size": size,
                 "ranks": int(rows["ranks"].iloc[-1]), "turns": TURNS, "enough": ENOUGH_S, "alpha_s": own_network[0],
                 "beta_s_per_byte": own_network[1]},
                [*(finding_of_machine(summary, name) for name in ("ring", "torus")), finding_of_checks(checks),
                 finding_of_others(others), finding_of_network(ping)],
                [Comparison(f"{c['machine']}, {c['ranks']} ranks: predicted / "
                            "measured", "", None, c["predicted / measured"],
                            c["remark"]) for _, c in checks[checks["ranks"] > 1].iterrows()],
                tables=tables_of(rows, checks, summary, networks, ping), plots=[*plots_of(rows, checks)],
                news=["Neither paper has more than one machine to run on; here its array is divided over as many hosts "
                      "as one likes, with the same image."],
                clock="measured here where it says so, all else predicted from measured seconds of one rank. What a "
                "render takes begins when its kernels are built and the scene has been sent; the time in all has the "
                "sending too.")


def summary_of(key, some):
    half = some["ranks"][some["communication (%)"] >= 50]
    best = some.loc[some["time (ms)"].idxmin()]
    return {"machine": key[0], "network": key[1], "half at (ranks)": half.iloc[0] if len(half) else None,
            "fastest (ranks)": best["ranks"], "array": best["array"], "time (ms)": best["time (ms)"],
            "speed-up": best["speed-up"]}


def finding_of_machine(summary, machine):
    some = summary[summary["machine"] == machine]
    halves = ", ".join(f"{'no number of' if pd.isna(r['half at (ranks)']) else int(r['half at (ranks)'])} ranks "
                       f"({r['network']})" for _, r in some.iterrows())
    fastest = ", ".join(f"{r['fastest (ranks)']} ({r['network']}, {r['speed-up']:.3g} times as fast as one)"
                        for _, r in some.iterrows())
    return (f"{machine}: communication takes half of the time on {halves}. The fewest seconds are had on so many "
            f"ranks: {fastest}.")


def finding_of_checks(checks):
    more = checks[checks["ranks"] > 1]

    def text(some):
        ratio = some["predicted / measured"]
        return f"{ratio.min():.2f} to {ratio.max():.2f}" if len(some) else "(none)"

    shared = more["cores"] < more["ranks"]
    return (f"On the ranks that can be measured here the prediction is {text(more[~shared])} times the measured time "
            f"where each rank has a core, and {text(more[shared])} times where ranks share cores; the minimum of up to "
            f"{TURNS} renders each.")


def finding_of_others(share):
    if share <= QUIET:
        return f"While this was measured other programs had {100 * share:.1f} % of this host's processors."
    return (f"While this was measured other programs had {100 * share:.0f} % of this host's processors: ranks waited "
            "for one another, and times of several ranks say little. To be repeated when the host is quiet.")


def finding_of_network(ping):
    first, last = ping["messages"][0], ping["messages"][-1]
    return (f"A message between two ranks here ({ping['library']}) takes {1e6 * ping['alpha_s']:.2f} us and "
            f"{1e9 * ping['beta_s_per_byte']:.3f} ns a byte by the fit; one byte took {1e6 * first['seconds']:.2f} us, "
            f"and 4 MB went at {1e-9 * last['bytes'] / last['seconds']:.1f} GB/s.")


def tables_of(rows, checks, summary, networks, ping):
    alpha, beta = ping["alpha_s"], ping["beta_s_per_byte"]
    return [Table("ranks", "Where communication takes half, and the fewest seconds", summary),
            Table("ranks-here", "Predicted and measured on one core a rank", checks),
            Table("ranks-networks", "The networks", [
                {"network": name, "alpha (us)": 1e6 * a, "beta (ns a byte)": 1e9 * b, "source": source}
                for name, ((a, b), source) in networks.items()]),
            Table("ranks-messages", "Messages between two ranks here", [
                {"bytes": m["bytes"], "measured (us)": 1e6 * m["seconds"],
                 "fitted (us)": 1e6 * (alpha + beta * m["bytes"])} for m in ping["messages"]]),
            Table("ranks-all", "Parts of the time on each number of ranks", rows, on_page=False)]


def plots_of(rows, checks):
    for machine in ("ring", "torus"):
        some = rows[rows["machine"] == machine]
        measured = checks[checks["machine"] == machine]
        yield Plot(f"ranks-{machine}-networks", f"{machine}: time against ranks, by network", "ranks", "time (ms)",
                   series_by(some, "network", "ranks", "time (ms)") +
                   [Series("measured", measured["ranks"], measured["measured, best (ms)"], "points")], "xy")
        one = some[some["network"] == "10 GbE"]
        labels = {"compute": "compute", "host": "host", "exchange": "exchange",
                  "collect": "pixels to rank 0" if machine == "ring" else "status to all", "broadcast": "scene"}
        parts = [Series(label, *zip(*[(r, ms) for r, ms in zip(one["ranks"], one[f"{part} (ms)"]) if ms > 0]))
                 for part, label in labels.items()]
        yield Plot(f"ranks-{machine}", f"{machine} on ranks, by 10 GbE", "ranks", "time (ms)",
                   [Series("in all", one["ranks"], one["time (ms)"]), *parts], "xy")
