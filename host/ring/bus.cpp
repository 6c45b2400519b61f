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
    counted_.transfer_words += words;
    const std::uint32_t sender = rank_of_pe(pes_, ranks_.count(), from.pe),
                        receiver = rank_of_pe(pes_, ranks_.count(), to.pe);
    if (sender == receiver) {
        if (ranks_.rank() == sender) session_.copy("bus.send", own, place(from), blocks, place(to), words);
        return;
    }
    std::vector<float> on_the_way(words);
    if (ranks_.rank() == sender) {
        session_.read("bus.send", own, on_the_way, place(from));
        ranks_.send(receiver, std::span<const float>(on_the_way));
    }
    if (ranks_.rank() == receiver) {
        ranks_.receive(sender, std::span(on_the_way));
        session_.write("bus.send", blocks, on_the_way, place(to));
    }
}

void Bus::broadcast_from(const Buffer<float>& own, PeWords from, Buffer<float>& heard, PeWords to, std::size_t words) {
    counted_.pe_broadcasts += 1;
    counted_.pe_broadcast_words += words;
    if (!ranks_.many()) return session_.copy("bus.broadcast_from", own, from.at(), heard, to.at(), words);
    const std::uint32_t sender = rank_of_pe(pes_, ranks_.count(), from.pe);
    std::vector<float> said(ranks_.rank() == sender ? words : 0);
    session_.read("bus.broadcast_from", own, said, said.empty() ? 0 : place(from));
    std::vector<std::size_t> sizes(ranks_.count());
    sizes[sender] = words;
    session_.write("bus.broadcast_from", heard, ranks_.all_gather(std::span<const float>(said), sizes), to.at());
}

void Bus::gather(const Buffer<float>& blocks, std::span<float> to, std::uint64_t words) {
    session_.read("bus.gather", blocks, to);
    counted_.gather_words += words;
}

std::size_t Bus::place(const PeWords& words) const { return (words.pe - here_.first) * words.pitch + words.offset; }

}  // namespace raya
