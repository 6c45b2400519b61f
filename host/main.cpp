// raya: traces rays on models of distributed-memory array machines.
#include "host/cli/commands.hpp"

int main(int argc, char** argv) { return raya::run_program(argc, argv); }
