// What raya is measured against: the same Whitted ray tracing (kernels/README.md) of the same scenes on Embree 3, on
// all cores.
//
//   embree_peer SCENE.nff WxH BOUNCES centres|corners SAMPLES
//
// Prints, for each of two ways, "WAY RAYS SECONDS...", one time for each sample; then "build SECONDS". `single` asks
// Embree ray by ray, `sixteen` walks the ray trees of sixteen pixels, 4 x 4, in step and asks for sixteen rays at once.
// Only the loop over the picture is timed.
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
#include <thread>
#include <vector>

#include "host/scene/nff_reader.hpp"
#include "tools/embree/embree_scene.hpp"

namespace raya {
namespace {

constexpr int kWide = 16, kTile = 4;
constexpr float kFar = 1e30f;

struct Camera {
    V3 eye, gaze, right, top;  // right and top to the middle of the image's sides at distance 1
    int width, height;
    bool corners;

    V3 direction(int row, int column) const {
        const auto share = [&](int at, int of) {
            if (corners) return of > 1 ? static_cast<float>(at) / static_cast<float>(of - 1) : 0.5f;
            return (static_cast<float>(at) + 0.5f) / static_cast<float>(of);
        };
        return normalized(gaze + (2 * share(column, width) - 1) * right + (1 - 2 * share(row, height)) * top);
    }
};

Camera camera_of(const View& view, int width, int height, bool corners) {
    const Vec3 gaze = (view.at - view.from).normalized(), right = gaze.cross(view.up).normalized();
    const double h = std::tan(view.angle_degrees * M_PI / 360);
    const auto side = [&](int pixels) { return corners ? std::max(1, pixels - 1) : pixels; };
    const double w = h * side(width) / side(height);
    return {to_float(view.from),
            to_float(gaze),
            to_float(w * right),
            to_float(h * right.cross(gaze)),
            width,
            height,
            corners};
}

struct PeerLight {
    V3 position, colour;
};

/// A ray of a pixel's tree that waits.
struct Waiting {
    V3 origin, direction;
    float weight;
    int level;
};

/// What a ray has met, turned against it.
struct Met {
    V3 point, outer, inner, normal, colour;
    const PeerSurface* surface;
    bool leaving;
};

class Whitted {
  public:
    Whitted(const Scene& scene, const EmbreeScene& embree, int bounces)
        : embree_(embree),
          bounces_(bounces),
          ambient_(static_cast<float>(ambient_intensity(scene))),
          margin_(static_cast<float>(scene_extent(scene)) * 0x1p-20f),
          background_(to_float(scene.background)) {
        for (const Light& l : scene.lights) lights_.push_back({to_float(l.position), to_float(light_colour(scene, l))});
    }

    const EmbreeScene& embree() const { return embree_; }
    const std::vector<PeerLight>& lights() const { return lights_; }
    V3 background() const { return background_; }

    Met meet(const Waiting& r, const PeerHit& h) const {
        Met m;
        m.surface = &embree_.surfaces()[static_cast<std::size_t>(h.surface)];
        m.point = r.origin + h.t * r.direction;
        m.leaving = dot(h.geometric, r.direction) > 0;
        const V3 geometric = m.leaving ? -1 * h.geometric : h.geometric;
        m.normal = dot(h.normal, geometric) < 0 ? -1 * h.normal : h.normal;
        m.outer = m.point + margin_ * geometric;
        m.inner = m.point - margin_ * geometric;
        m.colour = m.surface->checker > 0 ? square(m, geometric) : m.surface->even;
        return m;
    }

    V3 ambient(const Met& m) const { return (ambient_ * m.surface->diffuse) * m.colour; }

    /// What a light adds that nothing stops; `to_light` has length 1.
    V3 lit(const Waiting& r, const Met& m, const PeerLight& light, V3 to_light) const {
        const PeerSurface& s = *m.surface;
        const V3 mirror = r.direction - 2 * dot(m.normal, r.direction) * m.normal;
        const float cosine = dot(mirror, to_light);
        const float bright = s.specular > 0 && cosine > 0 ? s.specular * std::pow(cosine, s.shine) : 0;
        return times(light.colour, (s.diffuse * dot(m.normal, to_light)) * m.colour + V3{bright, bright, bright});
    }

