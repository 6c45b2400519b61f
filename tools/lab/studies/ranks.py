"""Renders on 1 to {ranks} ranks

Up to how many MPI ranks does a render become faster, and from which number upwards does communication take at least half of the time?

- Source: none of the papers. The study measures this host and extrapolates with a model.
- Ring: {scene} at {size} x {size} with the 3 x 3 filter, one PE per column. The offset is p = 16. If there are more ranks than columns, there is one
  PE per rank and p = round(sqrt(P)). Torus: {torus_scene} at {torus_size} x {torus_size} on 8 x 8 x 8 nodes, one voxel per node, queues of 1024
  packets.
- Each rank has one core of this machine's CPU, or its own device if the device is not a CPU. Three times of a render on one rank are measured:
  tracing on the device, all other kernels, and the rest, which is the work of the host program on rank 0.
- Ring on R ranks: tracing takes (measured time / R) (1 + u), where u is the load imbalance of the ranks by modelled cycles. The other kernels take
  measured time / R. Each rotation takes alpha + beta times the bytes of one PE's block. Rank 0 receives the pixels and loads of the ranks one after
  another. The scene is broadcast in log2 R rounds. alpha is the time per message (s), beta the time per byte (s).
- Torus on R ranks: each rank simulates a brick, a cuboid of nodes. In each superstep tracing takes the time of the rank with the most modelled
  cycles. The other kernels take time in proportion to the nodes of the largest brick. The exchange takes alpha per message and beta per byte of the
  rank that sends or receives most. All ranks receive the status of all nodes in log2 R rounds. One render counts supersteps, cycles and words over
  links.
- For more than 512 ranks the model assumes a torus with one node per rank. Supersteps and messages grow with its side, the cycles of a node shrink
  with the volume of its voxel, and its bytes with a face of the voxel. The host program on rank 0 processes more nodes.
- The model excludes device commands beyond those of one rank, collisions of messages, and waiting for a rank that is late for another reason.
- Networks: one fitted to the ping-pong of `raya ping`, two assumed, and one from the command line (`--network`). Measured times: `mpirun -n R raya
  render`, one thread per rank, for all R in turn after a warm-up, up to {turns} times each; no further render starts after {enough} s. The model is
  compared with the minimum.
- Scaling is measured in the same way. Strong: the same picture on more ranks. Weak: pixels (ring) or evenly spread objects (torus) in proportion to
  the ranks. Efficiency is the modelled cycles per second and core, by the minimum time, relative to one rank.
- Output: ranks.csv (number of ranks at which communication takes half of the time, and fastest number), ranks-here.csv (predicted and measured, ms),
  ranks-scaling.csv, ranks-networks.csv (alpha in us, beta in ns per byte), ranks-messages.csv (us), ranks-all.csv (parts of predicted times, ms).
"""
import json
import os
import resource
import tempfile

import numpy as np
import pandas as pd
import raya
from raya.lab import Comparison, Page, Plot, Series, Table, first_scene, series_by, study
from raya.lab.laboratory import format_for
from raya.lab.programs import missing_mpirun, render_on_ranks, run_on_ranks
from raya.lab.voxels import UNLIMITED_MEMORY, even_scene, near_cube, powers_of_two, sides_text

TURNS, SAMPLING_S, WEAK_SAMPLING_S = 3, 5, 2  # maximum renders of a case; seconds of renders of a case after which it gets no further render
MAX_OTHER_LOAD = 0.05  # fraction of the processor time used by other programs, above which measurements count as unreliable


# {name: ((alpha in s, beta in s/byte), source)}
NETWORKS = {"10 GbE": ((30e-6, 0.8e-9), "assumed: 10 Gbit/s of IEEE 802.3ae; 30 us per message, about that of TCP"),
            "InfiniBand HDR": ((1e-6, 0.04e-9), "assumed: 200 Gbit/s of a 4x port; 1 us per message: 0.6 us of the adapter, and MPI")}
