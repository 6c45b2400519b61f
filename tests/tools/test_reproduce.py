#!/usr/bin/env python3
"""Tests `raya verify --reproduce` with injected faults: each case must fail on the faulty kernel or driver and pass on the right one.

    test_reproduce.py RAYA PATCH_KERNELS CL_FAULTS [--reduce]

RAYA is the program, PATCH_KERNELS tests/patch_kernels, CL_FAULTS the library made of tests/cli/cl_faults.cpp.
--reduce: only the kernel faults that take longest, two random kernels reduced on their syntax tree, and two cases
reduced with cvise to fewer than 60 lines. Exit code 77: no C compiler, or no cvise or Oclgrind.
"""
import os, re, shlex, shutil, subprocess, sys, tempfile
from pathlib import Path

MAX_PROGRAM_LINES, MAX_REDUCED_LINES = 200, 60
# (check, file, text, replacement): faults of kernels.
KERNEL_FAULTS = [
    ("number e5m10", "number/reduced.clh", "even = ~(bits <<", "even = (bits <<"),
    ("geometry known hits of spheres, fp32", "geometry/sphere.clh", "& (t < h.distance)",
     "& ((t < h.distance) | ((t == h.distance) & (h.object != RAYA_NO_OBJECT)))"),
    ("machine mapping: cyclic, block fold", "shared/mapping.h", "(raya_u64)a * b / c", "a * b / c"),
    ("machine torus3d: exchange of few mailboxes", "torus/exchange.cl", "target[i] = source[i];", "target[i] = source[i] ^ (uint8)(1);"),
    ("image glass fp32: tiles", "shading/tree.clh", "count_event(t, RAYA_REFLECTED, m);", ""),
    ("number fp32", "number/divide.clh", "return a / b;", "return a * (1.0f / b);"),
]
SLOW_KERNEL_FAULTS = [
    ("image glass fp32 filter", "ring/filter.cl", "raya_has_neighbour(m, pixel, RAYA_RIGHT)", "1"),
    ("image polygons fp32: cyclic:8 on 20, grid", "grid/grid_search.clh", "count_event(t, RAYA_WALKS, w.on);", ""),
    ("image polygons fp32: cyclic:8 on 20, bvh", "bvh/ray_pool.clh", "RAYA_WALKS, p->queued.truth", "RAYA_STEPS, p->queued.truth"),
    ("image polygons fp32: torus3d 2x2x2, launches", "torus/inject.cl", "2 * RAYA_DISCARDED", "2 * RAYA_PRIMARY"),
]
# (check, RAYA_FAULT of cl_faults.cpp, words of the case's description): faults of a driver and its compiler.
DRIVER_FAULTS = [
    ("number e5m10", "clBuildProgram 0 max(a,b)=(b)", "launch of operations"),  # the check knows the right words
    ("image glass fp32: cyclic:8 on 20", "clBuildProgram 1 fabs(a)=(a)", "launch of trace"),  # right with -cl-opt-disable
    ("number e5m10", "clBuildProgram 0 max(a,b)=%", "build of checks/numbers.cl"),
    ("number fp32", "clEnqueueNDRangeKernel 1 -5", "launch of operations"),
]
REDUCED_FAULTS = [("number e5m10", "clBuildProgram 0 max(a,b)=(b)"), ("number e6m15", "clBuildProgram 0 min(a,b)=(a)")]


