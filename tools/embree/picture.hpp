// Renders a picture with Embree on all cores, with single rays or with packets of 16 rays, one for each of 16 pixels.
#pragma once
#include <pmmintrin.h>

#include <array>
#include <atomic>
#include <thread>
#include <vector>

#include "tools/embree/embree_api.hpp"
#include "tools/embree/whitted.hpp"

namespace raya {

inline constexpr int kPacketRays = 16, kTileSide = 4;  // number of rays in a packet; side of its tile in pixels
inline constexpr float kFar = 1e30f;

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

    /// Calls trace_row(row) for all rows, on all cores. Returns the sum of its results, the number of rays.
    template <class Row>
    long trace_rows(int rows, const Row& trace_row) {
        std::atomic<int> next = 0;
        std::atomic<long> rays = 0;
        std::vector<std::thread> threads;
        for (unsigned i = 0; i < std::thread::hardware_concurrency(); ++i)
            threads.emplace_back([&] {
                _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);  // recommended by Embree's manual
                _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
                long thread_rays = 0;
                for (int row = next++; row < rows; row = next++) thread_rays += trace_row(row);
                rays += thread_rays;
            });
        for (std::thread& thread : threads) thread.join();
        return rays;
    }

    /// Renders with single rays. Returns the number of rays.
    long render_single_rays() {
        return trace_rows(camera_.height, [&](int row) {
            long rays = 0;
            for (int column = 0; column < camera_.width; ++column)
                pixel(row, column) = trace(camera_.direction(row, column), rays);
            return rays;
        });
    }

    /// Renders tiles of 4 x 4 pixels with packets of 16 rays. Returns the number of rays.
    long render_packets() {
        const int tile_columns = (camera_.width + kTileSide - 1) / kTileSide,
                  tile_rows = (camera_.height + kTileSide - 1) / kTileSide;
        return trace_rows(tile_rows, [&](int row) {
            long rays = 0;
            for (int column = 0; column < tile_columns; ++column)
                rays += trace_tile(row * kTileSide, column * kTileSide);
            return rays;
        });
    }

    long render_coherent_packets() {
        coherent_ = true;
        return render_packets();
    }

    /// Returns the mean colour of the pixels.
    V3 mean() const {
        V3 sum;
        for (const V3& p : pixels_) sum = sum + p;
        return (1 / static_cast<float>(pixels_.size())) * sum;
    }

  private:
    V3& pixel(int row, int column) { return pixels_[static_cast<std::size_t>(row) * camera_.width + column]; }

    V3 trace(V3 direction, long& rays) const {
        Tracing tracing(false);
        V3 colour;
        RayStack stack;
        stack.push_back({camera_.eye, direction, 1, 0});
        while (!stack.empty()) {
            const PendingRay r = stack.pop();
            ++rays;
            RayHit q{};
            q.ray = {r.origin.x, r.origin.y, r.origin.z, 0, r.direction.x, r.direction.y, r.direction.z, 0,
                     kFar,       ~0u,        0,          0};
            q.hit.geomID = q.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            tracing.intersect(whitted_.embree().rtc(), q);
            const PeerHit h = whitted_.embree().hit(r.origin, r.direction, q.ray.tfar, q.hit.geomID, q.hit.primID,
                                                    {q.hit.Ng_x, q.hit.Ng_y, q.hit.Ng_z}, q.hit.u, q.hit.v);
            if (h.surface < 0) {
                colour = colour + r.weight * whitted_.background();
                continue;
            }
            const ShadingPoint m = whitted_.shading_point(r, h);
            colour = colour + r.weight * whitted_.ambient(m);
            for (const PeerLight& light : whitted_.lights()) {
                const V3 light_offset = light.position - m.outer;
                if (!(dot(m.normal, light_offset) > 0)) continue;
                ++rays;
                const float distance = std::sqrt(dot(light_offset, light_offset));
                const V3 to_light = (1 / distance) * light_offset;
                if (whitted_.embree().plane_blocks(m.outer, to_light, distance)) continue;
                RTCRay s = {m.outer.x,  m.outer.y, m.outer.z, 0,   to_light.x, to_light.y,
                            to_light.z, 0,         distance,  ~0u, 0,          0};
                tracing.occluded(whitted_.embree().rtc(), s);
                if (s.tfar > 0) colour = colour + r.weight * whitted_.light_contribution(r, m, light, to_light);
            }
            whitted_.push_secondary_rays(stack, r, m);
        }
        return colour;
    }

    /// Ray tree of one pixel of a tile.
    struct Lane {
        RayStack stack;
        PendingRay ray;
        ShadingPoint point;
        V3 colour;
    };

    long trace_tile(int top, int left) {
        Tracing tracing(coherent_);
        std::array<Lane, kPacketRays> lanes;
        for (int i = 0; i < kPacketRays; ++i) {
            const int row = top + i / kTileSide, column = left + i % kTileSide;
            if (row < camera_.height && column < camera_.width)
                lanes[i].stack.push_back({camera_.eye, camera_.direction(row, column), 1, 0});
        }
        long rays = 0;
        while (const long traced_rays = trace_next_rays(lanes, tracing, rays)) rays += traced_rays;
        for (int i = 0; i < kPacketRays; ++i) {
            const int row = top + i / kTileSide, column = left + i % kTileSide;
            if (row < camera_.height && column < camera_.width) pixel(row, column) = lanes[i].colour;
        }
        return rays;
    }

    // Traces the next ray of each lane and returns the number of these rays. Adds the number of shadow rays to `rays`.
    long trace_next_rays(std::array<Lane, kPacketRays>& lanes, Tracing& tracing, long& rays) const {
        alignas(64) std::array<int, kPacketRays> valid{};
        alignas(64) RayHit16 q;
        long traced_rays = 0;
        for (int i = 0; i < kPacketRays; ++i) {
            set_no_ray(q.ray, i);
            if (lanes[i].stack.empty()) continue;
            const PendingRay& r = lanes[i].ray = lanes[i].stack.pop();
            valid[i] = -1;
            ++traced_rays;
            set_ray(q.ray, i, r.origin, r.direction, kFar);
            q.hit.geomID[i] = q.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
        }
        if (traced_rays == 0) return 0;
        tracing.intersect(valid.data(), whitted_.embree().rtc(), q);
        for (int i = 0; i < kPacketRays; ++i) {
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
            lane.point = whitted_.shading_point(lane.ray, h);
            lane.colour = lane.colour + lane.ray.weight * whitted_.ambient(lane.point);
        }
        for (const PeerLight& light : whitted_.lights()) rays += add_light(lanes, valid, light, tracing);
        for (int i = 0; i < kPacketRays; ++i)
            if (valid[i] != 0) whitted_.push_secondary_rays(lanes[i].stack, lanes[i].ray, lanes[i].point);
        return traced_rays;
    }

    // Adds the contribution of a light to the colours of the lanes with a hit. Returns the number of shadow rays.
    long add_light(std::array<Lane, kPacketRays>& lanes, const std::array<int, kPacketRays>& valid,
                   const PeerLight& light, Tracing& tracing) const {
        alignas(64) std::array<int, kPacketRays> unblocked{};
        alignas(64) RTCRay16 s;
        std::array<V3, kPacketRays> to_light;
        long rays = 0;
        bool has_unblocked = false;
        for (int i = 0; i < kPacketRays; ++i) {
            const ShadingPoint& m = lanes[i].point;
            set_no_ray(s, i);
            if (valid[i] == 0) continue;
            const V3 light_offset = light.position - m.outer;
            if (!(dot(m.normal, light_offset) > 0)) continue;
            ++rays;
            const float distance = std::sqrt(dot(light_offset, light_offset));
            to_light[i] = (1 / distance) * light_offset;
            if (whitted_.embree().plane_blocks(m.outer, to_light[i], distance)) continue;
            set_ray(s, i, m.outer, to_light[i], distance);
            unblocked[i] = -1;
            has_unblocked = true;
        }
        if (has_unblocked) tracing.occluded(unblocked.data(), whitted_.embree().rtc(), s);
        for (int i = 0; i < kPacketRays; ++i)
            if (unblocked[i] != 0 && s.tfar[i] > 0)
                lanes[i].colour =
                    lanes[i].colour +
                    lanes[i].ray.weight * whitted_.light_contribution(lanes[i].ray, lanes[i].point, light, to_light[i]);
        return rays;
    }

    /// Sets a lane that has no ray. Without AVX-512, Embree 3 reads such lanes, too, and ends the program if they are
    /// not rays.
    static void set_no_ray(RTCRay16& rays, int i) { set_ray(rays, i, {0, 0, 0}, {0, 0, 1}, -1); }

    static void set_ray(RTCRay16& rays, int i, V3 origin, V3 direction, float far) {
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
    bool coherent_ = false;  // with the flag for coherent rays
    std::vector<V3> pixels_;
};

}  // namespace raya
