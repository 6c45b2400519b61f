"""Images of many kinds: efficiency

Is the cyclic mapping good for every image, or only for the one that Kohata & Ito analyse?

- Source: Kohata & Ito 1993, section on the experiments.
- The first pass of each scene on {pes} PEs of the SPA, with the column split (p = 0) and with the cyclic mapping (p = sqrt(P) = {offset}).
- If the image has more columns than there are PEs, PE i owns the columns i, i + P, ... of row 0 (cyclic fold).
- Efficiency is mean load / maximum load of computing, without communication, so it does not depend on a clock model. Kohata & Ito had several
  images of 6 to 30 objects. Their scenes are not known; ours have {fewest} to {most} objects.
- Ensemble: {ensemble}; {finer} of them also at twice the size.
- The correlation of neighbours is that between the cost of a pixel and the cost of its right neighbour, over all pixels of a picture.
- Another problem: {windows} windows of the Mandelbrot set, {pes} x {pes} points. The cost of a point is its number of iterations, at most
  {iterations}, computed without raya's kernels. Each window has a random width and a random centre on the set's boundary (seed {seed}).
- Output: images.csv has a row for each image, images-groups.csv one for each group of images. u = (max load - mean load) / mean load; columns
  +- are half widths of 95 % intervals.
"""
import numpy as np
import pandas as pd
import raya
from raya.lab import (CONTROLS, Comparison, Page, Plot, Series, Table, above, controlled, estimate, every, judged, papers, proportion, quantile_above,
                      study, under, with_paper)
from raya.lab.laboratory import control_u

FINER_VIEWS, WINDOWS, ITERATIONS = 180, 24, 1000  # numbers of pictures at twice the size and of Mandelbrot windows; maximum iterations of a point
ALIKE, STRONGLY, HIGH, SHARE = 0.8, 2, 0.8, 0.95  # bounds of neighbours-alike; columns-vary; cyclic-is-high; cyclic-is-high and gain-for-all


def rows_of(pictures, objects, pes, offset):
    u_0, u_p = np.array([raya.imbalances(one.trace, pes, [0, offset]) for one in pictures]).T
    return pd.DataFrame({"no.": range(1, len(pictures) + 1), "scene": [one.label for one in pictures], "objects": objects,
                         "side (pixels)": [len(one.trace) for one in pictures], "u, p = 0": u_0, "efficiency, p = 0": 1 / (1 + u_0),
                         f"u, p = {offset}": u_p, f"efficiency, p = {offset}": 1 / (1 + u_p)})


def mandelbrot(side, seed):
    """Returns a cost image, uint64 [side, side]: iterations of z = z^2 + c, at most ITERATIONS, in a window centred near the set's boundary."""
    random = np.random.default_rng(seed)
    angle, width = random.uniform(0, 2 * np.pi), 10 ** random.uniform(-2, 0.4)
    centre = (0.5 - 0.25 * np.exp(1j * angle)) * np.exp(1j * angle)  # the boundary of the main cardioid
    steps = (np.arange(side) + 0.5) / side - 0.5
    c = centre + width * (steps[None, :] + 1j * steps[:, None])
    z, count = np.zeros_like(c), np.zeros(c.shape, np.uint64)
    for _ in range(ITERATIONS):
        inside = z.real**2 + z.imag**2 <= 4
        if not inside.any():
            break
        count += inside
        z = np.where(inside, z * z + c, z)
    return count


def correlation(image):
    """Returns the correlation between the cost of a pixel and the cost of its right neighbour; 1 if all costs are equal."""
    left, right = image[:, :-1].ravel().astype(float), image[:, 1:].ravel().astype(float)
    return float(np.corrcoef(left, right)[0, 1]) if left.std() and right.std() else 1.0


def ensembles_of(lab, scenes):
    pes = lab.size(256)
    return lab.ensemble(scenes, pes), lab.ensemble(scenes, 2 * pes, views=FINER_VIEWS)


