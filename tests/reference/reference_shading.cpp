// Camera and shading, as specified in kernels/README.md, sections Camera and Shading.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <thread>

#include "tests/reference/reference.hpp"

namespace raya::reference {
namespace {

constexpr double kMarginShare = 1e-9;  // offset of secondary rays, relative to the scene's size: about 10^7 ulps

// Codes in a History. A hit is coded as 2 * object number, + 1 on an odd checker square.
constexpr int kMiss = -1, kLit = -2, kUnlit = -3, kTotalReflection = -4;

double margin_of(const Scene& scene, const Options& options) {
    return options.margin ? *options.margin : kMarginShare * scene_extent(scene);
}

/// Returns max(0, x)^shine, with 0^0 = 0.
double highlight(double x, double shine) { return x > 0 ? std::pow(x, shine) : 0; }

/// Traces the ray tree of one pixel.
class Tree {
  public:
    Tree(const Scene& scene, int bounces, double margin, Counts& counts, History* history)
        : scene_(scene), bounces_(bounces), margin_(margin), counts_(counts), history_(history) {}

    /// Returns the radiance along a ray of level `bounces` (0 for the primary ray).
    Colour seen(const Ray& ray, int bounces) {
        const std::optional<Hit> hit = closest_hit(scene_, ray);
        note(hit ? 2 * hit->object + hit->odd_square : kMiss);
        if (!hit) return scene_.background;
        if (bounces == 0) ++counts_.primary_hits;
        Colour sum = lit(ray, *hit);
        if (bounces < bounces_) sum += bounced(ray, *hit, bounces + 1);
        return sum;
    }

  private:
    const Surface& surface(const Hit& hit) const { return scene_.surfaces[static_cast<std::size_t>(hit.surface)]; }

    Vec3 in_front(const Hit& hit) const { return hit.point + margin_ * hit.geometric; }

    /// Returns the direct lighting of a hit: ambient light and all lights that are not blocked.
    Colour lit(const Ray& ray, const Hit& hit) {
        const Surface& look = surface(hit);
        const Vec3 mirrored = reflected_direction(ray.direction, hit.shading);
        Colour sum = ambient_intensity(scene_) * look.diffuse * hit.colour;
        for (const Light& light : scene_.lights) {
            const Vec3 to_light = (light.position - in_front(hit)).normalized();
            const double facing = hit.shading.dot(to_light);
            const bool reached = facing > 0 && !in_shadow(hit, light);
            note(reached ? kLit : kUnlit);
            if (!reached) continue;
            const double gloss = look.specular * highlight(mirrored.dot(to_light), look.shine);
            sum += light_colour(scene_, light) * (look.diffuse * facing * hit.colour + Colour(gloss));
        }
        return sum;
    }

    bool in_shadow(const Hit& hit, const Light& light) {
        const Vec3 way = light.position - in_front(hit);
        const bool blocked = closest_hit(scene_, {in_front(hit), way.normalized()}, way.length()).has_value();
        ++counts_.shadow;
        counts_.shadow_hits += blocked;
        return blocked;
    }

    /// Returns the contributions of the reflected and the refracted ray of a hit; both have the level `bounces`.
    Colour bounced(const Ray& ray, const Hit& hit, int bounces) {
        const Surface& look = surface(hit);
        double reflected_share = look.specular;
        std::optional<Vec3> refracted;
        if (look.transmittance > 0) {
            const double e = hit.leaving ? look.refraction : 1 / look.refraction;
            refracted = refracted_direction(ray.direction, hit.shading, e);
            if (!refracted) {
                note(kTotalReflection);
                reflected_share += look.transmittance;
            }
        }
        Colour sum(0, 0, 0);
        if (reflected_share > 0) {
            ++counts_.reflected;
            sum += reflected_share * seen({in_front(hit), reflected_direction(ray.direction, hit.shading)}, bounces);
        }
        if (refracted) {
            ++counts_.refracted;
            sum += look.transmittance * seen({hit.point - margin_ * hit.geometric, *refracted}, bounces);
        }
        return sum;
    }

    void note(int event) {
        if (history_) history_->push_back(event);
    }

    const Scene& scene_;
    int bounces_;
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
    const auto length = [&](int pixels) { return std::max(1.0, pixels - (options.corners ? 1.0 : 0.0)); };
    const auto share = [&](double position, int pixels) {
        const double first = options.corners && pixels > 1 ? 0 : 0.5;  // of the first sample point, in pixels
        return (position + first) / length(pixels);
    };
    const Vec3 gaze = (view.at - view.from).normalized();
    const Vec3 right = gaze.cross(view.up).normalized();
    const Vec3 top = right.cross(gaze);
    const double h = std::tan(view.angle_degrees * std::numbers::pi / 360);
    const double w = h * length(options.width) / length(options.height);
    const double fx = share(x, options.width);
    const double fy = share(y, options.height);
    return {view.from, (gaze + (2 * fx - 1) * w * right + (1 - 2 * fy) * h * top).normalized()};
}

Colour trace_pixel(const Scene& scene, const Options& options, double x, double y, Counts& counts, History* history) {
    ++counts.primary;
    Tree tree(scene, options.bounces, margin_of(scene, options), counts, history);
    return tree.seen(primary_ray(scene, options, x, y), 0);
}

Image render(const Scene& scene, const Options& options) {
    Options settled = options;
    settled.margin = margin_of(scene, options);
    const auto width = static_cast<std::size_t>(options.width);
    Image image{options.width, options.height, {}, {}};
    image.pixels.resize(width * static_cast<std::size_t>(options.height));
    std::vector<Counts> counts(static_cast<std::size_t>(options.threads));
    const auto render_rows = [&](int thread) {
        Counts own;
        for (int y = thread; y < options.height; y += options.threads)
            for (int x = 0; x < options.width; ++x)
                image.pixels[static_cast<std::size_t>(y) * width + static_cast<std::size_t>(x)] =
                    trace_pixel(scene, settled, x, y, own);
        counts[static_cast<std::size_t>(thread)] = own;
    };
    std::vector<std::thread> others;
    for (int thread = 1; thread < options.threads; ++thread) others.emplace_back(render_rows, thread);
    render_rows(0);
    for (std::thread& other : others) other.join();
    for (const Counts& part : counts) add(image.counts, part);
    return image;
}

}  // namespace raya::reference
