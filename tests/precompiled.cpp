// Empty, for the test programs' precompiled header: CMake makes one only for a file that uses it; main.cpp does not.
