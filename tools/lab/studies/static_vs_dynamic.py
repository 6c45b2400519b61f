"""Static against dynamic distribution

Are static strategies inadequate from 128 PEs on, and static plus dynamic ones nearly optimal, as Heirich and Arvo (1998) found?

- Source: Heirich & Arvo 1998, conclusions.
- Images of {size} x {size} pixels on 128 and more PEs of the SPA. Makespan = the time at which the last PE has finished, in cycles of the
  instruction budget. Efficiency = sum of all pixels' cycles / (P x makespan).
- Lower bound of the makespan: the larger of the mean load of a PE and the highest cost of a pixel. We call a strategy nearly optimal if its
  makespan is at most 1.1 times the lower bound.
- Static strategies: column split; cyclic mapping with p = 16 and p = sqrt(P); blocks of contiguous scan lines; tiles of 8 x 8 pixels, one after
  the other to each PE in turn; the 2-D grid of A x B PEs nearest to a square (a PE has every B-th pixel of every A-th line); random.
- dynamic:C: an idle PE takes the next C pixels. hybrid:C, share S: each PE first processes the fraction S of its own pixels (those of the 2-D
  grid, row by row from the top), then takes C pixels at a time of all pixels that are left. A discrete-event simulation on the pixels' costs
  gives the makespan.
- The SPA had no dynamic distribution. We assume that a request costs its PE {request_cycles} budget cycles: one word to the root and two words
  back at 6 Mword/s, each message with the 0.18 ms in which a rotation synchronises all PEs. This is the maximum; with "free requests", the
  minimum, a request costs nothing. Requests do not wait for each other, except in the table of LINKS-1.
- In LINKS-1 (Nishimura et al. 1985) a root answers one request at a time; we assume {request_cycles} budget cycles for each.
- A case is a scene on one number of PEs. The clock's factor is the number of the SPA's cycles for one budget cycle. It changes the cost of a
  request in budget cycles, so one table counts cases for three factors from 1 to 8.
- The claims use {ensemble}, at {claim_size} x {claim_size} pixels on {claim_pes} PEs.
- Classes of scenes: {classes}, {claim_size} x {claim_size} pixels. Of each picture: the first P at which the best static strategy has an efficiency
  below 90 %, and the first P from which on the best dynamic or hybrid strategy, requests included, is faster than the best static one by 10 %.
- Output: static-vs-dynamic.csv has a row for each scene, strategy and P. static-vs-dynamic-limits.csv has the first P with an efficiency below
  90 % and 50 %, static-vs-dynamic-classes.csv the classes, static-vs-dynamic-factors.csv the numbers of cases, static-vs-dynamic-root.csv LINKS-1.
"""
import math
from itertools import product

import numpy as np
import pandas as pd
import raya
from raya.lab import Page, Plot, Series, Table, above, counted, estimate, every, first_from, judged, papers, study
from raya.lab.laboratory import MACHINES, WIDE_FAMILIES
from raya.lab.spa import CLOCK, FACTOR, FACTORS
from raya.lab.studies.scale import squarest_grid
from raya.lab.voxels import powers_of_two

NAME, MIN_PES, MAX_PES = "static-vs-dynamic", 128, 16_384
NEAR_OPTIMAL = 1.1  # maximum makespan / lower bound of a nearly optimal strategy: our choice
SQUARE_ROOT = "cyclic, p = sqrt(P)"
CLASS_PES = tuple(2**k for k in range(6, 13))  # 1024 to 16 pixels a PE
CLASS_LIMITS = "P, static under 90 %", "P, dynamic faster by 10 %"
ROOT_CHUNKS, ROOT_PES = tuple(4**i for i in range(7)), (64, 256, 1024)  # pixels a request and numbers of PEs in the table of LINKS-1


def request_cycles(factor):
    """Returns the number of budget cycles from a PE's request for work to the answer: one word to the root, two words back."""
    return round(MACHINES["links"]["root_cycles"] * FACTOR / factor)


def static_mappings(size, pes):
    tile = math.gcd(size, 8)
    return {"column split": {"mapping": "column"}, "cyclic, p = 16": {"offset": 16 % size},
            SQUARE_ROOT: {"offset": round(pes**0.5) % size}, "blocks of scan lines": {"mapping": "blocks"},
            "tiles 8 x 8": {"mapping": f"tiles:{tile}x{tile}"}, "grid": {"mapping": squarest_grid(pes)},
            "random": {"mapping": "random:1"}}