class Test:
    def __init__(self, raya, patch_kernels, cl_faults, folder):
        self.raya, self.patch_kernels, self.cl_faults, self.folder, self.count = raya, patch_kernels, cl_faults, folder, 0

    def expect(self, right, what, output=""):
        if not right:
            sys.exit(f"FAILED: {what}\n{output}")

    def verify(self, check, *options, fault=None):
        """Runs raya verify on one check with 16 lanes. Returns (exit code, output)."""
        environment = {**os.environ, **({"LD_PRELOAD": self.cl_faults, "RAYA_FAULT": fault} if fault else {})}
        done = subprocess.run([self.raya, "verify", "--lanes", "16", *options], env=environment, capture_output=True, text=True)
        return done.returncode, done.stdout + done.stderr

    def new_folder(self):
        self.count += 1
        return self.folder / f"case{self.count}"

    def make(self, folder, output):
        self.expect(folder.is_dir(), f"no folder {folder.name}", output)
        done = subprocess.run(["make", "-C", str(folder), "CC=cc -Wextra -pedantic -Werror"], capture_output=True, text=True)
        self.expect(done.returncode == 0, "make", done.stdout + done.stderr)
        self.expect(len((folder / "repro.c").read_text().splitlines()) < MAX_PROGRAM_LINES, "repro.c is too long")

    def repro(self, folder, *arguments, fault=None, **variables):
        """Runs the case from another folder. Returns (exit code, output)."""
        environment = {**os.environ, **variables, **({"LD_PRELOAD": self.cl_faults, "RAYA_FAULT": fault} if fault else {})}
        done = subprocess.run([str(folder / "repro"), *map(str, arguments)], env=environment, capture_output=True, text=True, cwd="/")
        return done.returncode, done.stdout + done.stderr

    def kernel_fault(self, check, file, text, replacement):
        folder, kernels = self.new_folder(), self.folder / f"kernels{self.count}"
        subprocess.run([self.patch_kernels, str(kernels), file, text, replacement], check=True)
        code, output = self.verify(check, "--only", check, "--kernel-dir", str(kernels), "--reproduce", str(folder))
        self.expect(code == 4, f"verify of a faulty kernel: exit code {code}", output)
        self.make(folder, output)
        code, output = self.repro(folder)
        self.expect(code == 1 and "expected 0x" in output, f"{check}: the case of the faulty kernel: exit code {code}", output)
        code, output = self.repro(folder, folder / "right.cl")
        self.expect(code == 0, f"{check}: the case with the right kernel: exit code {code}", output)
        return folder

    def nan_signs(self):
        """Every NaN is right, whatever its sign, as in verify; a number of the other sign is wrong."""
        folder, store = self.kernel_fault(*KERNEL_FAULTS[-1]), "store_operations(a, b, c, results + first, rows);"
        right = (folder / "right.cl").read_text()
        self.expect(right.count(store) == 1, f"not one '{store}'")
        for condition, wanted in (("(*w & 0x7fffffff) > 0x7f800000", 0), ("(*w & 0x7fffffff) == 0x7f800000", 1)):  # NaN; infinity
            loop = f"for (uint i = 0; i < 16 * RAYA_LANES; ++i) {{ __global uint* w = results + first + i / RAYA_LANES * rows + i % RAYA_LANES; " \
                   f"if ({condition}) *w ^= 0x80000000; }}"
            (folder / "signs.cl").write_text(right.replace(store, store + loop))
            code, output = self.repro(folder, folder / "signs.cl")
            self.expect(code == wanted, f"other signs where {condition}: exit code {code}", output)

    def driver_fault(self, check, fault, description):
        folder = self.new_folder()
        code, output = self.verify(check, "--only", check, "--reproduce", str(folder), fault=fault)
        self.expect(code == 4 and description in output, f"verify with a faulty driver: exit code {code}", output)
        self.make(folder, output)
        code, output = self.repro(folder, fault=fault)
        self.expect(code == 1, f"{check}: the case with the faulty driver: exit code {code}", output)
        code, output = self.repro(folder)
        self.expect(code == 0, f"{check}: the case with the right driver: exit code {code}", output)
        return folder

    def endless_loop(self):
        """A launch that does not end becomes a case after --timeout."""
        folder, kernels = self.new_folder(), self.folder / f"kernels{self.count}"
        subprocess.run([self.patch_kernels, str(kernels), "checks/machine.cl", "uint sides = 0;",
                        "uint sides = 0;\n    for (volatile int endless = 1; endless;) {}"], check=True)
        code, output = self.verify("", "--only", "machine mapping: rows", "--timeout", "10", "--kernel-dir", str(kernels), "--reproduce", str(folder))
        self.expect(code == 4 and "launch of find_owners" in output, f"verify of an endless loop: exit code {code}", output)
        self.make(folder, output)
        self.expect(self.repro(folder, SECONDS="5")[0] == 1, "the case of an endless loop")
        self.expect(self.repro(folder, folder / "right.cl", SECONDS="60")[0] == 0, "the case of an endless loop with the right kernel")

    def random_kernel(self, fault, description):
        """A random kernel with a wrong word, or one that ends the process, is reduced on its syntax tree."""
        folder = self.new_folder()
        code, output = self.verify("", "--random", "25", "--seed", "3", "--reproduce", str(folder), fault=fault)
        sizes = re.search(r"reduced from (\d+) to (\d+) statements", output)
        self.expect(code == 4 and description in output and sizes, f"random kernels with {fault}: exit code {code}", output)
        print(f"random kernels, {fault}: {sizes[0]}", flush=True)
        self.expect(int(sizes[2]) < 30 < int(sizes[1]), sizes[0])
        self.make(folder, output)
        self.expect(self.repro(folder, fault=fault)[0] == 1, "the case of a random kernel with the faulty driver")
        self.expect(self.repro(folder)[0] == 0, "the case of a random kernel with the right driver")

    def messages(self):
        """Exit code 125, a folder that is not empty, and a check that passes."""
        check, fault, description = DRIVER_FAULTS[0]
        folder = self.driver_fault(check, fault, description)
        self.expect(self.repro(folder, DEVICE="no such device")[0] == 125, "DEVICE of another name")
        (folder / "arg0_operands.in").unlink()
        self.expect(self.repro(folder)[0] == 125, "no input file")
        code, output = self.verify(check, "--only", check, "--reproduce", str(folder))
        self.expect(code == 2 and "is not an empty folder" in output, f"a folder that is not empty: exit code {code}", output)
        code, output = self.verify(check, "--only", check, "--reproduce", str(self.new_folder()))
        self.expect(code == 0 and not (self.folder / f"case{self.count}").exists(), f"a check that passes: exit code {code}", output)
        code, output = self.verify(check, "--only", "machine bus: broadcast", "--reproduce", str(self.new_folder()), fault="clEnqueueReadBuffer 1 -5")
        self.expect(code == 4 and "no case of" in output, f"a fault of transfers: exit code {code}", output)

    def reduce(self):
        self.random_kernel("clBuildProgram 0 popcount(a)=clz(a)", ": wrong")
        self.random_kernel("clBuildProgram 0 popcount(a)=(__builtin_trap(),a)", "SIGILL")
        for check, fault in REDUCED_FAULTS:
            folder = self.driver_fault(check, fault, "launch of operations")
            script = self.folder / "faulty"
            script.write_text(f"#!/bin/sh\nLD_PRELOAD={shlex.quote(self.cl_faults)} RAYA_FAULT={shlex.quote(fault)} exec \"$@\"\n")
            script.chmod(0o755)
            done = subprocess.run(["make", "-C", str(folder), "reduce", f"RUN={script}"], capture_output=True, text=True)
            self.expect(done.returncode == 0, "make reduce", done.stdout + done.stderr)
            lines = (folder / "reduced.cl").read_text().count("\n")
            print(f"{check}, {fault}: {(folder / 'kernel.cl').read_text().count(chr(10))} lines reduced to {lines}", flush=True)
            self.expect(lines < MAX_REDUCED_LINES, f"{lines} lines", (folder / "reduced.cl").read_text())
            self.expect(self.repro(folder, folder / "reduced.cl", fault=fault)[0] == 1, "the reduced kernel passes with the fault")


def main():
    raya, patch_kernels, cl_faults, *mode = sys.argv[1:]
    if not shutil.which("cc") or not shutil.which("make") or mode == ["--reduce"] and not (shutil.which("cvise") and shutil.which("oclgrind")):
        return 77
    with tempfile.TemporaryDirectory() as folder:
        test = Test(raya, patch_kernels, cl_faults, Path(folder))
        if mode == ["--reduce"]:
            for fault in SLOW_KERNEL_FAULTS:
                test.kernel_fault(*fault)
            return test.reduce()
        test.messages()
        test.nan_signs()
        for fault in KERNEL_FAULTS:
            test.kernel_fault(*fault)
        for fault in DRIVER_FAULTS[1:]:
            test.driver_fault(*fault)
        test.endless_loop()


if __name__ == "__main__":
    sys.exit(main())
