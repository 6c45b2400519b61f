// Baseline for raya's render times: Whitted ray tracing as in kernels/README.md, of the same scenes, with Embree 3 on
// all cores.
//
//   embree_peer SCENE.nff WxH BOUNCES SAMPLES
//
// Prints for each of three methods "METHOD RAYS SECONDS...", with the seconds of each render, and "mean METHOD R G B",
// the image's mean colour; then "build SECONDS". `single` traces single rays; `sixteen` traces the ray trees of 4 x 4
// pixels in lockstep, in packets of 16 rays; `coherent` does the same, and tells Embree that the rays are coherent.
// Only the loop over the pixels is timed. Exit codes: 0 done; 2 an error.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

#include "host/scene/nff.hpp"
#include "tools/embree/picture.hpp"

namespace raya {
namespace {

template <int N>
void measure(const char* method, Picture& picture, bool coherent, int samples) {
    std::string times;
    long rays = 0;
    for (int i = 0; i <= samples; ++i) {  // iteration 0 is a warm-up
        const auto start = std::chrono::steady_clock::now();
        rays = picture.render<N>(coherent);
        const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        if (i > 0) times += " " + std::to_string(s);
    }
    const V3 mean = picture.mean();
    std::printf("%s %ld%s\nmean %s %f %f %f\n", method, rays, times.c_str(), method, mean.x, mean.y, mean.z);
}

int run(char** arguments) {
    const Scene scene = read_nff(arguments[0]);
    int width = 0, height = 0;
    if (std::sscanf(arguments[1], "%dx%d", &width, &height) != 2) return 2;
    const EmbreeScene embree(scene);
    const Whitted whitted(scene, embree, std::atoi(arguments[2]));
    Picture picture(whitted, camera_of(scene.view, width, height));
    const int samples = std::atoi(arguments[3]);
    measure<1>("single", picture, false, samples);
    measure<16>("sixteen", picture, false, samples);
    measure<16>("coherent", picture, true, samples);
    std::printf("build %f\n", embree.build_s());
    return 0;
}

}  // namespace
}  // namespace raya

int main(int argc, char** argv) {
    if (argc != 5) {
        std::fprintf(stderr, "usage: embree_peer SCENE.nff WxH BOUNCES SAMPLES\n");
        return 2;
    }
    try {
        return raya::run(argv + 1);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "embree_peer: %s\n", error.what());
        return 2;
    }
}
