// The option --as of `raya verify`: a render command, parsed like that of `raya render`.
#pragma once
#include <string>

#include "host/cli/render_command.hpp"
#include "host/verify/render_case.hpp"

namespace raya {

/// Parses a command such as "render scene.nff --lanes 8"; "raya" may precede it. Quotes work as in a shell. Throws
/// UserError, with --as, if `raya render` would refuse the options.
RenderCommand parse_render(const std::string& text);

/// Returns the render of such a command: reads its scene, and loads the values of raya tune unless the command has
/// --no-tuned. Throws UserError like `raya render`.
RenderCase render_case(const std::string& text);

}  // namespace raya
