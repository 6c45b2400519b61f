#include "host/cli/verify_as.hpp"

#include <fmt/core.h>

#include <iomanip>
#include <memory>
#include <sstream>
#include <vector>

#include "host/base/standard_streams.hpp"
#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/parse_failure.hpp"
#include "host/cli/tuned_option.hpp"
#include "host/cli/verbosity_options.hpp"
#include "host/error.hpp"

namespace raya {

RenderCommand parse_render(const std::string& text) {
    std::vector<std::string> words;  // those with blanks are in quotes
    std::istringstream in(text);
    for (std::string word; in >> std::ws && !in.eof(); words.push_back(word))
        in >> std::quoted(word, in.peek() == '\'' ? '\'' : '"');
    if (!words.empty() && words.front() == "raya") words.erase(words.begin());
    if (words.empty() || words.front() != "render")
        throw UserError(fmt::format("--as \"{}\": must be a render, such as \"render scene.nff --lanes 8\"", text));
    CLI::App program("", "raya");
    program.formatter(std::make_shared<HelpFormatter>());
    const auto command = std::make_shared<RenderCommand>();
    CLI::App* const parser = declare_render_command(program, command);
    parser->get_option("--output")->required(false);
    add_verbosity_options(program, Ranks::single());
    try {
        parse_arguments(program, words);
        refuse_options_of_other_machines(*parser, machine_named(command->render.machine));
    } catch (const UserError& error) {
        throw UserError(fmt::format("--as: {}", error.what()));
    } catch (const CLI::ParseError&) {  // --help
        throw UserError("--as: must be a render without --help");
    }
    if (is_standard_stream(command->render.scene)) throw UserError("--as: the scene must be a file, not stdin");
    return *command;
}

RenderCase render_case(const std::string& text) {
    const RenderCommand command = parse_render(text);
    Scene scene = read_scene(command.render.scene, command.render.strict).scene;
    change_view(command.render.view, scene);
    const ImageSize size = image_size(command.render, scene);
    const auto settings = [command](const Scene& other, const ImageSize& other_size) -> RenderCase::Settings {
        RenderOptions options = command.render;
        options.size = fmt::format("{}x{}", other_size.width, other_size.height);
        if (machine_named(options.machine).kind == MachineKind::kTorus)
            return torus_settings(options, command.torus, other);
        return ring_settings_of(command, options, other);
    };
    return {std::move(scene), size, settings,
            std::shared_ptr<ScopedTunedSource>(new ScopedTunedSource(use_tuned(command.render.no_tuned)))};
}

}  // namespace raya
