// Runs `raya render` on a scene in scenes/, with image, cost image and report.
#pragma once
#include <algorithm>
#include <catch2/catch.hpp>
#include <string>
#include <vector>

#include "tests/base/scratch_folder.hpp"
#include "tests/cli/run_program.hpp"
#include "tests/document.hpp"

namespace raya {

inline constexpr int kTestWidth = 20, kTestHeight = 12;  // default --size, in pixels

class RenderFiles {
  public:
    /// Renders the scene. If the render fails, the test case ends. Defaults: 20 x 12 pixels, 20 PEs, 4 lanes. All tests
    /// use these defaults, so that few kernels are compiled.
    explicit RenderFiles(const std::string& scene, std::vector<std::string> options = {},
                         const std::string& extension = ".pfm", const std::string& cost_extension = ".pfm")
        : image_(folder_ / ("image" + extension)),
          cost_(folder_ / ("cost" + cost_extension)),
          report_(folder_ / "report.json") {
        const auto add_default = [&](const std::string& option, const std::string& value) {
            if (std::find(options.begin(), options.end(), option) == options.end())
                options.insert(options.end(), {option, value});
        };
        add_default("--size", std::to_string(kTestWidth) + "x" + std::to_string(kTestHeight));
        add_default("--pes", std::to_string(kTestWidth));
        add_default("--lanes", "4");
        options.insert(options.begin(),
                       {"render", scene_file(scene), "-o", image_, "--cost", cost_, "--report", report_});
        run_ = run_raya(options);
        INFO(run_.describe());
        REQUIRE(run_.code == 0);
        REQUIRE(folder_.entries() == 3);
    }

    const std::string& image() const { return image_; }
    const std::string& cost() const { return cost_; }
    const RunOutcome& run() const { return run_; }
    Document report() const { return Document::parse(file_contents(report_)); }

  private:
    ScratchFolder folder_;
    std::string image_, cost_, report_;
    RunOutcome run_;
};

}  // namespace raya
