// raya machines: lists the modelled machines with the source of every number.
#include <fmt/core.h>

#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/model/machine.hpp"
#include "host/report/table.hpp"

namespace raya {
namespace {

void print_machine(const Machine& machine) {
    std::vector<std::vector<std::string>> rows = {{"number", "value", "source"}};
    for (const Fact& fact : machine.facts) rows.push_back({fact.what, fact.value, fact.source});
    fmt::print("{}: {}, {}\n{}\n", machine.name, machine.title, machine.topology, text_table(rows));
}

void list_machines(const std::string& name) {
    if (!name.empty()) return print_machine(machine_named(name));
    for (const Machine& machine : machines()) print_machine(machine);
    for (const CitedMachine& cited : cited_machines())
        fmt::print("{}: cited but not modelled, because {}. {}.\n", cited.name, cited.reason, cited.facts);
    fmt::print(
        "\n[P] printed in the machine's paper, [D] derived from printed figures, [T] data sheet of the T805, "
        "[?] assumed.\n");
}

}  // namespace

void add_machines_command(CLI::App& program) {
    CLI::App* command =
        program.add_subcommand("machines", "List the modelled machines, with the source of every number");
    add_examples(*command, {{"raya machines", "List all machines"}, {"raya machines spa", "List the numbers of spa"}});
    const auto name = std::make_shared<std::string>();
    command->add_option("machine", *name, "Name of one machine, as for --machine; default: all")->type_name("NAME");
    command->callback([name] { list_machines(*name); });
}

}  // namespace raya
