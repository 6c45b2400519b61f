// What raya is measured against: the same Whitted ray tracing (kernels/README.md) of the same scenes on Embree 3, on
// all cores.
//
//   embree_peer SCENE.nff WxH BOUNCES centres|corners SAMPLES
//
// Prints, for each of two ways, "WAY RAYS SECONDS...", one time for each sample; then "build SECONDS". `single` asks
// Embree ray by ray, `sixteen` walks the ray trees of sixteen pixels, 4 x 4, in step and asks for sixteen rays at once.
// Only the loop over the picture is timed.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "host/scene/nff.hpp"
#include "tools/embree/picture.hpp"

namespace raya {
namespace {

void measure(const char* way, Picture& picture, long (Picture::*render)(), int samples) {
    std::string times;
    long rays = 0;
    for (int i = 0; i <= samples; ++i) {  // the first warms up
        const auto start = std::chrono::steady_clock::now();
        rays = (picture.*render)();
        const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        if (i > 0) times += " " + std::to_string(s);
    }
    const V3 mean = picture.mean();
    std::printf("%s %ld%s\nmean %s %f %f %f\n", way, rays, times.c_str(), way, mean.x, mean.y, mean.z);
}

int run(char** words) {
    const Scene scene = read_nff(words[0]);
    int width = 0, height = 0;
    if (std::sscanf(words[1], "%dx%d", &width, &height) != 2) return 2;
    const EmbreeScene embree(scene);
    const Whitted whitted(scene, embree, std::atoi(words[2]));
    Picture picture(whitted, camera_of(scene.view, width, height, std::string(words[3]) == "corners"));
    const int samples = std::atoi(words[4]);
    measure("single", picture, &Picture::single, samples);
    measure("sixteen", picture, &Picture::sixteen, samples);
    std::printf("build %f\n", embree.build_s());
    return 0;
}

}  // namespace
}  // namespace raya

int main(int argc, char** argv) {
    if (argc != 6) {
        std::fprintf(stderr, "usage: embree_peer SCENE.nff WxH BOUNCES centres|corners SAMPLES\n");
        return 2;
    }
    try {
        return raya::run(argv + 1);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "embree_peer: %s\n", error.what());
        return 2;
    }
}
