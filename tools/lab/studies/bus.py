"""Neighbours over the ring and over the bus

The array of Kohata & Ito (1993) has a ring and a bus that also carries words from PE to PE and from one PE to all:
what is the ring for?

- {scene} at {size} x {size} on 4 to 256 PEs of the SPA, cyclic mapping with p = round(sqrt(P)), filtered and
  supersampled; neighbours' pixels come by rotations, by transfers from PE to PE, or by a broadcast of each PE
  (`--exchange`). All moves and words are counted in renders.
- Transfers: to each PE the share of the PE that is so far away, for each distance at which neighbours live; 4 P of
  them with an offset a side. Broadcasts: P a side for the filter, whose sums have an order; P in all for comparisons.
- PEs have room for whole shares, more than the SPA's for fewer than 256 PEs. The exchange's set-up, the same for every
  way, is left out.
"""
import pandas as pd
from raya.lab import Page, Plot, Series, Table, holding_to_the_end, one_of, study
from raya.lab.laboratory import SPA, format_for
from raya.lab.voxels import powers

WAYS = {"ring": "rotations", "bus": "transfers", "bus-broadcast": "pe_broadcasts"}


def exchange(lab, scene, size, pes, antialias, way):
    """(moves, modelled ms, ms by words alone, hash) of the exchange of neighbours by one way."""
    result = lab.render(scene, machine="grande", format=format_for(scene), bounces=SPA["bounces"], size=size, pes=pes,
                        offset=round(pes**0.5) % size, accel="none", antialias=antialias, exchange=way)
    c, ms = result.report["communication"], result.report["modelled_ms"]["communication"]
    words = c["transfer_words"] + c["pe_broadcast_words"]
    return c[WAYS[way]], ms, 1e3 * words / SPA["link_words_per_s"] if words else ms, result.hash


def rows_of(lab, scene, size, antialias):
    rows = []
    for pes in powers(min(256, size * size))[2:]:
        ring, bus, cast = (exchange(lab, scene, size, pes, antialias, way) for way in WAYS)
        rows.append({"anti-aliasing": antialias, "P": pes, "p": round(pes**0.5) % size, "rotations": ring[0],
                     "ring (ms)": ring[1], "transfers": bus[0], "bus (ms)": bus[1], "bus, words alone (ms)": bus[2],
                     "broadcasts": cast[0], "broadcasts, time (ms)": cast[1], "broadcasts, words alone (ms)": cast[2],
                     "bus / ring": bus[1] / ring[1], "broadcasts / ring": cast[1] / ring[1],
                     "same": ring[3] == bus[3] == cast[3]})
    return pd.DataFrame(rows)


def wins_from(rows, bus):
    """From which P on the ring takes less than the better of the bus's two ways."""
    pes = holding_to_the_end(rows["P"], rows["ring (ms)"] < bus)
    return f"from {pes.iloc[0]} PEs on" if len(pes) else "nowhere up to there"


def finding_of_ring(rows):
    best = rows[["bus (ms)", "broadcasts, time (ms)"]].min(1)
    least = rows[["bus, words alone (ms)", "broadcasts, words alone (ms)"]].min(1)
    last = rows.iloc[-1]
    return (f"{last['anti-aliasing']}: the ring takes least {wins_from(rows, best)}; {wins_from(rows, least)}, if the "
            f"bus had to wait for words alone. On {last['P']} PEs it takes {last['ring (ms)']:.1f} ms for "
            f"{last['rotations']} rotations, the bus {last['bus (ms)']:.1f} ms for {last['transfers']} transfers or "
            f"{last['broadcasts, time (ms)']:.1f} ms for {last['broadcasts']} broadcasts: "
            f"{best.iloc[-1] / last['ring (ms)']:.1f} times as long at best, {least.iloc[-1] / last['ring (ms)']:.1f} "
            "times by words alone.")


def plot_of(rows):
    method, bus, cast = rows["anti-aliasing"].iloc[0], "bus, PE to PE", "broadcasts by PEs"
    columns = {"ring": "ring (ms)", bus: "bus (ms)", cast: "broadcasts, time (ms)",
               f"{bus}, words alone": "bus, words alone (ms)", f"{cast}, words alone": "broadcasts, words alone (ms)"}
    return Plot(f"bus-{method}", f"Time of the exchange against the number of PEs, {method}", "PEs",
                "exchange (modelled ms)", [Series(label, rows["P"], rows[c]) for label, c in columns.items()], "xy")


@study("bus", one_scene=True)
def bus(lab, scenes):
    scene, size = one_of(scenes), lab.size(256)
    ways = [rows_of(lab, scene, size, method) for method in ("filter", "supersample")]
    rows = pd.concat(ways, ignore_index=True)
    return Page({"scene": scene.name, "size": size, "pes": ways[0]["P"].tolist(), "format": format_for(scene)},
                [*map(finding_of_ring, ways),
                 f"In {rows['same'].sum()} of {len(rows)} cases the three ways give the same image, bit for bit.",
                 "Words are why: the bus carries all pixels once for each side, or once in all, however many PEs there "
                 "are; on the ring P links carry at once, so that a rotation's words fall as 1 / P and its number "
                 "grows only as sqrt(P)."],
                tables=[Table("bus", "The exchange of neighbours by each way", rows.drop(columns="same"))],
                plots=[*map(plot_of, ways)],
                news=["Kohata & Ito name both ways and measure the ring. Here the same exchange is made by each, on "
                      "every size of the array."],
                clock="modelled: a rotation takes its words at 6 Mword/s, as printed, and 0.1845 ms of "
                "synchronisation, which Tables 3 and 4 leave [D]. No time is printed for a transfer from PE to PE: it "
                "is given the same, one transfer after another; and, as the least that it can take, its words alone. "
                "No computing is in these times, so no factor either.")
