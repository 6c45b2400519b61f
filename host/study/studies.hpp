// The studies of the load laboratory: the list from which `raya study` makes its commands, and each as a function of
// what was counted.
//
// A study is a struct for its rows, a function that computes them, columns that say what a row's figures are called
// (rows.hpp), plots and comparisons that name the same figures, and findings: sentences, each a function of the rows.
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "host/study/accel_run.hpp"
#include "host/study/ensemble.hpp"
#include "host/study/grid_run.hpp"
#include "host/study/laboratory.hpp"
#include "host/study/page.hpp"

namespace raya {

/// `scenes` are those that the user named; empty: the study's own.
using StudyFunction = StudyPage(Laboratory& laboratory, const Scenes& scenes);

struct Study {
    std::string name, summary;
    bool one_scene;  // takes the first of several
    StudyFunction* run;
    std::string (*lack)() = nullptr;  // what it needs and this machine does not have, and the remedy; empty: nothing
};

/// In the order in which they tell the story.
std::span<const Study> studies();

// Kohata & Ito 1993, figure by figure and table by table.
StudyFunction study_fig7, study_fig8, study_fig9, study_table2, study_table3, study_table4, study_cluster, study_fig12,
    study_fig13, study_images;

/// Fig. 9: speed-up against the number of PEs, 1 to one for each column of a square image of 16 pixels a side or more.
/// `views`: other pictures of its size. `sizes`: the scene in several sizes.
StudyPage speedup_page(const std::string& scene, const CostImage& image,
                       const std::vector<const CostImage*>& views = {},
                       const std::vector<const CostImage*>& sizes = {});

/// Pictures of one kind, and how they were made, a sentence.
struct ImageGroup {
    std::string label, method;
    std::vector<const Costs*> pictures;
};

/// `images`: one at least, of `pes` columns or more, in the order of the table. `more`: many pictures of a kind.
StudyPage images_page(std::uint32_t pes, const std::vector<const Costs*>& images,
                      const std::vector<ImageGroup>& more = {});

// Beyond the paper.
StudyFunction study_bus, study_lattice, study_scale, study_static_vs_dynamic, study_best_offset, study_turn;

/// `scenes`: square images of one size, 16 pixels a side or more, one scene at least; one without views stands for
/// itself.
StudyPage lattice_page(const std::vector<Ensemble>& scenes);

/// 16, 32, .. PEs, up to one for each pixel of a square image of 16 pixels a side or more. `views`: other pictures of
/// its size, two at least, or none.
StudyPage scale_page(const std::string& scene, const CostImage& image, const std::vector<const CostImage*>& views = {});

/// Whether more PEs than columns take 2-D: `kept` are the numbers of PEs, of `sizes` that there are, on which the
/// mapping called `best` keeps up with it.
std::string need_of_2d(const std::string& best, const std::vector<std::uint32_t>& kept, std::size_t sizes);

// Voxels in one machine.
StudyFunction study_divisions, study_havran, study_accel;

/// `all`: of each scene the divisions in ascending order, two at least. `from_paper`: the scenes are of the paper's
/// kind, with as many objects as the paper has, so that its figures stand beside ours; the last has 1024.
/// std::logic_error where 32 or 1024 divisions are missing then.
StudyPage divisions_page(std::uint32_t side, const std::vector<std::vector<GridRun>>& all, bool from_paper);

/// `runs`: one at least, those of one scene after one another, rendered with SPD's settings but `side`. Published
/// figures stand beside those whose label and divisions are in paper::kHavran.
StudyPage havran_page(std::uint32_t side, const std::vector<GridRun>& runs);

/// `all`: of each scene every way that was measured, grid and bvh at least; groups of one series in ascending order of
/// objects; those of one series that have several seeds have the same ones.
StudyPage accel_page(const AccelSettings& settings, const AccelRuns& all);

// The torus machine: Yoshitani & Yamazaki, and beyond.
StudyFunction study_objects, study_nodes, study_inject, study_hybrid;

/// Fig. 4 of images of `size` x `size`, from run_objects() (objects_runs.hpp).
struct ObjectsRuns;
StudyPage objects_page(const ObjectsRuns& all, std::uint32_t size);

struct NodesSettings {
    std::uint32_t size = 64;    // pixels a side
    std::uint32_t most = 4096;  // nodes, a power of two
    std::uint32_t sides = 16;   // voxels along each axis, where all machines have the same ones
    /// A series ends before a machine of which this many launches of a node are to be feared: supersteps x nodes.
    std::uint64_t most_launches = std::uint64_t{1} << 22;
};

/// `scenes`: one at least.
StudyPage nodes_page(Session& session, const Scenes& scenes, const NodesSettings& settings);

/// On 1, 2, 4, ... `most` nodes, a power of two.
StudyPage inject_page(Session& session, const LabelledScene& scene, std::uint32_t size, std::uint32_t most);

/// `nodes`: a power of two, of the whole machine; in 1, 2, 4, ... groups, up to one for each node. `scenes`: one at
/// least.
StudyPage hybrid_page(Session& session, const Scenes& scenes, std::uint32_t size, std::uint32_t nodes);

// The asynchronous torus.
StudyFunction study_simgrid;
std::string lack_of_simgrid();

/// The same history by raya and by `program`, simgrid_replay, on 4 x 4 x 4 and on 8 x 8 nodes. PeerFailure.
StudyPage simgrid_page(Session& session, const LabelledScene& scene, std::uint32_t size,
                       const std::filesystem::path& program);

// Several machines.
StudyFunction study_ranks;
std::string lack_of_ranks();

/// Pixels a side, the torus's 17 at least.
struct RanksSizes {
    std::uint32_t ring = 512, torus = 512;
};

/// Predictions for 1, 2, 4, ... ranks, 65,536 or one for each pixel of the ring, beside renders that `mpirun` starts
/// here. RanksFailure.
class Mpirun;
StudyPage ranks_page(Laboratory& laboratory, const LabelledScene& on_ring, const LabelledScene& on_torus,
                     const RanksSizes& sizes, const Mpirun& mpirun);

}  // namespace raya
