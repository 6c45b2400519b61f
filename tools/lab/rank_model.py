"""Predicts render times on MPI ranks from the measured times of one rank, the counts of a render, and two constants of the network: alpha (seconds
per message) and beta (seconds per byte)."""
import os

import numpy as np
import raya
from raya.lab.laboratory import format_for
from raya.lab.voxels import UNLIMITED_MEMORY, even_scene, near_cube, powers_of_two, sides_text

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
        parts = dict.fromkeys(PARTS, 0.0)
        parts.update(compute=(one_rank["trace"] * (1 + counts["u"]) + one_rank["rest"]) / processors, host=one_rank["host"])
        if ranks > 1:
            parts["exchange"] = counts["rotations"] * (alpha + beta * counts["block"])
            parts["collect"] = 2 * (ranks - 1) * alpha + beta * counts["image"] * (1 - 1 / ranks)
            parts["broadcast"] = rounds(ranks) * (alpha + beta * counts["scene"])
        return parts


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
        parts = dict.fromkeys(PARTS, 0.0)
        parts.update(compute=busiest_rank_s * ranks / processors, host=one_rank["host"] * counts["host"])
        if ranks > 1:
            remote_fraction = 1 - 1 / ranks
            parts["exchange"] = counts["messages"] * alpha + counts["bytes"] * beta
            parts["collect"] = counts["supersteps"] * (rounds(ranks) * alpha + beta * counts["status"] * remote_fraction)
            parts["broadcast"] = (ranks - 1) * alpha + beta * counts["scene"] * remote_fraction
        return parts


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
