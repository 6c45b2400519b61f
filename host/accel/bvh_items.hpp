// The objects of a job, as items of a BVH.
#pragma once
#include <cstdint>
#include <vector>

#include "host/accel/bvh.hpp"

namespace raya {

/// Returns the first of the words of a polygon, whose object number is `number`.
const std::uint32_t* polygon_words(const PackedJob& job, std::uint32_t number);

/// The finite objects of a job.
struct BvhItems {
    std::vector<BvhItem> items;           // empty if the hit regions are unbounded
    std::vector<std::uint32_t> separate;  // numbers of the separate objects, ascending
    double reach = -1;  // maximum coordinate of ray origins for which the boxes are valid; -1: no boxes
};

/// Returns the objects of a job with boxes that contain every point at which a kernel can compute a hit, with a margin
/// for rounding errors of the traversal. Uses up to `threads` threads.
BvhItems bvh_items(const PackedJob& job, const NumberFormat& format, unsigned threads);

}  // namespace raya
