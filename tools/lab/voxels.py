"""What the studies of divided space share: renders on the torus machine, or in one PE, and the figures of each."""
import math

import pandas as pd
import raya
from raya.lab.laboratory import measured, rays_of, sampled, tests_of

CLOCK = ("modelled, of T805 transputers at 25 MHz (data sheet of the IMS T805, SGS-Thomson 1996), from what was "
         "counted: 40 ns a cycle, links of 1.7 MB/s one way and 2.4 MB/s both ways, 2 w + 19 cycles of the processor "
         "at either end of a message of w words. Overlapped: the busiest processor or link, no one ever waiting for "
         "another; stepwise: every superstep waits for its busiest node, then for its busiest link. A real machine "
         "lies between the two. Nothing on this page is measured.")
NO_LIMIT = 1 << 40  # bytes of a node's memory
BOUNCES = next(m for m in raya.machines() if m["name"] == "torus")["bounces"]


def sides_text(sides):
    return "x".join(map(str, sides))


def near_cube(count):
    """The sides of 2^n nodes or voxels that are most alike, the longer ones first: 1x1x1, 2x1x1, 2x2x1, 2x2x2, ..."""
    bits = count.bit_length() - 1
    return 1 << (bits + 2) // 3, 1 << (bits + 1) // 3, 1 << bits // 3


def powers(most):
    """1, 2, 4, ... `most`."""
    return [1 << k for k in range(most.bit_length())]


def even_scene(count):
    """Spheres spread evenly over 4 x 4 x 4 voxels."""
    return raya.generate.uniform(count, (4, 4, 4)).renamed(f"even-{count}")


def balls_scene(level):
    return raya.generate.balls(level).renamed(f"balls-{level}")


# Columns of the studies' tables, and what they show of a run, where it has another name.
MEMBERS = {
    "divisions": "voxels", "A x B x C": "sides", "tests a ray": "tests_per_ray", "steps a ray": "steps_per_ray",
    "modelled (s)": "modelled_s", "measured (ms)": "measured_ms", "measured, median (ms)": "median_ms",
    "voxels of an object": "voxels_of_object", "overlapped (ms)": "overlapped_ms", "stepwise (ms)": "stepwise_ms",
    "the root's processor (ms)": "root_processor_ms", "the root's busiest link (ms)": "root_link_ms",
    "root / overlapped (%)": "root_share", "busiest link (bytes)": "busiest_link_bytes", "u": "imbalance",
    "rays thrown away": "discarded", "hops a packet": "hops_per_packet", "most packets in a queue": "queue_max"}


class Run:
    """Figures of one render. Times of the torus are modelled; those of one PE, `time`, are measured as well."""

    def __init__(self, scene, result, voxels, time=None):
        e, report = result.events, result.report
        self.scene, self.objects, self.result, self.events = scene.name, scene.objects, result, e
        self.voxels, self.sides = math.prod(voxels), sides_text(voxels)
        self.rays, self.tests, self.steps, self.primary = rays_of(e), tests_of(e), e["steps"], e["primary"]
        self.tests_per_ray, self.steps_per_ray = self.tests / max(1, self.rays), self.steps / max(1, self.rays)
        # Entries of the voxels' lists beyond each object's first.
        self.copies = report["torus" if time is None else "accel"]["copies"]
        self.voxels_of_object = 1 + self.copies / self.objects
        if time is not None:
            self.modelled_s = 1e-3 * raya.t805_ms(e)
            self.measured_ms, self.median_ms = 1e3 * time.least, 1e3 * time.median
            return
        torus, modelled_ms = report["torus"], report["modelled_ms"]
        self.packets = sum(kind["made"] for kind in torus["packets"].values())
        self.returns, self.discarded = torus["returns"]["messages"], torus["discarded"]
        for name in ("overlapped", "stepwise", "compute", "messages", "links"):
            setattr(self, f"{name}_ms", modelled_ms[name])
        self.asynchronous_ms = modelled_ms.get("asynchronous", {}).get("finish", math.nan)
        self.supersteps, self.hops, self.queue_max = torus["supersteps"], torus["hops"], torus["queue_max"]
        self.imbalance, self.balance, self.work_ms = result.imbalance, result.efficiency, result.work_ms
        self.hops_per_packet = self.hops / max(1, self.packets)
        self.busiest_link_bytes = torus["bytes_per_link"]["max"]
        self.root_processor_ms, self.root_link_ms = result.root["processor_ms"], result.root["link_ms"]
        self.root_ms = max(result.root.values())
        self.root_share = 100 * self.root_ms / self.overlapped_ms

    def row(self, columns):
        return {column: getattr(self, MEMBERS.get(column, column)) for column in columns}


def swept(cases, run, columns):
    """A row of each case, a dict of what is varied: run(**case) in those columns, and the run itself as the last."""
    return pd.DataFrame([{**case, **one.row(columns), "run": one} for case in cases for one in [run(**case)]])


def run_on_torus(lab, scene, size, nodes, voxels, queue=None, **options):
    """A render without a limit of memory. Where the queue is too short for the machine to come to an end, twice its
    length is tried, and so on up to the default."""
    while True:
        try:
            result = lab.render(scene, machine="torus", size=size, nodes=sides_text(nodes), voxels=sides_text(voxels),
                                queue=queue, pe_memory=NO_LIMIT, **options)
            return Run(scene, result, voxels)
        except raya.Deadlock:
            if queue is None or queue >= 8192:
                raise
            queue *= 2


def run_in_one_pe(lab, scene, size, voxels, bounces=0, sampling="centres", runs=1):
    """The scene in fp32 on one PE of grande, every ray walking through the grid; `runs` samples are timed."""
    options = dict(machine="grande", format="fp32", size=size, pes=1, offset=0, bounces=bounces, sampling=sampling,
                   accel=f"grid:{sides_text(voxels)}")
    counted = lab.render(scene, **options)  # a warm-up for those that are timed
    time = measured(lambda: sampled(lambda: lab.render(scene, **options).device_s), runs, 1, warm=False)
    return Run(scene, counted, voxels, time)
