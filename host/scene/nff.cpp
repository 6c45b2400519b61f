#include "host/scene/nff.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <utility>

#include "host/base/whole_file.hpp"
#include "host/error.hpp"

namespace raya {

void add_remark(std::vector<SceneRemark>& remarks, const SceneRemark& remark) {
    const auto equal_remark = std::ranges::find(remarks, remark.what, &SceneRemark::what);
    if (equal_remark == remarks.end())
        remarks.push_back(remark);
    else
        equal_remark->count += remark.count;
}

std::string remark_text(const std::string& file, const SceneRemark& remark) {
    std::string place = file;
    if (remark.line > 0) place += fmt::format(":{}", remark.line);
    if (!remark.place.empty()) place += ": " + remark.place;
    const std::string total = remark.count > 1 ? fmt::format(" ({} in all)", remark.count) : "";
    return fmt::format("{}: {}{}", place, remark.what, total);
}

namespace {

std::string text_of(const Vec3& v) { return fmt::format("{} {} {}", v.x, v.y, v.z); }

class NffWriter {
  public:
    explicit NffWriter(const Scene& scene) : scene_(scene), fills_(scene.surfaces.size()) {}

    std::string text() {
        write_head();
#define RAYA_WRITE(kind, kinds, KIND) \
    for (const auto& object : scene_.kinds) write(object);
        RAYA_OBJECT_LIST(RAYA_WRITE)
        return std::move(text_);
    }

  private:
    template <typename... Arguments>
    void write_line(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
        fmt::format_to(std::back_inserter(text_), format, std::forward<Arguments>(arguments)...);
        text_ += '\n';
    }

    void write_head() {
        const View& view = scene_.view;
        write_line("b {}", text_of(scene_.background));
        write_line("v\nfrom {}\nat {}\nup {}", text_of(view.from), text_of(view.at), text_of(view.up));
        write_line("angle {}\nhither {}\nresolution {} {}", view.angle_degrees, view.hither, view.width, view.height);
        for (const Light& light : scene_.lights)
            write_line("l {}{}", text_of(light.position),
                       light.colour ? fmt::format(" {}", text_of(*light.colour)) : "");
    }

    void write(const Sphere& s) {
        write_surface(s.surface, false);
        write_line("s {} {} {} {}", s.centre.x, s.centre.y, s.centre.z, s.radius);
    }

    void write(const Plane& p) {
        write_surface(p.surface, true);
        write_line("#raya plane {} {}", text_of(p.normal), p.distance);
    }

    void write(const Polygon& polygon) {
        write_surface(polygon.surface, true);
        const bool patch = !polygon.normals.empty();
        write_line("{} {}", patch ? "pp" : "p", polygon.vertices.size());
        for (std::size_t i = 0; i < polygon.vertices.size(); ++i)
            write_line("{}{}", text_of(polygon.vertices[i]),
                       patch ? fmt::format(" {}", text_of(polygon.normals[i])) : "");
    }

    void write(const Cone& c) {
        write_surface(c.surface, false);
        write_line("c {} {}\n  {} {}", text_of(c.base), c.base_radius, text_of(c.apex), c.apex_radius);
    }

    /// Writes an `f` if it differs from the last `f`. Always writes the surface's checker, if it has one, because
    /// `#raya checker` applies only to the next object.
    void write_surface(int index, bool flat) {
        const auto i = static_cast<std::size_t>(index);
        const Surface& s = scene_.surfaces.at(i);
        if (fills_[i].empty())
            fills_[i] = fmt::format("f {} {} {} {} {} {}", text_of(s.colour), s.diffuse, s.specular, s.shine,
                                    s.transmittance, s.refraction_index);
        if (fills_[i] != last_fill_) write_line("{}", fills_[i]);
        last_fill_ = fills_[i];
        if (!s.checker) return;
        if (!flat) throw UserError(scene_.name + ": NFF has no checkered spheres and cones; use a plane or polygon");
        write_line("#raya checker {} {} {}", text_of(s.checker->even), text_of(s.checker->odd), s.checker->size);
    }

    const Scene& scene_;
    std::vector<std::string> fills_;  // the `f` of each surface; empty until the surface is used
    std::string text_;
    std::string last_fill_;
};

}  // namespace

Scene read_nff(const std::filesystem::path& path, std::vector<SceneRemark>* remarks) {
    try {
        return parse_nff(read_input(path), input_name(path), remarks);
    } catch (const UnreadableFile& error) {
        throw UserError(fmt::format("{}: cannot read the scene: {}", input_name(path), error.what()));
    }
}

std::string write_nff(const Scene& scene) { return NffWriter(scene).text(); }

}  // namespace raya
