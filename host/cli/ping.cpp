// raya ping: measures message times between ranks, with the transport that renders use.
#include "host/ranks/ping.hpp"

#include <fmt/core.h>

#include "host/cli/command_tree.hpp"
#include "host/cli/commands.hpp"
#include "host/cli/options.hpp"
#include "host/error.hpp"

namespace raya {
namespace {

void run_ping(Ranks& ranks) {
    if (!ranks.has_several())
        throw UserError("ping needs two ranks or more and there is one; start it as mpirun -n 2 raya ping");
    const PingReport report = ping(ranks);
    if (ranks.is_first()) fmt::print("{}\n", report.json().dump(2));
}

}  // namespace

void add_ping_command(CLI::App& program, Ranks& ranks) {
    CLI::App* command = program.add_subcommand("ping",
                                               "Under mpirun: measure messages of 1 B to 4 MB between ranks and print "
                                               "their times, latency alpha and time per byte beta as JSON");
    add_examples(*command, {{"mpirun -n 2 raya ping", "Measure between two ranks of this machine"},
                            {"mpirun -n 2 --host one,other raya ping >network.json",
                             "Measure between two machines; raya study ranks --network takes alpha and beta"}});
    command->callback([&ranks] { run_ping(ranks); });
}

}  // namespace raya
