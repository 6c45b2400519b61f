// Fig. 4's machine, 64 transputers of a voxel each: what is rendered for it, and the figures that follow.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "host/study/rows.hpp"
#include "host/study/statistics.hpp"
#include "host/study/torus_runs.hpp"

namespace raya {

inline constexpr const char *kEven = "even", *kRandom = "random", *kWithin = "random, none astride";
inline constexpr const char *kPaperProtocol = kProtocolOfPaper.name, *kOwnProtocol = kProtocolOfRaya.name;

/// One number of objects of one kind by one protocol: a render of the even scene, or one of each random scene.
struct ObjectsRow {
    int objects = 0;
    std::string kind, protocol;
    std::vector<TorusRun> runs = {};  // one at least

    template <class Figure>
    Estimate of(Figure figure) const {
        std::vector<double> values;
        for (const TorusRun& run : runs) values.push_back(static_cast<double>(std::invoke(figure, run)));
        return estimate_of(values);
    }
    Estimate overlapped() const { return of(&TorusRun::overlapped_ms); }
    Estimate stepwise() const { return of(&TorusRun::stepwise_ms); }
    Estimate asynchronous() const { return of(&TorusRun::asynchronous_ms); }
    double overlapped_ms() const { return overlapped().mean; }
    double root_ms() const { return of(&TorusRun::root_ms).mean; }
    double tests_per_ray() const { return of(&TorusRun::tests_per_ray).mean; }
    double copies() const { return of(&TorusRun::copies).mean; }
};
using ObjectsRows = std::vector<ObjectsRow>;

/// Primary rays alone: how many hit; of those that meet the box, how many end in the first voxel, hit or out of the
/// box, and through how many voxels they go.
struct PrimaryRow {
    int objects = 0;
    std::string kind;
    std::vector<double> hit_shares = {}, first_shares = {}, voxels = {};  // of each scene

    double first_share() const { return estimate_of(first_shares).mean; }
    double steps() const { return estimate_of(voxels).mean; }
};

/// The even scene of most and of fewest objects, with ray packets of so many words.
struct WordsRow {
    int objects = 0;
    std::uint32_t words = 0;
    double overlapped_ms = 0, stepwise_ms = 0;
};

struct ObjectsRuns {
    ObjectsRows rows;
    std::vector<PrimaryRow> primary;
    std::vector<WordsRow> words;
};

/// For numbers of objects, ascending, and so many random scenes of each.
ObjectsRuns run_objects(Session& session, const std::vector<int>& counts, std::uint32_t size, int seeds);

/// Why time grows less than the objects do, in four factors whose product it is: fewer voxels for a ray to go through;
/// fewer tests in a voxel than in proportion to the objects; what does not depend on objects, such as making and
/// sending rays; and how far the time that the machine takes is bound by something other than the work of all its
/// nodes.
struct Growth {
    double objects = 1, time = 1;  // of the last number of objects, over the first
    double depth = 1, lists = 1, fixed = 1, bound = 1;

    double sublinearity() const { return objects / time; }
    double share(double factor) const;  // of the sub-linearity, by logarithms
};

/// By overlapped time.
Growth growth_of(const TorusRun& first, const TorusRun& last, double objects);

/// Of each scene of two rows: those of one seed.
std::vector<Growth> growth_of(const ObjectsRow& first, const ObjectsRow& last);

/// Those of one kind and protocol.
ObjectsRows of(const ObjectsRows& rows, const std::string& kind, const std::string& protocol);

/// Random scenes beside the even one of as many objects: times as long.
struct ObjectsRatio {
    int objects = 0;
    std::string kind, protocol;
    Estimate overlapped, stepwise, asynchronous;
};
using ObjectsRatios = std::vector<ObjectsRatio>;

ObjectsRatios ratios_of(const ObjectsRows& rows);
ObjectsRatios of(const ObjectsRatios& all, const std::string& kind, const std::string& protocol);

/// From the fewest objects to the most, of each scene.
struct GrowthRow {
    std::string kind, protocol;
    std::vector<Growth> scenes;

    template <class Figure>
    Estimate of(Figure figure) const {
        return estimate_of(each(scenes, figure));
    }
    double mean(double Growth::*factor) const { return of(factor).mean; }
};

/// Even and random, by the paper's protocol, then by raya's.
std::vector<GrowthRow> growth_rows(const ObjectsRows& rows);

}  // namespace raya
