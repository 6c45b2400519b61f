"""Resource usage of a kernel on a core of a GPU, and the kernel's occupancy: the number of its warps that fit in a core.

A core (NVIDIA: SM, AMD: CU, Intel: Xe core) runs work-groups. A warp (NVIDIA: warp, AMD: wave, Intel: thread) runs `width` work-items in
lockstep. For a group of `group` work-items:

    warps of a group  = group / width, rounded up
    groups            = warps for which a core has registers (by the vendor's rules) / warps of a group; at most the core's maximum of warps and groups;
                        if the kernel uses local memory, at most the core's local memory / the kernel's
    max. local memory = largest local memory of a group with which the registers, not local memory, still limit the number of groups
"""
from dataclasses import dataclass


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


def kernel_name(build, function):
    """Returns `ring/trace`; for a function with another name than its file, `ring/filter take_means`."""
    stem = build["file"].removesuffix(".cl")
    return stem if stem.split("/")[-1] == function else f"{stem} {function}"


def first_line(text, pattern):
    """Returns the first line that matches, stripped; None if there is none."""
    match = pattern.search(text)
    if not match:
        return None
    start, end = text.rfind("\n", 0, match.start()) + 1, text.find("\n", match.end())
    return " ".join(text[start:end if end >= 0 else None].split())
