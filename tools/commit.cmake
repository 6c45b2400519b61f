# Writes OUTPUT, a C++ file with the commit of the sources in ROOT and the text BUILD, unless the file already has this content; see host/version.hpp.
#   cmake -DROOT=DIR -DBUILD=TEXT -DOUTPUT=FILE -P tools/commit.cmake
# The commit comes from git, or from tools/commit.txt in sources that `git archive` packed; other sources have no commit.
set(commit "")
file(STRINGS ${ROOT}/tools/commit.txt packed REGEX "^[0-9a-f]+$")
if(packed)
    string(SUBSTRING "${packed}" 0 12 commit)
elseif(EXISTS ${ROOT}/.git)  # ROOT must be the repository, not a folder inside another project's repository
    find_program(GIT git)
    if(GIT)
        execute_process(COMMAND ${GIT} -C ${ROOT} describe --always --exclude=* --abbrev=12 "--dirty= with changes" OUTPUT_VARIABLE described
                        OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failure)
        if(failure EQUAL 0)
            set(commit "${described}")
        endif()
    endif()
endif()
if(commit)
    string(PREPEND BUILD "commit ${commit}, ")
endif()
file(CONFIGURE OUTPUT ${OUTPUT} @ONLY CONTENT [[// Made by tools/commit.cmake.
#include "host/version.hpp"

const char* raya::commit_and_build() { return "@BUILD@"; }
]])