MAX_RANKS = 65_536
SIDES, QUEUE = (8, 8, 8), 1024  # number of the torus's nodes along each axis; number of packets that a node's queue holds
PARTS = ("compute", "host", "exchange", "collect", "broadcast")  # parts of a render's time


def rounds(ranks):
    """Returns the number of rounds of a broadcast to all ranks."""
    return (ranks - 1).bit_length()


class RingModel:
    """Model of a ring with the 3 x 3 filter. The ring has as many PEs as image columns or ranks, whichever is more."""

    name, label = "ring", "trace"

    def __init__(self, lab, scene, file, size):
        costs = lab.costs(scene, size)
        self.arguments = [file, "--machine", "grande", "--accel", "none", "--antialias", "filter", "--format",
                          format_for(scene), "--size", str(size)]
        self.ranks = powers_of_two(min(MAX_RANKS, size * size))
        self.counts = []
        for ranks in self.ranks:
            pes = max(size, ranks)
            offset = (round(pes**0.5) if ranks > size else 16) % size
            loads = np.bincount(raya.ranks_of_pes(pes, ranks), raya.loads(costs.trace, pes=pes, offset=offset))
            self.counts.append({"pes": pes, "u": loads.max() / loads.mean() - 1,
                                "rotations": raya.rotations(size, size, pes=pes, offset=offset),
                                "block": 12 * raya.largest_share(size, size, pes=pes, offset=offset),
                                "image": 12 * size * size, "scene": 4 * costs.job_words})
        self.arrays = [f"{counts['pes']} PEs" for counts in self.counts]

    def weak(self, ranks):
        """Returns the arguments of a render with `ranks` times as many pixels (weak scaling)."""
        return [*self.arguments[:-1], str(round(int(self.arguments[-1]) * ranks**0.5))]

    def predict(self, i, one_rank, network, processors):
        """Returns {part: predicted seconds} for PARTS, on self.ranks[i] ranks. one_rank: measured seconds of one rank, by part; network: (alpha,
        beta)."""
        counts, ranks, (alpha, beta) = self.counts[i], self.ranks[i], network
        return {"compute": (one_rank["trace"] * (1 + counts["u"]) + one_rank["rest"]) / processors, "host": one_rank["host"],
                "exchange": (ranks > 1) * counts["rotations"] * (alpha + beta * counts["block"]),
                "collect": 2 * (ranks - 1) * alpha + beta * counts["image"] * (1 - 1 / ranks),
                "broadcast": rounds(ranks) * (alpha + beta * counts["scene"])}


