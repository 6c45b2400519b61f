"""Objects that rotate on the ring

How does a ring render scenes that exceed the memory of a PE, and when is a torus faster? How much faster would the machine show its images?

- Source: Kohata & Ito 1993, sections 3.1 and 5 (objects in parts are future work), 4.3 (display). Rays that visit all processors of a ring: Wald, Jaros
  & Zellmann, Ray Queue Cycling, Computer Graphics Forum 2023.
- `--split G`: the objects are in G parts, of which each PE holds one. In a turn each PE tests its rays against its part, and the ring passes the parts
  on, G times (docs/architecture.md). P PEs of the SPA, {size} x {size} pixels, cyclic mapping with p = sqrt(P). All PEs wait for each other after each
  part. "enough memory" is a PE that holds the whole scene, G = 1.
- Times: compute, rotations, broadcast of the objects and gathering of the image, without display. u: imbalance of the PEs' cycles; "with waits": of the
  cycles of all turns, in each step of which all PEs wait for the busiest one, against the mean load.
- Over the bus instead: each rotation is P transfers, one after another, or the host broadcasts each part to all PEs at the same time, once a turn. Each
  transfer or broadcast takes the synchronisation of a rotation.
- "rays rotate": each PE keeps its part, and the ring passes the rays with what they have found, {ray_words} words each. It is a model on the counted
  figures: the same cycles, G rotations a turn, words of the mean number of rays in flight (lower bound) or of all that fit (upper bound).
- Torus: {torus_nodes} as many nodes as PEs, each with one voxel and enough memory, overlapped and stepwise. Hybrid: groups of such nodes that share
  the screen, the best number of groups of 1 to P; the time is that of the slower of two of the groups.
- Intervals: over {views} pictures of 9 scene families, on {family_pes} PEs. The break-even of ring and torus is found for {views_even} views each of
  even and random spheres: the number of objects at which both take the same time, between two of {counts} (interpolated in logarithms).
- Frames: the image of a frame goes to the host (as printed), to a frame memory on the bus (as the paper proposes), or in either way while the next frame
  is traced. A series of many frames, times from Table 2 and from this study.
"""
from itertools import product

import numpy as np
import pandas as pd
import raya
from raya.lab import Page, Plot, Series, Table, estimate, first_from, judged, papers, proportion, series_by, study
from raya.lab.laboratory import FAMILIES, SPA, format_for, view_of
from raya.lab.spa import CLOCK as RING_CLOCK
from raya.lab.voxels import UNLIMITED_MEMORY, balls_scene, even_scene, near_cube, powers_of_two, run_on_torus

PROCESSORS = (64, 256, 1024)
EVEN = (30, 120, 480, 1920, 7680, 61440)
RAY_WORDS = 32  # of a ray in flight: the ray, the shadow rays' point, and what both have found (kernels/ring/flight.clh)
FAMILY_PES, VIEWS_EACH, FAMILY_PARTS = 64, 3, (1, 4, 16)
FAMILY_MEMORIES = (1024, 1280)  # bytes: less than most pictures of the families need in one part
VIEWS_EVEN, COUNTS = 4, (8, 30, 120, 480, 1920)
MEMORIES = [kilobytes * 1024 for kilobytes in (8, 16, 32, 64)]


def render(lab, scene, size, pes, parts, memory=UNLIMITED_MEMORY, offset=None):
    """Returns the result; None if the scene does not fit the memory (bytes of a PE) in this number of parts."""
    try:
        return lab.render(scene, machine="spa", size=size, pes=pes, offset=round(pes**0.5) % size if offset is None else offset, accel="none",
                          format=format_for(scene), split=parts, pe_memory=memory)
    except raya.DoesNotFit:
        return None


def link_ms(transfers, words):
    return transfers * SPA["rotation_sync_ms"] + 1e3 * words / SPA["link_words_per_s"]


