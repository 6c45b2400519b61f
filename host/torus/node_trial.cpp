#include "host/torus/node_trial.hpp"

#include "host/torus/node_memory.hpp"
#include "host/torus/topology.hpp"

namespace raya {
namespace {

// Entries of lists that are made in a fraction of a second.
constexpr std::uint64_t kFewEntries = std::uint64_t{1} << 24;

std::uint64_t voxels_of(const Divisions& divisions) {
    return std::uint64_t{divisions[0]} * divisions[1] * divisions[2];
}

class Trial {
  public:
    Trial(const PackedJob& job, const NumberFormat& format, const Divisions& voxels)
        : job_(job), format_(format), voxels_(voxels) {}

    std::optional<TrialNodes> operator()(const std::array<std::uint32_t, 3>& nodes) {
        TrialNodes tried{0, voxels_};
        for (std::size_t axis = 0; axis < 3; ++axis)
            while (tried.voxels[axis] < nodes[axis]) tried.voxels[axis] *= 2;
        const std::uint64_t voxels = voxels_of(tried.voxels);
        if (voxels > kMostCutVoxels || everywhere_ * voxels > kFewEntries) return {};
        try {
            const Partition cut = partition(job_, format_, tried.voxels);
            everywhere_ = cut.objects.size() == cut.distinct * voxels ? cut.distinct : 0;
            // Which voxels a node holds does not depend on its links.
            tried.words = fullest_node_words(job_, cut, make_torus(nodes, Links::kTorus3d));
            return tried;
        } catch (const TooManyEntries&) {
            return {};
        }
    }

  private:
    const PackedJob& job_;
    const NumberFormat format_;
    const Divisions voxels_;
    // How many objects the last trial found in every voxel, if all. Formats without a bound for the registration do
    // that to any number of voxels; no number of nodes helps then, and the lists grow long.
    std::uint64_t everywhere_ = 0;
};

}  // namespace

NodeTrial trial_of(const PackedJob& job, const NumberFormat& format, const Divisions& voxels) {
    return Trial(job, format, voxels);
}

}  // namespace raya
