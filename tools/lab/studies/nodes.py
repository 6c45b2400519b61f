"""The torus machine from one node to {nodes}

How many transputers pay, and what is their bottleneck?

- Source: Yoshitani & Yamazaki, about 1995, who had 64 nodes and print no speed-up.
- {size} x {size} pixels on 1, 2, 4, ... nodes, as near to a cube as powers of two allow; fp32. All nodes make primary rays and are
  charged for those that they make and discard; ray packets have 16 words, each term of a ray is a return; queues hold {queue} packets.
- Two divisions of the scene: one voxel a node, as in Yoshitani & Yamazaki; and {voxels} voxels on any number of nodes, laid out
  cyclically. With {voxels} voxels all machines do the same work, so the speed-up is due only to the nodes. With one voxel a node it is also due to
  the finer grid.
- The processors at both ends of a message spend time on it; u and tests are of computing, without messages.
- 2-D: slabs of nodes next to each other, four links a node, as a T805 has; 3-D: six links a node.
- A series ends before supersteps times nodes exceed {launches}: rays that have to visit all voxels, such as those from far away on a
  plane, cause very many supersteps.
- Asynchronous: simulated packet by packet without supersteps, on at most {max_async} nodes.
- Output: nodes.csv has a row for each scene, division, kind of torus and number of nodes: modelled times (ms), speed-up, u, counts, and the
  bottleneck (column "waits for").
"""
import pandas as pd
from raya.lab import Comparison, Page, Plot, Series, Table, study
from raya.lab.voxels import BOUNCES, CLOCK, balls_scene, even_scene, near_cube, powers_of_two, run_on_torus, sides_text

QUEUE = 256  # short enough for the memory of 4096 nodes, long enough for the project's scenes
MAX_NODES, SIDES, MAX_NODE_SUPERSTEPS = 4096, 16, 1 << 22
MAX_ASYNC = 512  # largest number of nodes that is simulated without supersteps
VOXELS = sides_text((SIDES,) * 3)
COLUMNS = ("u", "hops a packet", "supersteps", "busiest link (bytes)", "tests a ray", "steps a ray", "rays discarded")


def series_of(lab, scene, size, fixed, links, known):
    """Returns a table of tori of one kind, with 1, 2, 4, ... nodes. fixed: VOXELS on each, else one voxel a node. known: {settings: Run}, a cache."""
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
                     **run.row(["overlapped (ms)", "stepwise (ms)", "asynchronous (ms)"]),
                     "speed-up, asynchronous": one.asynchronous_ms / run.asynchronous_ms,
                     "speed-up, overlapped": one.overlapped_ms / run.overlapped_ms,
                     "speed-up, stepwise": one.stepwise_ms / run.stepwise_ms,
                     "efficiency, overlapped": one.overlapped_ms / run.overlapped_ms / nodes, **run.row(COLUMNS),
                     "waits for": bottleneck(nodes, run), "run": run, "balance": run.balance})
    return pd.DataFrame(rows)


def bottleneck(nodes, run):
    """Returns the name of the processor or link that determines the overlapped time."""
    if run.root_link_ms >= run.overlapped_ms:
        return "the root's link"
    if run.root_processor_ms >= run.overlapped_ms:
        return "the root" if nodes > 1 else "its one node"
    return "a link" if run.links_ms >= run.overlapped_ms else "a node"


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
            comparisons.append(Comparison(f"{best['scene']}, {best['voxels']}: best speed-up", "", None,
                                          best["speed-up, overlapped"], f"modelled, overlapped, {best['nodes']} nodes; "
                                          "Yoshitani & Yamazaki print no speed-up"))
        findings += [*findings_of_speedup(three, fixed), finding_of_links(three, two),
                     *findings_of_balance(three, fixed)]
    fixed = by_scene[0][-1]
    best_fixed = fixed.loc[fixed["overlapped (ms)"].idxmin()]
    rows = pd.concat(sum(by_scene, ()), ignore_index=True).drop(columns=["run", "balance"])
    return Page({"scenes": [scene.name for scene in chosen_scenes], "size": size, "nodes": MAX_NODES,
                 "voxels": VOXELS, "queue": QUEUE, "format": "fp32", "bounces": BOUNCES}, findings, comparisons,
                tables=[Table("nodes", "Every machine", rows)], plots=plots_of(by_scene),
                news=[f"With {VOXELS} voxels on every machine, {best_fixed['nodes']} transputers are at most {best_fixed['speed-up, overlapped']:.0f} times as "
                      f"fast as one; {best_fixed['waits for']} limits them."], clock=CLOCK,
                placeholders={"launches": MAX_NODE_SUPERSTEPS, "max_async": MAX_ASYNC})