def figures(result, pes):
    """Returns the figures of a render as a dictionary, times in ms."""
    report = result.report
    ms, load, sent, split = report["modelled_ms"], report["load"], report["communication"], report.get("split", {})
    parts, turns, part_words = split.get("parts", 1), split.get("turns", 0), split.get("part_words", 0)
    other = ms["objects"] + ms["image"] + ms["compute"]
    rays = sum(report["rays"][kind] for kind in ("primary", "reflected", "refracted"))
    in_flight = rays / (turns * pes) if turns else 0
    rotating = [link_ms(turns * parts, turns * parts * RAY_WORDS * count) for count in (in_flight, split.get("trees", 0))]
    return {"G": parts, "memory (KB)": report["machine"]["pe_memory_used_bytes"] / 1024, "trees": split.get("trees", 1), "rays in flight": in_flight,
            "turns": turns, "rotations": sent["rotations"], "words": sent["rotation_words"], "u": load["imbalance"],
            "u with waits": split.get("barrier_cycles", load["max"]) / load["mean"] - 1, "compute (ms)": ms["compute"],
            "rotations (ms)": ms["communication"], "time (ms)": other + ms["communication"],
            "bus, transfers (ms)": other + link_ms(sent["rotations"] * pes, sent["rotation_words"]),
            "bus, broadcasts (ms)": other + turns * parts * (SPA["rotation_sync_ms"] + 1e3 * part_words / SPA["broadcast_words_per_s"]),
            "rays rotate, at least (ms)": other + rotating[0], "rays rotate, at most (ms)": other + rotating[1]}


