// raya: a ray tracer on models of distributed-memory array machines.
#include "host/cli/commands.hpp"
#include "host/version.hpp"

int main(int argc, char** argv) { return raya::run_program(argc, argv, raya::commit_and_build()); }
