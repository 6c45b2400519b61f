// What the parser knows of commands and options, as plain text; and help as the parser prints it.
#pragma once
#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

#include "host/cli/command_text.hpp"

namespace raya {

/// Makes help of the tree from which manual pages are made (host/cli/command_tree.hpp), as wide as the terminal. Keeps
/// the examples of all commands of a program.
class HelpFormatter : public CLI::FormatterBase {
  public:
    /// The help of a command that the words `path` lead to.
    std::string make_help(const CLI::App* command, std::string path, CLI::AppFormatMode mode) const override;

    void keep(const CLI::App& command, std::vector<ExampleText> examples) { examples_[&command] = std::move(examples); }
    std::vector<ExampleText> examples_of(const CLI::App& command) const;

  private:
    std::map<const CLI::App*, std::vector<ExampleText>> examples_;
};

/// Says how the command is used: lines for a shell that run where scenes/ lies, each with what it does. The command's
/// program has a HelpFormatter.
void add_examples(CLI::App& command, std::vector<ExampleText> examples);

/// Those of a command; none where its program has another formatter.
std::vector<ExampleText> examples_of(const CLI::App& command);

OptionText option_text(CLI::Option& option);

/// The program with all its commands, but for what help does not show. A word called COMMAND is one of those.
CommandText command_text(const CLI::App& program);

}  // namespace raya
