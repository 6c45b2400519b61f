// The four neighbours of a pixel in the image, and the sample points of a pixel.
#ifndef RAYA_SHARED_NEIGHBOURS_H
#define RAYA_SHARED_NEIGHBOURS_H
#include "kernels/shared/mapping.h"

enum { RAYA_LEFT, RAYA_RIGHT, RAYA_ABOVE, RAYA_BELOW, RAYA_SIDES };

// Returns true if the pixel's neighbour on `side` lies in the image.
RAYA_SHARED_FUNCTION int raya_has_neighbour(raya_mapping m, raya_pixel pixel, raya_u32 side) {
    if (side == RAYA_LEFT) return pixel.column > 0;
    if (side == RAYA_RIGHT) return pixel.column + 1 < m.width;
    if (side == RAYA_ABOVE) return pixel.row > 0;
    return pixel.row + 1 < m.height;
}

// Returns the pixel's neighbour on `side`, which must lie in the image.
RAYA_SHARED_FUNCTION raya_pixel raya_neighbour(raya_pixel pixel, raya_u32 side) {
    if (side == RAYA_LEFT) pixel.column -= 1;
    if (side == RAYA_RIGHT) pixel.column += 1;
    if (side == RAYA_ABOVE) pixel.row -= 1;
    if (side == RAYA_BELOW) pixel.row += 1;
    return pixel;
}

// Sample points of a pixel that a pass traces: its own point, or the four new points of supersampling (Kohata & Ito
// 1993, supersampling).
enum {
    RAYA_POINTS_OWN,       // one point: the pixel's own sample point (kernels/README.md, Camera)
    RAYA_POINTS_AXES,      // four points, half a pixel to the left, right, above, below
    RAYA_POINTS_DIAGONALS  // four points, half a pixel away on both axes: upper left and right, lower left and right
};

#define RAYA_NEW_POINTS 4u

RAYA_SHARED_FUNCTION raya_u32 raya_points(raya_u32 points) { return points == RAYA_POINTS_OWN ? 1u : RAYA_NEW_POINTS; }

// Return the offset in pixels, to the right or down, of point n from the pixel's own sample point.
// n < raya_points(points).
RAYA_SHARED_FUNCTION float raya_point_right(raya_u32 points, raya_u32 n) {
    if (points == RAYA_POINTS_DIAGONALS) return n & 1u ? 0.5f : -0.5f;
    return points == RAYA_POINTS_OWN || n > 1u ? 0.0f : n == 1u ? 0.5f : -0.5f;
}
RAYA_SHARED_FUNCTION float raya_point_down(raya_u32 points, raya_u32 n) {
    if (points == RAYA_POINTS_DIAGONALS) return n & 2u ? 0.5f : -0.5f;
    return points == RAYA_POINTS_OWN || n < 2u ? 0.0f : n == 3u ? 0.5f : -0.5f;
}

#endif
