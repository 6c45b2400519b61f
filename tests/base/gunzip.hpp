// Unpacks gzip with the gzip program, which is independent of raya's encoder.
#pragma once
#include <cstdio>
#include <stdexcept>
#include <string>
#include <string_view>

#include "host/base/whole_file.hpp"
#include "tests/base/scratch_folder.hpp"

namespace raya {

/// Unpacks the bytes of a gzip file; throws std::runtime_error if gzip reports an error.
inline std::string gunzip(std::string_view bytes) {
    const ScratchFolder folder;
    write_whole_file(folder / "text.gz", bytes);
    std::FILE* const pipe = ::popen(("gzip -dc '" + (folder / "text.gz").string() + "'").c_str(), "r");
    if (pipe == nullptr) throw std::runtime_error("cannot run gzip");
    std::string text, block(1 << 16, '\0');
    while (const std::size_t read = std::fread(block.data(), 1, block.size(), pipe)) text.append(block, 0, read);
    if (::pclose(pipe) != 0) throw std::runtime_error("gzip cannot unpack the bytes");
    return text;
}

}  // namespace raya
