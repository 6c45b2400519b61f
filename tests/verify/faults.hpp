// Faults of a device, its driver or its compiler, as patches of kernels: in the code that is checked, never in a check.
#pragma once
#include "host/kernels/kernel_patch.hpp"

namespace raya {

/// Ties go to the odd number.
inline const SourcePatch kRoundingFault{"number/reduced.clh", "even = ~(bits <<", "even = (bits <<"};
/// The compiler may fuse a b + c.
inline const SourcePatch kContractionFault{"number/lanes.clh", "FP_CONTRACT OFF", "FP_CONTRACT ON"};
/// The device divides by the reciprocal.
inline const SourcePatch kDivisionFault{"number/divide.clh", "return a / b;", "return a * (1.0f / b);"};
/// Of equal distances the last object wins.
inline const SourcePatch kTieFault{"geometry/sphere.clh", "& (t < h.distance)",
                                   "& ((t < h.distance) | ((t == h.distance) & (h.object != RAYA_NO_OBJECT)))"};
/// The grid ends a voxel too soon.
inline const SourcePatch kWalkFault{"grid/walk.clh", "raya_voxel_plane(g, axis, g.divisions[axis])",
                                    "raya_voxel_plane(g, axis, g.divisions[axis] - 1)"};
/// Products of 64 bits lose their upper half.
inline const SourcePatch kMappingFault{"shared/ratios.h", "(raya_u64)a * b / c", "a * b / c"};
/// Work-items read before all have written.
inline const SourcePatch kBarrierFault{
    "checks/machine.cl", "words - 1 - w] + 1;\n        barrier(CLK_LOCAL_MEM_FENCE);", "words - 1 - w] + 1;"};
/// The filter takes the right border for the middle.
inline const SourcePatch kBorderFault{"ring/filter.cl", "raya_has_neighbour(m, pixel, RAYA_RIGHT)", "1"};
/// The exchange of the torus turns a bit round in a colour or a limit. Words that it lost would be what the memory held
/// before, a ray that never ends for one.
inline const SourcePatch kExchangeFault{"torus/exchange.cl", "to[i] = from[i];",
                                        "to[i] = from[i] ^ (uint8)(0, 0, 0, 0, 0, 0, 1 << 21, 0);"};
/// A launch that goes on takes what the one before has brought home for gone.
inline const SourcePatch kAgainFault{"torus/accept.cl", "gone = !again && (root", "gone = (root"};

}  // namespace raya
