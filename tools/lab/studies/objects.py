"""Fig. 4 of Yoshitani & Yamazaki: time against the number of objects, on 64 transputers

Are random objects slower than even ones, is it for their copies, and why does time grow less than the objects do?

- 64 nodes, 4 x 4 x 4, on an 8 x 8 torus of four links a node, one voxel each; {size} x {size} pixels, primary and
  shadow rays alone, one light, matt spheres.
- Two protocols. Yoshitani & Yamazaki: the root makes all primary rays and sends them to the voxels where they enter; a
  ray packet has the {words} words that their Table 1 adds up to, the least that they can be, as data for the search and
  of the object come to them; a ray brings home one return of 6 words, from where its shadow ray ends. Raya: every node
  makes the primary rays that enter at its voxel, and is charged for those that it makes and discards; a ray packet has
  16 words; each term of a ray, its ambient light, a light or the background, is a return of 8.
- The returns of a ray are moved apart, so that the image is the same; by the protocol of Yoshitani & Yamazaki they are
  charged as one message. What is shaded is charged where the ray hits.
- Even: every voxel holds as many spheres, each within its voxel.
- Random: the even scene's spheres, their radii, surfaces, light and view, about centres drawn from the cube and moved
  into it where they stick out; {seeds} scenes.
- Random, none astride: the random spheres moved until each lies within the voxel of its centre. As many lie in each
  voxel, but no sphere is in two: what separates copies from crowds.
- In all three the outermost spheres touch the sides of one cube, so that all have the same voxels. Registration takes
  each for larger by up to a 16th of a voxel's side; even spheres and those moved keep that far from the sides.
- Random is slower where the whole interval of random over even lies above 1, else not slower where it lies below 1.02;
  the claim is reproduced where all numbers of objects are slower, not reproduced where none is and half of them or more
  are not. It is judged by the asynchronous machine, the one that they describe, simulated packet by packet: two tasks a
  node, links that carry while nodes compute, finite buffers; overlapped and stepwise, where nothing or everything
  waits, stand next to it.
- How deep primary rays go is counted without lights. Why time grows less than the objects, from the
  fewest to the most of them, overlapped: objects over time is a product of four ratios, see its table.
- Time counts as linear where objects over time is less than 1.1. The reason that Yoshitani & Yamazaki give, rays that
  end earlier, is the right one where fewer voxels a ray explain more than half of the product, by logarithms, for even
  and for random objects.
"""
import numpy as np
import pandas as pd
import raya
from raya.lab import Claim, Page, Plot, Series, Table, estimate, papers, series_by, study, verdict
from raya.lab.voxels import CLOCK, even_scene, run_on_torus

COUNTS, SEEDS, OTHER_WORDS = (64, 192, 256, 512, 1024, 8320), 5, (32, 48)
EVEN, RANDOM, WITHIN = "even", "random", "random, none astride"
PAPER, OWN = "Yoshitani & Yamazaki", "raya"
PROTOCOLS = {PAPER: {"inject": "root", "packet_words": papers.RAY_WORDS, "returns": "rays"}, OWN: {}}
NOTICED, LINEAR = 1.02, 1.1  # times as long: slower; objects over time, within which time grows as the objects do
TIMES = ("overlapped", "stepwise", "asynchronous")


def render(lab, scene, size, **options):
    return run_on_torus(lab, scene, size, (4, 4, 4), (4, 4, 4), links="torus2d", bounces=0, **options)


def scenes_of(count):
    """The even scene, and of each seed one drawn at random and the same moved within its voxels."""
    even = even_scene(count).moved_within()
    random = [even.scattered(seed) for seed in range(1, SEEDS + 1)]
    return {EVEN: [even.touching_walls()], RANDOM: [one.touching_walls() for one in random],
            WITHIN: [one.moved_within().touching_walls() for one in random]}


def depth_of(lab, scene, size):
    """Primary rays alone: the share that hits; of those in the box, the share that ends in its first voxel, and
    voxels."""
    run = render(lab, scene.without_lights(), size, packets=True)
    packets = run.result.packets
    primary = packets[packets["kind"] == raya.PACKET_KINDS.index("primary")]
    walks = max(1, run.events["walks"])
    return (run.events["primary_hits"] / run.events["primary"], 1 - len(np.unique(primary["pixel"])) / walks,
            run.events["steps"] / walks)


