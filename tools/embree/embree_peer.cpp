// Baseline for raya's render times: Whitted ray tracing as in kernels/README.md, of the same scenes, with Embree 3 on
// all cores.
//
//   embree_peer SCENE.nff WxH BOUNCES SAMPLES
//   embree_peer SCENE.nff WxH BOUNCES SAMPLES tiles
//       prints only the least nanoseconds of each tile of 4 x 4 pixels, traced as `coherent` by one thread, a line for
//       each row of tiles
//
//   embree_peer SCENE.nff WxH BOUNCES SAMPLES robust
//       with Embree's flag for watertight tests; raya's are watertight, Embree's without the flag are not
//
// Prints for each of three methods "METHOD RAYS SECONDS...", with the seconds of each render, and "mean METHOD R G B",
// the image's mean colour; then "build SECONDS". `single` traces single rays; `sixteen` traces the ray trees of 4 x 4
// pixels in lockstep, in packets of 16 rays; `coherent` does the same, and tells Embree that the rays are coherent.
// Only the loop over the pixels is timed. Exit codes: 0 done; 2 an error.
#include <embree3/rtcore.h>
#include <pmmintrin.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "host/scene/nff.hpp"
#include "tools/embree/whitted.hpp"

namespace raya {
namespace {

constexpr float kFar = 1e30f;

/// RTCRayHit and RTCRayHit16. Embree 4 stores one more word for each ray than Embree 3.
template <int N>
struct RayHits {
    RTCRayNt<N> ray;
    RTCHitNt<N> hit;
    unsigned instance_primitives[N];
};

// The functions of Embree that trace rays, of Embree 3 or, with RAYA_EMBREE4, of Embree 4. The other functions,
// structures and constants that embree_peer uses are equal in both versions, so their declarations are always those of
// Embree 3.
#if RAYA_EMBREE4
/// RTCIntersectArguments and RTCOccludedArguments of Embree 4.
struct Query {
    int flags = 0;  // 1 << 16: coherent rays
    unsigned features = 0xffffffff;
    void *context = nullptr, *filter = nullptr, *callback = nullptr;

    explicit Query(bool coherent) : flags(coherent ? 1 << 16 : 0) {}
};
extern "C" {
void intersect1(RTCScene, void*, Query*) asm("rtcIntersect1");
void intersect16(const int*, RTCScene, void*, Query*) asm("rtcIntersect16");
void occluded1(RTCScene, void*, Query*) asm("rtcOccluded1");
void occluded16(const int*, RTCScene, void*, Query*) asm("rtcOccluded16");
}
#else
struct Query : RTCIntersectContext {
    explicit Query(bool coherent) {
        rtcInitIntersectContext(this);
        if (coherent) flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    }
};
inline void intersect1(RTCScene scene, void* ray, Query* query) {
    rtcIntersect1(scene, query, static_cast<RTCRayHit*>(ray));
}
inline void intersect16(const int* valid, RTCScene scene, void* rays, Query* query) {
    rtcIntersect16(valid, scene, query, static_cast<RTCRayHit16*>(rays));
}
inline void occluded1(RTCScene scene, void* ray, Query* query) {
    rtcOccluded1(scene, query, static_cast<RTCRay*>(ray));
}
inline void occluded16(const int* valid, RTCScene scene, void* rays, Query* query) {
    rtcOccluded16(valid, scene, query, static_cast<RTCRay16*>(rays));
}
#endif

/// Stack of the pending rays of a pixel's ray tree.
class RayStack {
  public:
    void push_back(const PendingRay& r) { rays_[size_++] = r; }
    PendingRay pop() { return rays_[--size_]; }
    bool empty() const { return size_ == 0; }

  private:
    std::array<PendingRay, 64> rays_;
    std::size_t size_ = 0;
};

class Picture {
  public:
    Picture(const Whitted& whitted, const Camera& camera)
        : whitted_(whitted), camera_(camera), pixels_(static_cast<std::size_t>(camera.width) * camera.height) {}

