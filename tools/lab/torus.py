"""What the studies of the torus machine share: renders, and the figures that they take from them."""
import math
from dataclasses import dataclass

import raya

CLOCK = ("modelled, of T805 transputers at 25 MHz (data sheet of the IMS T805, SGS-Thomson 1996), from what was counted: "
         "40 ns a cycle, links of 1.7 MB/s one way and 2.4 MB/s both ways, 2 w + 19 cycles of the processor at either end "
         "of a message of w words. Overlapped: the busiest processor or link, no one ever waiting for another; stepwise: "
         "every superstep waits for its busiest node, then for its busiest link. A real machine lies between the two. "
         "Nothing on this page is measured.")
NO_LIMIT = 1 << 40  # bytes of a node's memory
BOUNCES = next(m for m in raya.machines() if m["name"] == "torus")["bounces"]


def sides_text(sides):
    return "x".join(map(str, sides))


def near_cube(count):
    """The sides of 2^n nodes or voxels that are most alike, the longer ones first: 1x1x1, 2x1x1, 2x2x1, 2x2x2, ..."""
    bits = count.bit_length() - 1
    return 1 << (bits + 2) // 3, 1 << (bits + 1) // 3, 1 << bits // 3


def even_scene(count):
    """Spheres spread evenly over 4 x 4 x 4 voxels."""
    return raya.generate.uniform(count, (4, 4, 4)).renamed(f"even-{count}")


def balls_scene(level):
    return raya.generate.balls(level).renamed(f"balls-{level}")


@dataclass
class TorusRun:
    """Figures of one render; times are modelled."""

    result: raya.Result
    report: dict

    def __post_init__(self):
        e, m, t = self.result.events, self.report["modelled_ms"], self.report["torus"]
        self.nodes = math.prod(t["nodes"])
        self.events = e
        self.rays = e["primary"] + e["reflected"] + e["refracted"] + e["shadow"]
        self.tests = sum(e[f"{kind}_tests"] for kind in ("sphere", "plane", "polygon", "cone"))
        self.packets = sum(kind["made"] for kind in t["packets"].values())
        self.returns, self.discarded = t["returns"]["messages"], t["discarded"]
        self.overlapped_ms, self.stepwise_ms, self.compute_ms = m["overlapped"], m["stepwise"], m["compute"]
        self.messages_ms, self.links_ms = m["messages"], m["links"]
        self.asynchronous_ms = m.get("asynchronous", {}).get("finish", math.nan)
        self.supersteps, self.copies, self.hops = t["supersteps"], t["copies"], t["hops"]
        self.imbalance, self.balance = self.result.imbalance, self.result.efficiency
        self.tests_per_ray, self.steps_per_ray = self.tests / max(1, self.rays), e["steps"] / max(1, self.rays)
        self.hops_per_packet = t["hops"] / max(1, self.packets)
        self.busiest_link_bytes, self.queue_max = t["bytes_per_link"]["max"], t["queue_max"]
        root = self.result.root
        self.root_processor_ms, self.root_link_ms = root["processor_ms"], root["link_ms"]
        self.root_ms = max(root.values())
        self.work_ms = self.result.work_ms


def run_on_torus(lab, scene, size, nodes, voxels, queue=None, **options):
    """A render without a limit of memory. Where the queue is too short for the machine to come to an end, twice its
    length is tried, and so on up to the default."""
    while True:
        try:
            result = lab.render(scene, machine="torus", size=size, nodes=sides_text(nodes), voxels=sides_text(voxels),
                                queue=queue, pe_memory=NO_LIMIT, **options)
            return TorusRun(result, result.report)
        except raya.Deadlock:
            if queue is None or queue >= 8192:
                raise
            queue *= 2
