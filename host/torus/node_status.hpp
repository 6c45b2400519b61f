// The nodes' status words (kernels/shared/traffic.h) on the host.
#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "kernels/shared/traffic.h"

namespace raya {

/// What every node says of itself, as the host has read it: [node][RAYA_STATUS_WORDS].
class NodeStatus {
  public:
    explicit NodeStatus(std::uint32_t nodes) : words(std::size_t{nodes} * RAYA_STATUS_WORDS) {}
    explicit NodeStatus(std::vector<std::uint32_t> read) : words(std::move(read)) {}
    std::uint32_t at(std::uint32_t node, std::uint32_t word) const {
        return words[std::size_t{node} * RAYA_STATUS_WORDS + word];
    }
    std::vector<std::uint32_t> words;
};

}  // namespace raya