    /// Renders with single rays (N = 1), or tiles of 4 x 4 pixels with packets of N = 16 rays. coherent: with Embree's
    /// flag for coherent rays. Returns the number of rays.
    template <int N>
    long render(bool coherent) {
        const int rows = (camera_.height + kSide<N> - 1) / kSide<N>;
        std::atomic<int> next = 0;
        std::atomic<long> rays = 0;
        std::vector<std::thread> threads;
        for (unsigned i = 0; i < std::thread::hardware_concurrency(); ++i)
            threads.emplace_back([&] {
                _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);  // recommended by Embree's manual
                _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
                long thread_rays = 0;
                for (int row = next++; row < rows; row = next++)
                    for (int column = 0; column < camera_.width; column += kSide<N>)
                        thread_rays += trace_tile<N>(row * kSide<N>, column, coherent);
                rays += thread_rays;
            });
        for (std::thread& thread : threads) thread.join();
        return rays;
    }

    void print_tiles(int samples) {
        _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
        _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
        for (int row = 0; row < camera_.height; row += kSide<16>) {
            for (int column = 0; column < camera_.width; column += kSide<16>) {
                auto least = std::chrono::nanoseconds::max();
                for (int i = 0; i < samples; ++i) {
                    const auto start = std::chrono::steady_clock::now();
                    trace_tile<16>(row, column, true);
                    least = std::min<std::chrono::nanoseconds>(least, std::chrono::steady_clock::now() - start);
                }
                std::printf("%ld ", static_cast<long>(least.count()));
            }
            std::puts("");
        }
    }

    /// Returns the mean colour of the pixels.
    V3 mean() const {
        V3 sum;
        for (const V3& p : pixels_) sum = sum + p;
        return (1 / static_cast<float>(pixels_.size())) * sum;
    }

  private:
    template <int N>
    static constexpr int kSide = N == 1 ? 1 : 4;  // of a tile, in pixels

    /// Ray tree of one pixel of a tile.
    struct Lane {
        RayStack stack;
        PendingRay ray;
        ShadingPoint point;
        V3 colour;
    };

    template <int N>
    long trace_tile(int top, int left, bool coherent) {
        Query query(coherent);
        std::array<Lane, N> lanes;
        for (int i = 0; i < N; ++i) {
            const int row = top + i / kSide<N>, column = left + i % kSide<N>;
            if (row < camera_.height && column < camera_.width)
                lanes[i].stack.push_back({camera_.eye, camera_.direction(row, column), 1, 0});
        }
        long rays = 0;
        while (const long traced_rays = trace_next_rays<N>(lanes, query, rays)) rays += traced_rays;
        for (int i = 0; i < N; ++i) {
            const int row = top + i / kSide<N>, column = left + i % kSide<N>;
            if (row < camera_.height && column < camera_.width)
                pixels_[static_cast<std::size_t>(row) * camera_.width + column] = lanes[i].colour;
        }
        return rays;
    }

