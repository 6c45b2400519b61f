"""Neighbours over the ring and over the bus

The array of Kohata & Ito (1993) has a ring, and a bus that carries words from PE to PE and from one PE to all. How much faster is the exchange
of neighbouring pixels over the ring?

- Source: Kohata & Ito 1993, description of the array; times of a rotation from Tables 3 and 4.
- {scene} at {size} x {size} on 4 to 256 PEs of the SPA, cyclic mapping with p = round(sqrt(P)), filtered and supersampled. The neighbours'
  pixels come by rotations of the ring, by transfers from PE to PE over the bus, or by a broadcast of each PE (`--exchange`). The renders
  count all rotations, transfers, broadcasts and words.
- Transfers: each PE receives the share of every PE at the ring distances of its neighbours; with an offset these are 4 P transfers a side.
  Broadcasts: P a side for the filter, whose sums have a fixed order; P in total for comparisons.
- PEs have memory for whole shares, which on fewer than 256 PEs is more than the SPA's. The set-up of the exchange is the same for every
  method and is included.
- Output: bus.csv has a row for each anti-aliasing method and number of PEs: counts, and modelled times in ms. "words alone" excludes
  synchronisation.
"""
import pandas as pd
from raya.lab import Page, Plot, Series, Table, first_scene, study, tail_where
from raya.lab.laboratory import SPA, format_for
from raya.lab.voxels import powers_of_two

METHODS = {"ring": "rotations", "bus": "transfers", "bus-broadcast": "pe_broadcasts"}  # {--exchange: count in the report}


def exchange(lab, scene, size, pes, antialias, method):
    """Exchanges neighbouring pixels by one method. Returns (number of rotations, transfers or broadcasts; modelled ms; ms without synchronisation;
    image hash)."""
    result = lab.render(scene, machine="grande", format=format_for(scene), bounces=SPA["bounces"], size=size, pes=pes,
                        offset=round(pes**0.5) % size, accel="none", antialias=antialias, exchange=method)
    c, ms = result.report["communication"], result.report["modelled_ms"]["communication"]
    words = c["transfer_words"] + c["pe_broadcast_words"]
    return c[METHODS[method]], ms, SPA["setup_ms"] + 1e3 * words / SPA["link_words_per_s"] if words else ms, result.hash


def rows_of(lab, scene, size, antialias):
    rows = []
    for pes in powers_of_two(min(256, size * size))[2:]:
        ring, bus, broadcast = (exchange(lab, scene, size, pes, antialias, method) for method in METHODS)
        rows.append({"anti-aliasing": antialias, "P": pes, "p": round(pes**0.5) % size, "rotations": ring[0],
                     "ring (ms)": ring[1], "transfers": bus[0], "bus (ms)": bus[1], "bus, words alone (ms)": bus[2],
                     "broadcasts": broadcast[0], "broadcasts, time (ms)": broadcast[1], "broadcasts, words alone (ms)": broadcast[2],
                     "bus / ring": bus[1] / ring[1], "broadcasts / ring": broadcast[1] / ring[1],
                     "same": ring[3] == bus[3] == broadcast[3]})
    return pd.DataFrame(rows)


def ring_is_faster_from(rows, bus_ms):
    """Part of a sentence: the number of PEs from which on the ring takes less time than the faster of the two bus methods."""
    pes = tail_where(rows["P"], rows["ring (ms)"] < bus_ms)
    return f"from {pes.iloc[0]} PEs on" if len(pes) else f"for no number of PEs up to {rows['P'].iloc[-1]}"


def finding_of_ring(rows):
    best = rows[["bus (ms)", "broadcasts, time (ms)"]].min(1)
    words = rows[["bus, words alone (ms)", "broadcasts, words alone (ms)"]].min(1)
    last = rows.iloc[-1]
    return (f"{last['anti-aliasing']}: the ring is fastest {ring_is_faster_from(rows, best)}; {ring_is_faster_from(rows, words)} if the "
            f"bus takes only the time of its words. On {last['P']} PEs the ring takes {last['ring (ms)']:.1f} ms for "
            f"{last['rotations']} rotations, the bus {last['bus (ms)']:.1f} ms for {last['transfers']} transfers or "
            f"{last['broadcasts, time (ms)']:.1f} ms for {last['broadcasts']} broadcasts: at best "
            f"{best.iloc[-1] / last['ring (ms)']:.1f} times as long, {words.iloc[-1] / last['ring (ms)']:.1f} times without synchronisation.")


def plot_of(rows):
    method, bus, broadcast = rows["anti-aliasing"].iloc[0], "bus, PE to PE", "broadcasts by PEs"
    columns = {"ring": "ring (ms)", bus: "bus (ms)", broadcast: "broadcasts, time (ms)",
               f"{bus}, words alone": "bus, words alone (ms)", f"{broadcast}, words alone": "broadcasts, words alone (ms)"}
    return Plot(f"bus-{method}", f"Time of the exchange against the number of PEs, {method}", "PEs",
                "exchange (modelled ms)", [Series(label, rows["P"], rows[c]) for label, c in columns.items()], "xy")


@study("bus", one_scene=True)
def bus(lab, scenes):
    scene, size = first_scene(scenes), lab.size(256)
    by_method = [rows_of(lab, scene, size, method) for method in ("filter", "supersample")]
    rows = pd.concat(by_method, ignore_index=True)
    return Page({"scene": scene.name, "size": size, "pes": by_method[0]["P"].tolist(), "format": format_for(scene)},
                [*map(finding_of_ring, by_method),
                 f"In {rows['same'].sum()} of {len(rows)} cases the three methods give the same image, bit for bit.",
                 "The reason is the number of words. The bus carries all pixels once for each side, or once in total, however many PEs "
                 "there are. On the ring P links carry words at once: the words of a rotation fall as 1 / P, and the number of rotations "
                 "grows only as sqrt(P)."],
                tables=[Table("bus", "The exchange of neighbours by each method", rows.drop(columns="same"))],
                plots=[*map(plot_of, by_method)],
                news=[f"On {rows['P'].iloc[-1]} PEs the exchange of neighbours takes at least {rows[['bus / ring', 'broadcasts / ring']].iloc[-1].min():.0f} times "
                      "as long over the bus as over the ring."],
                clock="modelled. A rotation takes the time of its words at the printed 6 Mword/s plus 0.1845 ms of synchronisation, which follows "
                "from Tables 3 and 4 [D]. No time is printed for a transfer from PE to PE: we assume the same rate and synchronisation, one "
                "transfer after another; \"words alone\" is the minimum, without synchronisation. These times contain no computing, so the "
                "clock's factor does not apply.")
