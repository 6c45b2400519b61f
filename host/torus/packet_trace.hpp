// The trace of the packets between nodes as CSV, compressed with gzip: what simulators of networks ask for
// (docs/packets.md has the columns).
#pragma once
#include <cstdint>
#include <string>

#include "host/base/gzip.hpp"
#include "host/torus/packet_record.hpp"
#include "host/torus/ray_numbers.hpp"

namespace raya {

/// "primary", "reflected", "refracted", "shadow" or "return"; std::logic_error for another kind.
const char* packet_kind_name(std::uint32_t kind);

/// Takes records one after another, as a PacketSink is given them. Keeps the compressed text and the rays' numbers,
/// which is most of it: up to 48 bytes for each ray and shadow ray that was sent or whose child was.
class PacketTrace {
  public:
    PacketTrace();

    /// One row. std::logic_error for a head that no packet has.
    void add(const PacketRecord& record);

    /// The whole file; the last that may be asked of the trace.
    std::string finish();

    std::uint64_t rows() const { return rows_; }

  private:
    GzipText file_;
    std::string text_;  // rows that are not compressed yet
    RayNumbers numbers_;
    std::uint64_t rows_ = 0;
};

}  // namespace raya
