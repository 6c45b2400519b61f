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

/// The options as given on the command line. An empty value means the scene's value.
struct ViewOptions {
    std::string from{}, at{}, up{}, background{};
    std::optional<double> angle{};  // degrees
    std::vector<std::string> lights{};

    bool given() const { return !given_options().empty(); }

    /// Returns the options that were given, with their values: {"--from", "1,2,3"}.
    std::vector<std::pair<std::string, std::string>> given_options() const;
};

/// Adds --from, --at, --up, --angle, --background and --light.
void add_view_options(CLI::App& command, ViewOptions& options);

/// Applies the camera options to `view`. Throws UserError with the options' names for an invalid camera.
void change_viewpoint(const ViewOptions& options, View& view);

/// Applies all options to the scene, with the range checks of the NFF reader. Throws UserError with the option's name.
void change_view(const ViewOptions& options, Scene& scene);

}  // namespace raya
