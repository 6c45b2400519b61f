"""Who makes the primary rays: the root or all nodes

From how many nodes on does the root hold the machine up?

- {scene} at {size} x {size} on 1 to {nodes} nodes of a 3-D torus, doubling, one voxel a node, fp32. Root: it makes all
  primary rays, one after another, and sends each to where it enters the box, as Yoshitani & Yamazaki have it. All:
  every node makes those that enter at its voxel, and is charged for those that it makes and discards. Either way ray
  packets have 16 words, and each term of a ray is a return.
- The root's time is the greater of its processor's, computing and messages, and its busiest link's. Contributions to
  pixels come home to the root either way.
- One node has the whole scene in one voxel, and is its own root: where more nodes are more than so many times as fast,
  it is the grid's doing.
"""
from raya.lab import Page, Plot, Series, Table, holding_to_the_end, series_by, study
from raya.lab.voxels import BOUNCES, CLOCK, even_scene, near_cube, powers, run_on_torus, swept

MOST, PART = 512, 1.1  # PART: times as long; more than this and the two ways have parted
CASES = [{"nodes": nodes, "inject": way} for nodes in powers(MOST) for way in ("root", "all")]
COLUMNS = ("supersteps", "overlapped (ms)", "stepwise (ms)", "the root's processor (ms)",
           "the root's busiest link (ms)", "root / overlapped (%)", "busiest link (bytes)", "packets",
           "rays thrown away", "hops a packet", "most packets in a queue", "primary")


@study("inject", one_scene=True)
def inject(lab, scenes):
    scene, size = scenes[0] if scenes else even_scene(8320), lab.size(64)

    rows = swept(CASES, lambda nodes, inject: run_on_torus(lab, scene, size, near_cube(nodes), near_cube(nodes),
                                                           inject=inject), COLUMNS)
    root, every = (rows[rows["inject"] == way].reset_index() for way in ("root", "all"))
    return Page({"scene": scene.name, "size": size, "nodes": MOST, "links": "torus3d", "format": "fp32",
                 "bounces": BOUNCES}, findings_of(root, every),
                tables=[Table("inject", "The root or all nodes make the primary rays",
                              rows.drop(columns=["primary", "run"]))],
                plots=[Plot("inject", "Time against the number of nodes", "nodes", "modelled ms",
                            [Series(f"{some['inject'][0]}, {bound}", some["nodes"], some[f"{bound} (ms)"])
                             for some in (root, every) for bound in ("overlapped", "stepwise")], "xy"),
                       Plot("inject-root", "The root's share of the time", "nodes", "root / overlapped (%)",
                            series_by(rows, "inject", "nodes", "root / overlapped (%)"), "x"),
                       Plot("inject-supersteps", "Supersteps", "nodes", "supersteps",
                            series_by(rows, "inject", "nodes", "supersteps"), "xy")],
                news=["Yoshitani & Yamazaki let the root send all rays and do not ask what that costs; here both ways "
                      "stand side by side, from 1 to 512 nodes."], clock=CLOCK)


def bound_text(rows):
    """The fewest nodes, two or more, from which on the machine waits for its root with every number of nodes."""
    nodes = holding_to_the_end(rows["nodes"][1:], rows["root / overlapped (%)"][1:] >= 100)
    return f"from {nodes.iloc[0]} nodes on" if len(nodes) else "not with the most nodes"


def finding_of_parting(root, every):
    ratio = root["overlapped (ms)"] / every["overlapped (ms)"]
    last = f"with {every['nodes'].iloc[-1]} nodes the root's way takes {ratio.iloc[-1]:.2f} times as long"
    parted = ratio[ratio > PART]
    if not len(parted):
        return f"The two ways never part by more than 10 %: {last}."
    return (f"The two ways part by more than 10 % at {every['nodes'][parted.index[0]]} nodes: {parted.iloc[0]:.2f} "
            f"times as long; {last}.")


def findings_of(root, every):
    a, b = (rows.loc[rows["overlapped (ms)"].idxmin()] for rows in (root, every))
    one, last, all_last = every["overlapped (ms)"][0], root.iloc[-1], every.iloc[-1]
    return [f"The whole machine waits for its root, overlapped: where the root makes all primary rays "
            f"{bound_text(root)}, where all nodes do {bound_text(every)}.",
            f"Injection by the root ends at {a['overlapped (ms)']:.0f} ms on {a['nodes']} nodes, "
            f"{one / a['overlapped (ms)']:.1f} times as fast as one node; by all nodes at {b['overlapped (ms)']:.0f} "
            f"ms on {b['nodes']}, {one / b['overlapped (ms)']:.1f} times.",
            finding_of_parting(root, every),
            f"{all_last['nodes']} nodes that make their own primary rays make "
            f"{1 + all_last['rays thrown away'] / all_last['primary']:.1f} for each that they keep, all of which they "
            "are charged for: the other rays of their windows enter elsewhere.",
            f"Stepwise the root's way takes {last['stepwise (ms)'] / all_last['stepwise (ms)']:.2f} times as long with "
            f"{last['nodes']} nodes, in {last['supersteps']} supersteps against {all_last['supersteps']}: the root "
            "makes no more rays at a time than an eighth of its queue holds."]
