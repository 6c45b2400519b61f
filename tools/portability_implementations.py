"""The OpenCL implementations of tools/portability: starts programs on an implementation, explains why an implementation cannot run, and fetches those
that Debian does not have."""
import dataclasses, os, re, resource, shutil, sys, tempfile
from pathlib import Path

import programs

ROOT = Path(__file__).resolve().parent.parent
LLVM = programs.llvm()
VENDORS = Path("/etc/OpenCL/vendors")
FETCHED = "implementations"  # folder in the build folder to which set_up() fetches
DRIVERS = {"intel-cpu": "libintelocl.so", "pocl-3.0": "libpocl-*.so"}  # files in the packages of tests/portability/packages/NAME.txt


@dataclasses.dataclass(eq=False)
class Implementation:
    """An OpenCL implementation, on which run() starts programs. slow: it runs fewer cases, with `lanes` lanes. unavailable: reason why it cannot run, with
    a remedy, or None. needs_device: its driver may be installed on a machine without its device. budget: maximum seconds to compile a kernel.
    from_spirv: it gets the kernels as SPIR-V.

    reports_faults: the implementation detects faults in kernels and reports them only on stderr, with exit code 0. raya prints nothing to stderr
    without an error, so every line there is a fault. (Oclgrind's --log is not used, because each OpenCL context truncates that file.)
    """
    name: str
    variables: dict = dataclasses.field(default_factory=dict)
    prefix: tuple = ()
    slow: bool = False
    unavailable: str = None
    reports_faults: bool = False
    needs_device: bool = False
    budget: int = 60
    lanes: int = 1
    from_spirv: bool = False

    @property
    def lanes_option(self):
        return ["--lanes", self.lanes] if self.slow else []

    def with_spirv(self):
        """Returns the same implementation with kernels as SPIR-V."""
        missing = not shutil.which(f"clang-{LLVM}") or not shutil.which(f"llvm-spirv-{LLVM}")
        reason = self.unavailable or (f"no clang-{LLVM} or no llvm-spirv-{LLVM} (tools/setup --gpu)" if missing else None)
        return dataclasses.replace(self, name=f"{self.name}, SPIR-V", variables={**self.variables, "RAYA_BUILD_OPTIONS": "--il"}, from_spirv=True,
                                   unavailable=reason)

    def run(self, command, scratch, limit, variables=None):
        """Runs a command with additional environment variables. Returns (exit code, None after `limit` seconds; stdout and stderr; stdout; text of the
        faults that the implementation reported)."""
        # Ignores OpenCL variables in the caller's environment, such as a CI job's choice of an implementation.
        prefixes = ("RAYA_", "POCL_", "OCL_ICD_", "OCLGRIND_", "RUSTICL_", "CL_CONFIG_")
        inherited = {k: v for k, v in os.environ.items() if not k.startswith(prefixes)}
        caches = {"POCL_CACHE_DIR": str(scratch), "MESA_SHADER_CACHE_DIR": str(scratch)}
        environment = {**inherited, **caches, **self.variables, **(variables or {})}
        done = programs.run([*self.prefix, *command], limit, env=environment)
        faults = [line.strip() for line in done.err.splitlines() if line.strip()] if self.reports_faults else []
        fault = " ".join(faults[:1] + [f"(and {len(faults) - 1} more lines)"] * (len(faults) > 1))
        return done.code, f"not done after {limit} s" if done.code is None else done.text, done.out, fault


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
    methods = [(f" {method}", {"POCL_WORK_GROUP_METHOD": method}) for method in ("loopvec", "loops", "cbs")]
    found = variants_of("PoCL", icd("pocl"), no_pocl, [("", {}), *methods, unoptimised, (" basic", {"POCL_DEVICES": "basic"})])
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


def set_up(build):
    """Fetches the packages of each file in tests/portability/packages from PyPI to BUILD/implementations/NAME; pip verifies versions and hashes.
    NAME.icd beside it, which OpenCL loaders read, names the driver; it is written last, so that an interrupted set-up is not used. To uninstall
    everything, remove BUILD/implementations. Returns the exit code: 0, or 3 if something could not be fetched."""
    code = 0
    for packages in sorted((ROOT / "tests" / "portability" / "packages").glob("*.txt")):
        folder, requested = (build / FETCHED / packages.stem).absolute(), packages.read_text()
        driver_file, stamp = folder.with_name(f"{packages.stem}.icd"), folder / "packages.txt"
        if driver_file.exists() and stamp.exists() and stamp.read_text() == requested:
            print(f"{packages.stem}: already set up in {folder}")
            continue
        driver_file.unlink(missing_ok=True)
        shutil.rmtree(folder, ignore_errors=True)
        print(f"{packages.stem}: fetching", flush=True)
        done = programs.run([sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--no-cache-dir", "--only-binary", ":all:", "--require-hashes",
                             "--disable-pip-version-check", "--ignore-installed", "--no-compile", "-r", packages, "--prefix", folder])
        drivers = sorted(folder.rglob(DRIVERS[packages.stem]))
        if done.code or len(drivers) != 1:
            print(f"tools/portability --setup: {packages.name}: pip got no driver: {done.err.strip()[-500:]}; remedy: apt-get install python3-pip; a "
                  "network, or a folder with the wheels of that file and PIP_NO_INDEX=1 PIP_FIND_LINKS=FOLDER; Linux on x86-64", file=sys.stderr)
            code = 3
            continue
        stamp.write_text(requested)
        programs.write_whole(driver_file, f"{drivers[0]}\n")
        print(f"{packages.stem}: {drivers[0]}")
    return code
