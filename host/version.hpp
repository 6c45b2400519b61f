// Version texts, defined by the build.
#pragma once

namespace raya {

/// "1.2.3": the version in project() of CMakeLists.txt.
const char* raya_version();

/// "raya 1.2.3", for output files.
const char* name_and_version();

/// "15": the major version of the compilers clang-N and llvm-spirv-N for SPIR-V; `tools/setup --llvm` prints it.
const char* llvm_version();

/// "commit 0123456789ab, Release, GNU 12.2.0". "with changes" follows the commit if source files differ from it.
/// Without a git checkout the text has no commit. Only raya's executable links this function, so that a commit does not
/// relink tests and libraries.
const char* commit_and_build();

}  // namespace raya
