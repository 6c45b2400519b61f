#include <CLI/CLI.hpp>
#include "cli/commands.hpp"
namespace raya {
void add_bench_command(CLI::App&) {}
}