    /// Appends the rays that follow, the one that is to be followed first last.
    template <class Stack>
    void follow(Stack& stack, const Waiting& r, const Met& m) const {
        if (r.level >= bounces_) return;
        const PeerSurface& s = *m.surface;
        float mirrored = s.specular;
        if (s.transmittance > 0) {
            const float e = m.leaving ? s.refraction : 1 / s.refraction, c = -dot(m.normal, r.direction);
            const float g = 1 - e * e * (1 - c * c);
            if (g < 0) {
                mirrored += s.transmittance;
            } else {
                const V3 through = normalized(e * r.direction + (e * c - std::sqrt(g)) * m.normal);
                stack.push_back({m.inner, through, r.weight * s.transmittance, r.level + 1});
            }
        }
        if (mirrored > 0)
            stack.push_back(
                {m.outer, r.direction - 2 * dot(m.normal, r.direction) * m.normal, r.weight * mirrored, r.level + 1});
    }

  private:
    static V3 square(const Met& m, V3 geometric) {
        const float x = std::abs(geometric.x), y = std::abs(geometric.y), z = std::abs(geometric.z);
        const float side = m.surface->checker;
        const float u = x >= y && x >= z ? m.point.y : y >= z ? m.point.z : m.point.x;
        const float v = x >= y && x >= z ? m.point.z : y >= z ? m.point.x : m.point.y;
        const float half = 0.5f * (std::floor(u / side) + std::floor(v / side));
        return half == std::floor(half) ? m.surface->even : m.surface->odd;
    }

    const EmbreeScene& embree_;
    int bounces_;
    float ambient_, margin_;
    V3 background_;
    std::vector<PeerLight> lights_;
};

/// The rays that wait of one pixel's tree.
class RayStack {
  public:
    void push_back(const Waiting& r) { rays_[size_++] = r; }
    Waiting pop() { return rays_[--size_]; }
    bool empty() const { return size_ == 0; }

  private:
    std::array<Waiting, 64> rays_;
    std::size_t size_ = 0;
};

class Picture {
  public:
    Picture(const Whitted& whitted, const Camera& camera)
        : whitted_(whitted), camera_(camera), pixels_(static_cast<std::size_t>(camera.width) * camera.height) {}

    /// Rays of the picture, ray by ray; in rows.
    template <class Row>
    long all(int rows, const Row& trace_row) {
        std::atomic<int> next = 0;
        std::atomic<long> rays = 0;
        std::vector<std::thread> threads;
        for (unsigned i = 0; i < std::thread::hardware_concurrency(); ++i)
            threads.emplace_back([&] {
                _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);  // as Embree's manual wants it
                _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
                long own = 0;
                for (int row = next++; row < rows; row = next++) own += trace_row(row);
                rays += own;
            });
        for (std::thread& thread : threads) thread.join();
        return rays;
    }

    long single() {
        return all(camera_.height, [&](int row) {
            long rays = 0;
            for (int column = 0; column < camera_.width; ++column)
                pixel(row, column) = trace(camera_.direction(row, column), rays);
            return rays;
        });
    }

    long sixteen() {
        const int across = (camera_.width + kTile - 1) / kTile, down = (camera_.height + kTile - 1) / kTile;
        return all(down, [&](int row) {
            long rays = 0;
            for (int column = 0; column < across; ++column) rays += trace_tile(row * kTile, column * kTile);
            return rays;
        });
    }

    V3 mean() const {
        V3 sum;
        for (const V3& p : pixels_) sum = sum + p;
        return (1 / static_cast<float>(pixels_.size())) * sum;
    }

  private:
    V3& pixel(int row, int column) { return pixels_[static_cast<std::size_t>(row) * camera_.width + column]; }

    V3 trace(V3 direction, long& rays) const {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        V3 colour;
        RayStack stack;
        stack.push_back({camera_.eye, direction, 1, 0});
        while (!stack.empty()) {
            const Waiting r = stack.pop();
            ++rays;
            RTCRayHit q{};
            q.ray = {r.origin.x, r.origin.y, r.origin.z, 0, r.direction.x, r.direction.y, r.direction.z, 0,
                     kFar,       ~0u,        0,          0};
            q.hit.geomID = q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(whitted_.embree().rtc(), &context, &q);
            const PeerHit h = whitted_.embree().hit(r.origin, r.direction, q.ray.tfar, q.hit.geomID, q.hit.primID,
                                                    {q.hit.Ng_x, q.hit.Ng_y, q.hit.Ng_z}, q.hit.u, q.hit.v);
            if (h.surface < 0) {
                colour = colour + r.weight * whitted_.background();
                continue;
            }
            const Met m = whitted_.meet(r, h);
            colour = colour + r.weight * whitted_.ambient(m);
            for (const PeerLight& light : whitted_.lights()) {
                const V3 arm = light.position - m.outer;
                if (!(dot(m.normal, arm) > 0)) continue;
                ++rays;
                const float distance = std::sqrt(dot(arm, arm));
                const V3 to_light = (1 / distance) * arm;
                if (whitted_.embree().plane_blocks(m.outer, to_light, distance)) continue;
                RTCRay s = {m.outer.x,  m.outer.y, m.outer.z, 0,   to_light.x, to_light.y,
                            to_light.z, 0,         distance,  ~0u, 0,          0};
                rtcOccluded1(whitted_.embree().rtc(), &context, &s);
                if (s.tfar > 0) colour = colour + r.weight * whitted_.lit(r, m, light, to_light);
            }
            whitted_.follow(stack, r, m);
        }
        return colour;
    }

