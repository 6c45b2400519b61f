// Changes to kernel source text: the one way to put a fault into kernels on purpose.
#pragma once
#include <string>
#include <vector>

namespace raya {

/// In `file`, a path below kernels/ ("ring/trace.cl"), `replace` takes the place of `find`, which may span lines.
struct SourcePatch {
    std::string file, find, replace;
};

/// The `text` of `file` with those of `patches` that name it, one after another. std::logic_error, with file and text,
/// where a patch does not find its text exactly once: a fault that is not put in must not count as one that nobody
/// sees.
std::string patched_text(std::string text, const std::string& file, const std::vector<SourcePatch>& patches);

}  // namespace raya
