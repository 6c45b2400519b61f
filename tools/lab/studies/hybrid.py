"""Screen and space divided together: groups of nodes

Into how many groups that share the screen should the nodes be divided, and which numbers of groups fit in memory?

- Source: Yoshitani & Yamazaki, about 1995, mention the combination (Harada et al. 1995, their reference [1]) and do not try it.
- {nodes} nodes in G groups, fp32. Each group is a 3-D torus of {nodes} / G nodes and holds the whole scene. Of {size} x {size} pixels, numbered row
  by row, group g renders those with number mod G = g; so each row is shifted by {size} mod G relative to the row above, as in a cyclic mapping.
  Every node of a group creates primary rays; the time model includes those that it then discards because they belong to other nodes.
- Each group divides the scene into the same voxels and assigns them cyclically to its nodes, so that the work is the same for every G. G = 1
  divides only space; G = {nodes} divides only the screen.
- The machine's time is that of its slowest group. Speed-up is relative to one node that has all pixels and the same voxels. The transfer of
  pixels to the host from the roots of the groups, the nodes connected to it, is not modelled.
- Memory of the node that needs most (bytes): for its part of the scene; for this part with the shortest queue and mailboxes with which the node can
  process every hit; for this part with the queue and mailboxes of this study.
- Output: hybrid.csv (modelled times in ms, speed-ups, counts) and hybrid-memory.csv have a row for each scene, grid and number of groups.
"""
import numpy as np
import pandas as pd
import raya
from raya.lab import Comparison, Page, Plot, Series, Table, series_by, study
from raya.lab.voxels import BOUNCES, CLOCK, balls_scene, even_scene, near_cube, powers_of_two, run_on_torus, sides_text

NODES, SIDES = 64, (4, 8)  # SIDES: voxels along each axis of the grid of a group: as in the paper; a finer grid
MEMORIES = {"32 KB": 32 * 1024, "4 MB": 4 * 1024 * 1024}  # bytes of a node: as a PE of the SPA; as a transputer board


