"""Table 2: times of the SPA and of other machines

How long does one image take on the SPA with all its PEs, on the SPA with one PE, and on this machine?

- Source: Kohata & Ito 1993, Table 2. The host model follows from Tables 2 and 4.
- {scene} at {size} x {size} pixels, on {size} PEs of the SPA (a PE for each column, p = {offset}) and on one PE. The renders count rays, tests,
  words and transfers. Times are modelled from these counts.
- The time of the display is not modelled. Totals include the printed 1,130 ms (SPA, PC) and 300 ms (workstation).
- The scene of Kohata & Ito is not published. Ours differs, so the milliseconds of computing differ. The speed-up of the whole job in the first
  table follows from our speed-up of computing and from the printed times of one PE, of the transfers and of the display.
- Host model: a call from the host takes the time of its set-up, of its rotations, and of its words at the host's rate. The printed 2 and 12 ms
  (Table 4) and 140 ms (Table 2), each rounded to 1 ms, give a range for each of the three constants.
- Measured on this machine: the reference, raya's renderer in double precision, on one thread; and the kernels of the OpenCL device, without their
  build and without transfers. Warm-up renders are not counted.
- Output: table2.csv has a row for each machine, with times in ms (printed, modelled or measured). table2-factors.csv has the modelled times for
  each factor of the clock. table2-host.csv has the host model.
"""
import time

import pandas as pd
import raya
from raya.lab import Comparison, Page, Picture, Table, first_scene, judged, papers, study, time_calls, with_paper
from raya.lab.laboratory import SPA, format_for
from raya.lab.spa import CLOCK, FACTOR, FACTORS, host_model, run_on_spa, time_of

SAMPLING_S = 10  # seconds: no further run starts after the runs of a series took as long


def job_gain(one_ms, array_ms):
    """Returns the speed-up of Kohata & Ito's complete job, including display, for given computing times of one PE and of all PEs."""
    rest = papers.OBJECTS_MS + papers.IMAGE_MS + papers.DISPLAY_MS
    return (one_ms + rest) / (array_ms + rest)


@study("table2", one_scene=True, measures=True)
def table2(lab, scenes):
    scene, size = first_scene(scenes), lab.size(256)
    array, one = run_on_spa(lab, scene, size, size, 16 % size), run_on_spa(lab, scene, size, 1, 0)
    device = lab.session.device["name"]
    options = dict(machine="grande", bounces=SPA["bounces"], size=size, pes=size, offset=16 % size, accel="none")

    def reference_s():
        start = time.perf_counter()
        raya.reference(scene, size, SPA["bounces"], 1)
        return time.perf_counter() - start

    raya.reference(scene, 32, SPA["bounces"], 1)  # warms up
    here = {"reference, 64 bits, 1 thread": time_calls(reference_s, 3, SAMPLING_S, warm=False),
            **{f"{device}, {form}": time_calls(lambda form=form: lab.render(scene, format=form, **options).device_s, 5, SAMPLING_S)
               for form in ("fp32", SPA["format"])}}
    (reference, fp32, spa22), in_paper = here.values(), papers.is_papers(scene.name, size)
    speedup = array.report["load"]["trace"]["speedup"]
    balance = job_gain(papers.ONE_PE_COMPUTE_MS, papers.ONE_PE_COMPUTE_MS / speedup)
    factors = pd.DataFrame({"factor": FACTORS, "1 PE: compute (ms)": [time_of(one, f)["compute"] for f in FACTORS],
                            "all PEs: compute (ms)": [time_of(array, f)["compute"] for f in FACTORS]})
    factors["speed-up of the whole job"] = job_gain(factors.iloc[:, 1], factors.iloc[:, 2])
    setup, rotation, rate = host_model()
    words = array.report["communication"]["broadcast_words"]
    transfer = setup[0] + 1e3 * words / rate[1], setup[1] + 1e3 * words / rate[0]
    host = pd.DataFrame([("set-up of a call", "ms", *setup), ("rotation of 768 words", "ms", *rotation), ("rate of the host", "words/s", *rate),
                         (f"objects of our scene, {words} words", "ms", *transfer)], columns=["what", "unit", "least", "largest"])
    gflops, megabytes = SPA["pes"] * 2 / SPA["cycle_ns"], SPA["pes"] * SPA["pe_memory_bytes"] / 2**20
    gains = factors["speed-up of the whole job"]
    gain = job_gain(time_of(one)["compute"], time_of(array)["compute"])
    ratio = 1e3 * reference.minimum / time_of(array)["compute"]
    slower = f"{ratio:.3g} times slower than" if ratio >= 1 else f"{1 / ratio:.3g} times faster than"
    findings = [f"{size} PEs compute {speedup:.1f} times faster than one. The whole job, display included, is {gain:.1f} times faster "
                f"with the clock's factor, {gains.iloc[0]:.1f} to {gains.iloc[-1]:.1f} times with factors of 1 to 8.",
                f"The host model gives {host['least'].iloc[-1]:.2f} .. {host['largest'].iloc[-1]:.2f} ms for the transfer of our scene. The paper "
                "prints 2 ms for its scene, but not the scene's number of words.",
                f"A pixel of our scene takes {time_of(one, 1)['compute'] / 100e-6 / size**2:.0f} cycles of the instruction budget. A pixel of Kohata & "
                "Ito's takes 9,888 cycles of 100 ns [D: 64,800 ms / 65,536 pixels], or about 1,520 budget cycles by the clock's factor.",
                f"Measured on this machine, warm: one thread in 64 bits takes {1e3 * reference.minimum:.0f} ms. The device's kernels take "
                f"{1e3 * fp32.minimum:.1f} ms in fp32 and {1e3 * spa22.minimum:.1f} ms in the SPA's format, whose slowest of "
                f"{spa22.runs} runs took {100 * (spa22.maximum / spa22.minimum - 1):.0f} % longer than the fastest one. One thread is {slower} "
                "the SPA by its modelled computing time."]
    return Page({"scene": scene.name, "size": size, "pes": [size, 1], "offset": 16 % size,
                 "format": format_for(scene), "factor": FACTOR, "device": device},
                findings,
                with_paper(in_paper, comparisons_of(size, time_of(array), time_of(one), speedup, balance,
                                                    1e3 * reference.minimum)),
                [judged("totals-of-table-1", None, "", f"The modelled machine has {gflops:.2f} GFLOPS (each PE: two operations in a cycle of "
                        f"{SPA['cycle_ns']:g} ns), {megabytes:g} MB.")] if in_paper and not scenes else [],
                [Table("table2", "Times of one image", rows_of(size, array, one, here, in_paper)),
                 Table("table2-factors", "Computing times, and speed-up of the whole job, for each factor of the clock", factors),
                 Table("table2-host", "Host model: range of each figure, from the rounding of the printed 2, 12 and 140 ms", host)],
                pictures=[Picture("table2-picture", f"{scene.name} at {size} x {size}, rendered by the PEs",
                                  "glass and mirror spheres in the middle of the image, above a checkered plane"
                                  if scene.name == "centre" else "the scene of the command line",
                                  array.png)],
                clock=CLOCK, compared_with=papers.SPA)


