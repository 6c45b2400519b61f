#include "host/ring/bus_and_ring.hpp"

#include <algorithm>
#include <span>
#include <utility>
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
        if (ranks_.rank() == sender) copy("bus.send", own, from, blocks, to, words, segment_.first);
        return;
    }
    if (ranks_.rank() == sender) ranks_.send(receiver, std::span<const float>(read("bus.send", own, from, words)));
    if (ranks_.rank() == receiver) {
        std::vector<float> received(to.rows * words);
        ranks_.receive(sender, std::span(received));
        write("bus.send", blocks, to, received, segment_.first);
    }
}

void Bus::broadcast_from(const Buffer<float>& own, PeWords from, Buffer<float>& all_blocks, PeWords to,
                         std::size_t words) {
    counted_.pe_broadcasts += 1;
    counted_.pe_broadcast_words += from.rows * words;
    if (!ranks_.many()) return copy("bus.broadcast_from", own, from, all_blocks, to, words, 0);
    const std::uint32_t sender = rank_of_pe(pes_, ranks_.count(), from.pe);
    std::vector<float> sent;
    if (ranks_.rank() == sender) sent = read("bus.broadcast_from", own, from, words);
    std::vector<std::size_t> sizes(ranks_.count());
    sizes[sender] = from.rows * words;
    write("bus.broadcast_from", all_blocks, to, ranks_.all_gather(std::span<const float>(sent), sizes), 0);
}

void Bus::gather(const Buffer<float>& blocks, std::span<float> to, std::uint64_t words) {
    session_.read("bus.gather", blocks, to);
    counted_.gather_words += words;
}

void Bus::copy(const char* label, const Buffer<float>& own, const PeWords& from, Buffer<float>& blocks,
               const PeWords& to, std::size_t words, std::size_t first_of_blocks) {
    session_.copy_blocks(label, own, {from.offset, from.pitch, (from.pe - segment_.first) * from.rows * from.pitch},
                         blocks, {to.offset, to.pitch, (to.pe - first_of_blocks) * to.rows * to.pitch}, words,
                         from.rows);
}

std::vector<float> Bus::read(const char* label, const Buffer<float>& own, const PeWords& from, std::size_t words) {
    std::vector<float> read(from.rows * words);
    for (std::size_t row = 0; row < from.rows; ++row)
        session_.read(label, own, std::span(read).subspan(row * words, words),
                      ((from.pe - segment_.first) * from.rows + row) * from.pitch + from.offset);
    return read;
}

void Bus::write(const char* label, Buffer<float>& blocks, const PeWords& to, std::span<const float> words,
                std::size_t first_of_blocks) {
    const std::size_t of_row = words.size() / to.rows;
    for (std::size_t row = 0; row < to.rows; ++row)
        session_.write(label, blocks, words.subspan(row * of_row, of_row),
                       ((to.pe - first_of_blocks) * to.rows + row) * to.pitch + to.offset);
}

Ring::Ring(Session& session, Communication& counted, std::uint32_t pes, std::size_t rows, std::size_t row_words,
           Ranks& ranks)
    : session_(session),
      counted_(counted),
      ranks_(ranks),
      segment_(own_segment(pes, ranks)),
      pes_(pes),
      rows_(rows),
      row_words_(row_words),
      block_words_(rows * row_words),
      front_(session.buffer<float>("ring blocks", segment_.count * block_words_)),
      back_(session.buffer<float>("ring blocks in transit", segment_.count * block_words_)) {}

void Ring::load(const Buffer<float>& own, std::size_t own_words, std::size_t begin) {
    const std::size_t count = std::min(row_words_, own_words - begin), rows = segment_.count * rows_;
    if (count == own_words) return session_.copy("ring.load", own, 0, front_, 0, rows * count);
    session_.copy_blocks("ring.load", own, {begin, own_words}, front_, {0, row_words_}, count, rows);
}

// The block for another rank is sent first, so that its transfer overlaps with the copies within this rank.
void Ring::rotate(RingDirection direction) {
    if (ranks_.many()) send_block(direction);
    rotate_within_rank(direction);
    if (ranks_.many()) receive_block(direction);
    counted_.rotations += 1;
    counted_.rotation_words += pes_ * block_words_;
    std::swap(front_, back_);
}

// Moves the blocks within the segment. With a single rank, also moves the block at one end of the segment to the other
// end.
void Ring::rotate_within_rank(RingDirection direction) {
    const bool down = direction == RingDirection::kDown;
    const char* const label = down ? "ring.rotate_down" : "ring.rotate_up";
    const std::size_t last = segment_.count - 1;
    move(label, front_, down ? 1 : 0, back_, down ? 0 : 1, last);
    if (!ranks_.many()) move(label, front_, down ? 0 : last, back_, down ? last : 0, 1);
}

void Ring::send_block(RingDirection direction) {
    const bool down = direction == RingDirection::kDown;
    const std::uint32_t ranks = ranks_.count(), below = (ranks_.rank() + ranks - 1) % ranks,
                        above = (ranks_.rank() + 1) % ranks;
    outgoing_.resize(block_words_);
    incoming_.resize(block_words_);
    session_.read("ring.leave", front_, outgoing_, down ? 0 : (segment_.count - 1) * block_words_);
    const Outgoing out{down ? below : above, 0, std::as_bytes(std::span(outgoing_))};
    const Incoming in{down ? above : below, 0, std::as_writable_bytes(std::span(incoming_))};
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

void Ring::move(const char* label, const Buffer<float>& from, std::size_t first, Buffer<float>& to, std::size_t at,
                std::size_t blocks) {
    session_.copy(label, from, first * block_words_, to, at * block_words_, blocks * block_words_);
}

}  // namespace raya