def plans(overhead):
    """Yields (name, kind, True if requests take time, plan for raya.schedule()) of each dynamic or hybrid strategy."""
    for chunk, share in ((1, 0), (16, 0), (64, 0), (16, 0.5), (16, 0.9), (1, 0.9)):
        kind = "hybrid" if share else "dynamic"
        name = f"{kind}:{chunk}" + (f", share {share}" if share else "")
        for cost in (0, overhead):
            plan = f"{kind}:{chunk},{cost}" + (f",{share}" if share else "")
            yield name + ("" if cost else ", free requests"), kind, cost > 0, plan


def outcomes_of(label, image, sizes, overhead):
    """Returns a table with a row for each strategy and number of PEs. label: name of the scene; overhead: budget cycles of a request."""
    size, total, rows = len(image), int(image.sum()), []
    for pes in sizes:
        bound, mappings = raya.lower_bound(image, pes), static_mappings(size, pes)
        outcomes = [(name, "static", False, int(raya.loads(image, pes=pes, **options).max()), 0) for name, options in mappings.items()]
        for name, kind, pays, plan in plans(overhead):
            run = raya.schedule(image, plan, pes=pes, **mappings["grid" if kind == "hybrid" else "column split"])
            outcomes.append((name, kind, pays, run["makespan"], run["requests"]))
        rows += [{"scene": label, "strategy": name, "P": pes, "makespan (cycles)": makespan, "efficiency": total / (pes * makespan),
                  "makespan / lower bound": makespan / bound, "requests": requests, "kind": kind, "pays": pays, "bound": total / (pes * bound)}
                 for name, kind, pays, makespan, requests in outcomes]
    return pd.DataFrame(rows).sort_values("strategy", key=lambda names: pd.factorize(names)[0], kind="stable",
                                          ignore_index=True)


def makespans(image, overhead, pes):
    """Returns (makespan of the best static strategy, of the best dynamic or hybrid strategy with requests)."""
    mappings = static_mappings(len(image), pes)
    start = {"dynamic": mappings["column split"], "hybrid": mappings["grid"]}
    return (min(int(raya.loads(image, pes=pes, **options).max()) for options in mappings.values()),
            min(raya.schedule(image, plan, pes=pes, **start[kind])["makespan"] for _, kind, pays, plan in plans(overhead) if pays))


def class_rows(ensemble):
    """Returns a table of scene families: from which P on static strategies stop being enough. Median and 10 % .. 90 % quantiles of the pictures."""
    rows = []
    for family in dict.fromkeys(ensemble.families):
        images = [costs.trace for name, costs in zip(ensemble.families, ensemble.pictures) if name == family]
        first_below_90, first_faster = [], []
        for image in images:
            static, dynamic = np.array([makespans(image, request_cycles(FACTOR), pes) for pes in CLASS_PES]).T
            first_below_90.append(first_from(CLASS_PES, image.sum() / (np.array(CLASS_PES) * static) < 0.9, np.inf))
            first_faster.append(first_from(CLASS_PES, dynamic * NEAR_OPTIMAL < static, np.inf))
        row = {"class": family, "pictures": len(images)}
        for what, values in zip(CLASS_LIMITS, (first_below_90, first_faster)):
            low, median, high = (str(int(pes)) if pes < np.inf else "never" for pes in np.quantile(values, [0.1, 0.5, 0.9], method="inverted_cdf"))
            row |= {f"{what}, median": median, f"{what}, 10 % .. 90 %": f"{low} .. {high}"}
        rows.append(row)
    return pd.DataFrame(rows)


def finding_of_classes(rows):
    def summary(what):
        medians = rows[f"{what}, median"]
        reached = [int(pes) for pes in medians if pes != "never"]
        never = len(medians) - len(reached)
        return (f"from P = {min(reached)} .. {max(reached)} on, depending on the class" if reached else "in no class") + (
            f" (in {never} of {len(rows)} classes not up to P = {CLASS_PES[-1]})" if never and reached else "")

    return (f"Classes of scenes, median picture: the efficiency of the best static strategy is below 90 % {summary(CLASS_LIMITS[0])}. Dynamic or hybrid "
            f"distribution is faster by 10 % {summary(CLASS_LIMITS[1])}.")


def root_rows(images):
    """Returns a table of dynamic distribution: efficiency if requests are free, and if a root answers one at a time, as in LINKS-1."""
    rows = []
    for (name, image), pes, chunk in product(images.items(), ROOT_PES, ROOT_CHUNKS):
        free, serial = (raya.schedule(image, f"dynamic:{chunk},0,{cycles}", pes=pes) for cycles in (0, request_cycles(FACTOR)))
        rows.append({"scene": name, "P": pes, "pixels a request": chunk, "requests": serial["requests"],
                     "efficiency, free requests": free["speedup"] / pes, "efficiency, one at a time": serial["speedup"] / pes})
    return pd.DataFrame(rows)


