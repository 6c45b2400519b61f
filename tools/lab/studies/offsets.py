"""Predicting the best offset from the autocorrelation of the costs

Why does an offset p balance the load, and does the autocorrelation of a picture's costs predict the best one?

- The load of a PE is the sum of the costs (modelled cycles) of its pixels. Slot s of row y holds column (s + p y) mod W, so the load is a sum over a
  lattice of pixels. Its discrete Fourier transform over the PEs equals the Fourier transform of the cost image at the P points of the dual lattice:
  (j / P, -j p / P), j = 0..P - 1, in cycles per pixel; for P = k W PEs (j / W, m / k - j p / W), m = 0..k - 1. So the variance of the loads is the sum
  of the image's power spectrum at these points without (0, 0). The spectrum is the Fourier transform of the autocorrelation (Wiener & Khinchin).
- Prediction: the spectrum is taken as equal in all directions (its mean on rings around 0), and u = (expected maximum of P normal values) x
  (standard deviation of the loads) / (mean load). "own": spectrum of the picture itself. "others": mean spectrum of the other families.
- Ensemble: {ensemble}, {size} x {size} pixels; first pass. Offsets 0..min(P, W) - 1. All mappings are applied to the same pictures.
- P > W: the rows are dealt to P / W PEs of each slot in turn, so a PE's rows are k = P / W apart and their shift is k p mod W.
- "sqrt(P) / k": for P = k W its lattice is nearly square again. "Longest dual vector": the offset whose dual lattice has the longest shortest vector.
  "2-D grid": a PE has every sqrt(P)-th pixel of every sqrt(P)-th row, as on CAP and the Pixel Machine.
- "golden ratio": Chor, Leiserson, Rivest & Shearer 1986. "diagonal" and "offset and shift": the patterns of Kerbl et al. 2017, as their renderer cuRE
  has them: a row is shifted by 1 pixel; by sqrt(P), and once more after every sqrt(P) rows. "bit reversal": van Antwerpen et al. 2019, strips of
  pixels in bit-reversed order, 16 strips or all pixels for each PE.
- Rotations each way: of the ring, to exchange neighbouring rows: min(p, P - p) + 1, for P <= W.
- Time: computing with the largest load and one exchange of neighbours, 2 (min(p, P - p) + 1) rotations at a multiple of the SPA's link rate, relative to
  computing with equal loads. Modelled.
- With a tree: four views of each of four scenes, u without and with raya's BVH, whose tests and steps the costs then count.
- The random mapping gives each pixel to a random PE, with equally many pixels for every PE (one permutation for each picture).
- Intervals (+-): 95 %; the families are strata, so they hold for these families.
- Output: offsets.csv has, for each number of PEs P, the mean u of each way to choose the offset. offsets-accuracy.csv compares predictions with
  the measured u of all offsets of the same picture.
"""
import numpy as np
import pandas as pd
import raya
from raya.lab import Page, Plot, Series, Table, estimate, fitted_exponent, range_text, study
from raya.lab.claims import CONTROLS
from raya.lab.laboratory import SPA, WIDE_FAMILIES, imbalance, view_of
from raya.lab.spa import FACTOR, spa_ms
from scipy.stats import norm, spearmanr

PES = [4**k for k in range(2, 9)]  # 16 to 65,536
LINK_RATES = (1, 10, 100)  # multiples of the SPA's rate, including the synchronisation of a rotation
TREE_VIEWS = 4
FAR_OFF = ("column split (p = 0)", "p = sqrt(P)", "p = sqrt(P) / k", "diagonal", "bit reversal", "random")  # not in the plot, whose scale they would change
GOLDEN = (5**0.5 - 1) / 2