    // Traces the next ray of each lane and returns the number of these rays. Adds the number of shadow rays to `rays`.
    template <int N>
    long trace_next_rays(std::array<Lane, N>& lanes, Query& query, long& rays) const {
        alignas(64) std::array<int, N> valid{};
        alignas(64) RayHits<N> q;
        long traced_rays = 0;
        for (int i = 0; i < N; ++i) {
            set_no_ray(q.ray, i);
            if (lanes[i].stack.empty()) continue;
            const PendingRay& r = lanes[i].ray = lanes[i].stack.pop();
            valid[i] = -1;
            ++traced_rays;
            set_ray(q.ray, i, r.origin, r.direction, kFar);
            q.hit.geomID[i] = q.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        if (traced_rays == 0) return 0;
        if constexpr (N == 1)
            intersect1(whitted_.embree.rtc(), &q, &query);
        else
            intersect16(valid.data(), whitted_.embree.rtc(), &q, &query);
        for (int i = 0; i < N; ++i) {
            if (valid[i] == 0) continue;
            Lane& lane = lanes[i];
            const PeerHit h = whitted_.embree.hit(lane.ray.origin, lane.ray.direction, q.ray.tfar[i], q.hit.geomID[i],
                                                  q.hit.primID[i], {q.hit.Ng_x[i], q.hit.Ng_y[i], q.hit.Ng_z[i]},
                                                  q.hit.u[i], q.hit.v[i]);
            if (h.surface < 0) {
                lane.colour = lane.colour + lane.ray.weight * whitted_.background;
                valid[i] = 0;
                continue;
            }
            lane.point = whitted_.shading_point(lane.ray, h);
            lane.colour = lane.colour + lane.ray.weight * whitted_.ambient(lane.point);
        }
        for (const PeerLight& light : whitted_.lights) rays += add_light<N>(lanes, valid, light, query);
        for (int i = 0; i < N; ++i)
            if (valid[i] != 0) whitted_.push_secondary_rays(lanes[i].stack, lanes[i].ray, lanes[i].point);
        return traced_rays;
    }

    // Adds the contribution of a light to the colours of the lanes with a hit. Returns the number of shadow rays.
    template <int N>
    long add_light(std::array<Lane, N>& lanes, const std::array<int, N>& valid, const PeerLight& light,
                   Query& query) const {
        alignas(64) std::array<int, N> unblocked{};
        alignas(64) RTCRayNt<N> s;
        std::array<V3, N> to_light;
        long rays = 0;
        bool has_unblocked = false;
        for (int i = 0; i < N; ++i) {
            const ShadingPoint& m = lanes[i].point;
            set_no_ray(s, i);
            if (valid[i] == 0) continue;
            const V3 light_offset = light.position - m.outer;
            if (!(dot(m.normal, light_offset) > 0)) continue;
            ++rays;
            const float distance = std::sqrt(dot(light_offset, light_offset));
            to_light[i] = (1 / distance) * light_offset;
            if (whitted_.embree.plane_blocks(m.outer, to_light[i], distance)) continue;
            set_ray(s, i, m.outer, to_light[i], distance);
            unblocked[i] = -1;
            has_unblocked = true;
        }
        if (!has_unblocked) return rays;
        if constexpr (N == 1)
            occluded1(whitted_.embree.rtc(), &s, &query);
        else
            occluded16(unblocked.data(), whitted_.embree.rtc(), &s, &query);
        for (int i = 0; i < N; ++i)
            if (unblocked[i] != 0 && s.tfar[i] > 0)
                lanes[i].colour =
                    lanes[i].colour +
                    lanes[i].ray.weight * whitted_.light_contribution(lanes[i].ray, lanes[i].point, light, to_light[i]);
        return rays;
    }

    /// Sets a lane that has no ray. Without AVX-512, Embree 3 reads such lanes, too, and ends the program if they are
    /// not rays.
    template <int N>
    static void set_no_ray(RTCRayNt<N>& rays, int i) {
        set_ray(rays, i, {0, 0, 0}, {0, 0, 1}, -1);
    }

    template <int N>
    static void set_ray(RTCRayNt<N>& rays, int i, V3 origin, V3 direction, float far) {
        rays.org_x[i] = origin.x;
        rays.org_y[i] = origin.y;
        rays.org_z[i] = origin.z;
        rays.dir_x[i] = direction.x;
        rays.dir_y[i] = direction.y;
        rays.dir_z[i] = direction.z;
        rays.tnear[i] = rays.time[i] = 0;
        rays.tfar[i] = far;
        rays.mask[i] = ~0u;
        rays.flags[i] = 0;
    }

    const Whitted& whitted_;
    Camera camera_;
    std::vector<V3> pixels_;
};

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
    const std::string_view mode = arguments[4] ? arguments[4] : "";
    const EmbreeScene embree(scene, mode == "robust");
    const Whitted whitted(scene, embree, std::atoi(arguments[2]));
    Picture picture(whitted, camera_of(scene.view, width, height));
    const int samples = std::atoi(arguments[3]);
    if (mode == "tiles") {
        picture.print_tiles(samples);
        return 0;
    }
    measure<1>("single", picture, false, samples);
    measure<16>("sixteen", picture, false, samples);
    measure<16>("coherent", picture, true, samples);
    std::printf("build %f\n", embree.build_s());
    return 0;
}

}  // namespace
}  // namespace raya

int main(int argc, char** argv) {
    if (argc != 5 && !(argc == 6 && (argv[5] == std::string("tiles") || argv[5] == std::string("robust")))) {
        std::fprintf(stderr, "usage: embree_peer SCENE.nff WxH BOUNCES SAMPLES [tiles|robust]\n");
        return 2;
    }
    try {
        return raya::run(argv + 1);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "embree_peer: %s\n", error.what());
        return 2;
    }
}
