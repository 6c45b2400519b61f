"""The asynchronous torus, compared with SimGrid

Do raya's discrete-event simulation and SimGrid give the same time for the same work on the same machine?

- Source: SimGrid (Casanova et al. 2014), with the protocol of Yoshitani & Yamazaki, about 1995: ray packets of 22 words (their Table 1).
- Work: for each packet of a render, its cost on its node and the messages that it causes. The render is {scene}, {size} x {size} pixels,
  {nodes} nodes. The root or all nodes make the primary rays; each ray causes one return. The work does not depend on the order of events, so
  both simulators can replay it.
- raya: its own discrete-event simulation (`host/torus/async_machine.hpp`). SimGrid 3.32: hosts, links, actors and messages of its S4U
  interface (`tools/simgrid/replay.cpp`); SimGrid computes how messages share processors and links. Both follow the same rules. A node has a
  main task, and a communication task with priority. A link transfers one message at a time in each direction. A port has {buffer}
  slots for messages of each class (rays, returns). A ray needs two free slots to enter a link of another axis.
- SimGrid's platform has explicit links and routes between neighbours. A hop uses two links: one for its direction, and the wire that both
  directions share. SimGrid's own torus is not used: in it a message occupies all links of its route at once, but transputers store messages
  in every node.
- Effects are added one after another: only computing (messages take no time); the processors' time for messages; links of 1.7 MB/s in each
  direction; both directions share 2.4 MB/s; finite buffers. The plot numbers them from 0.
- The times agree if they differ by at most {goal} % on every machine.
- Output: simgrid.csv has a row for each torus, method of injection and machine: messages, modelled times of both simulators, the part of the
  effect added last (ms), and the difference (%).
"""
import os
import tempfile

import pandas as pd
import raya
from raya.lab import Comparison, Page, Plot, Series, Table, papers, study
from raya.lab.programs import output_of, sibling_program
from raya.lab.voxels import even_scene, run_on_torus

MAX_DIFFERENCE, BUFFER = 10, 4  # maximum difference in %; slots of a port for messages of each class
UNLIMITED = {"buffer": 1 << 20}  # buffers that never fill up
NO_LINKS = {"one_way": 0, "both_ways": 0}
# Each machine adds one effect to the previous machine; the last one is the complete machine.
EFFECTS = {"computing alone": {"message_cycles": 0, "word_cycles": 0, **NO_LINKS, **UNLIMITED},
           "+ processors handle messages": {**NO_LINKS, **UNLIMITED}, "+ links take time": {"both_ways": 3.4e6, **UNLIMITED},
           "+ both ways share a link": UNLIMITED, "+ finite buffers": {}}


def missing():
    """Returns an error message with a remedy if simgrid_replay was not built, else an empty string."""
    return "" if sibling_program("simgrid_replay") else (
        "there is no program simgrid_replay next to raya; remedy: `tools/setup --studies`, which installs SimGrid (Debian: "
        "libsimgrid-dev), then build again")


def simulate_by_simgrid(result, changes):
    """Replays a render with SimGrid on the machine with these changes. Returns (number of messages, finish time in ms)."""
    with tempfile.TemporaryDirectory(prefix="raya-simgrid-") as folder:
        platform, replay = os.path.join(folder, "platform.xml"), os.path.join(folder, "replay.txt")
        messages = result.write_replay(platform, replay, **changes)
        output = output_of([sibling_program("simgrid_replay"), platform, replay, "--log=root.thres:error"],
                           "simgrid_replay").split()
    if output[0::2] != ["finish_ms", "delivered"] or int(output[3]) != messages:
        raise raya.InputError(f"simgrid_replay: expected {messages} delivered messages, found the output '{' '.join(output)}'")
    return messages, float(output[1])


