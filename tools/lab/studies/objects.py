"""Fig. 4 of Yoshitani & Yamazaki: time against the number of objects, on 64 transputers

Do random objects take longer than even ones, are straddling objects the reason, and why does time grow less than the number of objects?

- Source: Yoshitani & Yamazaki, about 1995, Fig. 4 and Table 1.
- 64 nodes as an 8 x 8 torus, four links per node; one of 4 x 4 x 4 voxels per node. {size} x {size} pixels, primary and shadow rays only, one light,
  matt spheres.
- Protocol of Yoshitani & Yamazaki: the root makes all primary rays and sends each to the voxel where it enters. A ray packet has the {words} words
  of the scalars in their Table 1. This is a minimum, because a packet also carries data of the voxel search and of the object. For each ray, the
  node where its shadow ray ends sends one return of 6 words to the root.
- Protocol of raya: every node makes the primary rays that enter at its voxel, and is charged also for those that it makes and discards. A ray
  packet has 16 words. Each contribution of a ray (ambient light, a light or the background) is a return of 8 words.
- raya moves the contributions separately under both protocols, so that the image is the same. Under the protocol of Yoshitani & Yamazaki the time
  model charges those of a ray as one message. Shading is charged to the node where the ray hits.
- Each scene has {variants} variants with different random places and views. A variant has the radii of a generated even scene times one of {radii},
  at most {largest} of a voxel's side. Ratios of two scenes are taken within the same variant.
- Even: every voxel holds the same number of spheres, at random places within the voxel.
- Random: the even scene's spheres, with their radii, surfaces, light and view, at random centres; each is moved until it is inside the cube.
- Random, none across voxels: each sphere of the random scene is moved until it lies within the voxel of its centre. The voxels keep their numbers
  of spheres, but no sphere straddles voxels. This separates the effect of copies from that of unequal numbers.
- In all scenes the outermost spheres touch the sides of one cube, so the voxels are the same. raya registers a sphere in each voxel that it may
  meet, with a margin for rounding errors. Copies are all registrations but the first. "copies without margin" counts only voxels that the surface
  meets exactly.
- The claims use the times of a discrete-event simulation of the asynchronous machine, which the paper describes: a node has two tasks, links
  transfer while nodes compute, and buffers are finite. Overlapped (nothing waits) and stepwise (everything waits) times are shown as bounds.
- The depth of primary rays, the number of voxels that they visit, is counted in renders without lights. The growth of the overlapped time is
  analysed from the fewest to the most objects: growth of objects / growth of time is a product of four factors (table of growth).
- Output: objects.csv (modelled times in ms and counts), objects-ratios.csv, objects-growth.csv, objects-primary.csv, objects-words.csv, and
  objects-sweep.csv (random / even time by radius and by the root's cost of a primary ray). Columns +- are half widths of 95 % intervals.
"""
import numpy as np
import pandas as pd
import raya
from raya.lab import Page, Plot, Series, Table, above, estimate, every, judged, papers, series_by, study, under
from raya.lab.voxels import CLOCK, even_scene, run_on_torus, with_spheres

COUNTS, OTHER_WORDS, SIDES = (64, 192, 256, 512, 1024, 8320), (32, 48), 4  # numbers of objects; words of a ray packet; voxels along each axis
RADII, VARIANTS, MAX_RADIUS = (0.5, 1, 2), 18, 0.45  # factors of the radii; variants of a scene; maximum of radius / voxel side
ROOT_COSTS = (0, 0.25, 0.5, 1)  # of a primary ray, relative to the modelled one; 0: only its message takes time
EVEN, RANDOM, WITHIN = "even", "random", "random, none across voxels"
PAPER, RAYA = "Yoshitani & Yamazaki", "raya"
PROTOCOLS = {PAPER: {"inject": "root", "packet_words": papers.RAY_WORDS, "returns": "rays"}, RAYA: {}}
SLOWER, LINEAR_LIMIT, HALF = 1.02, 1.25, 0.5  # random-is-slower: ratio of times; not-linear: objects / time; front-voxels: part of its logarithm
TIMES = ("overlapped", "stepwise", "asynchronous")


def render(lab, scene, size, **options):
    return run_on_torus(lab, scene, size, (4, 4, 4), (4, 4, 4), links="torus2d", bounces=0, **options)


