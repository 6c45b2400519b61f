// Which raya this is. The build makes the definitions.
#pragma once

namespace raya {

/// "1.2.3": the version of CMake's project(), which stands nowhere else.
const char* raya_version();

/// "raya 1.2.3", by which files name what made them.
const char* name_and_version();

/// "commit 0123456789ab, Release, GNU 12.2.0"; "with changes" behind the commit where files differ from it, and no
/// commit where the sources are no checkout. Of the program alone: a commit links tests and libraries not anew.
const char* commit_and_build();

}  // namespace raya
