"""Common code of the studies of space division: renders on the torus or with a grid on one PE, and the figures of these renders."""
import math

import pandas as pd
import raya
from raya.lab.laboratory import MACHINES, mean_seconds, rays_of, tests_of, time_calls

CLOCK = ("modelled from counted events on T805 transputers at 25 MHz (data sheet of the IMS T805, SGS-Thomson 1996): 40 ns a "
         "cycle; links of 1.7 MB/s in one direction and 2.4 MB/s in both together; a message of w words costs the processor at "
         "either end 2 w + 19 cycles. Overlapped: the time of the busiest processor or link, as if it waited for nothing. Stepwise: "
         "in each superstep all nodes compute, then all links transfer, and each half takes the time of the busiest one. A real "
         "machine takes a time between the two. No time on this page is measured.")
UNLIMITED_MEMORY = 1 << 40  # bytes of a node's memory
BOUNCES = MACHINES["torus"]["bounces"]


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


def with_spheres(scene, change, name):
    """Returns the scene, renamed, with change([x, y, z, radius] as text), a text, instead of the numbers of each sphere."""
    lines = (f"s {change(line.split()[1:])}" if line.startswith("s ") else line for line in scene.nff.splitlines())
    return raya.parse("\n".join(lines) + "\n", name)


def figures_of(scene, result, voxels, time=None):
    """Returns the figures of a render by their names in tables, and `result` itself. On the torus the times are modelled. On one PE, `time` is the
    measured time (Timing)."""
    e, report = result.events, result.report
    rays, tests = rays_of(e), tests_of(e)
    copies = report["torus" if time is None else "accel"]["copies"]  # entries in the voxels' object lists, without the first one of each object
    figures = {"scene": scene.name, "objects": scene.objects, "divisions": math.prod(voxels), "A x B x C": sides_text(voxels), "rays": rays,
               "tests": tests, "steps": e["steps"], "primary": e["primary"], "tests a ray": tests / max(1, rays),
               "steps a ray": e["steps"] / max(1, rays), "copies": copies, "voxels of an object": 1 + copies / scene.objects, "result": result}
    if time is not None:
        return {**figures, "modelled (s)": 1e-3 * raya.t805_ms(e), "measured (ms)": 1e3 * time.minimum, "measured, median (ms)": 1e3 * time.median}
    torus, ms, root = report["torus"], report["modelled_ms"], result.root
    packets, root_ms = sum(kind["made"] for kind in torus["packets"].values()), max(root.values())
    return {**figures, **{f"{name} (ms)": ms[name] for name in ("overlapped", "stepwise", "compute", "messages", "links")},
            "asynchronous (ms)": ms.get("asynchronous", {}).get("finish", math.nan), "work (ms)": result.work_ms, "packets": packets,
            "returns": torus["returns"]["messages"], "rays discarded": torus["discarded"], "supersteps": torus["supersteps"], "hops": torus["hops"],
            "hops a packet": torus["hops"] / max(1, packets), "most packets in a queue": torus["queue_max"], "u": result.imbalance,
            "balance": result.efficiency, "busiest link (bytes)": torus["bytes_per_link"]["max"], "the root's processor (ms)": root["processor_ms"],
            "the root's busiest link (ms)": root["link_ms"], "the root (ms)": root_ms, "root / overlapped (%)": 100 * root_ms / ms["overlapped"]}


def run_cases(cases, run, columns):
    """Calls run(**case), which returns figures_of(), for each case. Returns a data frame with a row for each case: the arguments, `columns` of the
    figures, and all figures in column `run`."""
    return pd.DataFrame([{**case, **{column: one[column] for column in columns}, "run": one} for case in cases for one in [run(**case)]])


def run_on_torus(lab, scene, size, nodes, voxels, queue=None, **options):
    """Renders on the torus without a memory limit; returns figures_of(). raya repeats a render that deadlocks with longer queues."""
    return figures_of(scene, lab.render(scene, machine="torus", size=size, nodes=sides_text(nodes), voxels=sides_text(voxels), queue=queue,
                                        pe_memory=UNLIMITED_MEMORY, **options), voxels)


def run_in_one_pe(lab, scene, size, voxels, bounces=0, sampling="centres", runs=1):
    """Renders the scene in fp32 on one PE of machine grande with a grid; returns figures_of() with the times of at most `runs` samples."""
    options = dict(machine="grande", format="fp32", size=size, pes=1, offset=0, bounces=bounces, sampling=sampling,
                   accel=f"grid:{sides_text(voxels)}")
    counted = lab.render(scene, **options)  # also warms up the timed renders
    time = time_calls(lambda: mean_seconds(lambda: lab.render(scene, **options).device_s), runs, 1, warm=False)
    return figures_of(scene, counted, voxels, time)
