"""A turn round the scene

Is the load balanced equally well in all frames while the camera turns? Is the offset that is best for the first frame also good for the others?

- Source: Kohata & Ito 1993, Fig. 8, which shows u(p) of one picture.
- {frames} frames, between which the camera turns by {step_degrees} degrees about the upward axis through the point that it looks at. A PE for each
  column; no antialiasing.
- The load imbalance u = (max load - mean load) / mean load is computed for every offset, from the pixels' modelled cycles in each frame.
- Two methods choose an offset: the one with the lowest u in frame 1, or the one with the lowest mean u of the odd frames. Both are tested in the
  even frames. There they are compared with p = sqrt(P), and with the best offset of each single frame, a lower bound for every fixed offset.
- Frames of one turn resemble each other, so confidence intervals are over several turns. Each of them starts from a random view of the scene: the
  camera at the same distance, between {lowest_view_degrees} and {highest_view_degrees} degrees above the point that it looks at.
- Output: turn.csv has u of each frame for the chosen offsets. turn-starts.csv has a row for each turn, with the chosen offsets and their mean u
  in the even frames. The second scene has turn-2.csv and turn-2-starts.csv, and so on.
"""
import numpy as np
import pandas as pd
import raya
from raya.lab import Page, Plot, Series, Table, estimate, range_text, study
from raya.lab.laboratory import format_for

FRAMES, MAX_TURNS = 24, 8  # MAX_TURNS: maximum number of turns that start from random views
DEGREES = [360 * i / FRAMES for i in range(FRAMES)]


def turn_of(lab, scene, size):
    """Returns the load imbalance u in a turn of the camera, as an array [frame, offset]."""
    return np.array([raya.imbalances(lab.costs(scene.turned(degrees), size).trace, size, range(size))
                     for degrees in DEGREES])


def choices_of(u, root):
    """Returns the best offsets for frame 1 and for the odd frames, and the mean u of the even frames for these and two other choices."""
    odd, even = u[0::2], u[1::2]
    first, half = int(u[0].argmin()), int(odd.mean(0).argmin())
    return {"best p of frame 1": first, "u, best p of frame 1": even[:, first].mean(), "best p of odd frames": half,
            "u, best p of odd frames": even[:, half].mean(), f"u, p = {root}": even[:, root].mean(),
            "u, each frame's best p": even.min(1).mean()}


@study("turn")
def turn(lab, scenes):
    size = lab.size(256)
    root = round(size**0.5) % size
    settings, findings, tables, plots = [], [], [], []
    for number, scene in enumerate(scenes or [raya.example("centre"), raya.example("spheres")], 1):
        starts = min(max(2**28 // (size * size * FRAMES * max(scene.objects, 1)), 2), MAX_TURNS)
        own = turn_of(lab, scene, size)
        others = [turn_of(lab, scene.random_view(seed), size) for seed in range(1, starts + 1)]
        rows = pd.DataFrame([{"start": f"view {i}", **choices_of(u, root)} for i, u in enumerate(others, 1)])
        settings.append({"scene": scene.name, "size": size, "pes": size, "format": format_for(scene), "fold": "cyclic",
                         "start_seeds": f"1..{starts}"})
        findings += findings_of(scene.name, own, rows, root)
        choice, stem = choices_of(own, root), "turn" if number == 1 else f"turn-{number}"
        first, half = choice["best p of frame 1"], choice["best p of odd frames"]
        offsets = {"p = 0": 0, f"p = {root}, root of P": root, f"p = {first}, best of frame 1": first, f"p = {half}, best of odd frames": half}
        frames = pd.DataFrame({"frame": range(1, FRAMES + 1), "turned by (degrees)": DEGREES, **{f"u, {name}": own[:, p] for name, p in offsets.items()},
                               "best p of the frame": own.argmin(1), "u, best p of the frame": own.min(1)})
        tables += [Table(stem, f"u of every frame of {scene.name}, in the turn that starts from the scene's view", frames),
                   Table(f"{stem}-starts", f"Mean u of the even frames of {scene.name}, in turns that start from random views", rows)]
        plots.append(Plot(f"turn-{number}", f"Load imbalance u while the camera turns round {scene.name}", "turned by (degrees)", "u",
                          [*(Series("p = 0, column split" if p == 0 else name, DEGREES, own[:, p]) for name, p in offsets.items()),
                           Series("each frame's best p", DEGREES, own.min(1), "points")], "y"))
    return Page({"scenes": settings, "frames": FRAMES, "step_degrees": DEGREES[1], "lowest_view_degrees": 5,
                 "highest_view_degrees": 75}, findings, tables=tables, plots=plots)


def findings_of(scene, u, rows, root):
    half, first, at_root = rows["u, best p of odd frames"], rows["u, best p of frame 1"], rows[f"u, p = {root}"]
    return [f"{scene}, {FRAMES} frames of one turn: the mean u is {u[:, root].mean():.3f} at p = {root} "
            f"({range_text(u[:, root])} in single frames, {u[0, root]:.3f} in the first) and "
            f"{u[:, 0].mean():.3f} at p = 0 ({range_text(u[:, 0])}).",
            f"{scene}, {len(rows)} turns from random views: the mean u of the even frames is "
            f"{estimate(half).text()} with the best offset of the odd frames. It is {estimate(first).text()} with the best offset of frame 1 (a "
            f"difference of {estimate(first - half).text()}) and {estimate(at_root).text()} at p = {root} (a difference of "
            f"{estimate(at_root - half).text()}). With the best offset of each single frame it is "
            f"{estimate(rows[rows.columns[-1]]).text()}."]
