#include "host/ring/bus_and_ring.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

namespace raya {

void Bus::broadcast(Buffer<std::uint32_t>& target, std::span<const std::uint32_t> words) {
    session_.write("bus.broadcast", target, words);
    communication_.broadcasts += 1;
    communication_.broadcast_words += words.size();
}

void Bus::send(const Buffer<float>& pe_memory, PeWords source, Buffer<float>& blocks, PeWords target,
               std::size_t words) {
    communication_.transfers += 1;
    communication_.transfer_words += source.rows * words;
    const bool sends = pes_.has(source.pe), receives = pes_.has(target.pe);
    if (sends && receives) return copy("bus.send", pe_memory, source, blocks, target, words, pes_.first());
    if (sends)
        pes_.ranks().send(pes_.rank_of(target.pe), std::span<const float>(read("bus.send", pe_memory, source, words)));
    if (receives) {
        std::vector<float> received(target.rows * words);
        pes_.ranks().receive(pes_.rank_of(source.pe), std::span(received));
        write("bus.send", blocks, target, received, pes_.first());
    }
}

void Bus::broadcast_from(const Buffer<float>& pe_memory, PeWords source, Buffer<float>& all_blocks, PeWords target,
                         std::size_t words) {
    communication_.pe_broadcasts += 1;
    communication_.pe_broadcast_words += source.rows * words;
    if (pes_.count() == pes_.all()) return copy("bus.broadcast_from", pe_memory, source, all_blocks, target, words, 0);
    std::vector<float> sent;
    if (pes_.has(source.pe)) sent = read("bus.broadcast_from", pe_memory, source, words);
    std::vector<std::size_t> sizes(pes_.ranks().count());
    sizes[pes_.rank_of(source.pe)] = source.rows * words;
    write("bus.broadcast_from", all_blocks, target, pes_.ranks().all_gather(std::span<const float>(sent), sizes), 0);
}

void Bus::gather(const Buffer<float>& blocks, std::span<float> target, std::uint64_t words) {
    session_.read("bus.gather", blocks, target);
    communication_.gather_words += words;
}

void Bus::copy(const char* label, const Buffer<float>& pe_memory, const PeWords& source, Buffer<float>& blocks,
               const PeWords& target, std::size_t words, std::size_t first_block_pe) {
    session_.copy_blocks(label, pe_memory,
                         {source.offset, source.pitch, (source.pe - pes_.first()) * source.rows * source.pitch}, blocks,
                         {target.offset, target.pitch, (target.pe - first_block_pe) * target.rows * target.pitch},
                         words, source.rows);
}

std::vector<float> Bus::read(const char* label, const Buffer<float>& pe_memory, const PeWords& source,
                             std::size_t words) {
    std::vector<float> words_read(source.rows * words);
    for (std::size_t row = 0; row < source.rows; ++row)
        session_.read(label, pe_memory, std::span(words_read).subspan(row * words, words),
                      ((source.pe - pes_.first()) * source.rows + row) * source.pitch + source.offset);
    return words_read;
}

void Bus::write(const char* label, Buffer<float>& blocks, const PeWords& target, std::span<const float> words,
                std::size_t first_block_pe) {
    const std::size_t words_per_row = words.size() / target.rows;
    for (std::size_t row = 0; row < target.rows; ++row)
        session_.write(label, blocks, words.subspan(row * words_per_row, words_per_row),
                       ((target.pe - first_block_pe) * target.rows + row) * target.pitch + target.offset);
}

Ring::Ring(Session& session, Communication& communication, Distribution pes, std::size_t rows, std::size_t row_words)
    : session_(session),
      communication_(communication),
      pes_(std::move(pes)),
      rows_(rows),
      row_words_(row_words),
      block_words_(rows * row_words),
      front_(session.buffer<float>("ring blocks", pes_.count() * block_words_)),
      back_(session.buffer<float>("ring blocks in transit", pes_.count() * block_words_)) {}

void Ring::load(const Buffer<float>& pe_memory, std::size_t memory_row_words, std::size_t begin) {
    const std::size_t count = std::min(row_words_, memory_row_words - begin), rows = pes_.count() * rows_;
    if (count == memory_row_words) return session_.copy("ring.load", pe_memory, 0, front_, 0, rows * count);
    session_.copy_blocks("ring.load", pe_memory, {begin, memory_row_words}, front_, {0, row_words_}, count, rows);
}

// The block for another rank is sent first, so that its transfer overlaps with the copies within this rank.
void Ring::rotate(RingDirection direction) {
    const bool crosses_ranks = pes_.count() < pes_.all();
    if (crosses_ranks) send_block(direction);
    rotate_within_rank(direction);
    if (crosses_ranks) receive_block(direction);
    communication_.rotations += 1;
    communication_.rotation_words += pes_.all() * block_words_;
    std::swap(front_, back_);
}

// Moves the blocks within the rank. With a single rank, also moves the block at one end to the other end.
void Ring::rotate_within_rank(RingDirection direction) {
    const bool down = direction == RingDirection::kDown;
    const char* const label = down ? "ring.rotate_down" : "ring.rotate_up";
    const std::size_t last = pes_.count() - 1;
    move(label, front_, down ? 1 : 0, back_, down ? 0 : 1, last);
    if (pes_.count() == pes_.all()) move(label, front_, down ? 0 : last, back_, down ? last : 0, 1);
}

void Ring::send_block(RingDirection direction) {
    const bool down = direction == RingDirection::kDown;
    const std::uint32_t below = pes_.rank_of((pes_.first() + pes_.all() - 1) % pes_.all()),
                        above = pes_.rank_of((pes_.first() + pes_.count()) % pes_.all());
    outgoing_.resize(block_words_);
    incoming_.resize(block_words_);
    session_.read("ring.leave", front_, outgoing_, down ? 0 : (pes_.count() - 1) * block_words_);
    const OutgoingMessage out{down ? below : above, 0, std::as_bytes(std::span(outgoing_))};
    const IncomingMessage in{down ? above : below, 0, std::as_writable_bytes(std::span(incoming_))};
    pes_.ranks().start({&out, 1}, {&in, 1});
}

void Ring::receive_block(RingDirection direction) {
    session_.flush();
    pes_.ranks().wait();
    session_.write("ring.arrive", back_, incoming_,
                   direction == RingDirection::kDown ? (pes_.count() - 1) * block_words_ : 0);
}

void Ring::take(const Buffer<float>& all_blocks, std::size_t distance) {
    const std::size_t first = (pes_.first() + distance) % pes_.all();
    const std::size_t before_wrap = std::min<std::size_t>(pes_.count(), pes_.all() - first);
    move("ring.take", all_blocks, first, front_, 0, before_wrap);
    move("ring.take", all_blocks, 0, front_, before_wrap, pes_.count() - before_wrap);
}

void Ring::move(const char* label, const Buffer<float>& source, std::size_t first_source, Buffer<float>& target,
                std::size_t first_target, std::size_t blocks) {
    session_.copy(label, source, first_source * block_words_, target, first_target * block_words_,
                  blocks * block_words_);
}

}  // namespace raya
