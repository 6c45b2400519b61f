// Camera, background and lights from the command line, in place of what the scene says.
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

/// As given on the command line; what is empty stays as the scene has it.
struct ViewOptions {
    std::string from{}, at{}, up{}, background{};
    std::optional<double> angle{};  // degrees
    std::vector<std::string> lights{};

    bool given() const { return !words().empty(); }

    /// What was given, as option and value: {"--from", "1,2,3"}.
    std::vector<std::pair<std::string, std::string>> words() const;
};

/// Adds --from, --at, --up, --angle, --background and --light with their help texts.
void add_view_options(CLI::App& command, ViewOptions& view);

/// The names of those options, without dashes.
const std::vector<std::string>& view_option_names();

/// Puts what was given of the camera in place of what `view` says. UserError as change_view().
void change_viewpoint(const ViewOptions& options, View& view);

/// Puts what was given in place of what the scene says, by the rules of the reader of NFF. UserError names the option.
void change_view(const ViewOptions& view, Scene& scene);

}  // namespace raya
