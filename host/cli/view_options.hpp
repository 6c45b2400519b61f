// Options that replace the scene's camera, background and lights.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/scene/scene.hpp"

namespace CLI {
class App;
}

namespace raya {

/// As given on the command line; empty: the scene's.
struct ViewOptions {
    std::string from{}, at{}, up{}, background{};
    std::optional<double> angle{};  // degrees
    std::vector<std::string> lights{};

    bool given() const { return !given_options().empty(); }

    /// The options given, with their values: {"--from", "1,2,3"}.
    std::vector<std::pair<std::string, std::string>> given_options() const;
};

/// Adds --from, --at, --up, --angle, --background and --light.
void add_view_options(CLI::App& command, ViewOptions& view);

/// The names of those options, without dashes.
const std::vector<std::string>& view_option_names();

/// Applies the camera options to `view`. UserError as change_view().
void change_viewpoint(const ViewOptions& options, View& view);

/// Applies all options to the scene, with the range checks of the NFF reader. UserError names the option.
void change_view(const ViewOptions& view, Scene& scene);

}  // namespace raya
