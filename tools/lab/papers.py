"""Figures printed in the papers, with the number of the table or figure. [D] marks figures that we derived from printed ones."""

SPA = "Kohata & Ito 1993"
TP = "Yoshitani & Yamazaki, about 1995"
GRID = "Havran & Sixta 1999"
DYNAMIC = "Heirich & Arvo 1998"

# Kohata & Ito 1993.
SIZE = PES = 256
# Table 2: milliseconds for the scene of Fig. 6 on 256 PEs and on one PE; computing time of a PC and a workstation.
OBJECTS_MS, COMPUTE_MS, IMAGE_MS, DISPLAY_MS, TOTAL_MS = 2, 283, 140, 1130, 1555
ONE_PE_COMPUTE_MS, ONE_PE_TOTAL_MS = 64_800, 66_072
PC_MS, WORKSTATION_MS = 295_910, 28_800
# Table 3: ray tracing and filtering, p = 0 and p = 16.
TRACE_0_MS, TRACE_16_MS, FILTER_0_MS, FILTER_16_MS = 653, 283, 9, 19
FILTERED_0_MS, FILTERED_16_MS = TRACE_0_MS + FILTER_0_MS, TRACE_16_MS + FILTER_16_MS
# Table 4: supersampling, communication and computation, p = 0 and p = 16.
EXCHANGE_0_MS, EXCHANGE_16_MS, SUPERSAMPLE_0_MS, SUPERSAMPLE_16_MS = 2, 12, 739, 407
# [D] Times for p = 8, from Table 3: the time of its rotations plus the time of the filter's arithmetic, which is the same for every p.
FILTER_ARITHMETIC_MS = 7
# [D] Fraction of recomputed pixels, from Table 4, if its computation time is that of supersampling alone.
RECOMPUTED_MIN, RECOMPUTED_MAX = 0.16, 0.18
# [D] From Tables 2 and 3, with the digits that are certain although 653, 283 and 64,800 ms are rounded.
SPEEDUP_16 = 229  # printed in the abstracts
SPEEDUP_0 = 99.2
IMBALANCE_0, IMBALANCE_16 = 1.58, 0.118  # u(0), u(16); Figs 7 and 8 print no u
IMBALANCE_16_ROUNDING = "the paper's u(16) lies in 0.115 .. 0.121, because its times are rounded"
EFFICIENCY_0, EFFICIENCY_16 = 0.388, 0.895
CAP_RATIO = 3.86  # text next to Fig. 9: speed-up of CAP with 256 PEs over CAP with 64 PEs
PIXEL_MACHINE_SPEEDUP = 60  # text next to Fig. 9: 64 nodes, "60 or more"

# Yoshitani & Yamazaki, about 1995.
RAY_WORDS = 22  # [D] Table 1: number of scalars in a ray packet, without the data for the voxel search and of the object hit
FEW_DIVISIONS, MANY_DIVISIONS = 32, 1024  # numbers of divisions in Fig. 3, for 1024 objects on one machine
FEW_DIVISIONS_S, MANY_DIVISIONS_S = 313, 60  # seconds for these numbers of divisions
DIVISIONS_FALL = FEW_DIVISIONS_S / MANY_DIVISIONS_S  # [D]
TESTS_FALL = 5  # the number of tests falls "to about 1/5"

# Havran & Sixta 1999, uniform grid with 3D-DDA on SPD's scenes: {(scene, divisions along x, y, z): (tests per ray, steps per ray)}.
UNIFORM_GRIDS = {
    ("balls", (46, 46, 3)): (358.66, 5.69),
    ("balls", (103, 103, 7)): (72.54, 12.40),
    ("lattice", (20, 20, 20)): (20.67, 5.09),
    ("lattice", (44, 44, 44)): (9.26, 10.56),
}



def is_papers(scene, size):
    """Returns true for the scene that resembles the paper's, at the paper's image size."""
    return scene == "centre" and size == SIZE
