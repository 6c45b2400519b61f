"""The torus machine with 1 to {nodes} nodes

Up to how many transputers does the render become faster, and what is the bottleneck?

- Source: Yoshitani & Yamazaki, about 1995. They had 64 nodes and print no speed-up.
- {size} x {size} pixels on tori of 1, 2, 4, ... nodes, as near to a cube as powers of two allow; fp32. Each node makes the primary rays
  that enter at its voxels. The model also charges the rays that it makes and discards because they enter elsewhere. A ray packet has 16
  words, each contribution of a ray to its pixel is a packet (a return), and a node's queue holds {queue} packets.
- The scene is divided in two ways: into one voxel per node, as in Yoshitani & Yamazaki; and into {voxels} voxels, which are dealt
  cyclically to any number of nodes. With {voxels} voxels all machines do the same work, so the speed-up is due to the nodes alone. With
  one voxel per node it is also due to the finer grid.
- A message takes time on the processors at both of its ends. The load imbalance u is that of computing, without this time for messages.
- A 3-D torus has six links per node. A 2-D torus has four, as a T805 has; it places the layers of the 3-D torus next to each other.
- A series ends if the supersteps of its last machine times the nodes of the next one exceed {launches}. Rays that visit all voxels, such
  as those that start far away on a plane, need very many supersteps.
- Asynchronous times are those of a discrete-event simulation of each packet, without supersteps, on at most {max_async} nodes.
- Output: nodes.csv has a row for each scene, division, kind of torus and number of nodes: modelled times (ms), speed-up, u, counts, and
  the bottleneck (column "waits for").
"""
import pandas as pd
from raya.lab import Comparison, Page, Plot, Series, Table, study
from raya.lab.voxels import BOUNCES, CLOCK, balls_scene, even_scene, near_cube, powers_of_two, run_on_torus, sides_text

QUEUE = 256  # packets; short enough for the device memory of 4096 nodes, long enough for the scenes of this study
MAX_NODES, SIDES, MAX_NODE_SUPERSTEPS = 4096, 16, 1 << 22
MAX_ASYNC = 512  # maximum number of nodes for the discrete-event simulation
VOXELS = sides_text((SIDES,) * 3)
TIMES = "overlapped (ms)", "stepwise (ms)", "asynchronous (ms)"
COLUMNS = ("u", "hops a packet", "supersteps", "busiest link (bytes)", "tests a ray", "steps a ray", "rays discarded")


def series_of(lab, scene, size, fixed, links, known):
    """Returns a table of renders on 1, 2, 4, ... nodes. fixed: each torus has VOXELS, else one voxel per node. known: {settings: figures}, a cache."""
    rows, one = [], None
    for nodes in powers_of_two(MAX_NODES):
        if rows and rows[-1]["supersteps"] * nodes > MAX_NODE_SUPERSTEPS:
            break
        sides = near_cube(nodes)
        key = scene.name, sides, (SIDES,) * 3 if fixed else sides, links
        run = known[key] = known.get(key) or run_on_torus(lab, scene, size, *key[1:3], queue=QUEUE, links=links,
                                                           async_=nodes <= MAX_ASYNC)
        one = one or run
        rows.append({"scene": scene.name, "voxels": VOXELS if fixed else "one a node", "links": links, "nodes": nodes,
                     **{column: run[column] for column in TIMES},
                     **{f"speed-up, {bound}": one[f"{bound} (ms)"] / run[f"{bound} (ms)"] for bound in ("asynchronous", "overlapped", "stepwise")},
                     "efficiency, overlapped": one["overlapped (ms)"] / run["overlapped (ms)"] / nodes, **{column: run[column] for column in COLUMNS},
                     # the processor or link that determines the overlapped time
                     "waits for": "the root's link" if run["the root's busiest link (ms)"] >= run["overlapped (ms)"] else
                                  ("the root" if nodes > 1 else "its one node") if run["the root's processor (ms)"] >= run["overlapped (ms)"] else
                                  "a link" if run["links (ms)"] >= run["overlapped (ms)"] else "a node",
                     "balance": run["balance"]})
    return pd.DataFrame(rows)


