#!/usr/bin/env python3
"""Follows docs/extend.md (a primitive) in a copy of the sources, and builds raya. Adds disks, of which the image must be the same on the torus and with each
accelerator, and nearly that of polygons of 96 corners.
  test_how_to.py ROOT FOLDER     FOLDER: for the copy and its build, which later runs reuse"""
import json, math, subprocess, sys
from pathlib import Path

root, copy = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
PRIMITIVE = [  # (file, text after which the step inserts, inserted text)
    ("kernels/shared/job.h", "#define RAYA_FIXED_LIST(KIND) KIND(cone, cones, CONE)", " KIND(disk, disks, DISK)"),
    ("kernels/shared/job.h", "    RAYA_CONE_WORDS\n};\n", """
enum {  // words of a disk after those of its plane
    RAYA_DISK_CENTRE = RAYA_OBJECT_WORDS,
    RAYA_DISK_SQUARE = RAYA_DISK_CENTRE + 3,  // r^2
    RAYA_DISK_WORDS
};
"""),
    ("kernels/shared/events.h", 'EVENT(RAYA_CONE_TESTS, "cone_tests", "tests.cone")            /* against a cone or cylinder */                 \\\n',
     '    EVENT(RAYA_DISK_TESTS, "disk_tests", "tests.disk") /* against a disk */ \\\n'),
    ("kernels/geometry/disk.clh", "", """// Intersection of a ray with a disk.
#ifndef RAYA_DISK_CLH
#define RAYA_DISK_CLH
#include "kernels/geometry/polygon.clh"

static inline mask is_in_disk(const ray r, vec centre, real square, real t) {
    const vec arm = vec_mad(r.direction, t, vec_sub(r.origin, centre));
    return (t > 0.0f) & (vec_dot(arm, arm) <= square);
}

static inline hit hit_disk(hit h, const ray* r, const ray_frame* f, words scene, words disk, uint object) {
    const real t = plane_distance(*r, vec_at(disk), real_at(disk + RAYA_PLANE_DISTANCE));
    const mask found = is_in_disk(*r, vec_at(disk + RAYA_DISK_CENTRE), real_at(disk + RAYA_DISK_SQUARE), t);
    return nearer(h, found & (t < h.distance), t, object);
}

#endif
"""),
    ("kernels/geometry/listed.clh", '#include "kernels/geometry/cone.clh"\n', '#include "kernels/geometry/disk.clh"\n'),
    ("kernels/geometry/listed.clh", "    return nearer_listed(h, wanted & found.found, found.t, number);\n}\n", """
static inline hit hit_listed_disks(hit h, const ray r, const ray_frame* f, words scene, mask wanted, index at,
                                   index number) {
    const lanes_row plane = gather_row(scene, at);
    const index centre_at = choose_index(wanted, at + (uint)RAYA_DISK_CENTRE, at);
    const vec centre = gather_vec(scene, centre_at);
    const real square = gather_real(scene, choose_index(wanted, at + (uint)RAYA_DISK_SQUARE, at));
    const real t = plane_distance(r, plane.first3, plane.fourth);
    return nearer_listed(h, wanted & is_in_disk(r, centre, square, t), t, number);
}
"""),
    ("kernels/geometry/scene.clh", "#define RAYA_CONES 1  // 0: the scene has no cones\n#endif\n", """#ifndef RAYA_DISKS
#define RAYA_DISKS 1  // 0: the scene has no disks
#endif
"""),
    ("kernels/bvh/leaves.clh", "    *t = found.t;\n    return found.found;\n}\n", """
static inline mask leaf_disks(const ray* r, words leaf, int one, real* t) {
    const vec normal = leaf_vec(leaf, one), centre = leaf_vec(leaf + RAYA_DISK_CENTRE * RAYA_BVH_WIDTH, one);
    *t = plane_distance(*r, normal, leaf_real(leaf + RAYA_PLANE_DISTANCE * RAYA_BVH_WIDTH, one));
    return is_in_disk(*r, centre, leaf_real(leaf + RAYA_DISK_SQUARE * RAYA_BVH_WIDTH, one), *t);
}
"""),
    ("host/scene/scene.hpp", "    bool operator==(const Cone&) const = default;\n};\n", """
struct Disk {
    Vec3 centre, normal;  // the normal has length 1
    double radius = 1;
    int surface = 0;
    bool operator==(const Disk&) const = default;
};
"""),
    ("host/scene/scene.hpp", "    std::vector<Cone> cones;\n", "    std::vector<Disk> disks;\n"),
    ("host/scene/scene.cpp", "        extent = std::max(extent, largest_coordinate(c.apex) + std::abs(c.apex_radius));\n    }\n",
     "    for (const Disk& d : scene.disks) extent = std::max(extent, largest_coordinate(d.centre) + d.radius);\n"),
    ("host/scene/scene.cpp", "        extend_by_disk(box, c.apex, c.apex_radius, axis);\n    }\n",
     "    for (const Disk& d : scene.disks) extend_by_disk(box, d.centre, d.radius, d.normal);\n"),
    ("host/scene/scene.cpp", "    for (const Sphere& s : scene.spheres) visit(std::abs(s.radius));\n", "    for (const Disk& d : scene.disks) visit(d.radius);\n"),
    ("host/scene/nff_parse.cpp", "    void read_cone();\n", "    void read_disk();\n"),
    ("host/scene/nff_parse.cpp", '{"c", &NffReader::read_cone},', ' {"d", &NffReader::read_disk},'),
    ("host/scene/nff_parse.cpp", "    scene_.cones.push_back(cone);\n}\n", """
void NffReader::read_disk() {
    Disk disk;
    disk.centre = read_vector("the centre");
    disk.normal = unit_vector(read_vector("the normal"));
    disk.radius = read_length("the radius");
    disk.surface = current_surface_;
    if (disk.radius <= 0) refuse("the radius of the disk is not positive");
    scene_.disks.push_back(disk);
}
"""),
    ("host/scene/nff.cpp", "text_of(c.apex), c.apex_radius);\n    }\n", """
    void write(const Disk& d) {
        write_surface(d.surface, false);
        write_line("d {} {} {}", text_of(d.centre), text_of(d.normal), d.radius);
    }
"""),
    ("host/scene/packer.cpp", "    put_index(words, c.base_radius < 0 || c.apex_radius < 0 ? 1 : 0);\n}\n", """
void pack(JobWords& words, const Disk& d, const std::vector<std::uint32_t>& surface_at) {
    put(words, d.normal);
    put_length(words, d.normal.dot(d.centre));
    words.push_back(surface_at[d.surface]);
    put_length(words, d.centre);
    put_square(words, d.radius * d.radius);
}
"""),
    ("host/accel/hit_regions.cpp", "    widen(region.box, region.outer_radius);\n    return region;\n}\n", """
HitRegion HitRegions::disk(std::size_t at) const {
    HitRegion region;
    region.centre = vector(at + RAYA_DISK_CENTRE);
    const double radius = std::sqrt(real(at + RAYA_DISK_SQUARE));
    region.outer_radius = radius + (24 * unit_ + 1.5 * stretch_) * (max_distance(region.centre) + radius) + 4 * std::sqrt(smallest_);
    region.box = Box(region.centre, region.centre);
    widen(region.box, region.outer_radius);
    return region;
}
"""),
    ("host/model/budget.cpp", 'The 40 operations hide the loads of its 10 words"},\n',
     '    {.event = RAYA_DISK_TESTS, .multiply_accumulates = 7 + 6 + 3, .divisions = 1, .branches = 2, .additions = 14, .multiplications = 12, .work = "all"},\n'),
]