    struct Lane {
        RayStack stack;
        Waiting ray;
        Met met;
        V3 colour;
    };

    long trace_tile(int top, int left) {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        std::array<Lane, kWide> lanes;
        for (int i = 0; i < kWide; ++i) {
            const int row = top + i / kTile, column = left + i % kTile;
            if (row < camera_.height && column < camera_.width)
                lanes[i].stack.push_back({camera_.eye, camera_.direction(row, column), 1, 0});
        }
        long rays = 0;
        while (const long taken = step(lanes, context, rays)) rays += taken;
        for (int i = 0; i < kWide; ++i) {
            const int row = top + i / kTile, column = left + i % kTile;
            if (row < camera_.height && column < camera_.width) pixel(row, column) = lanes[i].colour;
        }
        return rays;
    }

    // The next ray of each lane's tree; returns how many there were. Shadow rays are added to `rays`.
    long step(std::array<Lane, kWide>& lanes, RTCIntersectContext& context, long& rays) const {
        alignas(64) std::array<int, kWide> valid{};
        alignas(64) RTCRayHit16 q;
        long taken = 0;
        for (int i = 0; i < kWide; ++i) {
            if (lanes[i].stack.empty()) continue;
            const Waiting& r = lanes[i].ray = lanes[i].stack.pop();
            valid[i] = -1;
            ++taken;
            put(q.ray, i, r.origin, r.direction, kFar);
            q.hit.geomID[i] = q.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        if (taken == 0) return 0;
        rtcIntersect16(valid.data(), whitted_.embree().rtc(), &context, &q);
        for (int i = 0; i < kWide; ++i) {
            if (valid[i] == 0) continue;
            Lane& lane = lanes[i];
            const PeerHit h = whitted_.embree().hit(lane.ray.origin, lane.ray.direction, q.ray.tfar[i], q.hit.geomID[i],
                                                    q.hit.primID[i], {q.hit.Ng_x[i], q.hit.Ng_y[i], q.hit.Ng_z[i]},
                                                    q.hit.u[i], q.hit.v[i]);
            if (h.surface < 0) {
                lane.colour = lane.colour + lane.ray.weight * whitted_.background();
                valid[i] = 0;
                continue;
            }
            lane.met = whitted_.meet(lane.ray, h);
            lane.colour = lane.colour + lane.ray.weight * whitted_.ambient(lane.met);
        }
        for (const PeerLight& light : whitted_.lights()) rays += light_up(lanes, valid, light, context);
        for (int i = 0; i < kWide; ++i)
            if (valid[i] != 0) whitted_.follow(lanes[i].stack, lanes[i].ray, lanes[i].met);
        return taken;
    }

    long light_up(std::array<Lane, kWide>& lanes, const std::array<int, kWide>& valid, const PeerLight& light,
                  RTCIntersectContext& context) const {
        alignas(64) std::array<int, kWide> open{};
        alignas(64) RTCRay16 s;
        std::array<V3, kWide> to_light;
        long rays = 0;
        bool any = false;
        for (int i = 0; i < kWide; ++i) {
            const Met& m = lanes[i].met;
            if (valid[i] == 0) continue;
            const V3 arm = light.position - m.outer;
            if (!(dot(m.normal, arm) > 0)) continue;
            ++rays;
            const float distance = std::sqrt(dot(arm, arm));
            to_light[i] = (1 / distance) * arm;
            if (whitted_.embree().plane_blocks(m.outer, to_light[i], distance)) continue;
            put(s, i, m.outer, to_light[i], distance);
            open[i] = -1;
            any = true;
        }
        if (any) rtcOccluded16(open.data(), whitted_.embree().rtc(), &context, &s);
        for (int i = 0; i < kWide; ++i)
            if (open[i] != 0 && s.tfar[i] > 0)
                lanes[i].colour = lanes[i].colour +
                                  lanes[i].ray.weight * whitted_.lit(lanes[i].ray, lanes[i].met, light, to_light[i]);
        return rays;
    }

    static void put(RTCRay16& rays, int i, V3 origin, V3 direction, float far) {
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
