"""Primary rays from the root or from all nodes

From how many nodes on is the root the bottleneck?

- Source: Yoshitani & Yamazaki, about 1995: the root makes and sends all primary rays.
- {scene} at {size} x {size} on 1 to {nodes} nodes of a 3-D torus, doubling, one voxel a node, fp32.
- Method root: the root makes all primary rays, one after another, and sends each to the node where it enters the bounding box, as in
  Yoshitani & Yamazaki. Method all: every node makes the rays that enter at its voxel, and is charged for those that it makes and discards.
  With both methods ray packets have 16 words, and each term of a ray is a return.
- The root's time is the larger of its processor's time (computing and messages) and its busiest link's. With both methods the contributions
  to pixels return to the root.
- A single node has the whole scene in one voxel and is its own root. A speed-up above the number of nodes is therefore due to the grid.
- Output: inject.csv has a row for each number of nodes and method: supersteps, modelled times (ms), the root's share (%), bytes over the
  busiest link, and counts.
"""
from raya.lab import Page, Plot, Series, Table, series_by, study, tail_where
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
    return Page({"scene": scene.name, "size": size, "nodes": MAX_NODES, "links": "torus3d", "format": "fp32",
                 "bounces": BOUNCES}, findings_of(root, all_nodes),
                tables=[Table("inject", "Primary rays from the root and from all nodes",
                              rows.drop(columns=["primary", "run"]))],
                plots=[Plot("inject", "Time against the number of nodes", "nodes", "modelled time (ms)",
                            [Series(f"{method_rows['inject'][0]}, {bound}", method_rows["nodes"], method_rows[f"{bound} (ms)"])
                             for method_rows in (root, all_nodes) for bound in ("overlapped", "stepwise")], "xy"),
                       Plot("inject-root", "The root's share of the time", "nodes", "root / overlapped (%)",
                            series_by(rows, "inject", "nodes", "root / overlapped (%)"), "x"),
                       Plot("inject-supersteps", "Supersteps", "nodes", "supersteps",
                            series_by(rows, "inject", "nodes", "supersteps"), "xy")],
                news=[f"The root is the bottleneck {bound_text(root)} if it makes all primary rays, and {bound_text(all_nodes)} if all nodes make them."], clock=CLOCK)


def bound_text(rows):
    """Part of a sentence: the number of nodes (at least two) from which on the root is always the bottleneck."""
    nodes = tail_where(rows["nodes"][1:], rows["root / overlapped (%)"][1:] >= 100)
    return f"from {nodes.iloc[0]} nodes on" if len(nodes) else "for no number of nodes"


def finding_of_difference(root, all_nodes):
    ratio = root["overlapped (ms)"] / all_nodes["overlapped (ms)"]
    last = f"with {all_nodes['nodes'].iloc[-1]} nodes injection by the root takes {ratio.iloc[-1]:.2f} times as long"
    different = ratio[ratio > DIFFERENCE_RATIO]
    if not len(different):
        return f"The two methods never differ by more than 10 %: {last}."
    return (f"The two methods first differ by more than 10 % on {all_nodes['nodes'][different.index[0]]} nodes, where injection by the root "
            f"takes {different.iloc[0]:.2f} times as long; {last}.")


def findings_of(root, all_nodes):
    a, b = (rows.loc[rows["overlapped (ms)"].idxmin()] for rows in (root, all_nodes))
    one, last, all_last = all_nodes["overlapped (ms)"][0], root.iloc[-1], all_nodes.iloc[-1]
    return [f"The root is the bottleneck of the machine, overlapped: {bound_text(root)} if it makes all primary rays, "
            f"{bound_text(all_nodes)} if all nodes do.",
            f"The fastest machine with injection by the root takes {a['overlapped (ms)']:.0f} ms, with {a['nodes']} nodes, "
            f"{one / a['overlapped (ms)']:.1f} times as fast as one node; with injection by all nodes "
            f"{b['overlapped (ms)']:.0f} ms, with {b['nodes']} nodes, {one / b['overlapped (ms)']:.1f} times.",
            finding_of_difference(root, all_nodes),
            f"{all_last['nodes']} nodes that make their own primary rays make "
            f"{1 + all_last['rays discarded'] / all_last['primary']:.1f} for each that they keep, and are charged for all of them: "
            "the other rays that they make enter at other voxels.",
            f"Stepwise, injection by the root takes {last['stepwise (ms)'] / all_last['stepwise (ms)']:.2f} times as long on "
            f"{last['nodes']} nodes, in {last['supersteps']} supersteps instead of {all_last['supersteps']}, because the root makes "
            "at most as many rays at a time as an eighth of its queue holds."]