def best_of(rows, kind):
    """Returns, for each P, the row of the best strategy of a kind, without the strategies with free requests."""
    strategies = rows[(rows["kind"] == kind) & (rows["pays"] | (kind == "static"))]
    return strategies.loc[strategies.groupby("P", sort=True)["makespan (cycles)"].idxmin()].reset_index(drop=True)


def counts_of(scenes):
    """Returns {name: number of cases}: of all cases, and of those in which no static strategy is near the bound, in which a hybrid is near the
    bound, and in which a hybrid is faster than all static strategies. A case is a scene on one number of PEs."""
    static, hybrid = (pd.concat([best_of(rows, kind) for rows in scenes]) for kind in ("static", "hybrid"))
    return {"cases": len(static), "no static one near the bound": (static["makespan / lower bound"] > NEAR_OPTIMAL).sum(),
            "hybrid near the bound": (hybrid["makespan / lower bound"] <= NEAR_OPTIMAL).sum(),
            "hybrid beats all static ones": (hybrid["makespan (cycles)"].values <
                                             static["makespan (cycles)"].values).sum()}


def ensembles_of(lab, scenes):
    """Returns the ensemble of the classes, and that of the claims; None instead of the latter if the command names scenes."""
    return lab.ensemble(scenes, CLAIM_SIZE, families=WIDE_FAMILIES), None if scenes else lab.ensemble([], CLAIM_SIZE, views=CLAIM_VIEWS)


@study(NAME, prepare=ensembles_of)
def static_vs_dynamic(lab, scenes):
    size = lab.size(512)
    default_scenes = [raya.example("centre"), raya.generate.random(200, 200).renamed("random-200"),
                      raya.generate.balls(3).renamed("balls-3")]
    sizes = [p for p in powers_of_two(min(MAX_PES, size * size)) if p >= MIN_PES]
    images = {scene.name: lab.costs(scene, size).trace for scene in scenes or default_scenes}
    of_classes, of_claims = ensembles_of(lab, scenes)
    classes = class_rows(of_classes)
    by_factor = {f: [outcomes_of(name, image, sizes, request_cycles(f)) for name, image in images.items()]
                 for f in (FACTORS[0], FACTOR, FACTORS[-1])}
    tables_by_scene = by_factor[FACTOR]
    factors = pd.DataFrame([{"factor": f, "request (budget cycles)": request_cycles(f), **counts_of(rows)}
                            for f, rows in by_factor.items()])
    tables, plots, of_root = [], [], root_rows(images)
    for number, rows in enumerate(tables_by_scene, 1):
        percent = 100 * rows.pivot_table("efficiency", "strategy", "P", sort=False)
        percent.loc["upper bound"] = 100 * rows.groupby("P")["bound"].first()
        tables.append(Table(f"{NAME}-{number}", f"Efficiency (%) for each P, {rows['scene'][0]}",
                            percent.rename(columns=str).reset_index()))
        plots += plots_of(rows, percent, number)
    outcomes = pd.concat(tables_by_scene, ignore_index=True)
    limits = outcomes.groupby(["scene", "strategy"], sort=False).apply(
        lambda one: pd.Series({f"P, under {100 * limit:.0f} %": next(iter(one["P"][one["efficiency"] < limit]), "never")
                               for limit in (0.9, 0.5)})).reset_index()
    shown = outcomes.drop(columns=["kind", "pays", "bound"])
    of_first_scene = of_root[of_root["scene"] == outcomes["scene"][0]]
    at_256 = of_first_scene[of_first_scene["P"] == ROOT_PES[1]]
    one_pixel, best = at_256.iloc[0], at_256.loc[at_256["efficiency, one at a time"].idxmax()]
    counts = counts_of(tables_by_scene)
    inadequate, cases = counts["no static one near the bound"], counts["cases"]
    how = "holds" if inadequate == cases else "holds in part" if inadequate else "does not hold"
    plots.append(Plot(f"{NAME}-root", f"One request at a time, {outcomes['scene'][0]}", "pixels a request", "efficiency",
                      [Series(f"P = {pes}", group["pixels a request"], group["efficiency, one at a time"])
                       for pes, group in of_first_scene.groupby("P")], "x"))
    return Page({"size": size, "pes": sizes, "factor": FACTOR, "request_cycles": request_cycles(FACTOR),
                 "random_seed": 1, "scenes": list(images)},
                [f"The statement that static strategies are inadequate from {outcomes['P'].min()} PEs on {how} here: in {inadequate} "
                 f"of {cases} cases (a scene on one number of PEs) no static strategy is within 10 % of the lower bound. The best hybrid, "
                 f"including the cost of requests, is within 10 % in {counts['hybrid near the bound']} cases. It is faster than every static "
                 f"strategy in {counts['hybrid beats all static ones']} cases.", finding_of_classes(classes)],
                claims=claims_of(of_claims) if of_claims else [],
                tables=tables + [Table(f"{NAME}-limits", "The first P at which the efficiency is below 90 % and below "
                                       "50 %", limits),
                                 Table(f"{NAME}-classes", "The first P at which static distribution is not enough, in each class of scenes", classes),
                                 Table(f"{NAME}-root", "LINKS-1: efficiency for each number of pixels a request", of_root),
                                 Table(NAME, "Every strategy, scene and number of PEs", shown, on_page=False),
                                 Table(f"{NAME}-factors", "Numbers of cases (a scene on one number of PEs) for each factor of the clock",
                                       factors)],
                plots=plots,
                news=[f"If a root answers one request at a time, as in LINKS-1, {ROOT_PES[1]} PEs have an efficiency of "
                      f"{100 * one_pixel['efficiency, one at a time']:.0f} % with one pixel a request and of "
                      f"{100 * best['efficiency, one at a time']:.0f} % with {best['pixels a request']} pixels a request ({one_pixel['scene']})."],
                clock=CLOCK, compared_with=papers.DYNAMIC,
                placeholders={"ensemble": of_claims.description if of_claims else "no ensemble", "classes": of_classes.description,
                              "claim_size": CLAIM_SIZE, "claim_pes": ", ".join(map(str, CLAIM_PES))})


