#include "host/verify/reference_images.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <sstream>
#include <stdexcept>

#include "host/base/encoding.hpp"
#include "host/embedded.hpp"
#include "host/ring/mapping.hpp"
#include "host/scene/nff.hpp"

namespace raya {
namespace {

void read_row(const std::string& line, const Image& previous, Image& image) {
    std::istringstream in(line);
    for (std::string pixel; in >> pixel;) {
        const std::size_t at = image.rgb.size();
        std::vector<float> rgb;
        if (pixel == "." && at >= 3)
            rgb.assign(image.rgb.end() - 3, image.rgb.end());
        else if (pixel == "=" && at + 3 <= previous.rgb.size())
            rgb = {previous.rgb[at], previous.rgb[at + 1], previous.rgb[at + 2]};
        else
            for (const std::string& digits : split(pixel, '/')) rgb.push_back(std::bit_cast<float>(word_of(digits)));
        image.rgb.insert(image.rgb.end(), rgb.begin(), rgb.end());
    }
    image.height += 1;
    image.width = static_cast<int>(image.rgb.size() / 3) / image.height;
}

std::string pixel_text(const std::array<std::uint32_t, 3>& bits) {
    const auto value = [&](std::size_t k) { return std::bit_cast<float>(bits[k]); };
    return fmt::format("0x{:08x} 0x{:08x} 0x{:08x} = ({:.9g}, {:.9g}, {:.9g})", bits[0], bits[1], bits[2], value(0),
                       value(1), value(2));
}

std::array<std::uint32_t, 3> pixel_bits(const Image& image, std::size_t pixel) {
    std::array<std::uint32_t, 3> bits{};
    for (std::size_t k = 0; k < 3; ++k) bits[k] = std::bit_cast<std::uint32_t>(image.rgb[3 * pixel + k]);
    return bits;
}

}  // namespace

const std::vector<ReferenceImage>& reference_images() {
    constexpr auto kFilter = AntialiasMethod::kFilter, kSupersample = AntialiasMethod::kSupersample;
    static const std::vector<ReferenceImage> all = {
        {"glass fp32", "glass", "fp32"},
        {"glass fp32 axes", "glass", "fp32", kSupersample},
        {"glass fp32 diagonals", "glass", "fp32", kSupersample, RAYA_POINTS_DIAGONALS},
        {"glass fp32 filter", "glass", "fp32", kFilter},
        {"polygons fp32", "polygons", "fp32"},
        {"cones fp32", "cones", "fp32"},
        {"planes fp32 corners", "planes", "fp32", AntialiasMethod::kNone, RAYA_POINTS_AXES, Sampling::kCorners},
        {"mirrors spa22", "mirrors", "spa22"},
        {"mirrors spa22 axes", "mirrors", "spa22", kSupersample},
        {"mirrors spa22 filter", "mirrors", "spa22", kFilter},
        {"polygons spa22", "polygons", "spa22"},
        {"cones e5m10", "cones", "e5m10"},
        {"spheres e8m12t", "spheres", "e8m12t"},
        {"glass e8m21", "glass", "e8m21"},
        {"ties fp32", "ties", "fp32"},
        {"leaves fp32", "leaves", "fp32"},
        {"leaves spa22", "leaves", "spa22"},
        {"far fp32", "far", "fp32", AntialiasMethod::kNone, RAYA_POINTS_AXES, Sampling::kCorners, {65, 6}}};
    return all;
}

const ReferenceImage& reference_image_named(const std::string& name) {
    for (const ReferenceImage& image : reference_images())
        if (image.name == name) return image;
    throw std::logic_error("no reference image '" + name + "'");
}

Scene scene_of(const ReferenceImage& image) {
    std::string file = "host/verify/" + image.scene + ".nff";
    if (!embedded_files().contains(file)) file = "scenes/" + image.scene + ".nff";
    return parse_nff(embedded_files().at(file), file);
}

RingSettings reference_settings(const ReferenceImage& image) {
    RingSettings settings;
    settings.machine = machine_named("grande");
    settings.mapping = make_mapping(column_mapping(), image.size, 1);
    settings.kernels = {.lanes = 1, .group_size = 1, .filter = false};
    settings.bounces = kReferenceBounces;
    settings.format = parse_format(image.format);
    settings.sampling = image.sampling;
    settings.antialias.method = image.antialias;
    settings.antialias.points = image.points;
    return settings;
}

std::vector<StoredImage> parse_reference_images(const std::string& text) {
    std::vector<StoredImage> all;
    std::istringstream lines(text);
    for (std::string line; std::getline(lines, line);) {
        if (line.empty() || line[0] == '#') continue;
        const std::size_t colon = line.find(": ");
        if (line.starts_with("counts "))
            all.back().counts[line.substr(7, colon - 7)] = line.substr(colon + 2);
        else if (colon != std::string::npos)
            all.push_back({line.substr(0, colon), line.substr(colon + 2), {}, {}});
        else
            read_row(line, all.size() > 1 ? all[all.size() - 2].image : Image{}, all.back().image);
    }
    for (const StoredImage& stored : all)
        if (pixel_hash(stored.image) != stored.hash)
            throw std::logic_error("reference images: '" + stored.name + "': pixels do not match the hash");
    return all;
}

const StoredImage& stored_image(const ReferenceImage& image) {
    static const std::vector<StoredImage> all =
        parse_reference_images(embedded_files().at("host/verify/reference_images.txt"));
    return *std::ranges::find(all, image.name, &StoredImage::name);
}

Verdict compare_images(const Image& expected, const Image& got) {
    std::size_t wrong_pixels = 0, first_wrong = 0;
    const std::size_t pixels = expected.rgb.size() / 3, width = static_cast<std::size_t>(expected.width);
    for (std::size_t i = pixels; i-- > 0;) {
        if (pixel_bits(got, i) == pixel_bits(expected, i)) continue;
        ++wrong_pixels;
        first_wrong = i;
    }
    if (wrong_pixels == 0) return passed(pixel_hash(got).substr(0, 8));
    return failed(
        fmt::format("{} of {} pixels wrong", wrong_pixels, pixels),
        {.where = fmt::format("row {}, column {} (red, green, blue)", first_wrong / width, first_wrong % width),
         .expected = pixel_text(pixel_bits(expected, first_wrong)),
         .got = pixel_text(pixel_bits(got, first_wrong))});
}

std::string counts_text(const EventCounts& events,
                        const std::vector<std::pair<const char*, std::uint64_t>>& other_counts) {
    std::string text;
    for (std::size_t event = 0; event < RAYA_EVENTS; ++event)
        text += fmt::format("{} {} ", kEvents[event].name, events[event]);
    for (const auto& [counter, number] : other_counts) text += fmt::format("{} {} ", counter, number);
    text.pop_back();
    return text;
}

Verdict check_counts(const std::string& expected, const std::string& got, const std::string& pass_text) {
    if (got == expected) return passed(pass_text);
    Fault fault{.where = "sums over the image, whose pixels are right"};
    std::istringstream expected_in(expected), got_in(got);
    std::string names;
    for (std::string name, correct, found; expected_in >> name >> correct && got_in >> name >> found;) {
        if (found == correct) continue;
        const char* comma = names.empty() ? "" : ", ";
        names += comma + name;
        fault.expected += fmt::format("{}{} {}", comma, name, correct);
        fault.got += fmt::format("{}{} {}", comma, name, found);
    }
    return failed("wrong counts: " + names, fault);
}

}  // namespace raya
