// What the kernels of a ring render did, for the roofline.
#pragma once
#include <vector>

#include "host/report/roofline.hpp"
#include "host/ring/ring_result.hpp"
#include "host/ring/ring_settings.hpp"

namespace raya {

/// One for each label of a kernel, those that did not run among them. Bytes, at least:
///   - trace, supersample: at each launch the words of the scene, by every PE that copies them into its own memory;
///   counters
///     read and written; of each pixel traced 12 bytes of colour and 8 of cycles written; supersampling also reads a
///     mark of each pixel and the colour of those marked. Words of the scene that a kernel reads again and again
///     where they lie (--accel grid) are not in it.
///   - sums of neighbours: of each pixel that has such a neighbour, its colour and the sum read, the sum written;
///     comparisons: of each, both colours read; means: of each pixel, the sum read and the mean written.
std::vector<KernelWork> ring_kernel_work(const RingSettings& settings, const RingResult& result);

}  // namespace raya