CLAIM_SIZE, CLAIM_PES, CLAIM_VIEWS = 256, (128, 256, 1024, 4096), 36


def claims_of(ensemble):
    """Judges the claims of Heirich & Arvo, and the claim of Kohata & Ito on dynamic distribution."""
    families, about, requests = ensemble.families, ensemble.description, request_cycles(FACTOR)
    tables = [outcomes_of(costs.label, costs.trace, CLAIM_PES, requests) for costs in ensemble.pictures]
    bound_ratios = {kind: np.array([best_of(rows, kind)["makespan / lower bound"] for rows in tables])  # [picture, P]
                    for kind in ("static", "hybrid")}
    def on_256(strategy, column):
        return np.array([rows[(rows["strategy"] == strategy) & (rows["P"] == 256)][column].iloc[0] for rows in tables])

    free_efficiency, cyclic_efficiency = on_256("dynamic:1, free requests", "efficiency"), on_256("cyclic, p = 16", "efficiency")
    sent_requests = on_256("dynamic:1", "requests")
    gain = 1 / cyclic_efficiency - 1 / free_efficiency  # difference of the imbalances u, because efficiency = 1 / (1 + u)

    def texts(values):
        return ", ".join(f"{estimate(one, families).text(2)} on {pes} PEs" for one, pes in zip(values.T, CLAIM_PES))

    return [judged("static-inadequate", None, about,
                   f"Makespan / lower bound of the best static strategy: {texts(bound_ratios['static'])}."),
            judged("hybrid-nearly-optimal", None, about,
                   f"Makespan / lower bound of the best hybrid, including the cost of requests: {texts(bound_ratios['hybrid'])}."),
            judged("dynamic-balances", every([above(gain, 0, families), counted(all(sent_requests > 0))]), about,
                   f"On 256 PEs, u of dynamic distribution (one pixel a request, free requests) is {estimate(gain, families).text()} lower than u of "
                   f"p = 16. It takes at least {sent_requests.min()} requests for an image; a static mapping takes none.")]


def plots_of(rows, percent, number):
    kinds = rows.drop_duplicates("strategy").set_index("strategy")
    for label, what, names in (("static", "static mappings", kinds.index[kinds["kind"] == "static"]),
                               ("dynamic", "dynamic and hybrid distribution", kinds.index[kinds["pays"]])):
        yield Plot(f"{NAME}-{number}-{label}", f"Efficiency against the number of PEs, {rows['scene'][0]}: {what}", "PEs", "efficiency (%)",
                   [Series(name, percent.columns, percent.loc[name]) for name in [*names, "upper bound"]], "x")