@study("objects", one_scene=True)
def objects(lab, scenes):
    size, runs, depths, words = lab.size(96), {}, [], []
    for count in COUNTS:
        some = scenes_of(count)
        for protocol, options in PROTOCOLS.items():
            for kind, drawn in some.items():
                runs[count, kind, protocol] = [render(lab, one, size, async_=True, **options) for one in drawn]
        for kind in (EVEN, RANDOM):
            hits, firsts, voxels = zip(*(depth_of(lab, one, size) for one in some[kind]))
            depths.append({"objects": count, "kind": kind, "hit (% of primary rays)": 100 * np.mean(hits),
                           "end in the first voxel (% of those in the box)": 100 * np.mean(firsts),
                           "voxels a ray in the box": np.mean(voxels), "half": estimate(voxels).half})
        if count in (COUNTS[0], COUNTS[-1]):
            for more in OTHER_WORDS:
                run = render(lab, some[EVEN][0], size, **{**PROTOCOLS[PAPER], "packet_words": more})
                words.append({"objects": count, "words a ray": more, "overlapped (ms)": run.overlapped_ms,
                              "stepwise (ms)": run.stepwise_ms})
    rows = pd.DataFrame([row_of(key, some) for key, some in runs.items()])
    ratios = pd.DataFrame([ratio_of(runs, count, kind, protocol) for protocol in PROTOCOLS for kind in (RANDOM, WITHIN)
                           for count in COUNTS])
    growth = [(kind, protocol, growth_of(runs[COUNTS[0], kind, protocol], runs[COUNTS[-1], kind, protocol]))
              for protocol in PROTOCOLS for kind in (EVEN, RANDOM)]
    depths, words = pd.DataFrame(depths), pd.DataFrame(words)
    more = ["The scenes that were named are not in it: the study makes its own, as the scenes of Yoshitani & Yamazaki "
            "were."] if scenes else []
    return Page({"nodes": "4x4x4", "voxels": "4x4x4", "links": "torus2d", "size": size, "bounces": 0, "format": "fp32",
                 "words": papers.RAY_WORDS, "seeds": SEEDS, "objects": list(COUNTS)},
                findings_of(runs, rows, ratios, growth, depths, words) + more,
                claims=[claim_of_random(ratios), claim_of_growth(growth), claim_of_depth(growth)],
                tables=tables_of(rows, ratios, growth, depths, words), plots=plots_of(rows, ratios, depths),
                news=["Yoshitani & Yamazaki print no times for Fig. 4 and one scene of each kind; here are intervals "
                      "over scenes, both protocols, copies kept apart from crowds, and the sub-linearity taken apart."],
                clock=CLOCK)


def row_of(key, runs):
    count, kind, protocol = key
    columns = ("copies", "tests a ray", "steps a ray", "returns", "rays thrown away", "u")
    row = {"objects": count, "kind": kind, "protocol": protocol, "scenes": len(runs),
           **pd.DataFrame([run.row(columns) for run in runs]).mean()}
    for time in TIMES:
        e = estimate([getattr(run, f"{time}_ms") for run in runs])
        row[f"{time} (ms)"], row[f"{time} +- (ms)"] = e.mean, e.half
    return {**row, "busiest node computes (ms)": np.mean([run.compute_ms for run in runs]),
            "the root alone (ms)": np.mean([run.root_ms for run in runs])}


def ratio_of(runs, count, kind, protocol):
    """Random scenes over the even one of as many objects: times as long."""
    even, some = runs[count, EVEN, protocol][0], runs[count, kind, protocol]
    return {"objects": count, "kind": kind, "protocol": protocol,
            **{time: estimate([getattr(run, f"{time}_ms") / getattr(even, f"{time}_ms") for run in some])
               for time in TIMES}}


def growth_of(first, last):
    """Objects over time, of each scene, as a product of four factors."""
    def one(a, b):
        steps, tests = b.events["steps"] / a.events["steps"], b.tests / a.tests
        work, time, count = b.work_ms / a.work_ms, b.overlapped_ms / a.overlapped_ms, COUNTS[-1] / COUNTS[0]
        return {"objects": count, "time": time, "objects / time": count / time, "fewer voxels a ray": 1 / steps,
                "tests a voxel grow less": count * steps / tests, "fixed costs": tests / work,
                "one node's bound": work / time}
    return pd.DataFrame([one(a, b) for a, b in zip(first, last)])


def of(rows, kind, protocol):
    return rows[(rows["kind"] == kind) & (rows["protocol"] == protocol)].reset_index(drop=True)


