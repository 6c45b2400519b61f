// Which pixels' rays may enter the box at which node's voxels: by the faces of the box that the eye sees.
#pragma once
#include <vector>

#include "host/model/number_format.hpp"
#include "kernels/shared/node.h"

namespace raya {

/// Rows from, to, and columns from, to, the last not included.
struct PixelWindow {
    std::uint32_t rows[2], columns[2];
};

/// For each node a window that holds every pixel whose primary ray enters the box at one of its voxels: all where the
/// eye is in that voxel; else those that its faces in the sides of the box before the eye cover, widened by what the
/// format can turn a ray. The whole image where the eye is so near to such a side, or the format has so few bits, that
/// no bound is known. Empty for a node where no ray enters.
std::vector<PixelWindow> pixel_windows(const raya_job& job, const raya_grid& grid, const raya_torus& torus,
                                       const NumberFormat& format);

}  // namespace raya