def findings_of_speedup(one, fixed):
    (best, own), first = (rows.loc[rows["overlapped (ms)"].idxmin()] for rows in (fixed, one)), one.iloc[0]
    half = fixed["nodes"][(fixed["efficiency, overlapped"] >= 0.5).cummin()].iloc[-1]
    return [f"{best['scene']}, {best['voxels']} voxels on every machine: {best['nodes']} nodes are fastest, "
            f"{best['speed-up, overlapped']:.1f} times as fast as one (overlapped; stepwise "
            f"{best['speed-up, stepwise']:.1f} times); their bottleneck is {best['waits for']}. The efficiency is at least 50 % up to "
            f"{half} nodes.",
            f"{first['scene']}, one voxel a node: {own['nodes']} nodes are {own['speed-up, overlapped']:.0f} times as fast as one. But "
            f"a single node has no grid, and makes {first['tests a ray'] / max(1e-9, own['tests a ray']):.1f} times as many tests a ray, "
            f"{first['tests a ray']:.1f} compared with {own['tests a ray']:.1f}. One node with {best['voxels']} voxels is already "
            f"{first['overlapped (ms)'] / fixed['overlapped (ms)'][0]:.0f} times as fast."]


def finding_of_links(three, two):
    count = min(len(three), len(two))
    ratios = two["overlapped (ms)"][:count] / three["overlapped (ms)"][:count]
    a, b = three.iloc[count - 1], two.iloc[count - 1]
    bytes_ratio = b["busiest link (bytes)"] / max(1, a["busiest link (bytes)"])
    return (f"{a['scene']}, 2-D compared with 3-D torus with {a['nodes']} nodes: {b['hops a packet']:.2f} hops a packet instead of "
            f"{a['hops a packet']:.2f}, {b['supersteps']} supersteps instead of {a['supersteps']}, {bytes_ratio:.2f} times "
            f"the bytes over the busiest link; overlapped it takes {ratios.iloc[-1]:.2f} times as long, over all numbers "
            f"of nodes {ratios.min():.2f} to {ratios.max():.2f} times.")


def findings_of_balance(one, fixed):
    a, b = ((rows[rows["nodes"] == 64] if (rows["nodes"] == 64).any() else rows).iloc[-1] for rows in (one, fixed))
    last = fixed.iloc[-1]

    def text(rows):
        most = rows.loc[rows["rays discarded"].idxmax()]
        discarded = most["rays discarded"] / most["run"].events["primary"]
        how = "a voxel each" if most["voxels"] == "one a node" else f"{most['voxels']} voxels laid out cyclically"
        return f"{1 + discarded:.1f} with {how} ({most['nodes']} nodes)"

    return [f"{a['scene']}, balance: u of {a['nodes']} nodes is {a['u']:.2f} with a voxel each and {b['u']:.2f} with "
            f"{b['voxels']} voxels laid out cyclically, {SIDES**3 // b['nodes']} a node; of {last['nodes']} nodes "
            f"{last['u']:.2f}.",
            f"{a['scene']}: nodes that make their own primary rays make up to {text(one)} or "
            f"{text(fixed)} for each that they keep; discarded rays are charged."]


def plots_of(by_scene):
    plots, hops, balance = [], [], []
    for number, (three, two, fixed) in enumerate(by_scene, 1):
        scene, voxels = three["scene"][0], fixed["voxels"][0]
        both = (fixed, voxels), (three, "a voxel a node")
        series = [Series(f"{label}, {bound}", rows["nodes"], rows[f"speed-up, {bound}"])
                  for rows, label in both for bound in ("overlapped", "stepwise")]
        plots.append(Plot(f"nodes-speedup-{number}", f"Speed-up of {scene}, 3-D torus", "nodes", "speed-up, modelled",
                          series + [Series("linear", fixed["nodes"], fixed["nodes"])], "xy"))
        hops += [Series(f"{scene}, {rows['links'][0]}", rows["nodes"], rows["hops a packet"]) for rows in (three, two)]
        balance += [Series(f"{scene}, {label}", rows["nodes"], rows["balance"])
                    for rows, label in both[::-1]]
    return plots + [
        Plot("nodes-hops", "Hops of a packet, a voxel a node", "nodes", "hops a packet", hops, "x"),
        Plot("nodes-balance", "Balance of computing, 3-D torus", "nodes", "mean load / largest load", balance, "xy")]
