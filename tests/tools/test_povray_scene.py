#!/usr/bin/env python3
"""Tests tools/povray_scene.py: reading NFF, triangulating polygons, and that POV-Ray's image equals raya's.

    tests/tools/test_povray_scene.py RAYA     RAYA: the built program. Exit code 77: POV-Ray is missing (Debian: povray), the other tests pass
"""
import re, shutil, struct, subprocess, sys, tempfile, unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(ROOT / "tools"))
import povray_scene as translation  # noqa: E402

# Every kind of object and surface: checkers on all axes, a concave polygon, an object visible from inside, glass, lights with and without a colour.
SCENE = """# comment
b 0.4 0.5 0.7
v
from 0.5 -9 4.6
at 0.2 0 1.1
up 0 0.1 1
angle 40
hither 1
resolution 48 48
l -6 -7 10 0.62 0.6 0.55
l 6 -5 6
f 0.8 0.75 0.65 0.85 0 0 0 1
#raya checker 0.85 0.8 0.7 0.3 0.3 0.5 1.5
#raya plane 0 0 2 0
#raya checker 1 0.5 0.5 0.2 0.4 0.9 0.7
p 4
-3 -1 0  -3 3 0  -3 3 3  -3 -1 3
#raya checker 0.5 1 0.5 0.9 0.4 0.2 0.7
p 4 -3 3 0  3 3 0  3 3 3  -3 3 3
f 0.45 0.25 0.12 0.7 0.2 30 0 1
p 6
1 2 0
3 2 0
3 2 1 # the notch
2 2 1
2 2 3
1 2 3
c -2.4 0.8 0 0.2   -2.4 0.8 0.8 0.2
c -2.4 0.8 0.6 1   -2.4 0.8 1.9 0
c 0.4 -1.3 0.1 -0.5  0.4 -1.3 1.4 -0.8
s -0.5 1 0.8 0.8
pp 3
1.2 -1 1 -0.5 -1 0.5
2.4 -1 1 0.5 -1 0.5
1.8 -0.6 2 0 -1 0.8
f 1 1 1 0.02 0.1 100 0.85 1.5
s -1.5 -2 0.8 0.8
"""

# (text of the POV-Ray scene, faulty replacement)
FAULTS = [("no_shadow", ""), ("max_trace_level 3", "max_trace_level 2"), ("texture { Clear } interior_texture", "texture"),
          (" open ", " "), ("ior 1.5", "ior 1.0"), ("translate <-500000000.0, 0.0, 0.0>", "translate <-500000000.0, 0.5, 0.0>")]
SIZE, BOUNCES = 96, 2


def numbers_of_ppm(file):
    """Returns the values of a PPM file with 16 bits a channel, linear, 0..1."""
    data = file.read_bytes()
    head = re.match(rb"P6\s(?:#.*\n)*\d+\s\d+\s(\d+)\s", data)
    assert head[1] == b"65535", head
    return [x[0] / 65535 for x in struct.iter_unpack(">H", data[head.end():])]


def numbers_of_pfm(file):
    """Returns the values of a PFM file, clamped to 0..1 as in a PPM file, top row first."""
    _, size, scale, data = file.read_bytes().split(b"\n", 3)
    width, height = map(int, size.split())
    row = 3 * width
    given = struct.unpack(f"{'<' if float(scale) < 0 else '>'}{row * height}f", data)
    return [min(1, max(0, x)) for y in reversed(range(height)) for x in given[y * row:(y + 1) * row]]


def area(a, b, c):
    return 0.5 * sum(x * x for x in translation.cross(translation.minus(b, a), translation.minus(c, a))) ** 0.5


def converted(text, name="scene"):
    return translation.povray_scene(text, name, BOUNCES, SIZE, SIZE)


