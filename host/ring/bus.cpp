#include "host/ring/bus.hpp"

#include <vector>

namespace raya {

void Bus::broadcast(Buffer<std::uint32_t>& to, std::span<const std::uint32_t> words) {
    session_.write("bus.broadcast", to, words);
    counted_.broadcasts += 1;
    counted_.broadcast_words += words.size();
}

void Bus::send(const Buffer<float>& own, PeWords from, Buffer<float>& blocks, PeWords to, std::size_t words) {
    counted_.transfers += 1;
    counted_.transfer_words += from.rows * words;
    const std::uint32_t sender = rank_of_pe(pes_, ranks_.count(), from.pe),
                        receiver = rank_of_pe(pes_, ranks_.count(), to.pe);
    if (sender == receiver) {
        if (ranks_.rank() == sender) copy("bus.send", own, from, blocks, to, words, here_.first);
        return;
    }
    if (ranks_.rank() == sender) ranks_.send(receiver, std::span<const float>(read("bus.send", own, from, words)));
    if (ranks_.rank() == receiver) {
        std::vector<float> come(to.rows * words);
        ranks_.receive(sender, std::span(come));
        write("bus.send", blocks, to, come, here_.first);
    }
}

void Bus::broadcast_from(const Buffer<float>& own, PeWords from, Buffer<float>& heard, PeWords to, std::size_t words) {
    counted_.pe_broadcasts += 1;
    counted_.pe_broadcast_words += from.rows * words;
    if (!ranks_.many()) return copy("bus.broadcast_from", own, from, heard, to, words, 0);
    const std::uint32_t sender = rank_of_pe(pes_, ranks_.count(), from.pe);
    std::vector<float> said;
    if (ranks_.rank() == sender) said = read("bus.broadcast_from", own, from, words);
    std::vector<std::size_t> sizes(ranks_.count());
    sizes[sender] = from.rows * words;
    write("bus.broadcast_from", heard, to, ranks_.all_gather(std::span<const float>(said), sizes), 0);
}

void Bus::gather(const Buffer<float>& blocks, std::span<float> to, std::uint64_t words) {
    session_.read("bus.gather", blocks, to);
    counted_.gather_words += words;
}

void Bus::copy(const char* label, const Buffer<float>& own, const PeWords& from, Buffer<float>& blocks,
               const PeWords& to, std::size_t words, std::size_t first_of_blocks) {
    session_.copy_blocks(label, own, {from.offset, from.pitch, (from.pe - here_.first) * from.rows * from.pitch},
                         blocks, {to.offset, to.pitch, (to.pe - first_of_blocks) * to.rows * to.pitch}, words,
                         from.rows);
}

std::vector<float> Bus::read(const char* label, const Buffer<float>& own, const PeWords& from, std::size_t words) {
    std::vector<float> read(from.rows * words);
    for (std::size_t row = 0; row < from.rows; ++row)
        session_.read(label, own, std::span(read).subspan(row * words, words),
                      ((from.pe - here_.first) * from.rows + row) * from.pitch + from.offset);
    return read;
}

void Bus::write(const char* label, Buffer<float>& blocks, const PeWords& to, std::span<const float> words,
                std::size_t first_of_blocks) {
    const std::size_t of_row = words.size() / to.rows;
    for (std::size_t row = 0; row < to.rows; ++row)
        session_.write(label, blocks, words.subspan(row * of_row, of_row),
                       ((to.pe - first_of_blocks) * to.rows + row) * to.pitch + to.offset);
}

}  // namespace raya
