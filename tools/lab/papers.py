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

REFERENCES = [
    "Milton Abramowitz, Irene A. Stegun (eds.): Handbook of Mathematical Functions. National Bureau of Standards, "
    "Applied Mathematics Series 55, 1964.",
    "John Amanatides, Andrew Woo: A Fast Voxel Traversal Algorithm for Ray Tracing. Eurographics '87, pp. 3-10, 1987.",
    "Akira Fujimoto, Takayuki Tanaka, Kansei Iwata: ARTS: Accelerated Ray-Tracing System. IEEE Computer Graphics and "
    "Applications 6 (4), pp. 16-26, 1986.",
    "Eric Haines: A Proposal for Standard Graphics Environments. IEEE Computer Graphics and Applications 7 (11), "
    "pp. 3-5, 1987. (The Standard Procedural Databases, SPD.)",
    "Vlastimil Havran, Filip Sixta: Comparison of Hierarchical Grids. Ray Tracing News 12 (1), 1999.",
    "Alan Heirich, James Arvo: A Competitive Analysis of Load Balancing Strategies for Parallel Ray Tracing. The "
    "Journal of Supercomputing 12, pp. 57-68, 1998.",
    "SGS-Thomson Microelectronics: IMS T805, 32-bit floating-point transputer. Data sheet, 1996.",
    "Sture Holm: A Simple Sequentially Rejective Multiple Test Procedure. Scandinavian Journal of Statistics 6 (2), "
    "pp. 65-70, 1979.",
    "Masaki Kohata, Taku Ito: Parallel Computation of Ray Tracing on a One-dimensional DSP Array "
    "(1次元DSPアレイでの光線追跡法の並列計算). IPSJ Journal (Information Processing Society of Japan), 1993, in Japanese.",
    "Hitoshi Nishimura, Hiroshi Deguchi, Toshikazu Tatsumi, Toru Kawata, Isao Shirakawa, Koichi Omura: Performance evaluation of parallel "
    "processing in the computer graphics system LINKS-1 (in Japanese, abstract). Transactions of the IEICE J68-D (4), pp. 733-740, 1985.",
    "Cellular Array Processor CAP and Applications (abstract). Journal of VLSI Signal Processing, doi:10.1007/BF00932066, 1989.",
    "Masaharu Yoshida, Tadashi Naruse, Tokiichiro Takahashi: A Dedicated Graphics Processor SIGHT-2. Eurographics Workshop on Graphics "
    "Hardware, pp. 151-169, 1989.",
    "Michael Potmesil, Eric M. Hoffert: The Pixel Machine: A Parallel Image Computer. Computer Graphics 23 (3) "
    "(SIGGRAPH '89), pp. 69-78, 1989.",
    "Henri Casanova, Arnaud Giersch, Arnaud Legrand, Martin Quinson, Frédéric Suter: Versatile, Scalable, and "
    "Accurate Simulation of Distributed Applications and Platforms. Journal of Parallel and Distributed Computing 74 "
    "(10), pp. 2899-2917, 2014.",
    "Ingo Wald, Sven Woop, Carsten Benthin, Gregory S. Johnson, Manfred Ernst: Embree: A Kernel Framework for "
    "Efficient CPU Ray Tracing. ACM Transactions on Graphics 33 (4), 2014.",
    "T. Yoshitani, K. Yamazaki: Realisation and evaluation of space-partition parallel ray tracing "
    "(空間分割型並列レイティング法の実現と評価). National convention of the IPSJ, 4L-6, about 1995, in Japanese.",
]


def is_papers(scene, size):
    """Returns true for the scene that resembles the paper's, at the paper's image size."""
    return scene == "centre" and size == SIZE
