"""NVIDIA's SMs: clang makes PTX, ptxas says what its machine code takes.

Registers are those of a work-item, at most 255; ptxas is told the group's size, as a driver is by reqd_work_group_size, and
fits registers to it; spills bytes that it stores. A quarter of an SM has 16,384 registers and hands them out by
8 for each of a warp's 32 work-items. CUDA C++ Programming Guide, Compute Capabilities: 64 warps, 32 groups, 164 or 228 KB.
"""
import glob, os, re, shutil, subprocess

from gpu.clang import first_error
from gpu.figures import Core, Fault, Figures, first_line, kernel_name, rounded_up

KB = 1024
CORES = {"sm_80": Core(64, 32, 164 * KB, 163 * KB, 128, KB), "sm_90": Core(64, 32, 228 * KB, 227 * KB, 128, KB)}
LIBRARY = "nvptx64--nvidiacl.bc"
OPTIONS = ["-target", "nvptx64-nvidia-nvcl", "-Xclang", "-target-cpu", "-Xclang", "sm_80"]  # clang 15 knows no newer one; PTX is the same
# Each rounded once, to nearest, denormals kept. Without a rounding ptxas may make two of them one.
ARITHMETIC = re.compile(r"^\s*(?:@\S+\s+)?(?:add|sub|mul|mad|fma|div|sqrt|rcp|rsqrt|sin|cos|lg2|ex2|tanh)(\.[a-z0-9_]+)*\.f32\b.*$", re.M)
MUST_NOT = {"double precision": re.compile(r"\.f64\b"), "denormals are flushed": re.compile(r"\.ftz\b"),
            "unresolved": re.compile(r"^\.extern \.func", re.M), "a call is left": re.compile(r"^\s*(?:@\S+\s+)?call\b", re.M)}
USED = re.compile(r"Compiling entry function '(\w+)' for '\w+'.*?(\d+) bytes stack frame, (\d+) bytes spill stores.*?Used (\d+) registers"
                  r"[^\n]*?(?:, (\d+) bytes smem)?[^\n]*\n", re.S)


def find_ptxas(told):
    """In the folder `told`, in PATH, or in the CUDA toolkit's own."""
    if told:
        below = [told, *sorted(glob.glob(os.path.join(told, "**", "ptxas"), recursive=True))]
        return next((path for path in below if os.path.isfile(path) and os.access(path, os.X_OK)), None)
    return shutil.which("ptxas") or next(iter(sorted(glob.glob("/usr/local/cuda*/bin/ptxas"))), None)


def faults_of(ptx):
    said = [f"{what}: {first_line(ptx, pattern)}" for what, pattern in MUST_NOT.items() if pattern.search(ptx)]
    otherwise = [m[0].split() for m in ARITHMETIC.finditer(ptx) if ".rn." not in m[0] or ".approx" in m[0]]
    return said + ([f"not rounded to nearest once: {' '.join(otherwise[0])}"] if otherwise else [])


def warps_of(registers):
    """That the registers of an SM are enough for."""
    return 4 * (16384 // (32 * rounded_up(registers, 8)))


class Nvidia:
    targets = list(CORES)

    def __init__(self, clang, ptxas):
        self.clang, self.ptxas = clang, find_ptxas(ptxas)

    def lacking(self):
        no_ptxas = ["ptxas (the CUDA toolkit, Debian: nvidia-cuda-toolkit, or PyPI: nvidia-cuda-nvcc and --ptxas)"]
        return self.clang.lacking(LIBRARY) + ([] if self.ptxas else no_ptxas)

    def version(self):
        said = subprocess.run([self.ptxas, "--version"], capture_output=True, text=True).stdout
        number = re.search(r"V(\d+[.\d]*)", said)
        return f"{self.clang.version(LIBRARY)}; ptxas {number[1] if number else 'unknown'}"

    @staticmethod
    def together(targets):
        return [targets]  # one assembly

    def seen(self, folder, build, targets):
        return self.clang.preprocessed(folder, build, OPTIONS)

    def look(self, folder, build, targets):
        """Figures and faults of the build's kernels for those of its targets."""
        def fault(target, text):
            return Fault(build["file"].removesuffix(".cl"), build["variant"], target, text)

        ptx, error = self.clang.assembly(folder, build, LIBRARY, OPTIONS)
        if error:
            return [], [fault(target, f"does not build: {error}") for target in targets]
        figures, faults, said = [], [], faults_of(ptx)
        for target in targets:
            faults += [fault(target, text) for text in said]
            done = subprocess.run([self.ptxas, "-v", f"-arch={target}", f"-maxntid={build['group']}", "-o", os.devnull, str(folder / f"{build['source']}.{LIBRARY}.s")],
                                  capture_output=True, text=True)
            if done.returncode:
                faults.append(fault(target, f"ptxas refuses it: {first_error(done.stderr)}"))
                continue
            figures += self.figures(build, target, ptx, done.stderr)
        return figures, faults

    @staticmethod
    def figures(build, target, ptx, said):
        for function, stack, spills, registers, local in USED.findall(said):
            found = Figures(kernel_name(build, function), build["variant"], target, 32, build["group"],
                            int(registers), int(spills), int(stack), int(local or 0))
            yield CORES[target].fit(found, warps_of(found.registers))
