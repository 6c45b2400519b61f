"""A turn round the scene

Does the balance of one picture hold while the camera turns, and does the offset that is best for the first frame also suit the others?

- Source: Kohata & Ito 1993, Fig. 8, which shows one picture.
- {frames} frames, {step_degrees} degrees apart, about the axis through the point that the camera looks at, as in `raya render --frames
  1:{frames} --turn 360`; a PE for each column, first pass.
- u = (max load - mean load) / mean load of every offset, from one cost image of each frame. It needs no clock.
- An offset is chosen by two methods: by frame 1, and by the mean of the odd frames. Both are judged in the even frames and compared
  with p = sqrt(P), and with each frame's own best offset, a bound that no choice in advance can beat.
- Frames of one turn resemble each other, so intervals are over turns that start from random views of the scene: the camera at the same
  distance, between {lowest_view_degrees} and {highest_view_degrees} degrees above the point that it looks at.
- Output: turn.csv has u of each frame for the chosen offsets; turn-starts.csv has a row for each turn, with the chosen offsets and their mean u
  in the even frames. Further scenes have turn-2.csv, turn-3.csv, ...
"""
import numpy as np
import pandas as pd
import raya
from raya.lab import Page, Plot, Series, Table, estimate, range_text, study
from raya.lab.laboratory import format_for

FRAMES, MAX_TURNS = 24, 8
DEGREES = [360 * i / FRAMES for i in range(FRAMES)]


def turn_of(lab, scene, size):
    """Returns u as an array [frame, offset]."""
    return np.array([raya.imbalances(lab.costs(scene.turned(degrees), size).trace, size, range(size))
                     for degrees in DEGREES])


def choices_of(u, root):
    """Returns the offsets that are best for frame 1 and for the odd frames, and the mean u of the even frames with each of these offsets."""
    odd, even = u[0::2], u[1::2]
    first, half = int(u[0].argmin()), int(odd.mean(0).argmin())
    return {"best p of frame 1": first, "its u": even[:, first].mean(), "best p of odd frames": half,
            "u of that": even[:, half].mean(), f"u, p = {root}": even[:, root].mean(),
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
        tables += tables_of(number, scene.name, own, rows, root)
        plots.append(plot_of(number, scene.name, own, root))
    return Page({"scenes": settings, "frames": FRAMES, "step_degrees": DEGREES[1], "lowest_view_degrees": 5,
                 "highest_view_degrees": 75}, findings, tables=tables, plots=plots)


def findings_of(scene, u, rows, root):
    half, first, at_root = rows["u of that"], rows["its u"], rows[f"u, p = {root}"]
    return [f"{scene}: over the {FRAMES} frames of its turn u at p = {root} is {u[:, root].mean():.3f} in the mean and "
            f"{range_text(u[:, root])} in single frames, {u[0, root]:.3f} in the first; at p = 0 it is "
            f"{u[:, 0].mean():.3f}, {range_text(u[:, 0])}.",
            f"{scene}, {len(rows)} turns from random views, in the even frames: u is "
            f"{estimate(half).text()} with the offset of the odd frames, {estimate(first).text()} with that of frame 1 (a "
            f"difference of {estimate(first - half).text()}) and {estimate(at_root).text()} at p = {root} (a difference of "
            f"{estimate(at_root - half).text()}); with each frame's own best offset it is "
            f"{estimate(rows[rows.columns[-1]]).text()}."]


def columns_of(u, root):
    choice = choices_of(u, root)
    first, half = choice["best p of frame 1"], choice["best p of odd frames"]
    return {"p = 0": 0, f"p = {root}, root of P": root, f"p = {first}, best of frame 1": first,
            f"p = {half}, best of odd frames": half}


def tables_of(number, scene, u, rows, root):
    stem = "turn" if number == 1 else f"turn-{number}"
    frames = pd.DataFrame({"frame": range(1, FRAMES + 1), "turned by (degrees)": DEGREES,
                           **{f"u, {name}": u[:, p] for name, p in columns_of(u, root).items()},
                           "best p of the frame": u.argmin(1), "its u": u.min(1)})
    return [Table(stem, f"u of every frame of {scene}, from the scene's own view", frames),
            Table(f"{stem}-starts", f"Turns of {scene} from random views: mean u of the even frames", rows)]


def plot_of(number, scene, u, root):
    lines = [Series("p = 0, column split" if p == 0 else name, DEGREES, u[:, p])
             for name, p in columns_of(u, root).items()]
    return Plot(f"turn-{number}", f"Balance over a turn round {scene}", "turned by (degrees)", "u",
                lines + [Series("each frame's best p", DEGREES, u.min(1), "points")], "y")
