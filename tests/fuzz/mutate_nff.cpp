// Mutates NFF scenes: the given text, or a valid scene that a grammar generates.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "tests/fuzz/mutate.hpp"

namespace {

using namespace raya::fuzz;

const std::vector<std::string> kKeywords = {"v",     "from",  "at",      "up",    "angle",    "hither",   "resolution",
                                            "b",     "l",     "f",       "s",     "p",        "pp",       "c",
                                            "#raya", "plane", "checker", "#",     "nff",      "pl",       "k",
                                            "tt",    "g",     "light",   "From:", "Subject:", "viewpoint"};

// Generates scenes and entities that the reader accepts.
class Grammar {
  public:
    explicit Grammar(Random& random) : random_(random) {}

    std::string scene() {
        std::string text;
        if (random_.one_in(8)) text += "From: somebody@example.org\nSubject: a scene\n\n";
        if (random_.one_in(4)) text += "# " + std::string(random_.below(20), 'x') + "\n";
        text += view();
        if (random_.one_in(2)) text += "b " + colour() + "\n";
        for (std::size_t i = random_.below(3); i > 0; --i) text += light();
        for (std::size_t i = 1 + random_.below(5); i > 0; --i) text += entity();
        return text;
    }

    std::string entity() {
        switch (random_.below(9)) {
            case 0:
                return surface();
            case 1:
                return "s " + vector() + blank() + positive() + "\n";
            case 2:
                return cone();
            case 3:
                return polygon(false);
            case 4:
                return polygon(true);
            case 5:
                return checker() + (random_.one_in(2) ? plane() : polygon(random_.one_in(2)));
            case 6:
                return plane();
            case 7:
                return light();
            default:
                return "# a comment\n" + surface();
        }
    }

  private:
    std::string format(const char* printf_format, double value) {
        char text[64];
        std::snprintf(text, sizeof text, printf_format, value);
        return text;
    }

    std::string number(double value) {
        static const char* const kFormats[] = {"%g", "%.3f", "%.17g", "%e", "%+g"};
        return format(random_.pick(kFormats), value);
    }

    std::string coordinate() {
        if (random_.one_in(3)) return std::to_string(static_cast<int>(random_.below(21)) - 10);
        static const double kScales[] = {1, 1, 1, 1e-6, 1e-3, 1e3, 1e6, 1e9};
        return number((static_cast<double>(random_.below(2001)) - 1000) / 1000 * random_.pick(kScales));
    }

    std::string positive() { return number(static_cast<double>(1 + random_.below(1000)) / 100); }
    std::string fraction() { return number(static_cast<double>(random_.below(11)) / 10); }
    std::string blank() { return random_.one_in(20) ? "\n" : random_.one_in(20) ? "\t" : " "; }
    std::string vector() { return coordinate() + blank() + coordinate() + blank() + coordinate(); }
    std::string colour() { return fraction() + " " + fraction() + " " + fraction(); }

    std::string view() {
        std::string parts[] = {"from " + vector(), "at 0 0 0",
                               "up 0 0 1",         "angle " + std::to_string(1 + random_.below(178)),
                               "hither 0.01",      "resolution " + std::to_string(1 + random_.below(512)) + " 9"};
        if (random_.one_in(4)) std::swap(parts[random_.below(6)], parts[random_.below(6)]);
        std::string text = "v";
        for (const std::string& part : parts) text += "\n" + part;
        return text + "\n";
    }

    std::string light() { return "l " + vector() + (random_.one_in(2) ? " " + colour() : "") + "\n"; }

    std::string surface() {
        return "f " + colour() + " " + fraction() + " " + fraction() + " " + positive() + " " + fraction() + " " +
               positive() + "\n";
    }

    std::string cone() {
        const std::string base_radius = random_.one_in(4) ? "0" : positive(),
                          apex_radius = random_.one_in(4) ? base_radius : positive();
        return "c " + vector() + blank() + base_radius + "\n" + vector() + blank() + apex_radius + "\n";
    }

    // Returns a polygon in a random plane. Its corners lie on an ellipse, except for some that lie inside. Rounding
    // makes the polygon slightly non-planar.
    std::string polygon(bool patch) {
        const std::size_t corners = 3 + random_.below(random_.one_in(8) ? 20 : 5);
        double axes[3][3];
        for (auto& axis : axes)
            for (double& value : axis) value = random_.one_in(3) ? 0 : static_cast<double>(random_.below(21)) - 10;
        std::string text = (patch ? "pp " : "p ") + std::to_string(corners) + "\n";
        for (std::size_t i = 0; i < corners; ++i) {
            const double angle = 2 * M_PI * static_cast<double>(i) / static_cast<double>(corners);
            const double radius = random_.one_in(5) ? 0.3 : 1;
            for (int k = 0; k < 3; ++k)
                text += format(random_.one_in(2) ? "%.17g" : "%.6g",
                               axes[2][k] + radius * (std::cos(angle) * axes[0][k] + std::sin(angle) * axes[1][k])) +
                        " ";
            text += (patch ? vector() : "") + "\n";
        }
        return text;
    }

    std::string plane() { return "#raya plane " + coordinate() + " " + coordinate() + " 1 " + coordinate() + "\n"; }
    std::string checker() { return "#raya checker " + colour() + " " + colour() + " " + positive() + "\n"; }

    Random& random_;
};

// Returns the start of a random line, or the end of the text.
std::size_t line_start(const std::string& text, Random& random) {
    const std::size_t end = text.rfind('\n', random.below(text.size() + 1));
    return end == std::string::npos ? text.size() : end + 1;
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
    Random random(seed);
    std::string text(reinterpret_cast<const char*>(data), size);
    if (text.empty() || random.one_in(10)) text = Grammar(random).scene();
    for (std::size_t changes = random.below(4); changes > 0; --changes) {
        if (random.one_in(4))
            text.insert(line_start(text, random), Grammar(random).entity());
        else if (random.one_in(4))
            mutate_bytes(text);
        else
            damage_tokens(text, kKeywords, random);
    }
    return store(text, data, max_size);
}
