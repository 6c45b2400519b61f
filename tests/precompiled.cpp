// Nothing but the test programs' precompiled header: CMake makes it for a file that takes it, and main.cpp does not.