def even_variant(count, factor, seed):
    """Returns an even scene. Its spheres have the radii of even_scene() times a factor, and random places within their voxels."""
    rng, side = np.random.default_rng(seed), 2 / SIDES  # side of a voxel; the cube is [-1, 1]^3

    def change(sphere):
        *centre, radius = map(float, sphere)
        radius = min(factor * radius, MAX_RADIUS * side)
        voxel = np.floor((np.array(centre) + 1) / side)
        return " ".join(f"{value:.7g}" for value in (*(-1 + side * voxel + rng.uniform(radius, side - radius, 3)), radius))

    return with_spheres(even_scene(count), change, f"even-{count}, variant {seed}").random_view(seed).moved_into_voxels()


def scenes_of(count, seeds):
    """Returns {kind: [scene of each variant]}: even scenes, random scenes, and random scenes with spheres moved into the voxels of their centres."""
    even = [even_variant(count, RADII[i % len(RADII)], seed) for i, seed in enumerate(seeds)]
    random = [one.scattered(seed) for seed, one in zip(seeds, even)]
    return {EVEN: [one.touching_walls() for one in even], RANDOM: [one.touching_walls() for one in random],
            WITHIN: [one.moved_into_voxels().touching_walls() for one in random]}


def copies_without_margin(scene):
    """Returns the number of pairs (sphere, voxel that its surface meets), minus the number of spheres."""
    spheres = np.array([list(map(float, line.split()[1:])) for line in scene.nff.splitlines() if line.startswith("s ")])
    centres, radii = spheres[:, None, :3], spheres[:, None, 3]
    low, high = (centres[:, 0] - radii).min(0), (centres[:, 0] + radii).max(0)
    corner = low + np.stack(np.meshgrid(*[range(SIDES)] * 3), -1).reshape(-1, 3) * (high - low) / SIDES  # [voxel, 3]
    below, above_ = centres - corner, corner + (high - low) / SIDES - centres  # [sphere, voxel, 3]: distances from the voxel's sides
    nearest, farthest = np.maximum(0, np.maximum(-below, -above_)), np.maximum(below, above_)
    meets = ((nearest**2).sum(2) <= radii**2) & ((farthest**2).sum(2) >= radii**2)
    return int(meets.sum()) - len(spheres)


def depth_of(lab, scene, size):
    """Returns three figures: the fraction of primary rays that hit an object; and, of the primary rays that enter the scene's box, the fraction that
    end in their first voxel and the mean number of voxels that they visit."""
    run = render(lab, scene.without_lights(), size, packets=True)
    packets, events = run["result"].packets, run["result"].events
    primary = packets[packets["kind"] == raya.PACKET_KINDS.index("primary")]
    walks = max(1, events["walks"])
    return (events["primary_hits"] / events["primary"], 1 - len(np.unique(primary["pixel"])) / walks,
            events["steps"] / walks)


