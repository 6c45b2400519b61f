"""AMD CUs: clang makes machine code and reports its resource usage.

Registers are the vector registers of a work-item, at most 512. Spills are vector registers spilled to memory; scalar registers are
spilled to lanes of vector registers. Each of a CU's four SIMDs has 512 vector registers (allocated in units
of 8), 800 scalar registers (in units of 16) and 8 waves. A CU has 64 KB of local memory and at most 16 groups of more than one wave (LLVM,
AMDGPUBaseInfo.cpp). The figures come from the metadata of the code, as printed by -Rpass-analysis=kernel-resource-usage.
"""
import re

from gpu.figures import Core, Fault, Figures, first_line, kernel_name, rounded_up

CORES = {"gfx90a": Core(32, 16, 64 * 1024, 64 * 1024, 512, max_single_warp_groups=32)}
LIBRARY = "amdgcn--amdhsa.bc"
FORBIDDEN = {"double precision": re.compile(r"^\s*v_\w+_f64\b", re.M),
            "does not round to nearest": re.compile(r"\.amdhsa_float_round_mode_32 [^0]"),
            "denormals are flushed": re.compile(r"\.amdhsa_float_denorm_mode_32 [^3]"),
            "a call is not inlined": re.compile(r"^\s*s_swappc_b64\b", re.M)}
SYMBOL = re.compile(r"\b([A-Za-z_]\w*)@(?:gotpcrel|rel)32")


def faults_of(text):
    """Returns texts on the faults in AMD assembly."""
    found = [f"{what}: {first_line(text, pattern)}" for what, pattern in FORBIDDEN.items() if pattern.search(text)]
    unresolved = sorted({name for name in SYMBOL.findall(text) if not re.search(rf"^{re.escape(name)}:", text, re.M)})
    return found + [f"unresolved: {name}" for name in unresolved]


def waves_of(vector, scalar):
    """Returns the number of waves for which a CU has registers. vector: vector registers of a work-item; scalar: scalar registers of a wave."""
    return 4 * min(8, 512 // rounded_up(max(vector, 1), 8), 800 // rounded_up(max(scalar, 1), 16))


def options_of(target):
    return ["-target", "amdgcn-amd-amdhsa", f"-mcpu={target}"]


class Amd:
    targets = list(CORES)

    def __init__(self, clang):
        self.clang = clang

    def missing(self):
        return self.clang.missing(LIBRARY)

    def version(self):
        return self.clang.version(LIBRARY)

    @staticmethod
    def batches(targets):
        """Returns lists of targets that compile() takes together."""
        return [[target] for target in targets]

    def compiler_input(self, folder, build, targets):
        return b"\0".join(self.clang.preprocessed(folder, build, options_of(target)) for target in targets)

    def compile(self, folder, build, targets):
        """Returns (figures, faults) of the build's kernels for these targets."""
        figures, faults = [], []
        for target in targets:
            text, error = self.clang.assembly(folder, build, LIBRARY, options_of(target))
            texts = [f"does not build: {error}"] if error else faults_of(text)
            faults += [Fault(build["file"].removesuffix(".cl"), build["variant"], target, what) for what in texts]
            figures += [] if error else self.figures(build, target, text)
        return figures, faults

    @staticmethod
    def figures(build, target, text):
        listed = text.split("amdhsa.kernels:", 1)[1]
        for kernel in re.split(r"^  - \.agpr_count:", listed, flags=re.M)[1:]:
            value = {key: int(number) for key, number in re.findall(r"^    \.(\w+): +(\d+)$", kernel, re.M)}
            group = re.search(r"\.reqd_workgroup_size:\s+- (\d+)", kernel)
            found = Figures(kernel_name(build, re.search(r"^    \.name: +(\w+)", kernel, re.M)[1]), build["variant"], target,
                            value["wavefront_size"], int(group[1]) if group else build["group"], value["vgpr_count"],
                            value["vgpr_spill_count"], value["private_segment_fixed_size"], value["group_segment_fixed_size"],
                            value["sgpr_spill_count"])
            yield CORES[target].set_occupancy(found, waves_of(found.registers, value["sgpr_count"]))
