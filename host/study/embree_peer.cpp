#include "host/study/embree_peer.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <sstream>

#include "host/study/peer.hpp"

namespace raya {
namespace {

constexpr const char *kBuild = "build", *kMean = "mean";  // the other lines: "build SECONDS", "mean WAY R G B"

PeerWay way_of(const std::string& name, std::istringstream& words) {
    PeerWay way{name, 0, {}};
    words >> way.rays;
    for (double seconds = 0; words >> seconds;) way.seconds.push_back(seconds);
    const bool positive = std::ranges::all_of(way.seconds, [](double s) { return s > 0; });
    if (way.rays == 0 || way.seconds.empty() || !positive || !words.eof())
        throw PeerFailure(fmt::format("embree_peer: '{}' is no line of rays and seconds", words.str()));
    return way;
}

}  // namespace

PeerAnswer peer_answer(const std::string& printed) {
    PeerAnswer answer;
    std::istringstream lines(printed);
    bool complete = false;  // the build's time comes last
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line);
        std::string name;
        words >> name;
        if (name == kBuild)
            complete = static_cast<bool>(words >> answer.build_s);
        else if (name != kMean)
            answer.ways.push_back(way_of(name, words));
    }
    if (!complete || answer.ways.empty()) throw PeerFailure("embree_peer: it does not tell its times");
    return answer;
}

PeerAnswer ask_embree(const std::filesystem::path& program, const std::string& nff, const PeerPicture& picture) {
    const std::string size = fmt::format("{}x{}", picture.side, picture.side);
    // The scene goes in as a temporary file without a name.
    return peer_answer(peer_output({program.string(), "/dev/stdin", size, std::to_string(picture.bounces), "centres",
                                    std::to_string(picture.samples)},
                                   nff));
}

}  // namespace raya
