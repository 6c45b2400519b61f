"""The OpenCL implementations of tools/portability: starts programs on an implementation, and explains why an implementation cannot run."""
import copy, os, re, resource, shutil, tempfile
from pathlib import Path

import programs
from gpu.clang import LLVM

VENDORS = Path("/etc/OpenCL/vendors")
FETCHED = "implementations"  # folder in the build folder to which tools/portability --setup fetches (tools/portability_setup.py)


class Implementation:
    """An OpenCL implementation, on which run() starts programs. slow: it runs fewer cases, with `lanes` lanes. unavailable: reason why it cannot run, with
    a remedy, or None. needs_device: its driver may be installed on a machine without its device. budget: maximum seconds to compile a kernel.
    from_spirv: it gets the kernels as SPIR-V.

    reports_faults: the implementation detects faults in kernels and reports them only on stderr, with exit code 0. raya prints nothing to stderr
    without an error, so every line there is a fault. (Oclgrind's --log is not used, because each OpenCL context truncates that file.)
    """

    def __init__(self, name, variables=None, prefix=(), slow=False, unavailable=None, reports_faults=False, needs_device=False, budget=60, lanes=1):
        self.name, self.prefix, self.slow, self.unavailable, self.reports_faults = name, list(prefix), slow, unavailable, reports_faults
        self.variables, self.needs_device, self.budget, self.from_spirv = dict(variables or {}), needs_device, budget, False
        self.lanes = lanes

    def with_spirv(self):
        """Returns the same implementation with kernels as SPIR-V."""
        other = copy.copy(self)
        other.name, other.variables, other.from_spirv = f"{self.name}, SPIR-V", {**self.variables, "RAYA_BUILD_OPTIONS": "--il"}, True
        if not shutil.which(f"clang-{LLVM}") or not shutil.which(f"llvm-spirv-{LLVM}"):
            other.unavailable = other.unavailable or f"no clang-{LLVM} or no llvm-spirv-{LLVM} (tools/setup --gpu)"
        return other

    def run(self, command, scratch, limit, variables=None):
        """Runs a command with additional environment variables. Returns (exit code, None after `limit` seconds; stdout and stderr; stdout; text of the
        faults that the implementation reported)."""
        # Ignores OpenCL variables in the caller's environment, such as a CI job's choice of an implementation.
        prefixes = ("RAYA_", "POCL_", "OCL_ICD_", "OCLGRIND_", "RUSTICL_", "CL_CONFIG_")
        inherited = {k: v for k, v in os.environ.items() if not k.startswith(prefixes)}
        caches = {"POCL_CACHE_DIR": str(scratch), "MESA_SHADER_CACHE_DIR": str(scratch)}
        environment = {**inherited, **caches, **self.variables, **(variables or {})}
        done = programs.run(self.prefix + command, limit, env=environment)
        return done.code, f"not done after {limit} s" if done.code is None else done.text, done.out, self.reported_faults(done.err)

    def reported_faults(self, stderr):
        """Returns the first line of stderr and the number of further lines; empty if the implementation does not report faults."""
        lines = [line.strip() for line in stderr.splitlines() if line.strip()] if self.reports_faults else []
        return "" if not lines else lines[0] + (f" (and {len(lines) - 1} more lines)" if len(lines) > 1 else "")