def torus_figures(lab, scene, size, pes):
    runs = {}
    for groups in powers_of_two(pes)[::4]:
        nodes = near_cube(pes // groups)
        runs[groups] = max(run_on_torus(lab, scene, size, nodes, near_cube(pes), queue=256, pixels=(groups, g))["overlapped (ms)"] for g in {0, groups // 2})
    whole = run_on_torus(lab, scene, size, near_cube(pes), near_cube(pes), queue=256)
    groups = min(runs, key=runs.get)
    return {"torus, overlapped (ms)": whole["overlapped (ms)"], "torus, stepwise (ms)": whole["stepwise (ms)"], "hybrid, overlapped (ms)": runs[groups],
            "hybrid, groups": groups}


def parts_to_try(pes):
    return sorted({1, *powers_of_two(pes)[1::3], pes})


def rows_of(lab, scene, size, pes):
    """Returns rows for each number of parts: with the memory of the SPA if the scene fits it so, else with enough memory."""
    rows = []
    for parts in parts_to_try(pes):
        fitting = render(lab, scene, size, pes, parts, SPA["pe_memory_bytes"])
        result = fitting or render(lab, scene, size, pes, parts)
        rows.append({"scene": scene.name, "N": scene.objects, "P": pes, **figures(result, pes), "fits": "yes" if fitting else "no"})
    return rows


def times_by_parts(lab, scene, size, pes, memory):
    """Returns {number of parts: ms} for the numbers of parts with which the scene fits the memory (bytes of a PE)."""
    results = {parts: render(lab, scene, size, pes, parts, memory) for parts in powers_of_two(pes)}
    return {parts: figures(result, pes)["time (ms)"] for parts, result in results.items() if result}


def best_for_memory(lab, scene, size, pes):
    rows = []
    for memory in MEMORIES:
        times = times_by_parts(lab, scene, size, pes, memory)
        if times:
            best, fewest = min(times, key=times.get), min(times)
            rows.append({"scene": scene.name, "memory (KB)": memory // 1024, "fewest parts": fewest, "time with the fewest (ms)": times[fewest],
                         "best G": best, "time with the best (ms)": times[best]})
    return rows


def family_rows(lab, size):
    """Returns a row for each picture of each family, number of parts and offset."""
    return pd.DataFrame([
        {"family": family, "view": view, "p": p, **figures(render(lab, make(lab.seed + view), size, FAMILY_PES, parts, offset=p), FAMILY_PES)}
        for (family, make), view, parts, p in product(FAMILIES.items(), range(VIEWS_EACH), FAMILY_PARTS, (0, round(FAMILY_PES**0.5)))])


def family_estimates(rows):
    """Returns a row for each number of parts: means and 95 % intervals over the pictures of the families."""
    root, table = rows["p"].max(), []
    for parts in FAMILY_PARTS:
        column, cyclic = (rows[(rows["G"] == parts) & (rows["p"] == p)].reset_index() for p in (0, root))
        gain = (column["compute (ms)"] / cyclic["compute (ms)"]).to_numpy()
        bus = {way: (cyclic[f"bus, {way} (ms)"] / cyclic["time (ms)"]).to_numpy() for way in ("transfers", "broadcasts")}
        names = cyclic["family"].tolist()
        table.append({"G": parts, "u": estimate(cyclic["u"], names), "u with waits": estimate(cyclic["u with waits"], names),
                      "computing time, p = 0 / cyclic": estimate(gain, names),
                      **{f"time, bus with {way} / ring": estimate(ratios, names) for way, ratios in bus.items()}})
    return table


def best_parts(lab, size):
    """Returns a row for each picture of the families that does not fit one of the memories in one part, but in several: for the smallest of these."""
    rows = []
    for (family, make), view in product(FAMILIES.items(), range(VIEWS_EACH)):
        for memory in FAMILY_MEMORIES:
            times = times_by_parts(lab, make(lab.seed + view), size, FAMILY_PES, memory)
            if times and 1 not in times:
                fewest, best = min(times), min(times, key=times.get)
                rows.append({"family": family, "view": view, "memory (bytes)": memory, "fewest parts": fewest, "best G": best,
                             "time, fewest / best": times[fewest] / times[best]})
                break  # one row for a picture, so that the rows are independent
    return pd.DataFrame(rows)


def crossing(counts, ratios):
    """Returns the number of objects at which the ratio ring / torus becomes 1, interpolated in logarithms; the first or last count if it is 1 nowhere
    between the counts."""
    logs = np.log(ratios)
    above = next((i for i, value in enumerate(logs) if value > 0), len(logs))
    if above in (0, len(logs)):
        return counts[0 if above == 0 else -1]
    return float(np.exp(np.interp(0, logs[above - 1:above + 1], np.log(counts[above - 1:above + 1]))))


def break_evens(lab, size):
    """Returns a row for each view of even and random spheres: the break-even numbers of objects of the ring with PEs of 32 KB and the torus."""
    rows, pes = [], FAMILY_PES
    for kind, make in (("even", lambda count, seed: even_scene(count)), ("random", raya.generate.random)):
        for seed in range(lab.seed, lab.seed + VIEWS_EVEN):
            times = []
            for count in COUNTS:
                scene = view_of(make(count, seed))(seed)
                fitting = (render(lab, scene, size, pes, parts, SPA["pe_memory_bytes"]) for parts in parts_to_try(pes))
                ring = min(figures(result, pes)["time (ms)"] for result in fitting if result)
                torus = run_on_torus(lab, scene, size, near_cube(pes), near_cube(pes), queue=256)
                times.append((ring, torus["overlapped (ms)"], torus["stepwise (ms)"]))
            ring, overlapped, stepwise = np.array(times).T
            rows.append({"spheres": kind, "view": seed, "overlapped": crossing(COUNTS, ring / overlapped), "stepwise": crossing(COUNTS, ring / stepwise)})
    return pd.DataFrame(rows)


@study("ring-of-objects")
def ring_of_objects(lab, scenes):
    size = lab.size(32)
    evens = [even_scene(count) for count in EVEN] if not scenes else scenes
    others = [] if scenes else [*(raya.example(name) for name in ("centre", "spheres", "mirrors", "glass", "polygons")), balls_scene(3),
                                raya.generate.lattice(4).renamed("lattice-4"), raya.generate.random(2000, 1).renamed("random-2000")]
    rows = pd.DataFrame([row for pes in PROCESSORS for scene in evens for row in rows_of(lab, scene, size, pes)]
                        + [row for scene in others for row in rows_of(lab, scene, size, 256)])
    torus = pd.DataFrame([{"scene": scene.name, "N": scene.objects, "P": pes, **torus_figures(lab, scene, size, pes)}
                          for pes in PROCESSORS[:2] for scene in evens])
    ring = rows[rows["fits"] == "yes"].groupby(["scene", "N", "P"], sort=False)["time (ms)"].min().reset_index()
    enough = rows[rows["G"] == 1][["scene", "P", "time (ms)"]].rename(columns={"time (ms)": "enough memory (ms)"})
    against = torus.merge(ring, on=["scene", "N", "P"], how="left").merge(enough, on=["scene", "P"])
    memory = pd.DataFrame([row for scene in evens[-3:-1] or evens for row in best_for_memory(lab, scene, size, 256)])
    families = family_rows(lab, size)
    estimated = family_estimates(families)
    fewest, crossings = best_parts(lab, size), break_evens(lab, size)
    compute, image, display = papers.COMPUTE_MS, papers.IMAGE_MS, papers.DISPLAY_MS
    frame_ms = {"as printed": papers.OBJECTS_MS + compute + image + display, "frame memory on the bus": papers.OBJECTS_MS + compute + image,
                "overlapped with the next frame": max(compute, image + display), "frame memory, overlapped": max(compute, image)}
    frames = pd.DataFrame([{"frames": name, "ms": ms, "frames a second": 1e3 / ms} for name, ms in frame_ms.items()])
    # The least N from which on the torus is faster, or the scene fits the ring in no number of parts.
    evens_of = {pes: {bound: first_from(group["N"], ~(group["time (ms)"] <= group[f"torus, {bound} (ms)"]))
                      for bound in ("overlapped", "stepwise")} for pes, group in against.groupby("P")}
    shown = pd.DataFrame([{key: value if key == "G" else value.text() for key, value in row.items()} for row in estimated])
    answers = answers_of(estimated, fewest, crossings)
    return Page({"size": size, "processors": ", ".join(map(str, PROCESSORS)), "views": len(FAMILIES) * VIEWS_EACH, "family_pes": FAMILY_PES,
                 "views_even": VIEWS_EVEN, "counts": ", ".join(map(str, COUNTS))},
                answers + findings_of(rows, memory, estimated, evens_of, frames),
                claims=[judged("objects-need-communication", None, "", f"With parts that rotate, {rows[rows['G'] > 1]['words'].min()} words or more pass "
                               "over the ring; with the whole scene in every PE, none.")] if not scenes else [],
                tables=[Table("ring-of-objects", "The ring with 1 to P parts", rows), Table("ring-of-objects-torus", "Ring, torus and hybrid", against),
                        Table("ring-of-objects-memory", "The best number of parts for a memory", memory),
                        Table("ring-of-objects-families", "Means and 95 % intervals over the families", shown),
                        Table("ring-of-objects-pictures", "The pictures of the families", families, on_page=False),
                        Table("ring-of-objects-fewest", "The best and the fewest parts, pictures of the families", fewest, on_page=False),
                        Table("ring-of-objects-break-even", "Objects from which on the torus is faster", crossings),
                        Table("ring-of-objects-frames", "A frame of a series, scene and times of Table 2", frames)],
                plots=[Plot("ring-of-objects", "Time against the number of parts, 256 PEs", "parts G", "time without display (modelled ms)",
                            series_by(rows[rows["P"] == 256], "scene", "G", "time (ms)"), "xy"),
                       Plot("ring-of-objects-torus", "Ring and torus, 256 processors", "objects", "time (modelled ms)",
                            [Series(name, against[against["P"] == 256]["N"], against[against["P"] == 256][column]) for name, column in (
                                ("ring", "time (ms)"), ("ring, enough memory", "enough memory (ms)"), ("torus, overlapped", "torus, overlapped (ms)"),
                                ("torus, stepwise", "torus, stepwise (ms)"), ("hybrid, overlapped", "hybrid, overlapped (ms)"))], "xy")],
                news=[f"A ring whose objects rotate renders scenes larger than a PE: {rows[rows['fits'] == 'yes']['N'].max()} objects on PEs of 32 KB.", *answers],
                clock=RING_CLOCK, placeholders={"ray_words": RAY_WORDS, "torus_nodes": "a 3-D torus of"})


def answers_of(estimated, fewest, crossings):
    """Returns the answers to the study's questions, with 95 % intervals."""
    def even_text(counts):
        outside = int((counts <= COUNTS[0]).sum())
        if outside:  # an interval would need their break-evens, which are below the range
            return f"at most {counts.max():.0f} ({outside} of {len(counts)} views: {COUNTS[0]} or fewer)"
        log = estimate(np.log(counts), crossings["spheres"].tolist())
        return f"{np.exp(log.mean):.0f} ({np.exp(log.low):.0f} .. {np.exp(log.high):.0f})"

    evens = {bound: even_text(crossings[bound]) for bound in ("overlapped", "stepwise")}
    holds = fewest["best G"] == fewest["fewest parts"]
    split = estimated[-1]
    return [f"On {FAMILY_PES} processors the torus is faster than a ring of objects from {evens['overlapped']} spheres on if it waits for nothing, and from "
            f"{evens['stepwise']} on step by step.",
            f"The fewest parts that fit are the best in {int(holds.sum())} of {len(holds)} pictures that do not fit in one part (95 %: "
            f"{proportion(holds, 0.5).interval}); they take at most {fewest['time, fewest / best'].max():.2f} times as long as the best.",
            f"The cyclic mapping still pays with G = {split['G']}: with p = 0 computing takes {split['computing time, p = 0 / cyclic'].text(2)} times as long.",
            f"With G = {split['G']} a bus instead of the ring makes the whole {split['time, bus with transfers / ring'].text(1)} times as long if the PEs "
            f"send each other their parts, but {split['time, bus with broadcasts / ring'].text(2)} times if the host broadcasts each part once a turn."]


def findings_of(rows, memory, estimated, evens_of, frames):
    objects = {bound: "; ".join(f"P = {pes}: {even[bound] or 'none of these'}" for pes, even in evens_of.items()) for bound in ("overlapped", "stepwise")}
    split = rows[rows["G"] > 1]
    rays = split["rays rotate, at least (ms)"] / split["time (ms)"]
    return [f"Objects from which on the torus is faster than the ring that fits 32 KB: {objects['overlapped']} (overlapped); {objects['stepwise']} (stepwise).",
            "The best number of parts for a memory: " + "; ".join(
                f"{scene}, {kilobytes} KB: {best} (fewest that fit: {fewest})" for scene, kilobytes, fewest, _, best, _ in memory.itertuples(index=False))
            + ".",
            *(f"G = {row['G']}, families: u {row['u'].text()}, with waits {row['u with waits'].text()}. With p = 0 computing takes "
              f"{row['computing time, p = 0 / cyclic'].text(2)} times as long as with the cyclic mapping; the whole takes "
              f"{row['time, bus with transfers / ring'].text(2)} times as long with transfers over the bus, "
              f"{row['time, bus with broadcasts / ring'].text(2)} times with broadcasts." for row in estimated),
            f"If the rays rotate instead, the time is {rays.min():.2f} to {rays.max():.2f} times that of rotating objects, at least.",
            "A frame of a series: " + "; ".join(f"{name} {ms:.0f} ms" for name, ms in zip(frames["frames"], frames["ms"])) + " (modelled)."]
