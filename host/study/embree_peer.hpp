// The same pictures by Embree, another ray tracer: what tools/embree's program embree_peer tells, where it lies beside
// the program that runs.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace raya {

/// What it is asked for.
struct PeerPicture {
    std::uint32_t side = 0;  // pixels
    std::uint32_t bounces = 0;
    int samples = 1;  // that are timed, after one that is not
};

/// One way of asking Embree: ray by ray, or sixteen in step.
struct PeerWay {
    std::string name;
    std::uint64_t rays = 0;       // of one picture
    std::vector<double> seconds;  // of each sample: the loop over the picture alone
};

struct PeerAnswer {
    std::vector<PeerWay> ways;
    double build_s = 0;  // of Embree's tree
};

/// Reads what embree_peer prints. PeerFailure where it is nothing of the kind.
PeerAnswer peer_answer(const std::string& printed);

/// Runs the program once with the scene's NFF text, rays through the centres of pixels. PeerFailure.
PeerAnswer ask_embree(const std::filesystem::path& program, const std::string& nff, const PeerPicture& picture);

}  // namespace raya