def processor_seconds():
    """Returns the processor seconds of all programs run so far, including their children. Unlike wall time, they do not depend on other load."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def icd(name):
    return VENDORS / f"{name}.icd"


def variants_of(name, driver, unavailable, variants):
    """Returns the implementations of one driver. `driver`: its .icd file; `variants`: [(suffix of the name, environment variables)]."""
    return [Implementation(name + suffix, {"OCL_ICD_VENDORS": str(driver), **variables}, unavailable=unavailable) for suffix, variables in variants]


def llvm_14_knows(cpuinfo):
    """Returns false for CPUs with which LLVM 14, in PoCL 3.0, fails. It calls AMD CPUs after family 25 "generic", a name that its own compiler rejects. It
    takes Zen 4 for Zen 3, which has no AVX-512, and aborts on vectors of 16 floats ("Cannot emit physreg copy instruction")."""
    family = int((re.search(r"^cpu family\s*: (\d+)$", cpuinfo, re.MULTILINE) or ["", "0"])[1])
    return "AuthenticAMD" not in cpuinfo or family < 25 or (family == 25 and "avx512vl" not in cpuinfo.split())


def known_implementations(build):
    """Returns all known implementations, the fast ones first; `build`: the build folder."""
    unoptimised = (" -cl-opt-disable", {"RAYA_BUILD_OPTIONS": "-cl-opt-disable"})
    no_pocl = None if icd("pocl").exists() else "not installed (Debian: pocl-opencl-icd)"
    found = variants_of("PoCL", icd("pocl"), no_pocl, [
        ("", {}), (" loopvec", {"POCL_WORK_GROUP_METHOD": "loopvec"}), (" loops", {"POCL_WORK_GROUP_METHOD": "loops"}), (" cbs", {"POCL_WORK_GROUP_METHOD": "cbs"}), unoptimised,
        (" basic", {"POCL_DEVICES": "basic"})])
    for name, file, variants in [("PoCL 3.0 (PyPI)", "pocl-3.0", [("", {})]), ("Intel CPU", "intel-cpu", [("", {}), unoptimised])]:
        driver = (build / FETCHED / f"{file}.icd").absolute()
        unavailable = None if driver.exists() else "not set up (tools/portability --setup fetches it)"
        if file == "pocl-3.0" and not llvm_14_knows(Path("/proc/cpuinfo").read_text()):
            unavailable = "its LLVM 14 does not know this CPU"
        found += variants_of(name, driver, unavailable, variants)
    # Kernels are compiled unoptimised, because Oclgrind 21.10 does not support all optimised code. Oclgrind takes build options as an argument.
    found.append(Implementation("Oclgrind", prefix=["oclgrind", "--build-options", "-cl-opt-disable"], slow=True, reports_faults=True,
                                unavailable=None if shutil.which("oclgrind") else "not installed (Debian: oclgrind)"))
    # One lane, because rusticl's compiler takes a minute for a kernel with 16 lanes.
    rusticl = {"OCL_ICD_VENDORS": str(icd("rusticl")), "RUSTICL_ENABLE": "llvmpipe", "RAYA_NUMBER_LANES": "1"}
    found.append(Implementation("rusticl llvmpipe", rusticl, slow=True, budget=300,
                                unavailable=None if icd("rusticl").exists() else "not installed (Debian: mesa-opencl-icd)"))
    other_drivers = sorted(p for p in VENDORS.glob("*.icd") if p.stem not in ("pocl", "rusticl", "mesa"))
    found += [Implementation(p.stem, {"OCL_ICD_VENDORS": str(p)}, needs_device=True) for p in other_drivers]
    variants = {"RAYA_BUILD_OPTIONS", "POCL_WORK_GROUP_METHOD", "POCL_DEVICES"}
    found += [i.with_spirv() for i in found if not variants & set(i.variables)]
    if not any(word in p.stem.lower() for p in other_drivers for word in ("nvidia", "amd", "rocm", "intel", "gpu")):
        found.append(Implementation("GPU", unavailable="no GPU's driver is installed"))
    return found


def emulated(sysroot):
    """Returns PoCL in a Debian of another architecture, whose programs Linux starts in qemu-user: one lane, and two numbers for its vectors."""
    # qemu's default CPU of arm64 has features that LLVM does not know together.
    cpu = {"QEMU_CPU": "neoverse-n1"} if sysroot.endswith("/arm64") else {}
    return [Implementation(f"PoCL, {lanes} lane{'s' if lanes > 1 else ''}", {"OCL_ICD_VENDORS": str(icd("pocl")), "RAYA_NUMBER_LANES": str(lanes), **cpu},
                           prefix=["chroot", sysroot], slow=True, budget=600, lanes=lanes) for lanes in (1, 4, 8)]


def mark_missing_devices(implementations, raya):
    """Marks implementations as unable to run whose driver has no device here, such as a GPU's, does not accept SPIR-V, or does not know a setting."""
    for implementation in implementations:
        if implementation.name == "PoCL cbs" and "driver 3.1" in implementation.run([raya, "devices"], tempfile.gettempdir(), 120)[1]:
            implementation.unavailable = "PoCL 3.1 does not know this method"
        if implementation.unavailable or not (implementation.needs_device or implementation.from_spirv):
            continue
        if implementation.run([raya, "verify", "--list"], tempfile.gettempdir(), 120)[0] == 3:  # exit code 3: no usable device
            implementation.unavailable = ("no device accepts SPIR-V" if implementation.from_spirv else
                                          "its driver is installed, but reports no device")