def row_of(lab, scene, size, sides, groups):
    runs = [run_on_torus(lab, scene, size, near_cube(NODES // groups), (sides,) * 3, pixels=(groups, g))
            for g in range(groups)]
    loads = np.concatenate([run["result"].loads for run in runs])
    memory = runs[0]["result"].node_memory
    most, total = ({name: of([run[name] for run in runs]) for name in names} for of, names in (
        (max, ("overlapped (ms)", "stepwise (ms)", "messages (ms)", "supersteps")),
        (sum, ("hops", "packets", "tests", "rays", "rays discarded", "work (ms)"))))
    return {"scene": scene.name, "voxels": sides_text((sides,) * 3), "groups": groups, "nodes a group": NODES // groups,
            "overlapped (ms)": most["overlapped (ms)"], "stepwise (ms)": most["stepwise (ms)"], "u over all nodes": loads.max() / loads.mean() - 1,
            "most messages (ms)": most["messages (ms)"], "hops a packet": total["hops"] / max(1, total["packets"]),
            "supersteps": most["supersteps"], "tests a ray": total["tests"] / max(1, total["rays"]),
            "rays discarded": total["rays discarded"], "part of the scene (bytes)": memory["scene"],
            "scene and shortest buffers (bytes)": memory["shortest"], "scene and this study's buffers (bytes)": memory["used"],
            "work": total["work (ms)"]}


def rows_of(lab, scene, size, sides):
    """Returns a table with a row for each number of groups: 1, 2, 4, ..."""
    rows = pd.DataFrame([row_of(lab, scene, size, sides, groups) for groups in powers_of_two(NODES)])
    # In groups of one node no node sends messages or discards rays, so the sum of work is that of one node that renders all pixels.
    for bound in ("overlapped", "stepwise"):
        rows[f"speed-up, {bound}"] = rows["work"].iloc[-1] / rows[f"{bound} (ms)"]
    for name, size in MEMORIES.items():
        rows[f"fits {name}"] = np.where(rows["scene and shortest buffers (bytes)"] <= size, "yes", "no")
    return rows


@study("hybrid")
def hybrid(lab, scenes):
    size = lab.size(72)  # 64 + 8: with 64 groups each row is shifted by 8, the square root of 64, the best offset
    chosen_scenes = scenes or [even_scene(8320), raya.example("centre"), balls_scene(3)]
    every = [rows_of(lab, scene, size, sides) for scene in chosen_scenes for sides in SIDES]
    rows = pd.concat(every, ignore_index=True)
    best_groups = [int(one["groups"][one["overlapped (ms)"].idxmin()]) for one in every]
    head = ["scene", "voxels", "groups"]
    times = rows[head + ["nodes a group", "overlapped (ms)", "stepwise (ms)", "speed-up, overlapped",
                         "speed-up, stepwise", "u over all nodes", "most messages (ms)", "hops a packet", "supersteps",
                         "tests a ray", "rays discarded"]]
    memory = rows[head + ["part of the scene (bytes)", "scene and shortest buffers (bytes)",
                          "scene and this study's buffers (bytes)", "fits 32 KB", "fits 4 MB"]]
    labelled = rows.assign(label=rows["scene"] + ", " + rows["voxels"] + " voxels")

    def plot(name, title, y_label, column, log="x", more=()):
        return Plot(name, title, "groups G", y_label, series_by(labelled, "label", "groups", column) + list(more), log)

    limits = [Series(name, [1, NODES], [size, size]) for name, size in MEMORIES.items()]
    plots = [*(plot(name, f"Speed-up against the number of groups, {bound}", "speed-up, modelled", f"speed-up, {bound}")
               for name, bound in (("hybrid", "overlapped"), ("hybrid-stepwise", "stepwise"))),
             plot("hybrid-balance", "Load imbalance over the nodes of all groups", "u = (max load - mean load) / mean load", "u over all nodes"),
             plot("hybrid-memory", "Memory of the node that needs most, with the shortest buffers", "memory (bytes)",
                  "scene and shortest buffers (bytes)", "xy", limits)]
    return Page({"scenes": [scene.name for scene in chosen_scenes], "size": size, "nodes": NODES, "voxels": list(SIDES),
                 "links": "torus3d", "format": "fp32", "bounces": BOUNCES}, findings_of(every),
                [Comparison(f"best G, {one['scene'][0]}, {one['voxels'][0]} voxels", "groups", None, best,
                            "shortest overlapped time, modelled without a memory limit") for one, best in zip(every, best_groups)],
                tables=[Table("hybrid", "Time of the whole machine", times),
                        Table("hybrid-memory", "Memory of the node that needs most", memory)], plots=plots,
                clock=CLOCK)


def findings_of(every):
    def for_each_scene(text, argument=None, with_voxels=", {}"):
        return "; ".join(f"{r['scene'][0]}{with_voxels.format(r['voxels'][0])}: {text(r, argument)}" for r in every)

    def balance(r, _):
        return "{:.2f} and {:.2f}".format(*r["u over all nodes"].iloc[[0, -1]])

    def best(r, bound):
        i, speedup = r[f"{bound} (ms)"].idxmin(), r[f"speed-up, {bound}"]
        return f"G = {r['groups'][i]}, speed-up {speedup[i]:.1f} ({speedup[0]:.1f} with one group)"

    def memory(r, name):
        fit = r[r[f"fits {name}"] == "yes"]
        if not len(fit):
            size = r["scene and shortest buffers (bytes)"][0]
            scale, unit = next(one for one in ((1 << 30, "GB"), (1 << 20, "MB"), (1 << 10, "KB")) if size >= one[0])
            return f"no G (one group needs {np.ceil(10 * size / scale) / 10:.1f} {unit} per node)"  # rounded up, because it is a requirement
        if len(fit) == len(r):
            return "every G"
        i = fit["overlapped (ms)"].idxmin()
        return (f"G = {', '.join(map(str, fit['groups']))}; the best of these is {r['groups'][i]} with a speed-up of "
                f"{r['speed-up, overlapped'][i]:.1f}")

    return [f"The number of groups of {NODES} nodes with the shortest overlapped time, without a memory limit: "
            f"{for_each_scene(best, 'overlapped', ' with {} voxels')}.",
            f"The number of groups with the shortest stepwise time, without a memory limit: {for_each_scene(best, 'stepwise')}.",
            *(f"Numbers of groups that fit in nodes of {name}, with the shortest buffers: {for_each_scene(memory, name)}."
              for name in MEMORIES), f"Imbalance u over all nodes, with one group and with {NODES} groups: {for_each_scene(balance)}."]
