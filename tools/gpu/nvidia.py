"""NVIDIA SMs: clang makes PTX, ptxas compiles it to machine code and reports its resource usage.

Registers are those of a work-item, at most 255. ptxas gets the group's size, as a driver does by reqd_work_group_size, and allocates
registers for it. Spills are the bytes of spill stores. A quarter of an SM has 16,384 registers, allocated in units of 8 for each of a warp's
32 work-items. An SM has at most 64 warps and 32 groups, and 164 or 228 KB of local memory (CUDA C++ Programming Guide, Compute Capabilities).
"""
import glob, os, re, shutil, subprocess

from gpu.clang import first_error
from gpu.figures import Core, Fault, Figures, first_line, kernel_name, rounded_up

KB = 1024
CORES = {"sm_80": Core(64, 32, 164 * KB, 163 * KB, 128, KB), "sm_90": Core(64, 32, 228 * KB, 227 * KB, 128, KB)}
LIBRARY = "nvptx64--nvidiacl.bc"
OPTIONS = ["-target", "nvptx64-nvidia-nvcl", "-Xclang", "-target-cpu", "-Xclang", "sm_80"]  # the newest target of clang 15; sm_90 gets the same PTX
# Each of these instructions must round once, to nearest (.rn), and keep denormals. Without .rn ptxas may fuse two instructions.
ARITHMETIC = re.compile(r"^\s*(?:@\S+\s+)?(?:add|sub|mul|mad|fma|div|sqrt|rcp|rsqrt|sin|cos|lg2|ex2|tanh)(\.[a-z0-9_]+)*\.f32\b.*$", re.M)
FORBIDDEN = {"double precision": re.compile(r"\.f64\b"), "denormals are flushed": re.compile(r"\.ftz\b"),
            "unresolved": re.compile(r"^\.extern \.func", re.M), "a call is not inlined": re.compile(r"^\s*(?:@\S+\s+)?call\b", re.M)}
USED = re.compile(r"Compiling entry function '(\w+)' for '\w+'.*?(\d+) bytes stack frame, (\d+) bytes spill stores.*?Used (\d+) registers"
                  r"[^\n]*?(?:, (\d+) bytes smem)?[^\n]*\n", re.S)


def find_ptxas(given):
    """Returns the path of ptxas: the file `given`, or in the folder `given`. Without `given`, searches PATH and the CUDA toolkit. None: not found."""
    if given:
        candidates = [given, *sorted(glob.glob(os.path.join(given, "**", "ptxas"), recursive=True))]
        return next((path for path in candidates if os.path.isfile(path) and os.access(path, os.X_OK)), None)
    return shutil.which("ptxas") or next(iter(sorted(glob.glob("/usr/local/cuda*/bin/ptxas"))), None)


def faults_of(ptx):
    """Returns texts on the faults in PTX."""
    found = [f"{what}: {first_line(ptx, pattern)}" for what, pattern in FORBIDDEN.items() if pattern.search(ptx)]
    wrongly_rounded = [m[0].split() for m in ARITHMETIC.finditer(ptx) if ".rn." not in m[0] or ".approx" in m[0]]
    return found + ([f"not rounded to nearest once: {' '.join(wrongly_rounded[0])}"] if wrongly_rounded else [])


def warps_of(registers):
    """Returns the number of warps for which an SM has registers. registers: number of registers of a work-item."""
    return 4 * (16384 // (32 * rounded_up(registers, 8)))


class Nvidia:
    targets = list(CORES)

    def __init__(self, clang, ptxas):
        self.clang, self.ptxas = clang, find_ptxas(ptxas)

    def missing(self):
        no_ptxas = ["ptxas (the CUDA toolkit, Debian: nvidia-cuda-toolkit, or PyPI: nvidia-cuda-nvcc and --ptxas)"]
        return self.clang.missing(LIBRARY) + ([] if self.ptxas else no_ptxas)

    def version(self):
        output = subprocess.run([self.ptxas, "--version"], capture_output=True, text=True).stdout
        number = re.search(r"V(\d+[.\d]*)", output)
        return f"{self.clang.version(LIBRARY)}; ptxas {number[1] if number else 'unknown'}"

    @staticmethod
    def batches(targets):
        """Returns lists of targets that compile() takes together: they share the PTX."""
        return [targets]

    def compiler_input(self, folder, build, targets):
        return self.clang.preprocessed(folder, build, OPTIONS)

    def compile(self, folder, build, targets):
        """Returns (figures, faults) of the build's kernels for these targets."""
        def fault(target, text):
            return Fault(build["file"].removesuffix(".cl"), build["variant"], target, text)

        ptx, error = self.clang.assembly(folder, build, LIBRARY, OPTIONS)
        if error:
            return [], [fault(target, f"does not build: {error}") for target in targets]
        figures, faults, texts = [], [], faults_of(ptx)
        for target in targets:
            faults += [fault(target, text) for text in texts]
            done = subprocess.run([self.ptxas, "-v", f"-arch={target}", f"-maxntid={build['group']}", "-o", os.devnull,
                                   str(folder / f"{build['source']}.{LIBRARY}.s")], capture_output=True, text=True)
            if done.returncode:
                faults.append(fault(target, f"ptxas fails: {first_error(done.stderr)}"))
                continue
            figures += self.figures(build, target, ptx, done.stderr)
        return figures, faults

    @staticmethod
    def figures(build, target, ptx, output):
        for function, stack, spills, registers, local in USED.findall(output):
            found = Figures(kernel_name(build, function), build["variant"], target, 32, build["group"],
                            int(registers), int(spills), int(stack), int(local or 0))
            yield CORES[target].set_occupancy(found, warps_of(found.registers))
