#include "host/array/render.hpp"

#include <fmt/core.h>

namespace raya {

std::uint64_t RenderResult::launches(const std::string& label) const {
    std::uint64_t launches = 0;
    for (const LabelSummary& c : commands)
        if (c.label == label && c.kind == "kernel") launches += c.launches;
    return launches;
}

KernelOptions kernel_options(const RenderSettings& s, const raya_job& job, bool has_patches) {
    const raya_objects& objects = job.objects;
    return {.lanes = s.kernels.lanes,
            .group_size = s.kernels.group_size,
            .bounces = s.bounces,
            .format = s.format,
            .exact_divide = s.kernels.exact_arithmetic,
            .exact_fma = s.kernels.exact_arithmetic,
            .words_local = s.kernels.local_words,
            .filter = s.kernels.filter && (objects.spheres > 0 || objects.polygons > 0) &&
                      filters_are_valid(s.format, job.extent),
#define RAYA_KIND_OPTION(kind, kinds, KIND) .kinds = objects.kinds > 0,
            RAYA_SHAPE_LIST(RAYA_KIND_OPTION).patches = has_patches,
            .sphere_batch = s.kernels.sphere_batch};
}

std::vector<std::uint32_t> ranks_of_pes(std::uint32_t pes, std::uint32_t ranks) {
    if (pes < ranks)
        throw UserError(fmt::format(
            "{} ranks for {} PEs: a rank needs at least one PE; start {} ranks or fewer, or use more PEs (--pes)",
            ranks, pes, pes));
    std::vector<std::uint32_t> rank_of;
    for (std::uint64_t pe = 0; pe < pes; ++pe)
        rank_of.push_back(static_cast<std::uint32_t>(((pe + 1) * ranks - 1) / pes));
    return rank_of;
}

Distribution::Distribution(std::vector<std::uint32_t> rank_of, Ranks& ranks)
    : ranks_(ranks), rank_of_(std::move(rank_of)), slot_of_(rank_of_.size()), pes_of_(ranks.count()) {
    for (std::uint32_t pe = 0; pe < all(); ++pe) {
        std::vector<std::uint32_t>& pes = pes_of_[rank_of_[pe]];
        slot_of_[pe] = static_cast<std::uint32_t>(pes.size());
        pes.push_back(pe);
    }
}

}  // namespace raya
