"""Common code of the studies of space division: renders on the torus or with a grid on one PE, and the figures of these renders."""
import math

import pandas as pd
import raya
from raya.lab.laboratory import mean_seconds, rays_of, tests_of, time_calls

CLOCK = ("modelled from counted events on T805 transputers at 25 MHz (data sheet of the IMS T805, SGS-Thomson 1996): 40 ns a "
         "cycle; links of 1.7 MB/s in one direction and 2.4 MB/s in both together; a message of w words costs the processor at "
         "either end 2 w + 19 cycles. Overlapped: the time of the busiest processor or link, as if it waited for nothing. Stepwise: "
         "in each superstep all nodes compute, then all links transfer, and each half takes the time of the busiest one. A real "
         "machine takes a time between the two. No time on this page is measured.")
UNLIMITED_MEMORY = 1 << 40  # bytes of a node's memory
BOUNCES = next(m for m in raya.machines() if m["name"] == "torus")["bounces"]


def sides_text(sides):
    return "x".join(map(str, sides))


def near_cube(count):
    """Returns the sides of the cuboid of 2^n nodes or voxels that is nearest to a cube, longer sides first: 1x1x1, 2x1x1, 2x2x1, 2x2x2, ..."""
    bits = count.bit_length() - 1
    return 1 << (bits + 2) // 3, 1 << (bits + 1) // 3, 1 << bits // 3


def powers_of_two(maximum):
    """Returns [1, 2, 4, ...]: the powers of two up to `maximum`."""
    return [1 << k for k in range(maximum.bit_length())]


def even_scene(count):
    """Returns a scene of `count` spheres, spread evenly over 4 x 4 x 4 voxels."""
    return raya.generate.uniform(count, (4, 4, 4)).renamed(f"even-{count}")


def balls_scene(level):
    return raya.generate.balls(level).renamed(f"balls-{level}")


# {column of a table: member of Run} for columns whose name differs from the member's.
MEMBERS = {
    "divisions": "voxels", "A x B x C": "sides", "tests a ray": "tests_per_ray", "steps a ray": "steps_per_ray",
    "modelled (s)": "modelled_s", "measured (ms)": "measured_ms", "measured, median (ms)": "median_ms",
    "voxels of an object": "voxels_of_object", "overlapped (ms)": "overlapped_ms", "stepwise (ms)": "stepwise_ms",
    "asynchronous (ms)": "asynchronous_ms",
    "the root's processor (ms)": "root_processor_ms", "the root's busiest link (ms)": "root_link_ms",
    "root / overlapped (%)": "root_share", "busiest link (bytes)": "busiest_link_bytes", "u": "imbalance",
    "rays discarded": "discarded", "hops a packet": "hops_per_packet", "most packets in a queue": "queue_max"}


class Run:
    """Figures of one render. On the torus its times are modelled, and `time` is None. On one PE, `time` is the measured time (Timing)."""

    def __init__(self, scene, result, voxels, time=None):
        e, report = result.events, result.report
        self.scene, self.objects, self.result, self.events = scene.name, scene.objects, result, e
        self.voxels, self.sides = math.prod(voxels), sides_text(voxels)
        self.rays, self.tests, self.steps, self.primary = rays_of(e), tests_of(e), e["steps"], e["primary"]
        self.tests_per_ray, self.steps_per_ray = self.tests / max(1, self.rays), self.steps / max(1, self.rays)
        # Number of entries in the voxels' object lists, without the first entry of each object.
        self.copies = report["torus" if time is None else "accel"]["copies"]
        self.voxels_of_object = 1 + self.copies / self.objects
        if time is not None:
            self.modelled_s = 1e-3 * raya.t805_ms(e)
            self.measured_ms, self.median_ms = 1e3 * time.minimum, 1e3 * time.median
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


def run_cases(cases, run, columns):
    """Calls run(**case), which returns a Run, for each case. Returns a data frame with a row for each case: the arguments, `columns` of the Run, and
    the Run itself in column `run`."""
    return pd.DataFrame([{**case, **result.row(columns), "run": result} for case in cases for result in [run(**case)]])


def run_on_torus(lab, scene, size, nodes, voxels, queue=None, **options):
    """Renders on the torus without a memory limit; returns a Run. raya repeats a render that deadlocks with longer queues."""
    return Run(scene, lab.render(scene, machine="torus", size=size, nodes=sides_text(nodes), voxels=sides_text(voxels), queue=queue,
                                 pe_memory=UNLIMITED_MEMORY, **options), voxels)


def run_in_one_pe(lab, scene, size, voxels, bounces=0, sampling="centres", runs=1):
    """Renders the scene in fp32 on one PE of machine grande with a grid; returns a Run with the times of at most `runs` samples."""
    options = dict(machine="grande", format="fp32", size=size, pes=1, offset=0, bounces=bounces, sampling=sampling,
                   accel=f"grid:{sides_text(voxels)}")
    counted = lab.render(scene, **options)  # also warms up the timed renders
    time = time_calls(lambda: mean_seconds(lambda: lab.render(scene, **options).device_s), runs, 1, warm=False)
    return Run(scene, counted, voxels, time)
