"""Tables of figures: a row for each kernel and variant, a column for each target."""
import sys

from gpu import figures

LEGEND = """A cell contains: the registers of a work-item (r); spills, if any (sp; of AMD's scalar registers: ssp); the stack of a work-item in bytes (B); the
number of warps that fit in a core at the same time if groups have the size in column `group` (w); and the largest local memory of a group with which
this number of warps still fits, in KB (K). Intel's cells start with the number of work-items of a thread (x); their registers are those of a thread,
128 or 256."""
CORE = {"sm_80": "A100, SM: 64 warps of 32", "sm_90": "H100, SM: 64 warps of 32", "gfx90a": "MI200, CU: 32 waves of 64",
        "dg2": "Arc, Xe core: 128 threads of 8, 16 or 32", "pvc": "Max, Xe core: 64 threads of 16 or 32"}


def cell(f):
    registers = f"x{f.width} {f.registers}r" if f.target in ("dg2", "pvc") else f"{f.registers}r"
    spills = (f" {f.spills}sp" if f.spills else "") + (f" {f.scalar_spills}ssp" if f.scalar_spills else "")
    return f"{registers}{spills} {f.stack}B {f.warps}w/{f.max_local_bytes // 1024}K"


def rows(all_figures, targets):
    """Returns rows of cells, the header first, in the order of the figures."""
    by_key = {f.key: f for f in all_figures}
    kernels = dict.fromkeys((f.kernel, f.variant, f.group) for f in all_figures)
    found = [["kernel", "variant", "group", *targets]]
    for kernel, variant, group in kernels:
        figures_by_target = [by_key.get((kernel, variant, target)) for target in targets]
        found.append([kernel, variant, str(group), *[cell(f) if f else "-" for f in figures_by_target]])
    return found


def aligned(cells):
    widths = [max(len(row[i]) for row in cells) for i in range(len(cells[0]))]
    return "".join("  ".join(text.ljust(width) for text, width in zip(row, widths)).rstrip() + "\n" for row in cells)


def markdown(cells):
    return "".join("| " + " | ".join(row) + " |\n" for row in [cells[0], ["---"] * len(cells[0]), *cells[1:]])


def page(cells, versions, vendors):
    """Returns a page of all figures. The docstrings of the vendors' modules describe how figures are made."""
    paragraphs = {vendor: sys.modules[type(vendor).__module__].__doc__.strip().split("\n\n") for vendor, _ in vendors}
    core_rows = "".join(f"| {target} | {CORE[target]} | {version} |\n" for target, version in versions.items())
    descriptions = "".join(f"**{', '.join(vendor.targets)}.** {' '.join(text)}\n\n" for vendor, text in paragraphs.items())
    return f"""# Resource usage of kernels on GPUs

Written by `tools/gpu_check --write`. `tools/gpu_check` compiles the kernels for GPUs on a machine without a GPU, with the options that renders use
(`host/cl/kernel_options.cpp`), and compares the figures with `tests/portability/gpu_budget.csv`. For NVIDIA and AMD it uses clang and libclc and
inlines all calls; the compilers of NVIDIA's and AMD's drivers may give other figures. For Intel it uses ocloc, the compiler of Intel's driver.

| target | core | compilers |
| --- | --- | --- |
{core_rows}
## Occupancy

{figures.__doc__.strip()}

{descriptions}## Kernels

{LEGEND}

Variants: `spheres`: for scenes of spheres and planes only. `grid`, `bvh`: with this acceleration structure in global memory. `costs`: torus nodes record
the cost of packets. `refined`: for devices without correctly rounded division or `fma`. `any`: the kernel is the same for all number formats.

{markdown(cells)}"""