@study("objects", one_scene=True)
def objects(lab, scenes):
    size, runs, depths, words, exact, times = lab.size(96), {}, [], [], {}, {}
    seeds = range(lab.seed, lab.seed + VARIANTS)
    for count in COUNTS:
        scenes_by_kind = scenes_of(count, seeds)
        for kind, kind_scenes in scenes_by_kind.items():
            exact[count, kind] = np.mean([copies_without_margin(one) for one in kind_scenes])
        for protocol, options in PROTOCOLS.items():
            for kind, kind_scenes in scenes_by_kind.items():
                runs[count, kind, protocol] = [render(lab, one, size, async_=True, **options) for one in kind_scenes]
        times |= {(count, kind): np.array([[run["result"].simulate(primary_factor=f) for f in ROOT_COSTS] for run in runs[count, kind, PAPER]]).T
                 for kind in (EVEN, RANDOM, WITHIN)}  # [cost, variant]
        for kind in (EVEN, RANDOM):
            hits, firsts, voxels = zip(*(depth_of(lab, one, size) for one in scenes_by_kind[kind]))
            depths.append({"objects": count, "kind": kind, "hit (% of primary rays)": 100 * np.mean(hits),
                           "end in the first voxel (% of those in the box)": 100 * np.mean(firsts),
                           "voxels a ray in the box": np.mean(voxels), "half": estimate(voxels).half})
        if count in (COUNTS[0], COUNTS[-1]):
            for more in OTHER_WORDS:
                run = render(lab, scenes_by_kind[EVEN][0], size, **{**PROTOCOLS[PAPER], "packet_words": more})
                words.append({"objects": count, "words a ray": more, "overlapped (ms)": run["overlapped (ms)"],
                              "stepwise (ms)": run["stepwise (ms)"]})
    rows = pd.DataFrame([row_of(key, kind_runs, exact) for key, kind_runs in runs.items()])
    # (time of a scene of this kind) / (time of the even scene of the same variant), an estimate for each of TIMES
    ratios = pd.DataFrame([{"objects": count, "kind": kind, "protocol": protocol, **{time: estimate([
        run[f"{time} (ms)"] / even[f"{time} (ms)"] for run, even in zip(runs[count, kind, protocol], runs[count, EVEN, protocol])])
        for time in TIMES}} for protocol in PROTOCOLS for kind in (RANDOM, WITHIN) for count in COUNTS])
    growth = [(kind, protocol, growth_of(runs[COUNTS[0], kind, protocol], runs[COUNTS[-1], kind, protocol]))
              for protocol in PROTOCOLS for kind in (EVEN, RANDOM)]
    depths, words, sweep = pd.DataFrame(depths), pd.DataFrame(words), sweep_of(times)
    spread = ratios[["objects", "kind", "protocol"]].copy()
    for time in TIMES:
        spread[time], spread[f"{time} +-"] = [e.mean for e in ratios[time]], [e.half for e in ratios[time]]
    factors = pd.DataFrame([  # geometric means: unlike means, those of factors multiply to that of their product
        {"kind": kind, "protocol": protocol, **np.exp(np.log(growth_rows).mean())} for kind, protocol, growth_rows in growth])
    factors.insert(5, "+-", [estimate(growth_rows["objects / time"]).half for *_, growth_rows in growth])
    low, high = (sweep.loc[pick] for pick in (sweep["random / even"].idxmin(), sweep["random / even"].idxmax()))
    more = ["This study ignores the scenes of the command line: it generates scenes like those of Yoshitani & Yamazaki."] if scenes else []
    return Page({"nodes": "4x4x4", "voxels": "4x4x4", "links": "torus2d", "size": size, "bounces": 0, "format": "fp32",
                 "words": papers.RAY_WORDS, "variants": VARIANTS, "seed": lab.seed, "objects": list(COUNTS)},
                [*findings_of(runs, rows, ratios, depths, words),
                 f"For all radii and costs of a primary ray, time of random / time of even objects (asynchronous) is {low['random / even']:.2f} ({low['objects']} "
                 f"objects, {low['variants']}) to {high['random / even']:.2f} ({high['objects']} objects, {high['variants']}).", *more],
                claims=claims_of(times, ratios, growth, f"{VARIANTS} variants of each scene, seeds {seeds[0]}..{seeds[-1]}"),
                tables=[Table("objects", "Time and work for each number of objects", rows),
                        Table("objects-ratios", "Time of random / time of even objects", spread),
                        Table("objects-growth", "Growth from the fewest to the most objects: objects / time as a product of four factors", factors),
                        Table("objects-primary", "Voxels that primary rays visit", depths.drop(columns="half")),
                        Table("objects-words", "Times with larger ray packets, protocol of Yoshitani & Yamazaki, even scenes", words),
                        Table("objects-sweep", "Time of random / time of even, asynchronous, protocol of Yoshitani & Yamazaki", sweep)],
                plots=plots_of(rows, ratios, depths),
                clock=CLOCK, placeholders={"radii": ", ".join(map(str, RADII)), "largest": MAX_RADIUS})


def sweep_of(times):
    """Returns a table of time of random / time of even objects: for each factor of the radii, and over all variants for each of ROOT_COSTS."""
    rows = []
    for count in COUNTS:
        ratios = times[count, RANDOM] / times[count, EVEN]  # [cost, variant]
        groups = {f"radii x {factor}": [value for i, value in enumerate(ratios[-1]) if RADII[i % len(RADII)] == factor] for factor in RADII}
        groups |= {f"a primary ray costs {cost:g}": ratio for cost, ratio in zip(ROOT_COSTS, ratios)}
        rows += [{"objects": count, "variants": name, "random / even": estimate(values).mean, "+-": estimate(values).half}
                 for name, values in groups.items()]
    return pd.DataFrame(rows)