def rows_of(size, array, one, here, in_paper):
    rows = []
    if in_paper:
        for name, *ms in (("PC, 50 ns, 64 bits", 0, papers.PC_MS, 0, papers.DISPLAY_MS),
                          ("workstation, 25 ns, 64 bits", 0, papers.WORKSTATION_MS, 0, 300),
                          ("SPA, 256 PEs", papers.OBJECTS_MS, papers.COMPUTE_MS, papers.IMAGE_MS, papers.DISPLAY_MS),
                          ("SPA, 1 PE", papers.OBJECTS_MS, papers.ONE_PE_COMPUTE_MS, papers.IMAGE_MS,
                           papers.DISPLAY_MS)):
            rows.append((f"Kohata & Ito: {name}", "printed", *ms, sum(ms)))
    for name, t in ((f"SPA, {size} PEs", time_of(array)), ("SPA, 1 PE", time_of(one))):
        rows.append((name, "modelled", t["objects"], t["compute"], t["image"], t["display"], t["total"]))
    for name, times in here.items():
        for which in ("minimum", "median", "maximum"):
            ms = 1e3 * getattr(times, which)
            rows.append((f"here: {name}", f"measured warm, {which} of {times.runs}", None, ms, None, None, ms))
    return pd.DataFrame(rows, columns=["machine", "figures", "objects (ms)", "compute (ms)", "image transfer (ms)",
                                       "display (ms)", "total (ms)"])


def comparisons_of(size, array, one, speedup, balance, reference):
    display = "contains the display, whose rate is fitted to the printed 1,130 ms"
    cycle_ms = 100e-6 * FACTOR  # milliseconds of a budget cycle, with the clock's factor
    rows = [(f"{size} PEs: objects", "ms", papers.OBJECTS_MS, array["objects"], "set-up + words of the scene / rate of the host"),
            (f"{size} PEs: compute", "ms", papers.COMPUTE_MS, array["compute"], "the paper's scene differs from ours"),
            (f"{size} PEs: image transfer", "ms", papers.IMAGE_MS, array["image"],
             "the host's rate is derived from this printed figure"),
            (f"{size} PEs: total", "ms", papers.TOTAL_MS, array["total"], display),
            ("1 PE: compute", "ms", papers.ONE_PE_COMPUTE_MS, one["compute"], "the paper's scene differs from ours"),
            ("1 PE: total", "ms", papers.ONE_PE_TOTAL_MS, one["total"], display),
            ("cycles a pixel", "", papers.ONE_PE_COMPUTE_MS / cycle_ms / papers.SIZE**2,
             one["compute"] / cycle_ms / size**2, "of the instruction budget; the paper's: printed time / time of a budget cycle", True),
            ("speed-up of computing", "", papers.SPEEDUP_16, speedup, "does not depend on the clock"),
            ("speed-up of the whole job", "", None, balance,
             "the paper's is 42.5, but any u up to 0.44 gives that within 5 %; "
             "ours: from our speed-up of computing and the printed times of one PE, transfers and display"),
            ("PC, and this machine", "ms", papers.PC_MS, reference,
             "one processor, 64 bits; ours: the reference on one thread of this machine, measured"),
            ("workstation, and this machine", "ms", papers.WORKSTATION_MS, reference, "one processor, 64 bits; ours: the same measurement")]
    return [Comparison(*row) for row in rows]
