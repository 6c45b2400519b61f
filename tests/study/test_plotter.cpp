// Plots are drawn where Python and matplotlib are there; where they are not, the reason is told and no file is left.
#include <OpenImageIO/imageio.h>
#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "host/base/whole_file.hpp"
#include "host/study/page_writer.hpp"
#include "host/study/plotter.hpp"
#include "tests/base/scratch_folder.hpp"
#include "tests/study/small_page.hpp"

namespace raya {
namespace {
namespace fs = std::filesystem;
using Catch::Matchers::Contains;
using Catch::Matchers::EndsWith;
using Catch::Matchers::StartsWith;

/// Sets an environment variable, or takes it away, while it lives.
class Environment {
  public:
    Environment(const char* name, const std::optional<std::string>& value) : name_(name) {
        if (const char* old = std::getenv(name)) old_ = old;
        set(value);
    }
    Environment(const Environment&) = delete;
    Environment& operator=(const Environment&) = delete;
    ~Environment() { set(old_); }

  private:
    void set(const std::optional<std::string>& value) {
        if (value)
            ::setenv(name_, value->c_str(), 1);
        else
            ::unsetenv(name_);
    }

    const char* name_;
    std::optional<std::string> old_;
};

void write_program(const fs::path& path, const std::string& body) {
    write_whole_file(path, "#!/bin/sh\n" + body + "\n");
    ::chmod(path.c_str(), 0755);
}

/// The page's JSON in a folder, and what draw_plots() makes of it with RAYA_PYTHON as given.
struct Drawing {
    ScratchFolder folder;
    StudyPage page = small_page();