def dual_points(pes, offset, width):
    """Returns the points (fx, fy), in cycles per pixel, at which the spectrum of the cost image determines the loads' variance. `pes` must divide
    the width, or be a multiple of it."""
    steps = max(1, pes // width)
    slots = pes // steps
    j, m = (part.ravel()[1:] for part in np.meshgrid(np.arange(slots), np.arange(steps), indexing="ij"))
    return j / slots, m / steps - j * offset / slots


def power_spectrum(cost):
    """Returns the power of the relative costs, [vertical, horizontal frequency] in cycles per image."""
    return np.abs(np.fft.fft2(cost / cost.mean() - 1))**2 / cost.size**2


def ring_spectrum(cost):
    """Returns the mean power of the relative costs on rings of radius 0, 1, 2 ... cycles per image, for images of equal sides."""
    size, power = len(cost), power_spectrum(cost)
    cycles = np.fft.fftfreq(size) * size
    ring = np.rint(np.hypot(*np.meshgrid(cycles, cycles))).astype(int).ravel()
    return np.bincount(ring, power.ravel()) / np.bincount(ring)


def spectrum_rows(ensemble, spectra):
    """Returns rows with the exponent e of the fit power = c f^-e of each family's pictures, for 4 cycles per image to half the highest frequency; and
    the power at vertical and at horizontal frequencies relative to the mean of their rings."""
    top = len(ensemble.pictures[0].trace) // 4
    cycles = np.arange(4, top + 1)
    exponents = np.array([-fitted_exponent(cycles, spectrum[cycles]) for spectrum in spectra])
    axes = np.array([[np.mean(axis[cycles] / spectrum[cycles]) for axis in (power[:, 0], power[0])]
                     for costs, spectrum in zip(ensemble.pictures, spectra) for power in [power_spectrum(costs.trace.astype(float))]])
    families = np.array(ensemble.families)
    groups = {name: families == name for name in dict.fromkeys(ensemble.families)} | {"all": families != ""}
    return [{"family": name, "pictures": int(some.sum()), "exponent": exponents[some].mean(), "least": exponents[some].min(),
             "largest": exponents[some].max(), "vertical / ring": axes[some, 0].mean(), "horizontal / ring": axes[some, 1].mean(),
             "hexagonal lattice gains (%)": 100 * hexagonal_gain(exponents[some].mean())} for name, some in groups.items()]


def hexagonal_gain(exponent, radius=200):
    """Returns by which fraction the standard deviation of the loads with a hexagonal dual lattice is below that with a square one of the same density,
    if power = c f^-exponent; nan if the exponent is at most 2, where the sum diverges. Sums the points within the radius; the others are alike for
    both lattices."""
    if exponent <= 2:
        return np.nan
    i, j = np.meshgrid(*[np.arange(-2 * radius, 2 * radius + 1)] * 2)
    scale = (2 / 3**0.5)**0.5  # side of the hexagonal lattice's cells of area 1

    def variance(squares):
        squares = squares[(squares > 0) & (squares <= radius**2)]
        return (squares**(-exponent / 2)).sum() + 2 * np.pi * radius**(2 - exponent) / (exponent - 2)

    return 1 - (variance(scale**2 * (i * i + i * j + j * j)) / variance(1.0 * (i * i + j * j)))**0.5


def expected_maximum(count):
    """Returns the approximate expected maximum of `count` standard normal values (Blom 1958)."""
    return norm.ppf((count - 0.375) / (count + 0.25))


def dual_lengths(pes, offset, size):
    """Returns the lengths, in cycles per image, of the shortest vectors to the points of dual_points(), which repeat with period 1."""
    return size * np.hypot(*((part + 0.5) % 1 - 0.5 for part in dual_points(pes, offset, size)))


def ring_weights(pes, offset, size):
    """Returns how often the P points of dual_points() lie on each ring of ring_spectrum(); points between two rings count for both, linearly."""
    rings = round(size * 0.5**0.5) + 1
    distance = dual_lengths(pes, offset, size)
    inner = np.minimum(distance.astype(int), rings - 2)
    share = np.minimum(distance - inner, 1)
    return np.bincount(inner, 1 - share, rings) + np.bincount(inner + 1, share, rings)


def predicted_u(spectra, pes, offsets, size):
    """Returns the predicted load imbalance of the cyclic mapping for images of size x size pixels: an array [spectrum, offset]. Rounded, so that two
    offsets with the same prediction, such as p and W - p, are equal on every computer."""
    weights = np.array([ring_weights(pes, p, size) for p in offsets])
    return np.round(expected_maximum(pes) * (spectra @ weights.T)**0.5, 12)


def pattern_owners(size, pes):
    """Returns {pattern: the PE of each pixel} of the patterns by others that are no cyclic mapping."""
    y, x = np.indices((size, size))
    root, pixels = round(pes**0.5), size * size
    strips = min(16 * pes, pixels)
    bits = strips.bit_length() - 1
    strip = np.arange(pixels) * strips // pixels
    reversed_strip = sum((strip >> bit & 1) << bits - 1 - bit for bit in range(bits))
    return {"offset and shift": ((x + root * y + y // root) % pes).ravel(), "bit reversal": reversed_strip * pes // strips}


def relative_time(u, offset, pes, costs, rate):
    """Returns the modelled time of computing and one exchange of neighbours relative to computing with equal loads. rate: one of LINK_RATES."""
    rotation_ms = SPA["rotation_sync_ms"] + 1e3 * 3 * costs.trace.size / pes / SPA["link_words_per_s"]
    mean_ms = FACTOR * spa_ms(int(costs.trace.sum())) / pes
    return 1 + u + 2 * (min(offset, pes - offset) + 1) * rotation_ms / rate / mean_ms


def tree_rows(lab, size):
    """Returns rows with the mean u of views of a scene, without and with the BVH, and the difference at sqrt(P) within the same view."""
    rows = []
    for name, scene in {"balls-3": raya.generate.balls(3), "lattice-4": raya.generate.lattice(4), "gears-2": raya.generate.gears(2),
                        "random-2000": raya.generate.random(2000)}.items():
        make = view_of(scene.renamed(name))
        views = {accel: [lab.costs(make(lab.seed + i), size, accel=accel).trace for i in range(TREE_VIEWS)] for accel in ("none", "bvh")}
        u = {(accel, label): np.array([imbalance(raya.loads(cost, pes=size, **options)) for cost in costs]) for accel, costs in views.items()
             for label, options in {"p = sqrt(P)": {"offset": round(size**0.5)}, "column split": {"offset": 0}, **CONTROLS}.items()}
        with_tree = estimate(u["bvh", "p = sqrt(P)"] - u["none", "p = sqrt(P)"])
        rows.append({"scene": name, "objects": scene.objects, **{f"u, {accel}, {label}": values.mean() for (accel, label), values in u.items()},
                     "difference": with_tree.mean, "+-": with_tree.half})
    return rows


def random_u(cost, pes, seed):
    return imbalance(raya.loads(cost, pes=pes, mapping=f"random:{seed}"))


def measure(ensemble, spectra, pes, size):
    """spectra: ring_spectrum() of each picture. Returns ({mapping: u of each picture}, {mapping: offset of each picture, for mappings with an offset},
    measured u [picture, offset], predicted u [picture, offset])."""
    count = min(pes, size)
    offsets, sharing, root = range(count), max(1, pes // size), round(pes**0.5)  # sharing: PEs that share a column
    families = np.array(ensemble.families)
    names = list(dict.fromkeys(ensemble.families))
    own = predicted_u(spectra, pes, offsets, size)
    others = predicted_u(np.array([spectra[families != name].mean(0) for name in names]), pes, offsets, size)
    shortest = np.round([dual_lengths(pes, p, size).min() for p in offsets], 9)
    u = ensemble.map(lambda costs: raya.imbalances(costs.trace, pes, offsets))
    chosen = {"column split (p = 0)": 0, "p = sqrt(P)": root % count, "p = 3/4 sqrt(P)": round(0.75 * root) % count, "p = sqrt(P) / k": root // sharing, "longest dual vector": shortest.argmax(),
              "golden ratio": round(count * GOLDEN), "diagonal": 1, "predicted, own": own.argmin(1),
              "predicted, others": [others[names.index(name)].argmin() for name in ensemble.families], "best of all offsets": u.argmin(1)}
    chosen = {name: np.broadcast_to(p, len(u)) for name, p in chosen.items()}
    values = {name: u[np.arange(len(u)), p] for name, p in chosen.items()}
    values["2-D grid"] = ensemble.map(lambda costs: imbalance(raya.loads(costs.trace, pes=pes, mapping=f"grid:{root}x{root}")))
    values |= {name: ensemble.map(lambda costs, owners=owners: imbalance(np.bincount(owners, costs.trace.ravel(), pes)))
               for name, owners in pattern_owners(size, pes).items()}
    values["random"] = np.array([random_u(costs.trace, pes, seed) for seed, costs in enumerate(ensemble.pictures)])
    return values, chosen, u, own


@study("offsets", prepare=lambda lab, scenes: lab.ensemble(scenes, lab.size(256), families=WIDE_FAMILIES))
def offsets(lab, scenes):
    size = lab.size(256)
    ensemble = lab.ensemble(scenes, size, families=WIDE_FAMILIES)
    families, rows, accuracy = ensemble.families, [], []
    spectra = ensemble.map(lambda costs: ring_spectrum(costs.trace.astype(float)))
    for pes in [pes for pes in PES if 16 * pes <= size * size and (size % pes == 0 or pes % size == 0)]:
        mappings, chosen, u, own = measure(ensemble, spectra, pes, size)
        root = mappings["p = sqrt(P)"]
        for name, values in mappings.items():
            mean, loss = estimate(values, families), estimate(values - root, families)
            rows.append({"P": pes, "mapping": name, "mean u": mean.mean, "+-": mean.half, "mean u - u(sqrt(P))": loss.mean,
                         "+-, difference": loss.half, "better than sqrt(P) (pictures)": int((values < root).sum()),
                         "rotations each way": np.minimum(chosen[name], pes - chosen[name]).mean() + 1
                         if name in chosen and pes <= size else np.nan,
                         **{f"time, links x {rate}": np.mean([relative_time(*one, pes, costs, rate) for *one, costs in zip(
                             values, chosen[name], ensemble.pictures)]) if name in chosen and pes <= size else np.nan for rate in LINK_RATES}})
        ranks = np.array([spearmanr(*pair)[0] for pair in zip(own, u) if min(map(np.ptp, pair)) > 0])  # undefined for a constant
        ratio = np.median(own / np.maximum(u, 1e-12), axis=1)
        accuracy.append({"P": pes, "median rank correlation": np.median(ranks), "rank correlations": range_text(ranks, 2),
                         "median predicted / measured u": np.median(ratio), "10 % of pictures below": np.quantile(ratio, 0.1),
                         "10 % of pictures above": np.quantile(ratio, 0.9)})
    rows, accuracy = pd.DataFrame(rows), pd.DataFrame(accuracy)
    shown = rows[(rows["P"] == rows["P"][rows["P"] <= size].max()) & ~rows["mapping"].isin(FAR_OFF)]

    def differences(name):
        chosen = rows[rows["mapping"] == name]
        low, high = chosen["mean u - u(sqrt(P))"] + chosen["+-, difference"], chosen["mean u - u(sqrt(P))"] - chosen["+-, difference"]
        return (f"{name}: u is lower than with p = sqrt(P) for P = {', '.join(map(str, chosen['P'][low < 0])) or 'none'}, and higher for P = "
                f"{', '.join(map(str, chosen['P'][high > 0])) or 'none'} (95 % intervals of the difference).")

    findings = [differences(name) for name in ("predicted, own", "predicted, others", "golden ratio", "p = sqrt(P) / k", "longest dual vector", "2-D grid",
                                                  "random", "column split (p = 0)")] + [
            f"The median of predicted / measured u is {range_text(accuracy['median predicted / measured u'], 2)} over the numbers of PEs; the median rank "
            f"correlation over the offsets of a picture is {range_text(accuracy['median rank correlation'], 2)}."]
    return Page({"size": size, "pictures": len(families), "families": len(set(families))}, findings,
                tables=[Table("offsets", "Mean u of each choice of the offset", rows),
                        *([Table("offsets-tree", "u without and with a tree", tree_rows(lab, size))] if not scenes else []),
                        Table("offsets-spectrum", "Fall of the power with the frequency", spectrum_rows(ensemble, spectra)),
                        Table("offsets-accuracy", "Predictions and measured u over all offsets of a picture", accuracy)],
                plots=[Plot("offsets", f"Mean load imbalance minus that of p = sqrt(P), {shown['P'].iloc[0]} PEs", "mapping", "mean of u - u(sqrt(P))",
                            [Series("difference", range(1, len(shown) + 1), shown["mean u - u(sqrt(P))"], "points", shown["+-, difference"])],
                            x_names=shown["mapping"].tolist())],
                placeholders={"ensemble": ensemble.description})
