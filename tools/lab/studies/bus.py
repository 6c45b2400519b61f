"""Neighbours over the ring and over the bus

The array of Kohata & Ito (1993) has a ring, and a bus that carries words from PE to PE and from one PE to all. How much faster is the exchange
of neighbouring pixels over the ring?

- Source: Kohata & Ito 1993, description of the array; times of a rotation from Tables 3 and 4.
- {scene} at {size} x {size} on 4 to 256 PEs of the SPA, cyclic mapping with p = round(sqrt(P)), filtered and supersampled. The neighbouring
  pixels come by rotations of the ring, by transfers from PE to PE over the bus, or by broadcasts from one PE after another (`--exchange`).
  The renders count all rotations, transfers, broadcasts and words. A PE's share is the pixels that it owns.
- Transfers: for each of the four sides, every PE receives the shares of all PEs that own neighbours of its pixels: P transfers per side if
  P divides the number of columns. Broadcasts: P per side for the filter, which adds the sides in a fixed order; P in total for supersampling.
- The modelled PEs have enough memory for whole shares. On fewer than 256 PEs this is more memory than that of the SPA's PEs. The set-up of the
  exchange takes the same time with every method and is included.
- Output: bus.csv has a row for each anti-aliasing method and number of PEs: counts, and modelled times in ms. "words alone" excludes
  synchronisation.
"""
import pandas as pd
from raya.lab import Page, Plot, Series, Table, first_from, first_scene, study
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


def finding_of_ring(rows):
    best = rows[["bus (ms)", "broadcasts, time (ms)"]].min(1)
    words = rows[["bus, words alone (ms)", "broadcasts, words alone (ms)"]].min(1)
    last = rows.iloc[-1]
    faster = [first_from(rows["P"], rows["ring (ms)"] < bus_ms) for bus_ms in (best, words)]
    whole, alone = (f"from {pes} PEs on" if pes else f"for no number of PEs up to {last['P']}" for pes in faster)
    return (f"{last['anti-aliasing']}: the ring is fastest {whole}, and {alone} if bus "
            f"transfers need no synchronisation. On {last['P']} PEs the ring takes {last['ring (ms)']:.1f} ms for "
            f"{last['rotations']} rotations, the bus {last['bus (ms)']:.1f} ms for {last['transfers']} transfers or "
            f"{last['broadcasts, time (ms)']:.1f} ms for {last['broadcasts']} broadcasts. The faster bus method takes "
            f"{best.iloc[-1] / last['ring (ms)']:.1f} times as long, {words.iloc[-1] / last['ring (ms)']:.1f} times without synchronisation.")


def plot_of(rows):
    method, bus, broadcast = rows["anti-aliasing"].iloc[0], "bus, PE to PE", "broadcasts by PEs"
    columns = {"ring": "ring (ms)", bus: "bus (ms)", broadcast: "broadcasts, time (ms)",
               f"{bus}, words alone": "bus, words alone (ms)", f"{broadcast}, words alone": "broadcasts, words alone (ms)"}
    return Plot(f"bus-{method}", f"Time of the exchange against the number of PEs, {method}", "PEs",
                "time of the exchange (modelled ms)", [Series(label, rows["P"], rows[c]) for label, c in columns.items()], "xy")


@study("bus", one_scene=True)
def bus(lab, scenes):
    scene, size = first_scene(scenes), lab.size(256)
    by_method = [rows_of(lab, scene, size, method) for method in ("filter", "supersample")]
    rows = pd.concat(by_method, ignore_index=True)
    last = rows.iloc[-1]
    best = {"bus": min(last["bus (ms)"], last["broadcasts, time (ms)"]),
            "words": min(last["bus, words alone (ms)"], last["broadcasts, words alone (ms)"])}
    return Page({"scene": scene.name, "size": size, "pes": by_method[0]["P"].tolist(), "format": format_for(scene)},
                [*map(finding_of_ring, by_method),
                 "The P links of the ring carry words at the same time. Up to one PE per column, the words per link in a rotation fall as "
                 "1 / P, and the number of rotations grows only as sqrt(P). The bus carries all pixels once for each side, or once in "
                 "total, however many PEs there are.",
                 f"In {rows['same'].sum()} of {len(rows)} cases the three methods give the same image, bit for bit."],
                tables=[Table("bus", "The exchange of neighbouring pixels by each method", rows.drop(columns="same"))],
                plots=[*map(plot_of, by_method)],
                news=[f"On {last['P']} PEs the exchange of neighbours takes {best['bus'] / last['ring (ms)']:.1f} times as long over the bus as over "
                      f"the ring, if a transfer over the bus takes the synchronisation of a rotation, and {best['words'] / last['ring (ms)']:.1f} "
                      "times if it takes none."],
                clock="modelled. A rotation takes the time of its words at the printed 6 Mword/s plus 0.1845 ms of synchronisation, which follows "
                "from Tables 3 and 4 [D]. No time is printed for a transfer from PE to PE: we assume the same rate and synchronisation, one "
                "transfer after another. \"words alone\" is a lower bound, without synchronisation. The factor by which the clock model "
                "scales computing times does not apply, because these times contain no computing.")