def row_of(key, runs, exact):
    count, kind, protocol = key
    columns = ("copies", "tests a ray", "steps a ray", "returns", "rays discarded", "u")
    row = {"objects": count, "kind": kind, "protocol": protocol, "scenes": len(runs),
           **pd.DataFrame(runs)[list(columns)].mean(), "copies without margin": exact[count, kind]}
    for time in TIMES:
        e = estimate([run[f"{time} (ms)"] for run in runs])
        row[f"{time} (ms)"], row[f"{time} +- (ms)"] = e.mean, e.half
    return {**row, "busiest node computes (ms)": np.mean([run["compute (ms)"] for run in runs]),
            "the root alone (ms)": np.mean([run["the root (ms)"] for run in runs])}


def growth_of(first, last):
    """Returns growth of objects / growth of time and its four factors, for each variant. first, last: Runs with the fewest and most objects."""
    def one(a, b):
        steps, tests = b["steps"] / a["steps"], b["tests"] / a["tests"]
        work, time, count = b["work (ms)"] / a["work (ms)"], b["overlapped (ms)"] / a["overlapped (ms)"], COUNTS[-1] / COUNTS[0]
        return {"objects": count, "time": time, "objects / time": count / time, "fewer voxels a ray": 1 / steps,
                "tests a voxel grow less": count * steps / tests, "fixed costs": tests / work,
                "one node's bound": work / time}
    return pd.DataFrame([one(a, b) for a, b in zip(first, last)])


def select(rows, kind, protocol):
    return rows[(rows["kind"] == kind) & (rows["protocol"] == protocol)].reset_index(drop=True)


def texts_of(time_ratios, time):
    return ", ".join(f"{e.text(2)} ({count})" for e, count in zip(time_ratios[time], time_ratios["objects"]))


def claims_of(times, ratios, growth, about):
    """Judges by asynchronous times, because the paper's machine is asynchronous. times: {(objects, kind): [cost of ROOT_COSTS, variant]}."""
    random_ratios = select(ratios, RANDOM, PAPER)
    of_even = {kind: {count: times[count, kind] / times[count, EVEN] for count in COUNTS} for kind in (RANDOM, WITHIN)}  # {count: [cost, variant]}
    slower = {f"{count} objects": every([above(of_even[RANDOM][count][-1], SLOWER), above((of_even[RANDOM][count] - of_even[WITHIN][count])[-1])])
              for count in COUNTS}
    growths = {(cost, kind): COUNTS[-1] / COUNTS[0] / (times[COUNTS[-1], kind][i] / times[COUNTS[0], kind][i])
               for i, cost in enumerate(ROOT_COSTS) for kind in (EVEN, RANDOM)}  # objects / time
    linear = {f"a primary ray costs {cost:g}": every(above(growths[cost, kind], LINEAR_LIMIT) for kind in (EVEN, RANDOM)) for cost in (0, 1)}
    excess, shares = {}, []
    for protocol in PROTOCOLS:
        rows = [one for _, of_protocol, one in growth if of_protocol == protocol]
        logs = [(np.log(one["fewer voxels a ray"]), np.log(one["objects / time"])) for one in rows]
        excess[f"protocol of {protocol}"] = every(above(part - HALF * whole) for part, whole in logs)
        shares.append(f"{' and '.join(f'{100 * np.mean(part / whole):.0f} %' for part, whole in logs)} under the protocol of {protocol} (growth "
                      f"{' and '.join(format(one['objects / time'].mean(), '.1f') for one in rows)})")

    def texts(kind, cost):
        return ", ".join(f"{estimate(of_even[kind][count][ROOT_COSTS.index(cost)]).text(2)} ({count})" for count in COUNTS)

    return [judged("random-is-slower", under(slower), about,
                   f"Time of random / time of even objects, asynchronous, by number of objects (in brackets): {texts(RANDOM, 1)}; if no random object "
                   f"straddles voxels: {texts(WITHIN, 1)}; if a primary ray costs the root half as much: {texts(RANDOM, 0.5)}, and nothing but its "
                   f"message: {texts(RANDOM, 0)}. Bounds: overlapped {texts_of(random_ratios, 'overlapped')}; stepwise "
                   f"{texts_of(random_ratios, 'stepwise')}."),
            judged("not-linear", under(linear), about,
                   f"Growth of objects / growth of time from {COUNTS[0]} to {COUNTS[-1]} objects, even and random: " + "; ".join(
                       f"{estimate(growths[cost, EVEN]).text(1)} and {estimate(growths[cost, RANDOM]).text(1)} if a primary ray costs {cost:g}"
                       for cost in ROOT_COSTS) + "."),
            judged("front-voxels", under(excess), about,
                   f"That rays visit fewer voxels is this part of the logarithm of growth of objects / growth of time, for even and random objects: "
                   f"{'; '.join(shares)}.")]