@study("images", prepare=ensembles_of)
def images(lab, scenes):
    pes = lab.size(256)
    p = round(pes**0.5)
    shown_scenes = scenes or [  # ten scenes of 6 to 30 spheres and planes, as in the paper's experiments
        *(raya.example(name) for name in ("centre", "spheres", "mirrors", "glass", "planes")),
        *(raya.generate.random(n, n).renamed(f"random-{n}") for n in (6, 12, 20, 30)), raya.generate.uniform(27, (3, 3, 3)).renamed("uniform-27")]
    pictures = [lab.costs(scene, side) for side in (pes, 2 * pes) for scene in shown_scenes]
    rows = rows_of(pictures, [scene.objects for scene in shown_scenes] * 2, pes, p)
    split_column, cyclic_column = "efficiency, p = 0", f"efficiency, p = {p}"
    ensemble, finer = ensembles_of(lab, scenes)
    window_images = [mandelbrot(pes, lab.seed + i) for i in range(WINDOWS)]
    windows = np.array([[*raya.imbalances(image, pes, [0, p]), *control_u(image, pes)] for image in window_images])  # [window, mapping]
    groups = {f"scenes at {side} x {side}": group for side, group in rows.groupby("side (pixels)", sort=False)}
    groups.update({f"ensemble at {len(one.pictures[0].trace)} x {len(one.pictures[0].trace)}": rows_of(one.pictures, 0, pes, p)
                   for one in (ensemble, finer)})
    groups["Mandelbrot windows"] = pd.DataFrame({split_column: 1 / (1 + windows[:, 0]), cyclic_column: 1 / (1 + windows[:, 1])})
    table = pd.DataFrame({"pictures": list(groups), "number": [len(group) for group in groups.values()]})
    for name, column in (("p = 0", split_column), ("cyclic", cyclic_column)):
        means = [estimate(group[column]) for group in groups.values()]
        table[name], table[f"{name}, +-"] = [m.mean for m in means], [m.half for m in means]
        for which, extreme in (("least", min), ("largest", max)):
            table[f"{name}, {which}"] = [extreme(group[column]) for group in groups.values()]
    means = "; ".join(f"{estimate(g[split_column]).text()} and {estimate(g[cyclic_column]).text()} for {label} ({len(g)} images)"
                      for label, g in groups.items())
    worst = rows.loc[rows[cyclic_column].idxmin()]
    worse = (rows[split_column] > rows[cyclic_column]).sum()
    size = "{0} x {0}".format(worst["side (pixels)"])
    rest = (f"The column split is better for {worse} of {len(rows)} images." if worse else
            f"The cyclic mapping is at least as good as the column split on all {len(rows)} images.")
    findings = [f"Mean efficiency of the column split and of the cyclic mapping: {means}.",
                f"In the scenes' own views the efficiency is {rows[split_column].min():.3f} to {rows[split_column].max():.3f} with "
                f"the column split and {rows[cyclic_column].min():.3f} to {rows[cyclic_column].max():.3f} with p = {p}.",
                f"The cyclic mapping's lowest efficiency is {worst[cyclic_column]:.3f}, for {worst['scene']} at {size}; there the column split "
                f"has {worst[split_column]:.3f}. {rest}"]
    return Page({"pes": pes, "offset": p, "images": len(rows), "windows": WINDOWS, "iterations": ITERATIONS, "seed": lab.seed},
                findings,
                comparisons_of(rows, split_column, cyclic_column, pes),
                claims_of(ensemble, finer, windows, pes, p) if not scenes else [],
                [Table("images-groups", "Mean efficiency of each group of images, with 95 % intervals", table),
                 Table("images", "Load imbalance and efficiency of each image", rows)],
                plots_of(rows, groups, split_column, cyclic_column, pes, p),
                [f"The cyclic mapping also balances another problem: over {WINDOWS} windows of the Mandelbrot set its mean efficiency is "
                 f"{groups['Mandelbrot windows'][cyclic_column].mean():.2f}, that of the column split {groups['Mandelbrot windows'][split_column].mean():.2f}."],
                compared_with=papers.SPA,
                placeholders={"fewest": rows["objects"].min(), "most": rows["objects"].max(), "ensemble": ensemble.description,
                              "finer": len(finer.pictures)})


