#!/usr/bin/env python3
"""Recomputes the figures of the studies of Figs 7, 8 and 9 and Tables 2 and 3 from `raya render --cost --report`.

    tests/tools/test_study_figures.py RAYA     RAYA: the built program

Independent of raya's code: implements the cyclic mapping, u, speed-ups and times again, and uses only raya's output files.
"""
import json, math, struct, subprocess, sys, tempfile, unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
SCENE = ROOT / "scenes" / "glass.nff"
SIZE = 48
# Ratio of the filter's time, 7 ms (FILTER_ARITHMETIC_MS of tools/lab/papers.py), to its budget: 42 cycles of 100 ns for each of 256 pixels.
TIME_PER_BUDGET = 7 / (256 * 42 * 100e-6)


def run(*arguments):
    done = subprocess.run([RAYA, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(done.stderr)


def read_pfm(path):
    """Returns the rows of a grey PFM file, top row first."""
    kind, size, scale, values = path.read_bytes().split(b"\n", 3)
    assert kind == b"Pf" and float(scale) < 0
    width, height = map(int, size.split())
    flat = struct.unpack(f"<{width * height}f", values)
    return [flat[row * width:(row + 1) * width] for row in reversed(range(height))]


def loads(cost, p, pes=SIZE):
    """Returns the load of each PE. Slot i has the pixels in row j and column (j p + i) mod N. PE k has the slots with i mod (number of PEs) = k."""
    sums = [0] * pes
    for j, row in enumerate(cost):
        for i in range(SIZE):
            sums[i % pes] += row[(j * p + i) % SIZE]
    return sums


def imbalance(sums):
    mean = sum(sums) / len(sums)
    return (max(sums) - mean) / mean


def table(page, name):
    """Returns the rows of a table: dictionaries {column name without unit: value}."""
    found = next(candidate for candidate in page["tables"] if candidate["name"] == name)
    labels = [column.rsplit(" (", 1)[0] for column in found["columns"]]
    return [dict(zip(labels, row)) for row in found["rows"]]


def our_figure(page, what):
    return next(comparison["ours"] for comparison in page["comparisons"] if comparison["what"] == what)


class Figures(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.scratch = tempfile.TemporaryDirectory()
        folder = Path(cls.scratch.name)
        cls.reports = {}
        for p in (0, 16):
            run("render", SCENE, "-o", folder / "image.pfm", "--machine", "spa", "--pes", SIZE, "--size", SIZE, "--offset", p,
                "--cost", folder / f"{p}.pfm", "--report", folder / f"{p}.json")
            cls.reports[p] = json.loads((folder / f"{p}.json").read_text())
        cls.cost = read_pfm(folder / "0.pfm")
        cls.cost_at_offset_16 = read_pfm(folder / "16.pfm")
        cls.pages = {}
        for study in ("fig7", "fig8", "fig9", "table2", "table3"):
            run("study", study, SCENE, "--size", SIZE, "-o", folder / study)
            cls.pages[study] = json.loads((folder / study / f"{study}.json").read_text())

    @classmethod
    def tearDownClass(cls):
        cls.scratch.cleanup()

    def test_pixel_cost_does_not_depend_on_its_pe(self):
        self.assertEqual(self.cost, self.cost_at_offset_16)

    def test_loads_equal_those_of_the_report(self):
        for p, report in self.reports.items():
            sums = loads(self.cost, p)
            self.assertEqual(sums, report["load"]["per_pe"])
            rows = table(self.pages["fig7"], "fig7")
            self.assertEqual(sums, [row[f"p = {p}"] for row in rows])

    def test_u_of_every_offset(self):
        rows = table(self.pages["fig8"], "fig8")
        self.assertEqual(len(rows), SIZE)
        for row in rows:
            self.assertAlmostEqual(row["u"], imbalance(loads(self.cost, row["p"])), delta=1e-12)
        self.assertNotAlmostEqual(rows[5]["u"], imbalance(loads(self.cost, 6)), delta=1e-6)  # the comparison would detect another offset

    def test_speed_ups_of_every_number_of_pes(self):
        for row in table(self.pages["fig9"], "fig9"):
            for label, p in (("p = 0, cyclic fold", 0), ("p = 16, cyclic fold", 16)):
                sums = loads(self.cost, p, row["P"])
                self.assertAlmostEqual(row[label], sum(sums) / max(sums), delta=1e-9)

    def test_times_with_one_clock(self):
        total = sum(map(sum, self.cost))
        self.assertAlmostEqual(our_figure(self.pages["table2"], "1 PE: compute"), TIME_PER_BUDGET * total * 100e-6, delta=1e-6)
        speedup = total / max(loads(self.cost, 16))
        other_ms = 2 + 140 + 1130  # transfers of objects and image, display (Table 2)
        self.assertAlmostEqual(our_figure(self.pages["table2"], "speed-up of the whole job"),
                               (64800 + other_ms) / (64800 / speedup + other_ms), delta=1e-9)
        rotation = 10 / 32 - 768 / 6e3 + 3 * SIZE / 6e3  # ms, at 6,000 words per ms; a rotation of 768 words takes 10/32 ms
        for row in table(self.pages["table3"], "table3"):
            p = row["p"]
            ring = 1.375 + 2 * (min(p, SIZE - p) + 1) * rotation
            self.assertAlmostEqual(row["communication"], ring, delta=1e-9)
            tracing = TIME_PER_BUDGET * max(loads(self.cost, p)) * 100e-6
            self.assertAlmostEqual(row["total"], tracing + TIME_PER_BUDGET * 42 * SIZE * 100e-6 + ring, delta=1e-6)

    def test_means_have_student_intervals(self):
        for row in table(self.pages["fig8"], "fig8")[:20]:
            self.assertLessEqual(row["least u"], row["mean u"])
            self.assertLessEqual(row["mean u"], row["largest u"])
            # For 64 views the half width is 2.0 standard errors, and a standard error is at most (range / 2) / sqrt(63).
            self.assertLess(row["+-"], 2.0 * (row["largest u"] - row["least u"]) / 2 / math.sqrt(63) + 1e-12)


if __name__ == "__main__":
    RAYA = sys.argv.pop(1)
    unittest.main()
