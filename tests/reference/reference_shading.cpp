// Camera and shading, as specified in kernels/README.md, sections Camera and Shading.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <thread>

#include "tests/reference/reference.hpp"

namespace raya::reference {
namespace {

constexpr double kRelativeMargin = 1e-9;  // offset of secondary rays relative to the scene's extent: about 10^7 ulps

// Codes in a History. The code of a hit is 2 * object number, + 1 on an odd checker square.
constexpr int kMiss = -1, kLit = -2, kUnlit = -3, kTotalReflection = -4;

double margin_of(const Scene& scene, const Options& options) {
    return options.margin ? *options.margin : kRelativeMargin * scene_extent(scene);
}

/// Returns max(0, x)^shine, with 0^0 = 0.
double highlight(double x, double shine) { return x > 0 ? std::pow(x, shine) : 0; }

/// Traces the ray tree of one pixel.
class TreeTracer {
  public:
    TreeTracer(const Scene& scene, int max_level, double margin, Counts& counts, History* history)
        : scene_(scene), max_level_(max_level), margin_(margin), counts_(counts), history_(history) {}

    /// Returns the radiance along a ray of level `level` (0 for the primary ray).
    Colour radiance(const Ray& ray, int level) {
        const std::optional<Hit> hit = closest_hit(scene_, ray);
        record(hit ? 2 * hit->object + hit->odd_square : kMiss);
        if (!hit) return scene_.background;
        if (level == 0) ++counts_.primary_hits;
        Colour sum = direct_light(ray, *hit);
        if (level < max_level_) sum += secondary_light(ray, *hit, level + 1);
        return sum;
    }

  private:
    const Surface& surface(const Hit& hit) const { return scene_.surfaces[static_cast<std::size_t>(hit.surface)]; }

    /// Returns the origin of rays that start in front of the surface.
    Vec3 origin_in_front(const Hit& hit) const { return hit.point + margin_ * hit.geometric; }

    /// Returns the direct lighting of a hit: ambient light and all lights that are not blocked.
    Colour direct_light(const Ray& ray, const Hit& hit) {
        const Surface& material = surface(hit);
        const Vec3 mirrored = reflected_direction(ray.direction, hit.shading);
        Colour sum = ambient_intensity(scene_) * material.diffuse * hit.colour;
        for (const Light& light : scene_.lights) {
            const Vec3 to_light = (light.position - origin_in_front(hit)).normalized();
            const double cosine = hit.shading.dot(to_light);
            const bool reached = cosine > 0 && !in_shadow(hit, light);
            record(reached ? kLit : kUnlit);
            if (!reached) continue;
            const double gloss = material.specular * highlight(mirrored.dot(to_light), material.shine);
            sum += light_colour(scene_, light) * (material.diffuse * cosine * hit.colour + Colour(gloss));
        }
        return sum;
    }

    bool in_shadow(const Hit& hit, const Light& light) {
        const Vec3 to_light = light.position - origin_in_front(hit);
        const bool blocked =
            closest_hit(scene_, {origin_in_front(hit), to_light.normalized()}, to_light.length()).has_value();
        ++counts_.shadow;
        counts_.shadow_hits += blocked;
        return blocked;
    }

    /// Returns the contributions of the reflected and the refracted ray of a hit. Both rays have the level `level`.
    Colour secondary_light(const Ray& ray, const Hit& hit, int level) {
        const Surface& material = surface(hit);
        double reflectance = material.specular;
        std::optional<Vec3> refracted;
        if (material.transmittance > 0) {
            const double e = hit.leaving ? material.refraction_index : 1 / material.refraction_index;
            refracted = refracted_direction(ray.direction, hit.shading, e);
            if (!refracted) {
                record(kTotalReflection);
                reflectance += material.transmittance;
            }
        }
        Colour sum(0, 0, 0);
        if (reflectance > 0) {
            ++counts_.reflected;
            sum +=
                reflectance * radiance({origin_in_front(hit), reflected_direction(ray.direction, hit.shading)}, level);
        }
        if (refracted) {
            ++counts_.refracted;
            sum += material.transmittance * radiance({hit.point - margin_ * hit.geometric, *refracted}, level);
        }
        return sum;
    }

    void record(int event) {
        if (history_) history_->push_back(event);
    }

    const Scene& scene_;
    int max_level_;
    double margin_;  // scene units
    Counts& counts_;
    History* history_;
};

void add(Counts& sum, const Counts& more) {
    sum.primary += more.primary;
    sum.primary_hits += more.primary_hits;
    sum.reflected += more.reflected;
    sum.refracted += more.refracted;
    sum.shadow += more.shadow;
    sum.shadow_hits += more.shadow_hits;
}

}  // namespace

Vec3 reflected_direction(const Vec3& direction, const Vec3& normal) {
    return direction - 2 * normal.dot(direction) * normal;
}

std::optional<Vec3> refracted_direction(const Vec3& direction, const Vec3& normal, double e) {
    const double c = -normal.dot(direction);
    const double g = 1 - e * e * (1 - c * c);
    if (g < 0) return {};
    return (e * direction + (e * c - std::sqrt(g)) * normal).normalized();
}

Ray primary_ray(const Scene& scene, const Options& options, double x, double y) {
    const View& view = scene.view;
    // Returns the size of the image along an axis, in distances between sample points.
    const auto length = [&](int pixels) { return std::max(1.0, pixels - (options.corners ? 1.0 : 0.0)); };
    // Returns the position of a point in the image, 0..1 along an axis.
    const auto fraction = [&](double position, int pixels) {
        const double first = options.corners && pixels > 1 ? 0 : 0.5;  // position of the first sample point, in pixels
        return (position + first) / length(pixels);
    };
    const Vec3 view_direction = (view.at - view.from).normalized();
    const Vec3 right = view_direction.cross(view.up).normalized();
    const Vec3 up = right.cross(view_direction);
    const double half_height = std::tan(view.angle_degrees * std::numbers::pi / 360);
    const double half_width = half_height * length(options.width) / length(options.height);
    const double fx = fraction(x, options.width);
    const double fy = fraction(y, options.height);
    return {view.from,
            (view_direction + (2 * fx - 1) * half_width * right + (1 - 2 * fy) * half_height * up).normalized()};
}

Colour trace_pixel(const Scene& scene, const Options& options, double x, double y, Counts& counts, History* history) {
    ++counts.primary;
    TreeTracer tracer(scene, options.bounces, margin_of(scene, options), counts, history);
    return tracer.radiance(primary_ray(scene, options, x, y), 0);
}

Image render(const Scene& scene, const Options& options) {
    Options with_margin = options;
    with_margin.margin = margin_of(scene, options);
    const auto width = static_cast<std::size_t>(options.width);
    Image image{options.width, options.height, {}, {}};
    image.pixels.resize(width * static_cast<std::size_t>(options.height));
    std::vector<Counts> counts(static_cast<std::size_t>(options.threads));
    const auto render_rows = [&](int thread) {
        Counts thread_counts;
        for (int y = thread; y < options.height; y += options.threads)
            for (int x = 0; x < options.width; ++x)
                image.pixels[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)] =
                    trace_pixel(scene, with_margin, x, y, thread_counts);
        counts[static_cast<std::size_t>(thread)] = thread_counts;
    };
    std::vector<std::thread> threads;
    for (int thread = 1; thread < options.threads; ++thread) threads.emplace_back(render_rows, thread);
    render_rows(0);
    for (std::thread& thread : threads) thread.join();
    for (const Counts& part : counts) add(image.counts, part);
    return image;
}

}  // namespace raya::reference