@study("nodes")
def nodes(lab, scenes):
    size = lab.size(64)
    chosen_scenes = scenes or [even_scene(8320), balls_scene(3)]
    known, findings, comparisons, by_scene = {}, [], [], []
    for scene in chosen_scenes:
        three, two, fixed = (series_of(lab, scene, size, *kind, known) for kind in
                             ((False, "torus3d"), (False, "torus2d"), (True, "torus3d")))
        by_scene.append((three, two, fixed))
        for one in (three, fixed):
            best = one.loc[one["overlapped (ms)"].idxmin()]
            comparisons.append(Comparison(f"best speed-up, {best['scene']}, voxels: {best['voxels']}", "", None,
                                          best["speed-up, overlapped"], f"modelled, overlapped, {best['nodes']} nodes; "
                                          "Yoshitani & Yamazaki print no speed-up"))
        findings += findings_of_speedup(three, fixed)
    fixed = by_scene[0][-1]
    best_fixed = fixed.loc[fixed["overlapped (ms)"].idxmin()]
    rows = pd.concat(sum(by_scene, ()), ignore_index=True).drop(columns="balance")
    return Page({"scenes": [scene.name for scene in chosen_scenes], "size": size, "nodes": MAX_NODES,
                 "voxels": VOXELS, "queue": QUEUE, "format": "fp32", "bounces": BOUNCES}, findings, comparisons,
                tables=[Table("nodes", "Time and work on each torus", rows)], plots=plots_of(by_scene),
                news=[f"With {VOXELS} voxels, the best overlapped speed-up is {best_fixed['speed-up, overlapped']:.0f}, with {best_fixed['nodes']} "
                      f"transputers; their bottleneck is {best_fixed['waits for']}."], clock=CLOCK,
                placeholders={"launches": MAX_NODE_SUPERSTEPS, "max_async": MAX_ASYNC})


def findings_of_speedup(one, fixed):
    (best, fastest), first = (rows.loc[rows["overlapped (ms)"].idxmin()] for rows in (fixed, one)), one.iloc[0]
    half = fixed["nodes"][(fixed["efficiency, overlapped"] >= 0.5).cummin()].iloc[-1]
    return [f"{best['scene']}, {best['voxels']} voxels on every machine: the fastest machine has {best['nodes']} nodes. It is "
            f"{best['speed-up, overlapped']:.1f} times as fast as one node overlapped, and {best['speed-up, stepwise']:.1f} times stepwise. "
            f"Its bottleneck is {best['waits for']}. The overlapped efficiency is at least 50 % up to {half} nodes.",
            f"{first['scene']}, one voxel per node: {fastest['nodes']} nodes are {fastest['speed-up, overlapped']:.0f} times as fast as one. But "
            f"one node has no grid and makes {first['tests a ray'] / max(1e-9, fastest['tests a ray']):.1f} times as many tests per ray: "
            f"{first['tests a ray']:.1f} instead of {fastest['tests a ray']:.1f}. With {best['voxels']} voxels, one node is already "
            f"{first['overlapped (ms)'] / fixed['overlapped (ms)'][0]:.0f} times as fast as with one voxel."]


def plots_of(by_scene):
    plots, hops, balance = [], [], []
    for number, (three, two, fixed) in enumerate(by_scene, 1):
        scene, voxels = three["scene"][0], fixed["voxels"][0]
        both = (fixed, voxels), (three, "one voxel per node")
        series = [Series(f"{label}, {bound}", rows["nodes"], rows[f"speed-up, {bound}"])
                  for rows, label in both for bound in ("overlapped", "stepwise")]
        plots.append(Plot(f"nodes-speedup-{number}", f"Speed-up of {scene}, 3-D torus", "number of nodes", "modelled speed-up",
                          series + [Series("linear", fixed["nodes"], fixed["nodes"])], "xy"))
        hops += [Series(f"{scene}, {rows['links'][0]}", rows["nodes"], rows["hops a packet"]) for rows in (three, two)]
        balance += [Series(f"{scene}, {label}", rows["nodes"], rows["balance"]) for rows, label in both[::-1]]
    return plots + [
        Plot("nodes-hops", "Hops of a packet, one voxel per node", "number of nodes", "mean hops of a packet", hops, "x"),
        Plot("nodes-balance", "Balance of computing, 3-D torus", "number of nodes", "mean load / largest load", balance, "xy")]