def texts_of(some, time):
    return ", ".join(f"{e.text(2)} ({count})" for e, count in zip(some[time], some["objects"]))


def claim_of_random(ratios):
    """By the machine without supersteps, as theirs is; its bounds stand next to it."""
    some = of(ratios, RANDOM, PAPER)
    slower = sum(e.low > 1 for e in some["asynchronous"])
    not_slower = sum(e.low <= 1 and e.high < NOTICED for e in some["asynchronous"])
    return Claim(papers.TP, "Fig. 4", "Random objects take longer than even ones, as those that straddle voxels are "
                 "registered more than once.",
                 verdict(slower == len(some), slower == 0 and 2 * not_slower >= len(some)),
                 f"Random over even, without supersteps: {texts_of(some, 'asynchronous')}. Slower, by the 95 % "
                 f"interval, for {slower} of {len(some)} numbers of objects; not slower, or by less than 2 %, for "
                 f"{not_slower}. Its bounds: overlapped {texts_of(some, 'overlapped')}; stepwise "
                 f"{texts_of(some, 'stepwise')}.")


def claim_of_growth(growth):
    even, random = growth[0][2], growth[1][2]
    of_even, of_random = estimate(even["objects / time"]), estimate(random["objects / time"])
    return Claim(papers.TP, "Fig. 4", "Time does not grow linearly with the objects.",
                 verdict(min(of_even.least, of_random.least) > LINEAR, min(of_even.most, of_random.most) <= LINEAR),
                 f"{even['objects'][0]:.0f} times the objects take {even['time'][0]:.2f} times the time, even; "
                 f"{estimate(random['time']).text(2)} times, random.")


def claim_of_depth(growth):
    """The paper's reason is the right one where it explains more than half, of logarithms, in both kinds."""
    even, random = growth[0][2], growth[1][2]
    shares = [estimate(np.log(rows["fewer voxels a ray"]) / np.log(rows["objects / time"])) for rows in (even, random)]
    return Claim(papers.TP, "Fig. 4", "That is since the share of rays that end in the front voxels differs.",
                 verdict(min(e.least for e in shares) > 0.5, min(e.most for e in shares) <= 0.5),
                 f"Rays end earlier: fewer voxels a ray explain a factor of {even['fewer voxels a ray'].mean():.2f} of "
                 f"{even['objects / time'].mean():.2f} even, {random['fewer voxels a ray'].mean():.2f} of "
                 f"{random['objects / time'].mean():.2f} random; that is {100 * shares[0].mean:.0f} % and "
                 f"{100 * shares[1].mean:.0f} % of it by logarithms.")


def findings_of(runs, rows, ratios, growth, depths, words):
    random = of(rows, RANDOM, OWN)
    first, last = random.iloc[0], random.iloc[-1]
    copies = (f"Is it the copies? Random objects are registered {1 + first['copies'] / first['objects']:.2f} times "
              f"each where there are {first['objects']} and {1 + last['copies'] / last['objects']:.2f} times where "
              f"there are {last['objects']}. Moved until none lies astride, they take "
              f"{texts_of(of(ratios, WITHIN, OWN), 'overlapped')} times as long as even ones where all nodes make "
              "primary rays: what remains is that voxels hold unequal numbers.")
    a, b = (depths[depths["kind"] == EVEN].iloc[i] for i in (0, -1))
    (va, vb), end = (one["voxels a ray in the box"] for one in (a, b)), "end in the first voxel (% of those in the box)"
    theirs, ours = runs[COUNTS[0], EVEN, PAPER][0], runs[COUNTS[0], EVEN, OWN][0]
    even = of(rows, EVEN, PAPER).set_index("objects")
    longer = words["overlapped (ms)"].values / even["overlapped (ms)"][words["objects"]].values
    more = ", ".join(f"{w['words a ray']:.0f} words take {times:.2f} times as long ({w['objects']:.0f} objects)"
                     for times, (_, w) in zip(longer, words.iterrows()))
    return [*findings_of_protocol(rows, ratios, PAPER), *findings_of_protocol(rows, ratios, OWN), copies,
            *(finding_of_growth(*one) for one in growth),
            f"A primary ray in the box goes through {va:.2f} voxels where there are {a['objects']} even objects and "
            f"through {vb:.2f} where there are {b['objects']}, {va / vb:.2f} times fewer; {a[end]:.0f} % and "
            f"{b[end]:.0f} % end in the first one.",
            f"{theirs.events['primary']} primary rays bring home {theirs.returns} returns by the protocol of {PAPER} "
            f"and {ours.returns} where each term is one; there, all nodes together make {ours.discarded} primary rays "
            f"that they discard ({COUNTS[0]} even objects).",
            f"Larger ray packets than the {papers.RAY_WORDS} words of Table 1, overlapped: {more}."]


