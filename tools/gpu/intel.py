"""Intel Xe cores: ocloc is the compiler of Intel's own driver.

A thread has 128 registers, or 256 if the core runs half as many threads. The compiler chooses the width of a thread, 8, 16 or 32
work-items: a smaller width if registers run out. Spills are counted in registers, as ocloc reports them. An Xe core has 128 threads (dg2: 16
engines of 8) or 64 (pvc: 8 of 8), and 128 KB of local memory. Its maximum number of groups is not known, so only the number of threads limits the groups
(oneAPI GPU Optimization Guide, Intel Xe GPU Architecture).
"""
import re, shutil, struct, subprocess, tempfile
from pathlib import Path

from gpu.clang import first_error
from gpu.figures import Core, Fault, Figures, kernel_name
from gpu.spirv import faults_of

KB = 1024
CORES = {"dg2": Core(128, 128, 128 * KB, 64 * KB, KB), "pvc": Core(64, 64, 128 * KB, 128 * KB, KB)}
SPILLED = re.compile(r"kernel (\w+)\s+compiled SIMD\d+ allocated \d+ regs and spilled around (\d+)")


class Intel:
    targets = list(CORES)

    def missing(self):
        return [] if shutil.which("ocloc") else ["ocloc (Debian: intel-opencl-icd)"]

    def version(self):
        with tempfile.TemporaryDirectory() as folder:  # ocloc writes a file to its current folder
            subprocess.run(["ocloc", "query", "OCL_DRIVER_VERSION"], cwd=folder, capture_output=True)
            file = Path(folder, "OCL_DRIVER_VERSION")
            return "ocloc " + (file.read_text().strip("\0\n ") if file.exists() else "unknown")

    @staticmethod
    def batches(targets):
        """Returns lists of targets that compile() takes together."""
        return [[target] for target in targets]

    @staticmethod
    def run_ocloc(folder, build, target, out_folder, *more):
        """Runs ocloc. Returns (True if it compiled, output)."""
        done = subprocess.run(["ocloc", "compile", *more, "-file", str(folder / build["source"]), "-device", target,
                               "-options", " ".join(build["options"]), "-out_dir", str(out_folder)], capture_output=True, text=True)
        return done.returncode == 0, done.stdout + done.stderr

    def compiler_input(self, folder, build, targets):
        """Returns the build as SPIR-V, which takes little time compared with machine code; empty if it does not compile."""
        found = []
        for target in targets:
            out_folder = folder / target / "spirv" / build["source"]
            done, _ = self.run_ocloc(folder, build, target, out_folder, "-spv_only")
            found += [path.read_bytes() for path in out_folder.glob("*.spv")] if done else []
        return b"".join(found) if len(found) == len(targets) else b""

    def compile(self, folder, build, targets):
        """Returns (figures, faults) of the build's kernels for these targets."""
        figures, faults = [], []
        for target in targets:
            out_folder = folder / target / build["source"]
            done, output = self.run_ocloc(folder, build, target, out_folder, "--format", "zebin")
            files = [next(out_folder.glob(f"*.{end}"), None) for end in ("bin", "spv")] if done else [None]
            if not all(files):
                texts = [f"does not build: {first_error(output)}"]
            else:
                info = section(files[0].read_bytes(), ".ze_info")
                texts = faults_of(files[1].read_bytes()) + ["a call is not inlined"] * ("has_stack_calls: true" in info)
                figures += self.figures(build, target, info, dict(SPILLED.findall(output)))
            faults += [Fault(build["file"].removesuffix(".cl"), build["variant"], target, what) for what in texts]
        return figures, faults

    @staticmethod
    def figures(build, target, info, spilled):
        listed = info.split("kernels_misc_info:")[0]
        for kernel in re.split(r"^  - name: +", listed, flags=re.M)[1:]:
            value = {key: int(number) for key, number in re.findall(r"^      (\w+): +(\d+)$", kernel, re.M)}
            function, group = kernel.split()[0], re.search(r"required_work_group_size: \[ (\d+)", kernel)
            simd = value["simd_size"]
            found = Figures(kernel_name(build, function), build["variant"], target, simd, int(group[1]) if group else build["group"],
                            value["grf_count"], int(spilled.get(function, 0)), stack_of(kernel, simd), value.get("slm_size", 0))
            yield CORES[target].set_occupancy(found, CORES[target].warps * 128 // found.registers)


def stack_of(kernel, simd):
    """Returns the bytes of stack of a work-item. The compiler lists memory of a thread, or of a work-item with is_simt_thread."""
    bytes_of_item = 0
    for memory in re.split(r"^      - type:", kernel.split("per_thread_memory_buffers:")[-1], flags=re.M)[1:]:
        size = re.search(r"^        size: +(\d+)", memory, re.M)
        if size and "spill_fill_space" not in memory:
            bytes_of_item += int(size[1]) // (1 if "is_simt_thread:  true" in memory else simd)
    return bytes_of_item


def section(elf, name):
    """Returns the text of a section of a 64-bit ELF file."""
    start, = struct.unpack_from("<Q", elf, 0x28)
    size, count, names_at = struct.unpack_from("<HHH", elf, 0x3A)
    headers = [struct.unpack_from("<IIQQQQ", elf, start + i * size) for i in range(count)]
    names = elf[headers[names_at][4]:][:headers[names_at][5]]
    for header in headers:
        if names[header[0]:].split(b"\0")[0] == name.encode():
            return elf[header[4]:header[4] + header[5]].decode()
    raise ValueError(f"no {name} in ocloc's binary")