def claims_of(ensemble, finer, windows, pes, p):
    families, about = ensemble.families, ensemble.description
    u = [one.map(lambda costs: raya.imbalances(costs.trace, pes, [0, p])) for one in (ensemble, finer)]
    by_size = [one.control_u(pes) for one in (ensemble, finer)]
    controls = {name: [control[name] for control in by_size] for name in CONTROLS}  # {control: [u at each size]}
    gains = [of_size[:, 1] < of_size[:, 0] for of_size in u]
    efficiency = 1 / (1 + u[0])
    deviation = np.abs(efficiency - efficiency.mean(0))
    alike = ensemble.map(lambda costs: correlation(costs.trace))
    worst = int(efficiency[:, 1].argmin())
    of_family = {name: np.array(families) == name for name in dict.fromkeys(families)}
    shares = ", ".join(f"{(efficiency[some, 1] >= HIGH).sum()} of {some.sum()} ({name})" for name, some in of_family.items())

    def gain(by_size):
        return every(proportion(one < of_size[:, 0], SHARE) for one, of_size in zip(by_size, u))

    def varies_less(efficiency):
        return above(deviation[:, 0] - STRONGLY * np.abs(efficiency - efficiency.mean()), 0, families)

    def high(efficiency):
        return under({name: quantile_above(efficiency[some], HIGH, SHARE) for name, some in of_family.items()})

    control_efficiency = {name: 1 / (1 + by_size[0]) for name, by_size in controls.items()}
    return [controlled("gain-for-all", gain, [of_size[:, 1] for of_size in u], controls,
                   f"{about}; {len(finer.pictures)} of them also at {2 * pes} x {2 * pes}",
                   f"u({p}) is lower than u(0) in {gains[0].sum()} of {len(gains[0])} pictures and, at twice the size, in {gains[1].sum()} of "
                   f"{len(gains[1])}."),
            judged("neighbours-alike", above(alike, ALIKE, families), about,
                   f"The mean correlation is {estimate(alike, families).text()}, the lowest one {alike.min():.2f}."),
            controlled("columns-vary", varies_less, efficiency[:, 1], control_efficiency, about,
                   f"The mean absolute deviation of the efficiency is {deviation[:, 0].mean():.3f} for the column split and "
                   f"{deviation[:, 1].mean():.3f} for the cyclic mapping."),
            controlled("cyclic-is-high", high, efficiency[:, 1], control_efficiency, about,
                   f"Pictures with an efficiency of {HIGH} or more: {shares}; the lowest is {efficiency[worst, 1]:.3f}, "
                   f"{ensemble.pictures[worst].label}."),
            controlled("other-problems", lambda u: above(windows[:, 0] - u), windows[:, 1], dict(zip(CONTROLS, windows[:, 2:].T)),
                   f"{len(windows)} windows of the Mandelbrot set",
                   f"The mean u falls by {estimate(windows[:, 0] - windows[:, 1]).text()} from p = 0 to {p}, to {estimate(windows[:, 1]).text()}.")]


def comparisons_of(rows, split_column, cyclic_column, pes):
    first = rows.iloc[0]
    same = pes == papers.PES and first["scene"] == "centre" and first["side (pixels)"] == papers.SIZE
    name = "{0} at {1} x {1}".format(first["scene"], first["side (pixels)"])
    source = "Kohata & Ito: their most unbalanced image" if same else ""
    return [*with_paper(same, [Comparison(f"{name}, p = 0", "", papers.EFFICIENCY_0, first[split_column], source, True),
                               Comparison(f"{name}, cyclic", "", papers.EFFICIENCY_16, first[cyclic_column], source, True)]),
            *(Comparison(f"{which} of all, {name}", "", None, value, remark)
              for name, column, about in (("p = 0", split_column, "differs strongly between images"), ("cyclic", cyclic_column, "high for all images"))
              for which, value, remark in (("lowest", rows[column].min(), f"Kohata & Ito: {about}"), ("highest", rows[column].max(), "")))]


def plots_of(rows, groups, split_column, cyclic_column, pes, p):
    """Returns plots of the efficiency of each scene and of its distribution over the pictures."""
    names = rows["scene"][rows["side (pixels)"] == rows["side (pixels)"].iloc[0]].tolist()
    series = [Series(f"p = {offset} at {side} x {side}", range(1, len(image_rows) + 1), image_rows[column], "points")
              for offset, column in ((p, cyclic_column), (0, split_column))
              for side, image_rows in rows.groupby("side (pixels)", sort=False)]
    if pes == papers.PES and rows["scene"].iloc[0] == "centre":
        series.append(Series("Kohata & Ito, their most unbalanced image", [1, 1], [papers.EFFICIENCY_0, papers.EFFICIENCY_16],
                             "paper"))
    distributions = [Series(f"{name}, {label}", 100 * np.arange(1, len(image_rows) + 1) / len(image_rows), np.sort(image_rows[column]), "steps")
                     for label, image_rows in groups.items() if not label.startswith("scenes")
                     for name, column in (("cyclic", cyclic_column), ("p = 0", split_column))]
    return [Plot("images", "Efficiency of each scene", "scene", "efficiency", series, x_names=names),
            Plot("images-groups", "Distribution of the efficiency over the pictures", "pictures with at most this efficiency (%)",
                 "efficiency", distributions)]
