"""Hash and counts of renders, as in tests/portability/renders.csv and gpu_day.csv: rows {"hash": ..., COUNTS}, by scene and options."""
import csv

import programs

SCENES = ["centre", "spheres", "mirrors", "glass", "polygons", "cones", "planes"]
COUNTS = ["primary", "primary_hits", "reflected", "refracted", "shadow", "shadow_hits", "sphere", "plane", "polygon", "cone", "walks", "steps",
          "hits", "lit", "highlights", "cycles", "discarded", "packets", "hops"]


def read(path):
    """Returns {(scene, options): row}; empty if there is no file."""
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")] if path.exists() else []
    return {(row.pop("scene"), row.pop("options")): row for row in csv.DictReader(lines)}


def write(path, header, rows):
    """Writes the rows as read() returns them, below the lines of `header`."""
    lines = [["scene", "options", "hash", *COUNTS], *([*key, *row.values()] for key, row in rows.items())]
    programs.write_whole(path, header + "".join(",".join(line) + "\n" for line in lines))


def row_of(report):
    """Returns the row of a render's report. cycles: sum of the modelled cycles of all PEs or nodes; packets: packets made on the torus."""
    torus = report.get("torus", {"discarded": 0, "packets": {}, "hops": 0})
    packets = sum(kind["made"] for kind in torus["packets"].values())
    found = {**report["rays"], **report["tests"], **report["shading"], "walks": report["walks"], "steps": report["steps"],
             "cycles": sum(report["load"]["per_pe"]), "discarded": torus["discarded"], "packets": packets, "hops": torus["hops"]}
    return {"hash": report["image"]["hash"], **{name: str(found[name]) for name in COUNTS}}


def difference(found, right):
    """Returns the differences between two rows; empty if there are none. Counts are not compared if the image differs."""
    if found["hash"] != right["hash"]:
        return f"wrong image {found['hash']}; right: {right['hash']}"
    wrong = [f"{name} is {found[name]}, right: {right.get(name)}" for name in COUNTS if found[name] != right.get(name)]
    return f"wrong counts: {'; '.join(wrong)}" if wrong else ""
