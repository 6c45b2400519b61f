#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <sstream>

#include "host/cli/command_text.hpp"

namespace raya {
namespace {

// Escapes the characters that man interprets.
std::string man_escaped(const std::string& text) {
    std::string page;
    for (const char c : text) switch (c) {
            case '\\':
                page += "\\e";
                break;
            case '-':
                page += "\\-";
                break;
            case '\'':
                page += "\\(aq";
                break;
            case '"':
                page += "\\(dq";
                break;
            case '`':
                page += "\\(ga";
                break;
            case '^':
                page += "\\(ha";
                break;
            case '~':
                page += "\\(ti";
                break;
            default:
                page += c;
        }
    return page;
}

// Returns a line of text. Escapes a leading dot, which would begin a macro.
std::string line(const std::string& text) { return (text.starts_with('.') ? "\\&" : "") + man_escaped(text) + '\n'; }

std::string bold(const std::string& text) { return "\\fB" + man_escaped(text) + "\\fR"; }
std::string italic(const std::string& text) { return "\\fI" + man_escaped(text) + "\\fR"; }

std::string upper(std::string text) {
    std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
    return text;
}

std::string heading(const std::string& text) { return ".SH " + upper(man_escaped(text)) + '\n'; }

std::string in_synopsis(const OptionText& o) {
    std::string text = o.is_argument() ? italic(o.names.front()) + (o.repeated ? " ..." : "")
                                       : bold(o.names.front()) + ' ' + italic(o.placeholder);
    return o.required ? text : '[' + text + ']';
}

std::string synopsis(const CommandText& command, const std::string& path) {
    std::string text = bold(path);
    if (!command.commands.empty()) text += ' ' + italic("COMMAND");
    for (const OptionText& argument : command.arguments) text += ' ' + in_synopsis(argument);
    for (const OptionText& option : command.options)
        if (option.required) text += ' ' + in_synopsis(option);
    return text + " [" + italic("OPTIONS") + "]\n";
}

std::string entry(const OptionText& o) {
    std::string names;
    for (const std::string& name : o.names)
        names += (names.empty() ? "" : ", ") + (name.starts_with('-') ? bold(name) : italic(name));
    if (!o.is_flag() && !o.is_argument()) names += ' ' + italic(o.placeholder);
    return ".TP\n" + names + '\n' + line(description_of(o));
}

std::string entries(const std::vector<OptionText>& options) {
    std::string text;
    for (const OptionText& option : options) text += entry(option);
    return text;
}

// Returns the command's arguments and options by group. `make_heading`: returns the heading for a group's name.
template <class Heading>
std::string grouped(const CommandText& command, Heading&& make_heading) {
    std::string text;
    if (!command.arguments.empty()) text = make_heading("Arguments") + entries(command.arguments);
    for (const std::string& group : groups_of(command)) {
        text += make_heading(group);
        for (const OptionText& o : command.options)
            if (o.group == group) text += entry(o);
    }
    return text;
}

bool have_same_options(const CommandText& a, const CommandText& b) {
    const auto equal = [](const std::vector<OptionText>& x, const std::vector<OptionText>& y) {
        return std::equal(x.begin(), x.end(), y.begin(), y.end(), [](const OptionText& p, const OptionText& q) {
            return p.names == q.names && p.placeholder == q.placeholder && p.default_value == q.default_value &&
                   p.help == q.help;
        });
    };
    return equal(a.arguments, b.arguments) && equal(a.options, b.options);
}

std::string examples(const CommandText& command) {
    std::string text;
    for (const ExampleText& example : command.examples)
        text += ".TP\n" + bold(example.command) + '\n' + line(example.description);
    return text;
}

// Returns the command without `listed_options`, which the page already lists for the parent command.
CommandText without_options(CommandText command, const std::vector<OptionText>& listed_options) {
    std::erase_if(command.options, [&](const OptionText& o) {
        return std::any_of(listed_options.begin(), listed_options.end(),
                           [&](const OptionText& option) { return option.names == o.names; });
    });
    return command;
}

// Returns the subcommands with their options. Subcommands with equal options share one list.
std::string commands_below(const CommandText& command, const std::string& path) {
    std::string text = heading("Commands");
    std::vector<const CommandText*> remaining;
    for (const CommandText& subcommand : command.commands) remaining.push_back(&subcommand);
    while (!remaining.empty()) {
        const CommandText& first = *remaining.front();
        const auto first_different =
            std::stable_partition(remaining.begin(), remaining.end(),
                                  [&](const auto* subcommand) { return have_same_options(*subcommand, first); });
        for (auto subcommand = remaining.begin(); subcommand != first_different; ++subcommand)
            text += ".TP\n" + synopsis(**subcommand, path + ' ' + (*subcommand)->name) + line((*subcommand)->summary);
        text += ".RS\n" +
                grouped(without_options(first, command.options), [](const std::string&) { return std::string(); });
        if (!first.examples.empty()) text += ".TP\nExamples\n" + (".RS\n" + examples(first)) + ".RE\n";
        text += ".RE\n";
        remaining.erase(remaining.begin(), first_different);
    }
    return text;
}

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream in(text);
    for (std::string text_line; std::getline(in, text_line);) lines.push_back(text_line);
    return lines;
}

// Formats an indented line "  NAME   description" as a list entry. Formats other lines, and commands of raya, verbatim.
std::string indented(const std::string& source_line) {
    const std::string text = source_line.substr(std::min(source_line.find_first_not_of(' '), source_line.size()));
    const std::size_t gap = text.find("  ");
    if (gap == std::string::npos || text.starts_with("raya ")) return ".PP\n.EX\n" + line("    " + text) + ".EE\n";
    return ".TP\n" + bold(text.substr(0, gap)) + '\n' + line(text.substr(text.find_first_not_of(' ', gap)));
}

// Returns the footer of the command's help as sections of the page.
std::string footer_sections(const std::string& footer) {
    std::string text;
    bool begins_paragraph = true;
    for (const std::string& source_line : lines_of(footer)) {
        const std::size_t colon = source_line.find(':');
        const bool titled = begins_paragraph && colon != std::string::npos && !source_line.starts_with(' ');
        if (titled) text += heading(source_line.substr(0, colon));
        const std::string rest = titled ? source_line.substr(std::min(colon + 2, source_line.size())) : source_line;
        if (!rest.empty()) text += rest.starts_with("  ") ? indented(rest) : line(rest);
        begins_paragraph = source_line.empty();
    }
    return text;
}

std::string page_header(const std::string& name, const CommandText& command, const std::string& path,
                        const std::string& version) {
    std::string summary = command.summary;
    if (summary.starts_with(command.name + ' ')) summary.erase(0, command.name.size() + 1);
    return fmt::format(
               ".\\\" Generated by raya manual from the texts of --help-all.\n"
               ".TH {} 1 \"\" \"{}\" \"User Commands\"\n{}{} \\- {}",
               upper(man_escaped(name)), version, heading("Name"), man_escaped(name), line(summary)) +
           heading("Synopsis") + synopsis(command, path) + heading("Description") + line(command.summary);
}

std::string page_reference(const std::string& name) { return ".BR " + man_escaped(name) + " (1)"; }

ManPage page_of(const CommandText& command, const CommandText& program, const std::string& version) {
    const bool is_program = &command == &program;
    const std::string name = is_program ? program.name : program.name + '-' + command.name;
    const std::string path = is_program ? program.name : program.name + ' ' + command.name;
    std::string text = page_header(name, command, path, version);
    if (!is_program && !command.commands.empty()) text += commands_below(command, path);
    if (is_program) text += heading("Commands");
    for (const CommandText& subcommand : program.commands)
        if (is_program)
            text += ".TP\n" + page_reference(name + '-' + subcommand.name) + '\n' + line(subcommand.summary);
    text += grouped(command, heading);
    if (!command.examples.empty()) text += heading("Examples") + examples(command);
    text += footer_sections(command.footer) + heading("See also");
    if (!is_program) return {name, text + page_reference(program.name) + '\n'};
    for (const CommandText& subcommand : program.commands)
        text +=
            page_reference(name + '-' + subcommand.name) + (&subcommand == &program.commands.back() ? "\n" : " ,\n");
    return {name, text};
}

}  // namespace

std::vector<ManPage> man_pages(const CommandText& program, const std::string& name_and_version) {
    std::vector<ManPage> pages = {page_of(program, program, name_and_version)};
    for (const CommandText& command : program.commands) pages.push_back(page_of(command, program, name_and_version));
    return pages;
}

}  // namespace raya