class Reading(unittest.TestCase):
    text = converted(SCENE)

    def count(self, pattern):
        return len(re.findall(pattern, self.text))

    def test_every_kind_of_object_is_read_with_its_numbers(self):
        for part in ("location <0.5, -9.0, 4.6>", "background { color rgb <0.4, 0.5, 0.7> }", "light_source { <-6.0, -7.0, 10.0> color rgb <0.62, 0.6, 0.55> }",
                     "light_source { <6.0, -5.0, 6.0> color rgb <0.353", "sphere { <-0.5, 1.0, 0.8>, 0.8 ", "sphere { <-1.5, -2.0, 0.8>, 0.8 ",
                     "plane { <0.0, 0.0, 1.0>, 0.0 ", "cone { <-2.4, 0.8, 0.6>, 1.0, <-2.4, 0.8, 1.9>, 0.0 open", "cylinder { <-2.4, 0.8, 0.0>, <-2.4, 0.8, 0.8>, 0.2",
                     "cone { <0.4, -1.3, 0.1>, 0.5, <0.4, -1.3, 1.4>, 0.8 open texture { Clear } interior_texture"):
            self.assertIn(part, self.text)
        self.assertEqual((self.count(r"\btriangle {"), self.count("smooth_triangle {"), self.count("mesh {")), (8, 1, 3))
        normal = re.search(r"<2.4, -1.0, 1.0>, <([^>]*)>", self.text)[1]
        self.assertAlmostEqual(sum(float(x) ** 2 for x in normal.split(", ")), 1)

    def test_surfaces_have_their_checkers(self):
        self.assertIn("color rgb <0.8, 0.75, 0.65>", converted(SCENE.replace("#raya checker 0.85", "# 0.85")))
        self.assertIn("transmit 0.85", self.text)
        self.assertIn("ior 1.5", self.text)
        scales = re.findall(r"checker color rgb (<[^>]*>) .*? scale (<[^>]*>)", self.text)
        self.assertEqual(scales, [("<0.85, 0.8, 0.7>", "<1.5, 1.5, 1000000000.0>"), ("<1.0, 0.5, 0.5>", "<1000000000.0, 0.7, 0.7>"),
                                  ("<0.5, 1.0, 0.5>", "<0.7, 1000000000.0, 0.7>")])

    def test_invalid_nff_is_refused(self):
        for text, reason in [("b 0 0 0\ntt 1", "unknown entity 'tt'"), ("b 0 0\n\nl 1 1 1", "could not convert string to float: 'l'"),
                             ("s 1 1 1", "pop from empty list"), ("plane 0 0 1 0", "unknown entity 'plane'"), ("b 0 0 0", "no 'v'"),
                             ("v from 0 0 0 form", "'form'")]:
            with self.assertRaisesRegex(translation.SceneError, f"x.nff: .*: {reason}"):
                converted(text, "x.nff")

    def test_polygons_without_area_are_left_out(self):
        self.assertEqual(converted(SCENE + "p 3 0 0 0 1 1 1 2 2 2\np 2 0 0 0 1 0 0\n"), self.text)


class Triangles(unittest.TestCase):
    # A comb, with many concave corners.
    comb = [(0, 0), (6, 0), (6, 3), (5, 3), (5, 1), (4, 1), (4, 3), (3, 3), (3, 1), (2, 1), (2, 3), (0, 3)]

    def cut(self, vertices, expected_area):
        found = translation.triangles(vertices)
        self.assertEqual(len(found), len(vertices) - 2)
        self.assertAlmostEqual(sum(area(*(vertices[i] for i in corners)) for corners in found), expected_area)  # no overlaps, nothing outside

    def test_concave_outlines_on_all_axes_in_both_orientations(self):
        for place in (lambda u, v: (1.0, u, v), lambda u, v: (v, 1.0, u), lambda u, v: (u, v, 1.0), lambda u, v: (u, v, u + v)):
            area_factor = 3 ** 0.5 if place(1, 1) == (1, 1, 2) else 1
            outline = [place(u, v) for u, v in self.comb]
            for shift in range(len(outline)):
                self.cut(outline[shift:] + outline[:shift], 14 * area_factor)
                self.cut((outline[shift:] + outline[:shift])[::-1], 14 * area_factor)

    def test_a_hole_joined_to_the_outline_is_not_covered(self):
        outline = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 1), (1, 2), (2, 2), (2, 1), (1, 1)]
        self.cut([(u, v, 0.0) for u, v in outline], 15)


class Picture(unittest.TestCase):
    def setUp(self):
        if not shutil.which("povray"):
            self.skipTest("no povray (Debian: povray)")
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        (self.folder / "scene.nff").write_text(SCENE)
        subprocess.run([RAYA, "render", "scene.nff", "-o", "raya.pfm", "--machine", "grande", "--format", "fp32", "--lanes", "1", "--size", str(SIZE),
                        "--bounces", str(BOUNCES), "--quiet"], cwd=self.folder, check=True)
        self.raya_values = numbers_of_pfm(self.folder / "raya.pfm")

    def differing_fraction(self, text):
        """Renders a POV-Ray scene. Returns the fraction of the values that differ from raya's."""
        (self.folder / "scene.pov").write_text(text)
        command = ["povray", "+Iscene.pov", "+Opovray.ppm", "+FP16", "File_Gamma=1.0", f"+W{SIZE}", f"+H{SIZE}", "-A", "-D", "-V", "-GA"]
        done = subprocess.run(command, cwd=self.folder, capture_output=True, text=True)
        self.assertEqual(done.returncode, 0, done.stderr)
        found = numbers_of_ppm(self.folder / "povray.ppm")
        self.assertEqual(len(found), len(self.raya_values))
        return sum(abs(a - b) > 0.002 for a, b in zip(found, self.raya_values)) / len(found)

    def test_picture_equals_rayas_and_faults_are_detected(self):
        text = converted(SCENE)
        self.assertLess(self.differing_fraction(text), 0.001)
        for old, new in FAULTS:
            self.assertIn(old, text)
            with self.subTest(old=old, new=new):
                self.assertGreater(self.differing_fraction(text.replace(old, new)), 0.01)


if __name__ == "__main__":
    RAYA = str(Path(sys.argv[1]).resolve())
    outcome = unittest.main(argv=sys.argv[:1], exit=False).result
    sys.exit(1 if not outcome.wasSuccessful() else 77 if outcome.skipped else 0)