def findings_of(runs, rows, ratios, depths, words):
    random = select(rows, RANDOM, RAYA)
    first, last = random.iloc[0], random.iloc[-1]
    copies = (f"Straddling objects: a random object is registered in {1 + first['copies'] / first['objects']:.2f} voxels in the mean with "
              f"{first['objects']} objects, and in {1 + last['copies'] / last['objects']:.2f} voxels with {last['objects']}. If none straddles "
              f"voxels, random objects take {texts_of(select(ratios, WITHIN, RAYA), 'overlapped')} times as long as even ones (overlapped, "
              "raya's protocol, number of objects in brackets), because the voxels have unequal numbers of objects.")
    a, b = (depths[depths["kind"] == EVEN].iloc[i] for i in (0, -1))
    (va, vb), end = (one["voxels a ray in the box"] for one in (a, b)), "end in the first voxel (% of those in the box)"
    theirs, ours = runs[COUNTS[0], EVEN, PAPER][0], runs[COUNTS[0], EVEN, RAYA][0]
    even = select(rows, EVEN, PAPER).set_index("objects")
    times_longer = words["overlapped (ms)"].values / even["overlapped (ms)"][words["objects"]].values
    more = ", ".join(f"with {w['words a ray']:.0f} words {times:.2f} times ({w['objects']:.0f} objects)"
                     for times, (_, w) in zip(times_longer, words.iterrows()))
    return [copies,
            f"A primary ray in the scene's box visits {va:.2f} voxels in the mean with {a['objects']} even objects and {vb:.2f} with "
            f"{b['objects']}, a ratio of {va / vb:.2f}. {a[end]:.0f} % and {b[end]:.0f} % of these rays end in their first voxel.",
            f"With {COUNTS[0]} even objects, {theirs['primary']} primary rays cause {theirs['returns']} returns under the protocol of {PAPER} "
            f"and {ours['returns']} under raya's, where each contribution is a return. Under raya's protocol all nodes together discard "
            f"{ours['rays discarded']} primary rays.",
            f"Overlapped time with larger ray packets, compared with the {papers.RAY_WORDS} words of Table 1: {more}."]


def plots_of(rows, ratios, depths):
    def times(name, title, protocol, time):
        column = f"{time} (ms)"
        even = select(rows, EVEN, protocol)
        series = [Series(kind, kind_rows["objects"], kind_rows[column], half_widths=kind_rows[f"{time} +- (ms)"])
                  for kind in (EVEN, RANDOM, WITHIN) for kind_rows in [select(rows, kind, protocol)]]
        linear = Series("proportional to the number of even objects", even["objects"],
                        even[column][0] * even["objects"] / even["objects"][0])
        return Plot(name, title, "number of objects", "modelled time (ms)", series + [linear], "xy")

    title = "Time under the protocol of Yoshitani & Yamazaki"
    cases = [(kind, protocol) for protocol in PROTOCOLS for kind in (RANDOM, WITHIN)]
    ratio = [Series(f"{kind}, protocol: {protocol}", kind_rows["objects"] * 1.06**i, [e.mean for e in kind_rows["asynchronous"]],
                    half_widths=[e.half for e in kind_rows["asynchronous"]])
             for i, (kind, protocol) in enumerate(cases) for kind_rows in [select(ratios, kind, protocol)]]
    return [times("objects-async", f"{title}, asynchronous", PAPER, "asynchronous"),
            times("objects", f"{title}, overlapped", PAPER, "overlapped"),
            times("objects-stepwise", f"{title}, stepwise", PAPER, "stepwise"),
            times("objects-raya", "Time under raya's protocol, overlapped", RAYA, "overlapped"),
            Plot("objects-ratios", "Random and even objects, asynchronous", "objects (series shifted by 6 %)", "random / even time", ratio, "x"),
            Plot("objects-depth", "Voxels that primary rays visit", "number of objects", "voxels per ray in the box",
                 series_by(depths, "kind", "objects", "voxels a ray in the box", "half"), "x")]
