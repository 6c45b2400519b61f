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
    const std::uint32_t sender = rank_of_pe(pes_, ranks_.count(), source.pe),
                        receiver = rank_of_pe(pes_, ranks_.count(), target.pe);
    if (sender == receiver) {
        if (ranks_.rank() == sender) copy("bus.send", pe_memory, source, blocks, target, words, segment_.first);
        return;
    }
    if (ranks_.rank() == sender)
        ranks_.send(receiver, std::span<const float>(read("bus.send", pe_memory, source, words)));
    if (ranks_.rank() == receiver) {
        std::vector<float> received(target.rows * words);
        ranks_.receive(sender, std::span(received));
        write("bus.send", blocks, target, received, segment_.first);
    }
}

void Bus::broadcast_from(const Buffer<float>& pe_memory, PeWords source, Buffer<float>& all_blocks, PeWords target,
                         std::size_t words) {
    communication_.pe_broadcasts += 1;
    communication_.pe_broadcast_words += source.rows * words;
    if (!ranks_.has_several()) return copy("bus.broadcast_from", pe_memory, source, all_blocks, target, words, 0);
    const std::uint32_t sender = rank_of_pe(pes_, ranks_.count(), source.pe);
    std::vector<float> sent;
    if (ranks_.rank() == sender) sent = read("bus.broadcast_from", pe_memory, source, words);
    std::vector<std::size_t> sizes(ranks_.count());
    sizes[sender] = source.rows * words;
    write("bus.broadcast_from", all_blocks, target, ranks_.all_gather(std::span<const float>(sent), sizes), 0);
}

void Bus::gather(const Buffer<float>& blocks, std::span<float> target, std::uint64_t words) {
    session_.read("bus.gather", blocks, target);
    communication_.gather_words += words;
}

void Bus::copy(const char* label, const Buffer<float>& pe_memory, const PeWords& source, Buffer<float>& blocks,
               const PeWords& target, std::size_t words, std::size_t first_block_pe) {
    session_.copy_blocks(
        label, pe_memory, {source.offset, source.pitch, (source.pe - segment_.first) * source.rows * source.pitch},
        blocks, {target.offset, target.pitch, (target.pe - first_block_pe) * target.rows * target.pitch}, words,
        source.rows);
}

std::vector<float> Bus::read(const char* label, const Buffer<float>& pe_memory, const PeWords& source,
                             std::size_t words) {
    std::vector<float> words_read(source.rows * words);
    for (std::size_t row = 0; row < source.rows; ++row)
        session_.read(label, pe_memory, std::span(words_read).subspan(row * words, words),
                      ((source.pe - segment_.first) * source.rows + row) * source.pitch + source.offset);
    return words_read;
}

void Bus::write(const char* label, Buffer<float>& blocks, const PeWords& target, std::span<const float> words,
                std::size_t first_block_pe) {
    const std::size_t words_per_row = words.size() / target.rows;
    for (std::size_t row = 0; row < target.rows; ++row)
        session_.write(label, blocks, words.subspan(row * words_per_row, words_per_row),
                       ((target.pe - first_block_pe) * target.rows + row) * target.pitch + target.offset);
}

Ring::Ring(Session& session, Communication& communication, std::uint32_t pes, std::size_t rows, std::size_t row_words,
           Ranks& ranks)
    : session_(session),
      communication_(communication),
      ranks_(ranks),
      segment_(own_segment(pes, ranks)),
      pes_(pes),
      rows_(rows),
      row_words_(row_words),
      block_words_(rows * row_words),
      front_(session.buffer<float>("ring blocks", segment_.count * block_words_)),
      back_(session.buffer<float>("ring blocks in transit", segment_.count * block_words_)) {}

void Ring::load(const Buffer<float>& pe_memory, std::size_t memory_row_words, std::size_t begin) {
    const std::size_t count = std::min(row_words_, memory_row_words - begin), rows = segment_.count * rows_;
    if (count == memory_row_words) return session_.copy("ring.load", pe_memory, 0, front_, 0, rows * count);
    session_.copy_blocks("ring.load", pe_memory, {begin, memory_row_words}, front_, {0, row_words_}, count, rows);
}

// The block for another rank is sent first, so that its transfer overlaps with the copies within this rank.
void Ring::rotate(RingDirection direction) {
    if (ranks_.has_several()) send_block(direction);
    rotate_within_rank(direction);
    if (ranks_.has_several()) receive_block(direction);
    communication_.rotations += 1;
    communication_.rotation_words += pes_ * block_words_;
    std::swap(front_, back_);
}

// Moves the blocks within the segment. With a single rank, also moves the block at one end of the segment to the other
// end.
void Ring::rotate_within_rank(RingDirection direction) {
    const bool down = direction == RingDirection::kDown;
    const char* const label = down ? "ring.rotate_down" : "ring.rotate_up";
    const std::size_t last = segment_.count - 1;
    move(label, front_, down ? 1 : 0, back_, down ? 0 : 1, last);
    if (!ranks_.has_several()) move(label, front_, down ? 0 : last, back_, down ? last : 0, 1);
}

void Ring::send_block(RingDirection direction) {
    const bool down = direction == RingDirection::kDown;
    const std::uint32_t ranks = ranks_.count(), rank_below = (ranks_.rank() + ranks - 1) % ranks,
                        rank_above = (ranks_.rank() + 1) % ranks;
    outgoing_.resize(block_words_);
    incoming_.resize(block_words_);
    session_.read("ring.leave", front_, outgoing_, down ? 0 : (segment_.count - 1) * block_words_);
    const OutgoingMessage out{down ? rank_below : rank_above, 0, std::as_bytes(std::span(outgoing_))};
    const IncomingMessage in{down ? rank_above : rank_below, 0, std::as_writable_bytes(std::span(incoming_))};
    ranks_.start({&out, 1}, {&in, 1});
}

void Ring::receive_block(RingDirection direction) {
    session_.flush();
    ranks_.wait();
    session_.write("ring.arrive", back_, incoming_,
                   direction == RingDirection::kDown ? (segment_.count - 1) * block_words_ : 0);
}

void Ring::take(const Buffer<float>& all_blocks, std::size_t distance) {
    const std::size_t first = (segment_.first + distance) % pes_;
    const std::size_t before_wrap = std::min<std::size_t>(segment_.count, pes_ - first);
    move("ring.take", all_blocks, first, front_, 0, before_wrap);
    move("ring.take", all_blocks, 0, front_, before_wrap, segment_.count - before_wrap);
}

void Ring::move(const char* label, const Buffer<float>& source, std::size_t first_source, Buffer<float>& target,
                std::size_t first_target, std::size_t blocks) {
    session_.copy(label, source, first_source * block_words_, target, first_target * block_words_,
                  blocks * block_words_);
}

}  // namespace raya
