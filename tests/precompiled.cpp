// An empty source file: CMake builds a precompiled header only for a target with a source that uses it, and main.cpp
// does not.
