"""The asynchronous torus beside SimGrid

Does another simulator take as long for the same history on the same machine?

- A history: what each packet of a render cost its node and which messages it led to ({scene}, {size} x {size} pixels,
  {nodes} nodes, primary rays made by the root or by all nodes, ray packets of 22 words, one return a ray). It holds for
  any order in time, so two simulators can carry it out.
- raya: discrete events of its own (`host/torus/async_machine.hpp`). SimGrid 3.32: hosts, links, actors and messages of
  its S4U interface (`tools/simgrid/replay.cpp`); it shares processors and links by its own solver. The rules are
  common: a main task and a communication task that goes first, one message at a time over each way of a link, ports
  with room for {buffer} messages of a class, two of them free before a ray enters a ring.
- The platform has explicit links and routes between neighbours, two links to a hop: the way, and the wire that both
  ways share. SimGrid's own torus lets a message hold all links of its way at once; transputers store it in every node.
- Effects are switched on one after another, each machine having all that the one before has: computing alone, in which
  messages take no time; the processors' part of messages; links of 1.7 MB/s each way; both ways sharing 2.4 MB/s;
  finite buffers. On the plot they are numbered from 0.
"""
import os
import tempfile

import pandas as pd
import raya
from raya.lab import Comparison, Page, Plot, Series, Table, papers, study
from raya.lab.programs import beside_raya, output_of
from raya.lab.voxels import even_scene, run_on_torus

GOAL, BUFFER = 10, 4  # %, how near the two are to be; messages of a class in a port
ROOMY = {"buffer": 1 << 20}  # no message ever waits for room
NO_LINKS = {"one_way": 0, "both_ways": 0}
# Each machine has all that the one before it has, and one thing more; the last is the machine as it is.
EFFECTS = {"computing alone": {"message_cycles": 0, "word_cycles": 0, **NO_LINKS, **ROOMY},
           "+ processors handle messages": {**NO_LINKS, **ROOMY}, "+ links take time": {"both_ways": 3.4e6, **ROOMY},
           "+ both ways share a link": ROOMY, "+ finite buffers": {}}


def lacks():
    return "" if beside_raya("simgrid_replay") else (
        "SimGrid is not there: no program simgrid_replay lies beside raya. `tools/setup --studies` installs it "
        "(Debian: libsimgrid-dev), then build again.")


def ask_simgrid(result, changes):
    """(messages, ms) by SimGrid."""
    with tempfile.TemporaryDirectory(prefix="raya-simgrid-") as folder:
        platform, replay = os.path.join(folder, "platform.xml"), os.path.join(folder, "replay.txt")
        messages = result.write_replay(platform, replay, **changes)
        words = output_of([beside_raya("simgrid_replay"), platform, replay, "--log=root.thres:error"],
                          "simgrid_replay").split()
    if words[0::2] != ["finish_ms", "delivered"] or int(words[3]) != messages:
        raise raya.InputError(f"simgrid_replay: does not deliver {messages} messages, but prints {' '.join(words)}")
    return messages, float(words[1])


def rows_of(lab, scene, size, links, inject):
    run = run_on_torus(lab, scene, size, (4, 4, 4), (4, 4, 4), links=links, inject=inject, async_=True, returns="rays",
                       packet_words=papers.RAY_WORDS)
    rows, before = [], (0, 0)
    for name, changes in EFFECTS.items():
        messages, theirs = ask_simgrid(run.result, changes)
        ours = run.result.simulate(**changes)
        rows.append({"torus": "4 x 4 x 4" if links == "torus3d" else "8 x 8", "inject": inject, "machine": name,
                     "messages": messages, "raya (ms)": ours, "SimGrid (ms)": theirs,
                     "difference (%)": 100 * (ours / theirs - 1), "raya, the effect (ms)": ours - before[0],
                     "SimGrid, the effect (ms)": theirs - before[1], "overlapped": run.overlapped_ms,
                     "stepwise": run.stepwise_ms})
        before = ours, theirs
    return rows


@study("simgrid", one_scene=True, lacks=lacks)
def simgrid(lab, scenes):
    scene, size = scenes[0] if scenes else even_scene(512), lab.size(48)
    rows = pd.DataFrame([row for links in ("torus3d", "torus2d") for inject in ("root", "all")
                         for row in rows_of(lab, scene, size, links, inject)])
    whole = rows[rows["machine"] == list(EFFECTS)[-1]]
    series = [Series(f"{shape}, {inject}, {who}", range(len(some)), some[f"{who} (ms)"], style)
              for (shape, inject), some in rows.groupby(["torus", "inject"], sort=False)
              for who, style in (("raya", "line"), ("SimGrid", "points"))]
    bounds = [f"{row['torus']}, inject {row['inject']}: the whole machine takes {row['raya (ms)']:.1f} ms, between "
              f"{row['overlapped']:.1f} ms if nothing waited and {row['stepwise']:.1f} ms step by step."
              for _, row in whole.iterrows()]
    return Page({"scene": scene.name, "size": size, "nodes": "4x4x4", "buffer": BUFFER, "goal": GOAL},
                findings_of(rows) + bounds,
                [Comparison(f"{row['torus']}, {row['inject']}, the whole machine, ours / SimGrid", "", None,
                            row["raya (ms)"] / row["SimGrid (ms)"], "modelled, asynchronous")
                 for _, row in whole.iterrows()],
                tables=[Table("simgrid", "Time of one history, by raya and by SimGrid",
                              rows.drop(columns=["overlapped", "stepwise"]))],
                plots=[Plot("simgrid", "Time of the machine, one effect after another", "effects", "modelled ms",
                            series)],
                news=["The asynchronous torus is compared with a simulator that others wrote; neither paper has been."],
                clock="Modelled on T805s from counted cycles, 40 ns each; both simulators have the same rates.")


def findings_of(rows):
    """Whether the two are near one another; the effect, other than computing itself, that takes most."""
    worst = rows.loc[rows["difference (%)"].abs().idxmax()]
    most, where = abs(worst["difference (%)"]), f"{worst['torus']}, inject {worst['inject']}, {worst['machine']}"
    near = (f"On all {len(rows)} machines the two times lie within {GOAL} % of one another; the most that they differ "
            f"is {most:.2g} % ({where})." if most <= GOAL else
            f"The two times are not within {GOAL} % of one another on all {len(rows)} machines: they differ by "
            f"{most:.2f} % on {where}.")
    more = rows[rows["machine"].str.startswith("+")]
    ours, theirs = more["raya, the effect (ms)"], more["SimGrid, the effect (ms)"]
    i = ours.idxmax()
    return [near, f"Of the effects next to computing the largest is that {more['machine'][i][2:]} ({more['torus'][i]}, "
            f"inject {more['inject'][i]}): it adds {ours[i]:.2f} ms by raya and {theirs[i]:.2f} ms by SimGrid. In no "
            f"effect are the two more than {(ours - theirs).abs().max():.3f} ms apart."]