def run(*command):
    return subprocess.run([str(argument) for argument in command], cwd=copy, check=True, stdout=subprocess.PIPE, text=True).stdout


def sources():
    """Returns {file: contents} of the copy: those of the checkout, with the steps."""
    names = subprocess.run(["git", "-C", root, "ls-files"], capture_output=True, text=True, check=True).stdout.splitlines()
    texts = {name: (root / name).read_bytes() for name in names if (root / name).is_file()}
    for file, before, inserted in PRIMITIVE:
        if not before:
            assert file not in texts, file
            texts[file] = inserted.encode()
            continue
        assert texts[file].count(before.encode()) == 1, f"{file}: not once: {before}"
        texts[file] = texts[file].replace(before.encode(), (before + inserted).encode())
    return texts


def render(scene, *options):
    run("build/raya", "render", scene, *options, "--report", "r.json", "-o", "x.ppm")
    return json.loads((copy / "r.json").read_text())


def disk_scene(name, corners):
    """Writes a scene of a hundred disks, or if `corners` is not 0 of polygons with so many corners. Returns its name."""
    lines = ["b 0.1 0.2 0.3", "v", "from 0 0 12", "at 0 0 0", "up 0 1 0", "angle 45", "hither 1", "resolution 60 60", "l 5 9 20", "l -9 3 8"]
    for i in range(100):
        a, b = 2.4 * i, math.asin(2 * (i + 0.5) / 100 - 1)  # points of a sphere, about evenly apart
        normal = [math.cos(a) * math.cos(b), math.sin(a) * math.cos(b), math.sin(b)]
        centre, radius = [3.7 * x for x in normal], 0.3 + 0.002 * i
        tilt = [normal[1] + 0.3, normal[2] - 0.1, normal[0] + 0.2]
        u = [tilt[(k + 1) % 3] * normal[(k + 2) % 3] - tilt[(k + 2) % 3] * normal[(k + 1) % 3] for k in range(3)]
        u = [x / math.dist(u, (0, 0, 0)) for x in u]
        v = [normal[(k + 1) % 3] * u[(k + 2) % 3] - normal[(k + 2) % 3] * u[(k + 1) % 3] for k in range(3)]
        lines.append(f"f {0.2 + i / 200} 0.6 {1 - i / 120} 0.7 0.3 20 0 1")
        if not corners:
            lines.append(f"d {' '.join(map(str, centre + normal))} {radius}")
            continue
        lines.append(f"p {corners}")
        for n in range(corners):
            angle = 2 * math.pi * n / corners
            lines.append(" ".join(str(centre[k] + radius * (math.cos(angle) * u[k] + math.sin(angle) * v[k])) for k in range(3)))
    (copy / name).write_text("\n".join(lines) + "\n")
    return name


