#include "host/torus/composer.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <stdexcept>

#include "host/array/render.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

bool comes_before(const raya_head& a, const raya_head& b) {
    return raya_comes_before(a.path, a.state, b.path, b.state);
}

void append_contribution(std::vector<float>& colours, const raya_head& packet) {
    colours.insert(colours.end(), std::begin(packet.carries.colour), std::end(packet.carries.colour));
    colours.push_back(packet.weight);
}

}  // namespace

Contributions sort_contributions(const std::vector<raya_head>& returns, std::uint32_t pixels) {
    if (returns.size() > std::numeric_limits<std::uint32_t>::max())
        throw UserError("more than 2^32 contributions to one image; render fewer pixels or with fewer --bounces");
    Contributions sorted;
    sorted.starts.assign(std::size_t{pixels} + 1, 0);
    for (const raya_head& packet : returns) {
        if (packet.pixel >= pixels)
            throw std::logic_error(
                fmt::format("a contribution has pixel {}, but the image has only {} pixels", packet.pixel, pixels));
        ++sorted.starts[packet.pixel + 1];
    }
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) sorted.starts[pixel + 1] += sorted.starts[pixel];
    std::vector<std::uint32_t> next(sorted.starts.begin(), sorted.starts.end() - 1), order(returns.size());
    for (std::uint32_t i = 0; i < returns.size(); ++i) order[next[returns[i].pixel]++] = i;

    sorted.colours.reserve(4 * returns.size());
    for (std::uint32_t pixel = 0; pixel < pixels; ++pixel) {
        const auto first = order.begin() + sorted.starts[pixel], last = order.begin() + sorted.starts[pixel + 1];
        std::sort(first, last, [&](std::uint32_t a, std::uint32_t b) { return comes_before(returns[a], returns[b]); });
        for (auto i = first; i != last; ++i) {
            if (i != first && !comes_before(returns[i[-1]], returns[*i]))
                throw std::logic_error(fmt::format("pixel {}: two contributions of the same ray", pixel));
            append_contribution(sorted.colours, returns[*i]);
        }
    }
    return sorted;
}

Composer::Composer(Kernels& kernels)
    : session_(kernels.session()), group_size_(kernels.options().group_size), compose_(kernels.get<ComposeKernel>()) {
    compose({{0, 0, 0, 0}, {0, 1}});  // compiles the kernel, because PoCL does so at the first launch
}

std::vector<float> Composer::compose(const Contributions& contributions) {
    const auto pixels = static_cast<std::uint32_t>(contributions.starts.size() - 1);
    Buffer<float> colours =
        session_.buffer<float>("contributions", std::max<std::size_t>(4, contributions.colours.size()));
    Buffer<std::uint32_t> starts =
        session_.buffer<std::uint32_t>("starts of contributions", contributions.starts.size());
    Buffer<float> image = session_.buffer<float>("image", 3ull * pixels);
    Buffer<std::uint32_t> cut_flag = session_.buffer<std::uint32_t>("loops cut", 1);
    session_.write("compose", colours, contributions.colours);
    session_.write("compose", starts, contributions.starts);
    constexpr std::size_t kPixelsPerItem = 16, kMaxGroups = 4096;
    std::uint32_t was_cut = 1;
    for (std::size_t groups = std::min(kMaxGroups, pixels / (kPixelsPerItem * group_size_) + 1); was_cut; groups *= 2) {
        session_.fill("compose", cut_flag, 0);
        session_.launch("compose", compose_, groups, group_size_, colours, starts, Uint<"pixels">{pixels}, image,
                        cut_flag);
        session_.read("compose", cut_flag, {&was_cut, 1});
        if (was_cut && groups * group_size_ >= pixels)
            throw truncated_loops_error("compose", session_.device().name, "fewer --bounces");
    }
    std::vector<float> pixels_of_image(3ull * pixels);
    session_.read("compose", image, pixels_of_image);
    return pixels_of_image;
}

}  // namespace raya
