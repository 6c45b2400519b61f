"""Compiles kernels for GPUs without a GPU: resource usage and faults of machine code, and occupancy, the number of a kernel's warps that fit in a core.

A core (NVIDIA: SM, AMD: CU, Intel: Xe core) runs work-groups. A warp (NVIDIA: warp, AMD: wave, Intel: thread) runs `width` work-items in
lockstep. For a group of `group` work-items:

    warps of a group  = group / width, rounded up
    groups            = warps for which a core has registers (by the vendor's rules) / warps of a group; at most the core's maximum of warps and groups;
                        if the kernel uses local memory, at most the core's local memory / the kernel's
    max. local memory = largest local memory of a group with which the registers, not local memory, still limit the number of groups

For NVIDIA and AMD, clang and libclc replace the compilers of the drivers, which may give other figures; all calls are inlined, as the drivers do.
"""
import glob, hashlib, os, re, shutil, tempfile
from dataclasses import dataclass
from pathlib import Path

import programs

LLVM = programs.llvm()
CLANG = f"clang-{LLVM}"
LIBCLC = Path("/usr/lib/clc")
KB = 1024


def rounded_up(number, unit):
    return -(-number // unit) * unit


@dataclass
class Figures:
    """Figures of one kernel in one variant for one target. Memory in bytes; spills in the vendor's unit; `stack` of a work-item."""
    kernel: str
    variant: str
    target: str
    width: int
    group: int
    registers: int
    spills: int
    stack: int
    local: int
    scalar_spills: int = 0  # AMD: scalar registers spilled to lanes of vector registers
    warps: int = 0          # maximum number of warps that fit in a core at the same time
    max_local_bytes: int = 0  # largest local memory of a group with which registers still limit the number of groups

    @property
    def key(self):
        return self.kernel, self.variant, self.target


@dataclass
class Fault:
    """A fault of a kernel, described by `text`."""
    kernel: str
    variant: str
    target: str
    text: str


@dataclass(frozen=True)
class Core:
    """Limits of a core; memory in bytes."""
    warps: int        # maximum number of warps
    groups: int       # maximum number of groups
    local: int        # local memory of all groups together
    group_local: int  # maximum local memory of one group
    unit: int         # allocation unit of local memory
    reserved: int = 0  # local memory of each group that the driver reserves
    max_single_warp_groups: int = 0  # maximum number of groups of a single warp, if it differs from `groups`

    def set_occupancy(self, figures, warps_by_registers):
        """Sets warps and max_local_bytes of the figures, and returns them."""
        warps_per_group = rounded_up(figures.group, figures.width) // figures.width
        max_groups = self.max_single_warp_groups if warps_per_group == 1 and self.max_single_warp_groups else self.groups
        groups = min(min(self.warps, warps_by_registers) // warps_per_group, max_groups)
        if figures.local:
            groups = min(groups, self.local // rounded_up(figures.local + self.reserved, self.unit))
        figures.warps = groups * warps_per_group
        if groups:
            figures.max_local_bytes = min(self.group_local, self.local // groups // self.unit * self.unit - self.reserved)
        return figures


CORES = {"sm_80": Core(64, 32, 164 * KB, 163 * KB, 128, KB), "sm_90": Core(64, 32, 228 * KB, 227 * KB, 128, KB),
         "gfx90a": Core(32, 16, 64 * KB, 64 * KB, 512, max_single_warp_groups=32),
         "dg2": Core(128, 128, 128 * KB, 64 * KB, KB), "pvc": Core(64, 64, 128 * KB, 128 * KB, KB)}


def first_error(text):
    return next((line for line in text.splitlines() if "error" in line or "fatal" in line), text.strip()[-300:] or "without a message")


def first_lines(text, patterns):
    """Returns the texts of the patterns {text: pattern} that occur, each with the first line."""
    found = {what: re.search(rf"^.*?(?:{pattern}).*$", text, re.M) for what, pattern in patterns.items()}
    return [f"{what}: {' '.join(match[0].split())}" for what, match in found.items() if match]


def parsed(text):
    import yaml  # only here, so that the message on missing compilers needs no package
    return yaml.load(text, yaml.CSafeLoader)


class Vendor:
    """Compiles builds (tests/kernels/kernel_builds.cpp) for its targets. Several threads call compile()."""
    targets, clang_options, library = [], [], None

    def missing(self):
        """Returns the programs and libraries that are not installed, with their Debian packages."""
        found = [] if shutil.which(CLANG) else [f"{CLANG} (Debian: {CLANG})"]
        return found + ([] if (LIBCLC / self.library).exists() else [f"{LIBCLC / self.library} (Debian: libclc-{LLVM})"])

    def version(self):
        output = programs.run([CLANG, "--version"]).out
        number = re.search(r"version (\d+[.\d]*)", output)
        digest = hashlib.sha256((LIBCLC / self.library).read_bytes()).hexdigest()[:8]
        return f"clang {number[1] if number else output.splitlines()[0]}; libclc {digest}"

    def assembly(self, folder, build):
        """Returns (assembly's file, None), or (None, the compiler's first error). A vendor's targets share the file."""
        file = folder / f"{build['source']}.{self.library}.s"
        if file.exists():
            return file, None
        done = programs.run([CLANG, "-x", "cl", "-O3", "-mllvm", "-inline-threshold=1000000", "-nogpulib", "-Wno-linker-warnings", *self.clang_options,
                             *build["options"], "-Xclang", "-mlink-builtin-bitcode", "-Xclang", LIBCLC / self.library, "-S", "-o", file,
                             folder / build["source"]])
        return (None, first_error(done.err)) if done.code else (file, None)

    def compile(self, folder, build, targets):
        """Returns (figures, faults) of the build's kernels for these targets."""
        all_figures, faults = [], []
        for target in targets:
            figures, texts = self.compile_for(folder, build, target)
            for function, warps_by_registers, values in figures:
                stem = build["file"].removesuffix(".cl")
                name = stem if stem.split("/")[-1] == function else f"{stem} {function}"  # ring/trace; ring/filter take_means
                found = Figures(name, build["variant"], target, **{"group": build["group"], **values})
                all_figures.append(CORES[target].set_occupancy(found, warps_by_registers))
            faults += [Fault(build["file"].removesuffix(".cl"), build["variant"], target, text) for text in texts]
        return all_figures, faults


class Nvidia(Vendor):
    """clang makes PTX, ptxas compiles it to machine code and reports its resource usage.

    Registers are those of a work-item, at most 255. ptxas gets the group's size, as a driver does by reqd_work_group_size, and allocates
    registers for it. Spills are the bytes of spill stores. A quarter of an SM has 16,384 registers, allocated in units of 8 for each of a warp's
    32 work-items. An SM has at most 64 warps and 32 groups, and 164 or 228 KB of local memory (CUDA C++ Programming Guide, Compute Capabilities).
    """
    targets = ["sm_80", "sm_90"]
    library = "nvptx64--nvidiacl.bc"
    clang_options = ["-target", "nvptx64-nvidia-nvcl", "-Xclang", "-target-cpu", "-Xclang", "sm_80"]  # clang 15's newest; sm_90 gets the same PTX
    used = re.compile(r"Compiling entry function '(\w+)' for '\w+'.*?(\d+) bytes stack frame, (\d+) bytes spill stores.*?Used (\d+) registers"
                      r"[^\n]*?(?:, (\d+) bytes smem)?[^\n]*\n", re.S)

    def __init__(self, ptxas=None):
        """ptxas: the program, or a folder that contains it; None: that of PATH or of the CUDA toolkit."""
        candidates = [ptxas, *sorted(glob.glob(os.path.join(ptxas, "**", "ptxas"), recursive=True))] if ptxas else \
            ["ptxas", *sorted(glob.glob("/usr/local/cuda*/bin/ptxas"))]
        self.ptxas = next(filter(None, map(shutil.which, candidates)), None)

    def missing(self):
        no_ptxas = ["ptxas (the CUDA toolkit, Debian: nvidia-cuda-toolkit, or PyPI: nvidia-cuda-nvcc and --ptxas)"]
        return super().missing() + ([] if self.ptxas else no_ptxas)

    def version(self):
        number = re.search(r"V(\d+[.\d]*)", programs.run([self.ptxas, "--version"]).out)
        return f"{super().version()}; ptxas {number[1] if number else 'unknown'}"

    @staticmethod
    def faults_of(ptx):
        """Returns texts on the faults in PTX. An instruction must round once, to nearest (.rn): without .rn ptxas may fuse two instructions."""
        found = first_lines(ptx, {"double precision": r"\.f64\b", "denormals are flushed": r"\.ftz\b", "unresolved": r"^\.extern \.func",
                                  "a call is not inlined": r"^[ \t]*(?:@\S+[ \t]+)?call\b"})
        arithmetic = r"^[ \t]*(?:@\S+[ \t]+)?(?:add|sub|mul|mad|fma|div|sqrt|rcp|rsqrt|sin|cos|lg2|ex2|tanh)(?:\.[a-z0-9_]+)*\.f32\b.*$"
        wrongly_rounded = [line for line in re.findall(arithmetic, ptx, re.M) if ".rn." not in line or ".approx" in line]
        return found + [f"not rounded to nearest once: {' '.join(line.split())}" for line in wrongly_rounded[:1]]

    @staticmethod
    def warps_of(registers):
        """Returns the number of warps for which an SM has registers. registers: number of registers of a work-item."""
        return 4 * (16384 // (32 * rounded_up(registers, 8)))

    def compile_for(self, folder, build, target):
        file, error = self.assembly(folder, build)
        if error:
            return [], [f"does not build: {error}"]
        done = programs.run([self.ptxas, "-v", f"-arch={target}", f"-maxntid={build['group']}", "-o", os.devnull, file])
        found = [(function, self.warps_of(int(registers)),
                  {"width": 32, "registers": int(registers), "spills": int(spills), "stack": int(stack), "local": int(local or 0)})
                 for function, stack, spills, registers, local in self.used.findall(done.err)]
        return found, self.faults_of(file.read_text()) + ([f"ptxas fails: {first_error(done.err)}"] if done.code else [])


class Amd(Vendor):
    """clang makes machine code and reports its resource usage.

    Registers are the vector registers of a work-item, at most 512. Spills are vector registers spilled to memory; scalar registers are
    spilled to lanes of vector registers. Each of a CU's four SIMDs has 512 vector registers (allocated in units of 8), 800 scalar registers (in
    units of 16) and 8 waves. A CU has 64 KB of local memory and at most 16 groups of more than one wave (LLVM, AMDGPUBaseInfo.cpp). The figures
    come from the metadata of the code.
    """
    targets = ["gfx90a"]
    library = "amdgcn--amdhsa.bc"
    clang_options = ["-target", "amdgcn-amd-amdhsa", "-mcpu=gfx90a"]

    @staticmethod
    def faults_of(text):
        """Returns texts on the faults in AMD assembly."""
        found = first_lines(text, {"double precision": r"^[ \t]*v_\w+_f64\b", "does not round to nearest": r"\.amdhsa_float_round_mode_32 [^0]",
                                   "denormals are flushed": r"\.amdhsa_float_denorm_mode_32 [^3]",
                                   "a call is not inlined": r"^[ \t]*s_swappc_b64\b"})
        used = sorted(set(re.findall(r"\b([A-Za-z_]\w*)@(?:gotpcrel|rel)32", text)) - set(re.findall(r"^(\w+):", text, re.M)))
        return found + [f"unresolved: {name}" for name in used]

    @staticmethod
    def waves_of(vector, scalar):
        """Returns the number of waves for which a CU has registers. vector: vector registers of a work-item; scalar: scalar registers of a wave."""
        return 4 * min(8, 512 // rounded_up(max(vector, 1), 8), 800 // rounded_up(max(scalar, 1), 16))

    def compile_for(self, folder, build, target):
        file, error = self.assembly(folder, build)
        if error:
            return [], [f"does not build: {error}"]
        text, found = file.read_text(), []
        for kernel in parsed(text.split(".amdgpu_metadata\n", 1)[1].split("\n\t.end_amdgpu_metadata", 1)[0])["amdhsa.kernels"]:
            values = {"width": kernel[".wavefront_size"], "group": kernel.get(".reqd_workgroup_size", [build["group"]])[0],
                      "registers": kernel[".vgpr_count"], "spills": kernel[".vgpr_spill_count"], "stack": kernel[".private_segment_fixed_size"],
                      "local": kernel[".group_segment_fixed_size"], "scalar_spills": kernel[".sgpr_spill_count"]}
            found.append((kernel[".name"], self.waves_of(values["registers"], kernel[".sgpr_count"]), values))
        return found, self.faults_of(text)


class Intel(Vendor):
    """ocloc is the compiler of Intel's own driver.

    A thread has 128 registers, or 256 if the core runs half as many threads. The compiler chooses the width of a thread, 8, 16 or 32
    work-items: a smaller width if registers run out. Spills are counted in registers, as ocloc reports them. An Xe core has 128 threads (dg2: 16
    engines of 8) or 64 (pvc: 8 of 8), and 128 KB of local memory. Its maximum number of groups is not known, so only the number of threads limits the
    groups (oneAPI GPU Optimization Guide, Intel Xe GPU Architecture).
    """
    targets = ["dg2", "pvc"]

    def missing(self):
        packages = {"ocloc": "intel-opencl-icd", "spirv-dis": "spirv-tools"}
        return [f"{program} (Debian: {package})" for program, package in packages.items() if not shutil.which(program)]

    def version(self):
        with tempfile.TemporaryDirectory() as folder:  # ocloc writes a file to its current folder
            programs.run(["ocloc", "query", "OCL_DRIVER_VERSION"], cwd=folder)
            file = Path(folder, "OCL_DRIVER_VERSION")
            return "ocloc " + (file.read_text().strip("\0\n ") if file.exists() else "unknown")

    @staticmethod
    def faults_of(spirv):
        """Returns texts on the faults in a module of SPIR-V."""
        text = programs.run(["spirv-dis", "--no-color", spirv]).out
        imports = re.findall(r'OpDecorate \S+ LinkageAttributes "(?!__spirv_BuiltIn)(.*)" Import', text)
        return ["double precision: OpTypeFloat 64"] * ("OpTypeFloat 64" in text) + [f"unresolved: {name}" for name in imports]

    def compile_for(self, folder, build, target):
        out = folder / target / build["source"]
        done = programs.run(["ocloc", "compile", "--format", "zebin", "-file", folder / build["source"], "-device", target,
                             "-options", " ".join(build["options"]), "-out_dir", out])
        code, spirv = (next(out.glob(f"*.{end}"), None) for end in ("bin", "spv"))
        if done.code or not code or not spirv:
            return [], [f"does not build: {first_error(done.text)}"]
        programs.run(["objcopy", "-I", "elf64-little", "--dump-section", f".ze_info={out / 'info'}", code, os.devnull])
        text, found = (out / "info").read_text(), []
        spilled = dict(re.findall(r"kernel (\w+)\s+compiled SIMD\d+ allocated \d+ regs and spilled around (\d+)", done.text))
        for kernel in parsed(text.split("kernels_misc_info:")[0])["kernels"]:
            values = kernel["execution_env"]
            simd, registers = values["simd_size"], values["grf_count"]
            # The compiler lists memory of a thread, or of a work-item with is_simt_thread.
            stack = sum(memory["size"] // (1 if memory.get("is_simt_thread") else simd) for memory in kernel.get("per_thread_memory_buffers", ())
                        if memory.get("usage") != "spill_fill_space")
            found.append((kernel["name"], CORES[target].warps * 128 // registers,
                          {"width": simd, "group": values.get("required_work_group_size", [build["group"]])[0], "registers": registers,
                           "spills": int(spilled.get(kernel["name"], 0)), "stack": stack, "local": values.get("slm_size", 0)}))
        return found, self.faults_of(spirv) + ["a call is not inlined"] * ("has_stack_calls: true" in text)