def check_primitive():
    disks, polygons = disk_scene("disks.nff", 0), disk_scene("polygons.nff", 96)
    for name in ("fp32", "spa22"):
        machines = [["--accel", accel] for accel in ("none", "grid", "bvh")] + [["--machine", "torus", "--nodes", "2x2x2"]]
        reports = [render(disks, "--format", name, *machine) for machine in machines]
        assert len({report["image"]["hash"] for report in reports}) == 1, [report["image"]["hash"] for report in reports]
        tests = [report["tests"]["disk"] for report in reports]
        assert 0 < tests[2] < tests[0] / 2, tests
        hits, same = (report["rays"]["primary_hits"] for report in (reports[0], render(polygons, "--format", name, "--machine", "grande")))
        assert 500 < hits < 3600 and abs(hits - same) < 0.01 * hits, (name, hits, same)


copy.mkdir(parents=True, exist_ok=True)
for name, text in sources().items():
    if not (copy / name).is_file() or (copy / name).read_bytes() != text:
        (copy / name).parent.mkdir(parents=True, exist_ok=True)
        (copy / name).write_bytes(text)
        (copy / name).chmod((root / name).stat().st_mode if (root / name).is_file() else 0o644)
run("cmake", "-S", copy, "-B", copy / "build", "-DBUILD_TESTING=OFF", "-DRAYA_PYTHON=OFF")
run("cmake", "--build", copy / "build", "--target", "raya", "-j2")
check_primitive()
print(f"a primitive in {len({file for file, _, _ in PRIMITIVE})} files: right on both machines")