def rows_of(lab, scene, size, links, inject):
    run = run_on_torus(lab, scene, size, (4, 4, 4), (4, 4, 4), links=links, inject=inject, async_=True, returns="rays",
                       packet_words=papers.RAY_WORDS)
    rows, before = [], (0, 0)
    for name, changes in EFFECTS.items():
        messages, theirs = simulate_by_simgrid(run["result"], changes)
        ours = run["result"].simulate(**changes)
        rows.append({"torus": "4 x 4 x 4" if links == "torus3d" else "8 x 8", "inject": inject, "machine": name,
                     "messages": messages, "raya (ms)": ours, "SimGrid (ms)": theirs,
                     "difference (%)": 100 * (ours / theirs - 1), "raya, the effect (ms)": ours - before[0],
                     "SimGrid, the effect (ms)": theirs - before[1], "overlapped": run["overlapped (ms)"],
                     "stepwise": run["stepwise (ms)"]})
        before = ours, theirs
    return rows


@study("simgrid", one_scene=True, missing=missing)
def simgrid(lab, scenes):
    scene, size = scenes[0] if scenes else even_scene(512), lab.size(48)
    rows = pd.DataFrame([row for links in ("torus3d", "torus2d") for inject in ("root", "all")
                         for row in rows_of(lab, scene, size, links, inject)])
    complete = rows[rows["machine"] == list(EFFECTS)[-1]]
    series = [Series(f"{torus}, {inject}, {simulator}", range(len(group)), group[f"{simulator} (ms)"], style)
              for (torus, inject), group in rows.groupby(["torus", "inject"], sort=False)
              for simulator, style in (("raya", "line"), ("SimGrid", "points"))]
    bounds = [f"{row['torus']} torus, rays made by: {row['inject']}. The complete machine takes {row['raya (ms)']:.1f} ms in raya's simulation; "
              f"the bounds are {row['overlapped']:.1f} ms overlapped and {row['stepwise']:.1f} ms stepwise."
              for _, row in complete.iterrows()]
    worst = rows.loc[rows["difference (%)"].abs().idxmax()]
    largest, where = abs(worst["difference (%)"]), f"{worst['torus']} torus, rays made by: {worst['inject']}, {worst['machine']}"
    agreement = (f"On all {len(rows)} machines the two times differ by at most {largest:.2g} % ({where}); the limit is {MAX_DIFFERENCE} %."
                 if largest <= MAX_DIFFERENCE else
                 f"On {len(rows)} machines the two times differ by up to {largest:.2f} % ({where}), more than the limit of {MAX_DIFFERENCE} %.")
    effects = rows[rows["machine"].str.startswith("+")]
    ours, theirs = effects["raya, the effect (ms)"], effects["SimGrid, the effect (ms)"]
    i = ours.idxmax()
    findings = [agreement, f"The largest effect after computing is \"{effects['machine'][i][2:]}\" ({effects['torus'][i]} torus, rays made "
                f"by: {effects['inject'][i]}). It adds {ours[i]:.2f} ms in raya's simulation and {theirs[i]:.2f} ms in SimGrid's. For each effect "
                f"the two simulations differ by at most {(ours - theirs).abs().max():.3f} ms."]
    return Page({"scene": scene.name, "size": size, "nodes": "4x4x4", "buffer": BUFFER, "goal": MAX_DIFFERENCE},
                findings + bounds,
                [Comparison(f"{row['torus']} torus, rays made by: {row['inject']}, complete machine, raya / SimGrid", "", None,
                            row["raya (ms)"] / row["SimGrid (ms)"], "modelled, asynchronous")
                 for _, row in complete.iterrows()],
                tables=[Table("simgrid", "Time of the same work, simulated by raya and by SimGrid, with one more effect in each row",
                              rows.drop(columns=["overlapped", "stepwise"]))],
                plots=[Plot("simgrid", "Time of the machine, with one more effect after another", "number of added effects", "modelled time (ms)",
                            series)],
                news=[f"The times of the asynchronous torus by raya and by SimGrid differ by at most {rows['difference (%)'].abs().max():.2g} %."],
                clock="modelled for T805 transputers from counted cycles of 40 ns; both simulators use the same rates.")