class TorusModel:
    """Model of a torus of 8 x 8 x 8 nodes, whose counts come from one render. For more ranks than nodes, extrapolate_counts() computes the counts of
    larger tori."""

    name, label = "torus", "trace_voxel"

    def __init__(self, lab, scene, file, size):
        sides = sides_text(SIDES)
        self.arguments = [file, "--machine", "torus", "--nodes", sides, "--voxels", sides, "--queue", str(QUEUE),
                          "--size", str(size)]
        self.ranks = powers_of_two(MAX_RANKS)
        result = lab.render(scene, machine="torus", size=size, nodes=sides, voxels=sides, queue=QUEUE, packets=True,
                            pe_memory=UNLIMITED_MEMORY)
        nodes = int(np.prod(SIDES))
        status, words = 4 * raya.STATUS_WORDS * nodes, 4 * result.copied_words
        counted = {ranks: {**count_on_bricks(result, ranks), "status": status, "scene": words, "host": 1}
                   for ranks in powers_of_two(nodes)}
        self.counts = [counted[r] if r <= nodes else extrapolate_counts(counted[nodes], r // nodes) for r in self.ranks]
        self.arrays = [f"{sides} nodes" if r <= nodes else f"{sides_text(near_cube(r))} nodes, assumed"
                       for r in self.ranks]
        self.objects = scene.objects

    def weak(self, ranks):
        """Returns the arguments of a render with `ranks` times as many objects, spread evenly (weak scaling)."""
        file = os.path.join(os.path.dirname(self.arguments[0]), f"even-{ranks}.nff")
        even_scene(self.objects * ranks).save(file)
        return [file, *self.arguments[1:]]

    def predict(self, i, one_rank, network, processors):
        counts, ranks, (alpha, beta) = self.counts[i], self.ranks[i], network
        busiest_rank_s = one_rank["trace"] * counts["cycles"] / counts["total_cycles"] + one_rank["rest"] * counts["max_nodes"] / counts["nodes"]
        remote_fraction = 1 - 1 / ranks
        return {"compute": busiest_rank_s * ranks / processors, "host": one_rank["host"] * counts["host"],
                "exchange": (ranks > 1) * (counts["messages"] * alpha + counts["bytes"] * beta),
                "collect": counts["supersteps"] * (rounds(ranks) * alpha + beta * counts["status"] * remote_fraction),
                "broadcast": (ranks - 1) * alpha + beta * counts["scene"] * remote_fraction}


def count_on_bricks(result, ranks):
    """Returns the counts of a torus render on ranks: cycles, messages and bytes, each as the sum over the supersteps of the maximum over the ranks. A
    rank models a brick, a cuboid of nodes. In a superstep, all packets from a brick to another rank in one direction form one message."""
    rank_of, ends = raya.ranks_of_nodes(SIDES, ranks), raya.link_ends(SIDES)
    cycles, words = result.step_cycles, result.step_link_words
    by_rank = np.stack([cycles[:, rank_of == rank].sum(1) for rank in range(ranks)], 1)
    source, target = np.repeat(rank_of[:, None], 6, 1), rank_of[ends]
    node, direction = np.nonzero(source != target)
    face = (source[node, direction].astype(np.int64) * ranks + target[node, direction]) * 6 + direction
    faces, index = np.unique(face, return_inverse=True)
    sums, maxima = np.zeros((len(words), len(faces))), {}  # [superstep, face]
    np.add.at(sums.T, index, 4 * words[:, node, direction].T.astype(float))
    for name, values in (("messages", (sums > 0).astype(float)), ("bytes", sums)):
        sent_received = [np.stack([values[:, end == rank].sum(1) for rank in range(ranks)], 1)
                         for end in (faces // 6 // ranks, faces // 6 % ranks)]
        maxima[name] = np.maximum(*sent_received).max(1).sum()
    return {"nodes": len(rank_of), "max_nodes": np.bincount(rank_of).max(), "supersteps": len(cycles),
            "cycles": float(by_rank.max(1).sum()), "total_cycles": float(cycles.sum()), **maxima}


def extrapolate_counts(counts, times):
    """Extrapolates the counts to a torus with `times` as many nodes and one rank per node: every node is divided into `times` smaller nodes."""
    side = times ** (1 / 3)
    change = {"nodes": times, "supersteps": side, "cycles": 1 / times, "messages": side, "bytes": 1 / side**2,
              "status": times, "host": side * times}
    return {name: value * change.get(name, 1) for name, value in counts.items()}


def parts_of(machine, report):
    """Returns {part: measured seconds} of a render on one rank: trace; rest (all other device commands); host (the rest of the render)."""
    commands = report["measured"]["commands"]
    device = 1e-9 * sum(c["total_ns"] for c in commands)
    trace = 1e-9 * sum(c["total_ns"] for c in commands if c["label"] == machine.label)
    return {"trace": trace, "rest": device - trace, "host": max(0.0, report["measured"]["render_s"] - device)}


def measure(arguments_by_ranks, device, sampling_s=SAMPLING_S):
    """Renders on ranks. arguments_by_ranks: {ranks: arguments of a render}. Returns {ranks: (seconds of each render, report of the fastest render)}.
    Raises InputError if the ranks use another device than `device`."""
    first = render_on_ranks(1, arguments_by_ranks[1])  # builds the kernels
    if first["device"]["name"] != device:
        raise raya.InputError(f"study ranks: --device {device}: the ranks use their default device, {first['device']['name']}; omit --device, "
                              "or name the device in RAYA_DEVICE")
    trials = {ranks: ([], None) for ranks in arguments_by_ranks}
    for _ in range(TURNS):
        for ranks, (seconds, best) in trials.items():
            if sum(seconds) < sampling_s:
                report = render_on_ranks(ranks, arguments_by_ranks[ranks])
                s = report["measured"]["render_s"]
                trials[ranks] = (seconds + [s], report if not seconds or s < min(seconds) else best)
    return trials


def scaling_of(machine, scaling, trials, available_cores):
    """Yields rows with the measured efficiency: modelled cycles per second and core, relative to one rank."""
    def rate(ranks):
        seconds, report = trials[ranks]
        return sum(report["load"]["per_pe"]) / min(seconds) / cores_of(report, ranks, available_cores)

    one = trials[1][1]
    for ranks, (seconds, report) in trials.items():
        image = report["image"]
        if scaling == "strong" and image["hash"] != one["image"]["hash"]:
            raise raya.DeviceError(f"{ranks} ranks and one rank give different images: {image['hash']} and {one['image']['hash']}")
        yield {"machine": machine.name, "scaling": scaling, "ranks": ranks, "cores": cores_of(report, ranks, available_cores),
               "size": f"{image['width']}x{image['height']}", "work (cycles)": sum(report["load"]["per_pe"]),
               "measured, best (ms)": 1e3 * min(seconds), "median (ms)": 1e3 * float(np.median(seconds)),
               "measured efficiency": rate(ranks) / rate(1)}


def cores_of(report, ranks, available_cores):
    """Returns the number of cores that the ranks have together. A device that is not a CPU counts as one core."""
    return available_cores[ranks] if report["device"]["platform"] == "Portable Computing Language" else ranks


def processor_time():
    """Returns (busy seconds of all processors, total seconds of all processors, processor seconds of this process and its finished children)"""
    with open("/proc/stat", encoding="utf-8") as file:
        ticks = [int(word) / os.sysconf("SC_CLK_TCK") for word in file.readline().split()[1:9]]
    own = sum(sum(resource.getrusage(who)[:2]) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(ticks) - ticks[3] - ticks[4], sum(ticks), own


@study("ranks", one_scene=True, measures=True, missing=missing_mpirun)
def ranks(lab, scenes):
    on_ring, on_torus = first_scene(scenes), scenes[0] if scenes else even_scene(8320)
    size = lab.size(512)
    with tempfile.TemporaryDirectory(prefix="raya-study-") as folder:
        files = [os.path.join(folder, name) for name in ("ring.nff", "torus.nff")]
        for scene, file in zip((on_ring, on_torus), files):
            scene.save(file)
        before = processor_time()
        ping = json.loads(run_on_ranks(2, ["ping"]))
        available_cores = {ranks: min(ranks, os.cpu_count()) for ranks in powers_of_two(min(max(2 * os.cpu_count(), 4), 16))}
        machines = [kind(lab, scene, file, size) for kind, scene, file in
                    zip((RingModel, TorusModel), (on_ring, on_torus), files)]
        device = lab.session.device["name"]
        trials = [measure(dict.fromkeys(available_cores, machine.arguments), device) for machine in machines]
        weak = [measure({ranks: machine.weak(ranks) for ranks in available_cores}, device, WEAK_SAMPLING_S) for machine in machines]
        busy, whole, own = (b - a for a, b in zip(before, processor_time()))
    fitted = (ping["alpha_s"], ping["beta_s_per_byte"]), f"fitted to the ping-pong, {ping['library']}"
    networks = {"this host": fitted, **NETWORKS, **({"given": (lab.network, "--network")} if lab.network else {})}
    one_rank_parts = [parts_of(machine, trial[1][1]) for machine, trial in zip(machines, trials)]
    rows = pd.DataFrame([row for machine, one in zip(machines, one_rank_parts) for row in rows_of(machine, one, networks)])
    checks = pd.DataFrame([row for some in zip(machines, one_rank_parts, trials)
                           for row in checks_of(*some, networks["this host"][0], available_cores)])
    scaling = pd.DataFrame([row for machine, *both in zip(machines, trials, weak)
                            for name, some in zip(("strong", "weak"), both)
                            for row in scaling_of(machine, name, some, available_cores)])
    summary = []
    for (machine, network), group in rows.groupby(["machine", "network"], sort=False):
        half, best = group["ranks"][group["communication (%)"] >= 50], group.loc[group["time (ms)"].idxmin()]
        summary.append({"machine": machine, "network": network, "half at (ranks)": half.iloc[0] if len(half) else None,
                        "fastest (ranks)": best["ranks"], "array": best["array"], "time (ms)": best["time (ms)"], "speed-up": best["speed-up"]})
    summary = pd.DataFrame(summary)
    other_load = min(max((busy - own) / whole, 0), 1) if whole > 0 else 0
    return Page({"scene": on_ring.name, "torus_scene": on_torus.name, "size": size, "torus_size": size,
                 "ranks": int(rows["ranks"].iloc[-1]), "turns": TURNS, "enough": SAMPLING_S, "alpha_s": ping["alpha_s"],
                 "beta_s_per_byte": ping["beta_s_per_byte"]},
                findings_of_model(summary, checks) + findings_of_measures(scaling, other_load, ping),
                [Comparison(f"{c['machine']}, {c['ranks']} ranks: predicted / measured", "", None,
                            c["predicted / measured"], c["remark"])
                 for _, c in checks[checks["ranks"] > 1].iterrows()],
                tables=[
                    Table("ranks", "Number of ranks at which communication takes half of the time, and fastest number of ranks", summary),
                    Table("ranks-here", "Predicted and measured times on this host", checks),
                    Table("ranks-scaling", "Strong and weak scaling, measured on this host", scaling),
                    Table("ranks-networks", "Networks of the model", [
                        {"network": name, "alpha (us)": 1e6 * a, "beta (ns a byte)": 1e9 * b, "source": source}
                        for name, ((a, b), source) in networks.items()]),
                    Table("ranks-messages", "Times of messages between two ranks on this host", [
                        {"bytes": m["bytes"], "measured (us)": 1e6 * m["seconds"],
                         "fitted (us)": 1e6 * (ping["alpha_s"] + ping["beta_s_per_byte"] * m["bytes"])} for m in ping["messages"]]),
                    Table("ranks-all", "Parts of the predicted time on each number of ranks", rows, on_page=False)],
                plots=[*plots_of(rows, checks)],
                clock="measured on this host where stated; all other times are predicted from the measured times of one rank. The measured time of "
                "a render starts after its kernels are built and the scene is broadcast. Predicted total times include the broadcast.")


def rows_of(machine, one_rank, networks):
    """Yields a row with the predicted times for each network and number of ranks. one_rank: measured seconds of one rank, by part."""
    one_s = sum(machine.predict(0, one_rank, (0, 0), 1).values())
    for name, (network, _) in networks.items():
        for i, count in enumerate(machine.ranks):
            parts = machine.predict(i, one_rank, network, count)
            total = sum(parts.values())
            yield {"machine": machine.name, "network": name, "ranks": count, "array": machine.arrays[i],
                   **{f"{part} (ms)": 1e3 * seconds for part, seconds in parts.items()}, "time (ms)": 1e3 * total,
                   "speed-up": one_s / total, "communication (%)": 100 * sum(parts[p] for p in PARTS[2:]) / total}


def checks_of(machine, one_rank, trial, network, available_cores):
    """Yields a row with predicted and measured times for each number of ranks that was measured."""
    for i, (count, (seconds, _)) in enumerate(trial.items()):
        cores = cores_of(trial[1][1], count, available_cores)
        parts = machine.predict(i, one_rank, network, cores)
        predicted = 1e3 * (sum(parts.values()) - parts["broadcast"])
        yield {"machine": machine.name, "ranks": count, "cores": cores, "predicted (ms)": predicted,
               "measured, best (ms)": 1e3 * min(seconds), "median (ms)": 1e3 * float(np.median(seconds)),
               "largest (ms)": 1e3 * max(seconds), "predicted / measured": predicted / min(seconds) / 1e3,
               "remark": "ranks share cores" if cores < count else "the model uses this measurement" if count == 1 else ""}


def findings_of_model(summary, checks):
    findings, more = [], checks[checks["ranks"] > 1]
    for machine, group in summary.groupby("machine", sort=False):
        halves = ", ".join(f"{'no number of' if pd.isna(r['half at (ranks)']) else int(r['half at (ranks)'])} ranks "
                           f"({r['network']})" for _, r in group.iterrows())
        fastest = ", ".join(f"{r['fastest (ranks)']} ({r['network']}, {r['speed-up']:.3g} times as fast as one)"
                            for _, r in group.iterrows())
        findings.append(f"{machine}: communication first takes at least half of the time on {halves}. The fastest numbers of ranks are {fastest}.")

    def text(group):
        ratio = group["predicted / measured"]
        return f"{ratio.min():.2f} to {ratio.max():.2f}" if len(group) else "(none)"

    shared = more["cores"] < more["ranks"]
    return findings + [
        f"On this host, predicted / measured time is {text(more[~shared])} for numbers of ranks with a core for each rank, and "
        f"{text(more[shared])} for those at which ranks share cores. The measured time is the minimum of up to {TURNS} renders."]


def findings_of_measures(scaling, other_load, ping):
    """other_load: fraction of the host's processor time that other programs used."""
    kinds = [f"{machine}, {name}: " + ", ".join(f"{r['measured efficiency']:.2f} on {r['ranks']}"
                                                for _, r in group[group["ranks"] > 1].iterrows())
             for (machine, name), group in scaling.groupby(["machine", "scaling"], sort=False)]
    others = f"During the measurements other programs used {100 * other_load:.1f} % of this host's processor time."
    if other_load > MAX_OTHER_LOAD:
        others += " Ranks had to wait for each other, so the times of several ranks are unreliable. Repeat this study when the host is idle."
    first, last = ping["messages"][0], ping["messages"][-1]
    return [f"Measured efficiency relative to one rank (on the given number of ranks): {'; '.join(kinds)}.", others,
            f"Fitted: a message between two ranks on this host ({ping['library']}) takes {1e6 * ping['alpha_s']:.2f} us plus "
            f"{1e9 * ping['beta_s_per_byte']:.3f} ns per byte. Measured: a message of one byte takes {1e6 * first['seconds']:.2f} us; one of 4 MB "
            f"has a rate of {1e-9 * last['bytes'] / last['seconds']:.1f} GB/s."]


def plots_of(rows, checks):
    for machine in ("ring", "torus"):
        machine_rows = rows[rows["machine"] == machine]
        measured = checks[checks["machine"] == machine]
        yield Plot(f"ranks-{machine}-networks", f"{machine}: time of a render, by network", "number of ranks", "time (ms)",
                   series_by(machine_rows, "network", "ranks", "time (ms)") +
                   [Series("measured, this host", measured["ranks"], measured["measured, best (ms)"], "points")], "xy")
        on_10_gbe = machine_rows[machine_rows["network"] == "10 GbE"]
        labels = {"compute": "kernels", "host": "host program", "exchange": "exchange",
                  "collect": "pixels to rank 0" if machine == "ring" else "status to all ranks", "broadcast": "broadcast of the scene"}
        parts = [Series(label, *zip(*[(r, ms) for r, ms in zip(on_10_gbe["ranks"], on_10_gbe[f"{part} (ms)"]) if ms > 0]))
                 for part, label in labels.items()]
        yield Plot(f"ranks-{machine}", f"{machine}: parts of the time with 10 GbE", "number of ranks", "predicted time (ms)",
                   [Series("total", on_10_gbe["ranks"], on_10_gbe["time (ms)"]), *parts], "xy")