    PlotOutcome draw(const std::optional<std::string>& python = {}) const {
        const Environment named("RAYA_PYTHON", python);
        write_whole_file(folder / "small.json", page_json(page).dump());
        return draw_plots(folder.path(), page);
    }
    void check_nothing_drawn() const { CHECK(folder.entries() == 1); }
};

/// Width and height in pixels, and how many pixels are not white.
struct Picture {
    int width = 0, height = 0;
    int inked = 0;
};

Picture picture_of(const fs::path& path) {
    const auto file = OIIO::ImageInput::open(path.string());
    REQUIRE(file != nullptr);
    const OIIO::ImageSpec& spec = file->spec();
    std::vector<float> values(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
    REQUIRE(file->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data()));
    Picture picture{spec.width, spec.height, 0};
    for (std::size_t i = 0; i < values.size(); i += static_cast<std::size_t>(spec.nchannels))
        picture.inked += values[i] + values[i + 1] + values[i + 2] < 3;
    return picture;
}

TEST_CASE("a page's plots appear as SVG and PNG, the same bytes each time, wherever the folder is", "[plotter]") {
    const ScratchFolder around;
    const fs::path folder = around / "a b;'$(touch x)", before = fs::current_path();
    fs::create_directory(folder);
    write_whole_file(folder / "json.py", "raise SystemExit(9)");  // Python must not import from the user's folder
    fs::current_path(folder);
    const PlotOutcome outcome = write_page(".", small_page());
    const std::string svg = contents_of("small-u.svg"), png = contents_of("small-u.png");
    const PlotOutcome again = write_page(folder, small_page());
    fs::current_path(before);
    INFO(outcome.reason);
    REQUIRE(outcome.drawn);
    CHECK(outcome.reason.empty());
    CHECK_THAT(svg, Contains("<svg") && Contains("</svg>"));
    const Picture picture = picture_of(folder / "small-u.png");
    CHECK(picture.width > 1000);
    CHECK(picture.height > 500);
    CHECK(picture.inked > 10'000);
    CHECK(again.drawn);
    CHECK(contents_of(folder / "small-u.svg") == svg);
    CHECK(contents_of(folder / "small-u.png") == png);
    CHECK_THAT(contents_of(folder / "small.md"), Contains("![u over p](small-u.svg)"));
    CHECK(std::distance(fs::directory_iterator(folder), fs::directory_iterator()) == 8);  // 5, json.py and the plots
    CHECK(around.entries() == 1);
}

TEST_CASE("no interpreter: the reason, and no plots, not even older ones", "[plotter]") {
    const Drawing drawing;
    std::ofstream(drawing.folder / "small-u.svg") << "of an earlier run";
    const PlotOutcome outcome = drawing.draw("/nowhere/python3");
    CHECK_FALSE(outcome.drawn);
    CHECK(outcome.reason == "cannot run /nowhere/python3 (No such file or directory): install python3-matplotlib");
    drawing.check_nothing_drawn();
}

TEST_CASE("an interpreter without matplotlib: the reason and the remedy, also on the page", "[plotter]") {
    const ScratchFolder programs;
    const std::string python = programs / "python";
    write_program(python, "exec /usr/bin/python3 -I -S \"$@\"");  // without the folders of installed modules
    const Drawing drawing;
    const PlotOutcome outcome = drawing.draw(python);
    CHECK_FALSE(outcome.drawn);
    CHECK(outcome.reason == python + " has no matplotlib: install python3-matplotlib");
    drawing.check_nothing_drawn();
    const Environment named("RAYA_PYTHON", python);
    CHECK_FALSE(write_page(drawing.folder.path(), drawing.page).drawn);
    CHECK_THAT(contents_of(drawing.folder / "small.md"), Contains("Not drawn: " + outcome.reason + ". Then"));
}

TEST_CASE("where python3 of PATH has no matplotlib or is a shim, Debian's is asked", "[plotter]") {
    const ScratchFolder programs;
    const std::string body = GENERATE("exec /usr/bin/python3 -I -S \"$@\"", "exit 127");
    write_program(programs / "python3", body);
    const Environment path("PATH", programs.path().string());
    Drawing drawing;
    drawing.page.plots[0].series[0].x.clear();  // the script finds this out before it draws
    CHECK_THAT(drawing.draw("").reason, StartsWith("/usr/bin/python3 failed with 1: plot.py: "));  // "" names none
}

TEST_CASE("an interpreter of PATH that draws is the one that draws", "[plotter]") {
    const ScratchFolder programs;
    write_program(programs / "python3", "exit 4");  // it could, had the page been right: Debian's is not asked
    const Environment path("PATH", programs.path().string() + ":/bin");
    CHECK(Drawing().draw().reason == "python3 failed with 4");
}

TEST_CASE("an interpreter that fails in its own way is told of", "[plotter]") {
    const ScratchFolder programs;
    const std::string python = programs / "python";
    const Drawing drawing;
    write_program(python, "cat >/dev/null; echo no; echo out of ink. >&2; echo; exit 5");
    CHECK(drawing.draw(python).reason == python + " failed with 5: out of ink");
    write_program(python, "kill -9 $$");
    CHECK(drawing.draw(python).reason == python + " was ended by signal 9");
    write_program(python, "exit 0");
    CHECK(drawing.draw(python).reason == "the script made no small-u.svg");
    drawing.check_nothing_drawn();
}

TEST_CASE("a plot that cannot be drawn: the reason, and none of the page's plots", "[plotter]") {
    Drawing drawing;
    drawing.page.plots.push_back(drawing.page.plots[0]);
    drawing.page.plots[1].name = "broken";
    drawing.page.plots[1].series[1].y.pop_back();
    const PlotOutcome outcome = drawing.draw();
    CHECK_FALSE(outcome.drawn);
    CHECK_THAT(outcome.reason, EndsWith("small.json: plot 'broken', series 'steps': 3 x and 2 y"));
    drawing.check_nothing_drawn();
}

TEST_CASE("a page without plots needs no Python", "[plotter]") {
    Drawing drawing;
    drawing.page.plots.clear();
    CHECK(drawing.draw("/nowhere/python3").drawn);
}

TEST_CASE("plots without a point, with points of no place and of formulas for labels are drawn", "[plotter]") {
    Drawing drawing;
    StudyPlot plot{"none", "no series", "x", "y", Axes::kLogBoth};
    drawing.page.plots = {plot};
    plot = {"nowhere", "nothing finite", "x", "y", Axes::kLogBoth, {{"a", {1, kInfinite, 0}, {-kInfinite, 1, 1}}}};
    drawing.page.plots.push_back(plot);
    plot = {"powers", "$2^{4$",    "_$",
            "y",      Axes::kLogX, {{"_$x", {4, 1048576, 64, 0}, {3, 0, 3, 3}, PlotStyle::kPaper}}};
    drawing.page.plots.push_back(plot);
    const PlotOutcome outcome = drawing.draw();
    INFO(outcome.reason);
    CHECK(outcome.drawn);
    CHECK(drawing.folder.entries() == 7);
}

}  // namespace
}  // namespace raya
