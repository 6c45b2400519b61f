"""Primary rays made by the root or by all nodes

From which number of nodes upwards is the root the bottleneck?

- Source: Yoshitani & Yamazaki, about 1995: the root (the node that is connected to the host) makes and sends all primary rays.
- Scene {scene}, {size} x {size} pixels, on 3-D tori of 1, 2, 4, ... {nodes} nodes with one voxel per node, in fp32.
- Method root, as in Yoshitani & Yamazaki: the root makes all primary rays, one after another, and sends each to the node where it enters the
  scene's bounding box. Method all: every node makes the rays that enter at its voxel. A node also makes rays that enter elsewhere; it discards
  them, but the model charges their time. In both methods a ray packet has 16 words, and each contribution of a ray to its pixel is a packet (a
  return).
- The root's time is that of its processor (computing and messages) or of its busiest link, whichever is longer. It receives all returns.
- A single node is its own root and has the whole scene in one voxel. More nodes have a finer grid, so speed-ups can exceed the number of nodes.
- Output: inject.csv has a row for each number of nodes and method: supersteps, modelled times (ms), the root's time in % of the overlapped time,
  bytes over the busiest link, and numbers of packets, rays and hops.
"""
from raya.lab import Page, Plot, Series, Table, first_from, series_by, study
from raya.lab.voxels import BOUNCES, CLOCK, even_scene, near_cube, powers_of_two, run_cases, run_on_torus

MAX_NODES, DIFFERENCE_RATIO = 512, 1.1  # maximum number of nodes; ratio above which the times of the two methods count as different
CASES = [{"nodes": nodes, "inject": method} for nodes in powers_of_two(MAX_NODES) for method in ("root", "all")]
COLUMNS = ("supersteps", "overlapped (ms)", "stepwise (ms)", "the root's processor (ms)",
           "the root's busiest link (ms)", "root / overlapped (%)", "busiest link (bytes)", "packets",
           "rays discarded", "hops a packet", "most packets in a queue", "primary")


@study("inject", one_scene=True)
def inject(lab, scenes):
    scene, size = scenes[0] if scenes else even_scene(8320), lab.size(64)
    rows = run_cases(CASES, lambda nodes, inject: run_on_torus(lab, scene, size, near_cube(nodes), near_cube(nodes),
                                                           inject=inject), COLUMNS)
    root, all_nodes = (rows[rows["inject"] == method].reset_index() for method in ("root", "all"))
    a, b = (rows.loc[rows["overlapped (ms)"].idxmin()] for rows in (root, all_nodes))
    one, last, all_last = all_nodes["overlapped (ms)"][0], root.iloc[-1], all_nodes.iloc[-1]
    ratio = root["overlapped (ms)"] / all_nodes["overlapped (ms)"]
    different = ratio[ratio > DIFFERENCE_RATIO]
    first, where, more = ("first takes more than 1.1 times", f" on {all_nodes['nodes'][different.index[0]]} nodes",
                          f"{different.iloc[0]:.2f} times; ") if len(different) else ("never takes more than 1.1 times", "", "")
    findings = [f"The root determines the overlapped time {bound_text(root)} if it makes all primary rays, and {bound_text(all_nodes)} if all nodes "
                "make them.",
                f"With method root the fastest machine has {a['nodes']} nodes: it takes {a['overlapped (ms)']:.0f} ms overlapped and is "
                f"{one / a['overlapped (ms)']:.1f} times as fast as one node. With method all the fastest machine has {b['nodes']} nodes: it takes "
                f"{b['overlapped (ms)']:.0f} ms and is {one / b['overlapped (ms)']:.1f} times as fast as one node.",
                f"Overlapped, method root {first} as long as method all{where}: {more}on {all_last['nodes']} nodes the time with method root is "
                f"{ratio.iloc[-1]:.2f} times that with method all.",
                f"With method all, {all_last['nodes']} nodes make "
                f"{1 + all_last['rays discarded'] / all_last['primary']:.1f} primary rays for each that they keep. They discard the others, which "
                "enter at other nodes' voxels, and are charged for all.",
                f"On {last['nodes']} nodes, method root takes {last['stepwise (ms)'] / all_last['stepwise (ms)']:.2f} times as long as method all, "
                f"stepwise. It has {last['supersteps']} supersteps instead of {all_last['supersteps']}, because the root stops making rays "
                "in a superstep when an eighth of its queue is full."]
    return Page({"scene": scene.name, "size": size, "nodes": MAX_NODES, "links": "torus3d", "format": "fp32",
                 "bounces": BOUNCES}, findings,
                tables=[Table("inject", "Time and work with primary rays made by the root and by all nodes",
                              rows.drop(columns=["primary", "run"]))],
                plots=[Plot("inject", "Time against the number of nodes", "number of nodes", "modelled time (ms)",
                            [Series(f"{method_rows['inject'][0]}, {bound}", method_rows["nodes"], method_rows[f"{bound} (ms)"])
                             for method_rows in (root, all_nodes) for bound in ("overlapped", "stepwise")], "xy"),
                       Plot("inject-root", "Time of the root in % of the overlapped time", "number of nodes", "root / overlapped (%)",
                            series_by(rows, "inject", "nodes", "root / overlapped (%)"), "x"),
                       Plot("inject-supersteps", "Supersteps of a render", "number of nodes", "supersteps",
                            series_by(rows, "inject", "nodes", "supersteps"), "xy")],
                news=[f"The root is the bottleneck {bound_text(root)} if it makes all primary rays, and {bound_text(all_nodes)} if all nodes do."], clock=CLOCK)


def bound_text(rows):
    """Part of a sentence: the smallest number of nodes (at least two) such that the root is the bottleneck for this and all larger numbers."""
    nodes = first_from(rows["nodes"][1:], rows["root / overlapped (%)"][1:] >= 100)
    return f"from {nodes} nodes upwards" if nodes else "for no number of nodes"
