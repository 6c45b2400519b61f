"""What a kernel takes of a GPU's core, and how many of its warps fit there.

A core is what a work-group runs on: NVIDIA's SM, AMD's CU, Intel's Xe core. A warp is what runs in step there: NVIDIA's warp, AMD's wave,
Intel's thread, of `width` work-items. The formula, for a group of `group` work-items:

    warps of a group  = group / width, rounded up
    groups            = what registers allow (the vendor's module) / warps of a group, at most what the core holds of either; where the kernel
                        has local memory of its own, at most the core's / that
    local memory left = what each of these groups may have before it, and no longer the registers, bounds how many there are
"""
from dataclasses import dataclass


def rounded_up(number, unit):
    return -(-number // unit) * unit


@dataclass
class Figures:
    """Of one kernel in one variant for one target. Bytes; spills as the vendor counts them; `stack` is of a work-item."""
    kernel: str
    variant: str
    target: str
    width: int
    group: int
    registers: int
    spills: int
    stack: int
    local: int
    scalar_spills: int = 0  # AMD: scalar registers kept in lanes of vector ones
    warps: int = 0          # that fit
    local_left: int = 0

    @property
    def name(self):
        return self.kernel, self.variant, self.target


@dataclass
class Fault:
    """What a kernel must not have."""
    kernel: str
    variant: str
    target: str
    text: str


@dataclass(frozen=True)
class Core:
    warps: int        # at most
    groups: int       # at most, of more than one warp; those of one warp where `lone_groups` says otherwise
    local: int        # bytes, of all groups together
    group_local: int  # bytes that one group may have
    unit: int         # in which local memory is handed out
    reserved: int = 0  # bytes of each group that the system takes
    lone_groups: int = 0

    def fit(self, figures, warps_by_registers):
        """Sets what fits."""
        each = rounded_up(figures.group, figures.width) // figures.width
        most = self.lone_groups if each == 1 and self.lone_groups else self.groups
        groups = min(min(self.warps, warps_by_registers) // each, most)
        if figures.local:
            groups = min(groups, self.local // rounded_up(figures.local + self.reserved, self.unit))
        figures.warps = groups * each
        if groups:
            figures.local_left = min(self.group_local, self.local // groups // self.unit * self.unit - self.reserved)
        return figures


def kernel_name(build, function):
    """`ring/trace`; of a file with other kernels, `ring/filter take_means`."""
    stem = build["file"].removesuffix(".cl")
    return stem if stem.split("/")[-1] == function else f"{stem} {function}"


def first_line(text, pattern):
    """The first line that has it, without blanks around; None."""
    match = pattern.search(text)
    if not match:
        return None
    start, end = text.rfind("\n", 0, match.start()) + 1, text.find("\n", match.end())
    return " ".join(text[start:end if end >= 0 else None].split())