def findings_of_protocol(rows, ratios, protocol):
    some, even = of(ratios, RANDOM, protocol), of(rows, EVEN, protocol)
    yield (f"Protocol of {protocol}: random over even is {texts_of(some, 'asynchronous')} without supersteps, "
           f"{texts_of(some, 'overlapped')} overlapped, {texts_of(some, 'stepwise')} stepwise (objects in brackets).")
    bound = even[even["the root alone (ms)"] >= even["overlapped (ms)"]]
    ms = bound["the root alone (ms)"]
    yield (f"Protocol of {protocol}: in no even scene does the machine wait for the root." if not len(bound) else
           f"Protocol of {protocol}: with {', '.join(map(str, bound['objects']))} even objects the machine waits for "
           f"the root, {ms.min():.0f} to {ms.max():.0f} ms; there the time is that of making rays and taking in "
           "returns, not of the objects.")


def finding_of_growth(kind, protocol, rows):
    mean = rows.mean()
    return (f"Protocol of {protocol}, {kind}: {mean['objects']:.0f} times the objects take "
            f"{estimate(rows['time']).text(2)} times the time, {estimate(rows['objects / time']).text(2)} times less "
            f"than in proportion. As a product: {mean['fewer voxels a ray']:.2f} as rays go through fewer voxels, "
            f"{mean['tests a voxel grow less']:.2f} as a voxel's tests grow less than the objects, "
            f"{mean['fixed costs']:.2f} for what does not depend on objects, {mean.iloc[-1]:.2f} for what one node or "
            "link holds up.")


def tables_of(rows, ratios, growth, depths, words):
    spread = ratios[["objects", "kind", "protocol"]].copy()
    for time in TIMES:
        spread[time], spread[f"{time} +-"] = [e.mean for e in ratios[time]], [e.half for e in ratios[time]]
    factors = pd.DataFrame([{"kind": kind, "protocol": protocol, **some.mean()} for kind, protocol, some in growth])
    factors.insert(5, "+-", [estimate(some["objects / time"]).half for *_, some in growth])
    return [Table("objects", "Time and work for each number of objects", rows),
            Table("objects-ratios", "Random over even", spread),
            Table("objects-growth", "Why time grows less than the objects: objects / time as a product", factors),
            Table("objects-primary", "How deep primary rays go", depths.drop(columns="half")),
            Table("objects-words", "Larger ray packets, from the root, a return for each ray, even scenes", words)]


def plots_of(rows, ratios, depths):
    def times(name, title, protocol, time):
        column = f"{time} (ms)"
        even = of(rows, EVEN, protocol)
        series = [Series(kind, some["objects"], some[column], half_widths=some[f"{time} +- (ms)"])
                  for kind in (EVEN, RANDOM, WITHIN) for some in [of(rows, kind, protocol)]]
        linear = Series("as the objects, from the even scene's first", even["objects"],
                        even[column][0] * even["objects"] / even["objects"][0])
        return Plot(name, title, "objects", "modelled ms", series + [linear], "xy")

    title = "Time by the protocol of Yoshitani & Yamazaki"
    ratio = [Series(f"{kind}, protocol: {protocol}", some["objects"], [e.mean for e in some["asynchronous"]],
                    half_widths=[e.half for e in some["asynchronous"]])
             for protocol in PROTOCOLS for kind in (RANDOM, WITHIN) for some in [of(ratios, kind, protocol)]]
    return [times("objects-async", f"{title}, without supersteps", PAPER, "asynchronous"),
            times("objects", f"{title}, overlapped", PAPER, "overlapped"),
            times("objects-stepwise", f"{title}, stepwise", PAPER, "stepwise"),
            times("objects-raya", "Time by raya's protocol, overlapped", OWN, "overlapped"),
            Plot("objects-ratios", "Random over even, without supersteps", "objects", "times as long", ratio, "x"),
            Plot("objects-depth", "How deep primary rays go", "objects", "voxels a ray in the box",
                 series_by(depths, "kind", "objects", "voxels a ray in the box", "half"), "x")]
