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
- Rotations each way: of the ring, to exchange neighbouring rows: min(p, P - p) + 1, for P <= W.
- The random mapping gives each pixel to a random PE, with equally many pixels for every PE (one permutation for each picture).
- Intervals (+-): 95 %, hierarchical: families are drawn at random, and pictures within each family (bootstrap).
- Output: offsets.csv has, for each number of PEs P, the mean u of each way to choose the offset. offsets-accuracy.csv compares predictions with
  the measured u of all offsets of the same picture.
"""
import numpy as np
import pandas as pd
import raya
from raya.lab import Page, Plot, Series, Table, range_text, study
from raya.lab.laboratory import WIDE_FAMILIES
from raya.lab.statistics import hierarchical
from scipy.stats import norm, spearmanr

PES = [4**k for k in range(2, 9)]  # 16 to 65,536
GOLDEN = (5**0.5 - 1) / 2


def dual_points(pes, offset, width):
    """Returns the points (fx, fy), in cycles per pixel, at which the spectrum of the cost image determines the loads' variance. `pes` must divide
    the width, or be a multiple of it."""
    steps = max(1, pes // width)
    slots = pes // steps
    j, m = (part.ravel()[1:] for part in np.meshgrid(np.arange(slots), np.arange(steps), indexing="ij"))
    return j / slots, m / steps - j * offset / slots


def ring_spectrum(cost):
    """Returns the mean power of the relative costs on rings of radius 0, 1, 2 ... cycles per image, for images of equal sides."""
    size = len(cost)
    power = np.abs(np.fft.fft2(cost / cost.mean() - 1))**2 / cost.size**2
    cycles = np.fft.fftfreq(size) * size
    ring = np.rint(np.hypot(*np.meshgrid(cycles, cycles))).astype(int).ravel()
    return np.bincount(ring, power.ravel()) / np.bincount(ring)


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


def imbalance(loads):
    return loads.max() / loads.mean() - 1


def random_u(cost, pes, seed):
    return imbalance(np.bincount(np.random.default_rng(seed).permutation(cost.size) % pes, cost.ravel(), pes))


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
    chosen = {"column split (p = 0)": 0, "p = sqrt(P)": root % count, "p = sqrt(P) / k": root // sharing, "longest dual vector": shortest.argmax(),
              "golden ratio": round(count * GOLDEN), "predicted, own": own.argmin(1),
              "predicted, others": [others[names.index(name)].argmin() for name in ensemble.families], "best of all offsets": u.argmin(1)}
    chosen = {name: np.broadcast_to(p, len(u)) for name, p in chosen.items()}
    values = {name: u[np.arange(len(u)), p] for name, p in chosen.items()}
    values["2-D grid"] = ensemble.map(lambda costs: imbalance(raya.loads(costs.trace, pes=pes, mapping=f"grid:{root}x{root}")))
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
            mean, loss = hierarchical(values, families), hierarchical(values - root, families)
            rows.append({"P": pes, "mapping": name, "mean u": mean.mean, "+-": mean.half, "mean u - u(sqrt(P))": loss.mean,
                         "+-, difference": loss.half, "better than sqrt(P) (pictures)": int((values < root).sum()),
                         "rotations each way": np.minimum(chosen[name], pes - chosen[name]).mean() + 1
                         if name in chosen and pes <= size else np.nan})
        ranks = np.array([spearmanr(*pair)[0] for pair in zip(own, u) if min(map(np.ptp, pair)) > 0])  # undefined for a constant
        ratio = np.median(own / np.maximum(u, 1e-12), axis=1)
        accuracy.append({"P": pes, "median rank correlation": np.median(ranks), "rank correlations": range_text(ranks, 2),
                         "median predicted / measured u": np.median(ratio), "10 % of pictures below": np.quantile(ratio, 0.1),
                         "10 % of pictures above": np.quantile(ratio, 0.9)})
    rows, accuracy = pd.DataFrame(rows), pd.DataFrame(accuracy)
    reference = rows[rows["mapping"] == "p = sqrt(P) / k"].set_index("P")["mean u"]
    series = [Series(name, group["P"], group["mean u"] / group["P"].map(reference)) for name, group in rows.groupby("mapping", sort=False)]

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
                        Table("offsets-accuracy", "Predictions and measured u over all offsets of a picture", accuracy)],
                plots=[Plot("offsets", "Mean load imbalance relative to that of p = sqrt(P) / k", "PEs", "mean u / mean u(sqrt(P) / k)", series, "xy")],
                placeholders={"ensemble": ensemble.description})
