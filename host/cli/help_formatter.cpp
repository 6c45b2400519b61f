#include "host/cli/help_formatter.hpp"

#include <memory>
#include <utility>

#include "host/base/terminal.hpp"
#include "host/cli/command_tree.hpp"
#include "host/cli/help_text.hpp"

namespace raya {

std::string HelpFormatter::make_help(const CLI::App* command, std::string path, CLI::AppFormatMode) const {
    return help_text(command_text(*command), path, text_width());
}

std::vector<ExampleText> HelpFormatter::examples_of(const CLI::App& command) const {
    const auto found = examples_.find(&command);
    return found == examples_.end() ? std::vector<ExampleText>{} : found->second;
}

void add_examples(CLI::App& command, std::vector<ExampleText> examples) {
    dynamic_cast<HelpFormatter&>(*command.get_formatter()).keep(command, std::move(examples));
}

std::vector<ExampleText> examples_of(const CLI::App& command) {
    const auto* const formatter = dynamic_cast<const HelpFormatter*>(command.get_formatter().get());
    return formatter == nullptr ? std::vector<ExampleText>{} : formatter->examples_of(command);
}

}  // namespace raya
