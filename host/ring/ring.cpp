#include "host/ring/ring.hpp"

#include <algorithm>
#include <span>
#include <utility>

namespace raya {

Ring::Ring(Session& session, Communication& counted, std::uint32_t pes, std::size_t rows, std::size_t row_words,
           Ranks& ranks)
    : session_(session),
      counted_(counted),
      ranks_(ranks),
      here_(own_segment(pes, ranks)),
      pes_(pes),
      rows_(rows),
      row_words_(row_words),
      block_words_(rows * row_words),
      front_(session.buffer<float>("ring blocks", here_.count * block_words_)),
      back_(session.buffer<float>("ring blocks on their way", here_.count * block_words_)) {}

void Ring::load(const Buffer<float>& own, std::size_t own_words, std::size_t begin) {
    const std::size_t count = std::min(row_words_, own_words - begin), rows = here_.count * rows_;
    if (count == own_words) return session_.copy("ring.load", own, 0, front_, 0, rows * count);
    session_.copy_blocks("ring.load", own, {begin, own_words}, front_, {0, row_words_}, count, rows);
}

// What goes to another rank leaves first, so that it travels while the others are copied.
void Ring::rotate(Turn turn) {
    if (ranks_.many()) leave(turn);
    turn_here(turn);
    if (ranks_.many()) arrive(turn);
    counted_.rotations += 1;
    counted_.rotation_words += pes_ * block_words_;
    std::swap(front_, back_);
}

// The block that leaves at one end comes in at the other; on one rank the ends are neighbours.
void Ring::turn_here(Turn turn) {
    const bool down = turn == Turn::kDown;
    const char* const label = down ? "ring.rotate_down" : "ring.rotate_up";
    const std::size_t last = here_.count - 1;
    move(label, front_, down ? 1 : 0, back_, down ? 0 : 1, last);
    if (!ranks_.many()) move(label, front_, down ? 0 : last, back_, down ? last : 0, 1);
}

void Ring::leave(Turn turn) {
    const bool down = turn == Turn::kDown;
    const std::uint32_t ranks = ranks_.count(), below = (ranks_.rank() + ranks - 1) % ranks,
                        above = (ranks_.rank() + 1) % ranks;
    leaves_.resize(block_words_);
    comes_.resize(block_words_);
    session_.read("ring.leave", front_, leaves_, down ? 0 : (here_.count - 1) * block_words_);
    const Outgoing out{down ? below : above, 0, std::as_bytes(std::span(leaves_))};
    const Incoming in{down ? above : below, 0, std::as_writable_bytes(std::span(comes_))};
    ranks_.start({&out, 1}, {&in, 1});
}

void Ring::arrive(Turn turn) {
    session_.flush();
    ranks_.wait();
    session_.write("ring.arrive", back_, comes_, turn == Turn::kDown ? (here_.count - 1) * block_words_ : 0);
}

void Ring::take(const Buffer<float>& heard, std::size_t distance) {
    const std::size_t first = (here_.first + distance) % pes_;
    const std::size_t before_wrap = std::min<std::size_t>(here_.count, pes_ - first);
    move("ring.take", heard, first, front_, 0, before_wrap);
    move("ring.take", heard, 0, front_, before_wrap, here_.count - before_wrap);
}

void Ring::move(const char* label, const Buffer<float>& from, std::size_t first, Buffer<float>& to, std::size_t at,
                std::size_t blocks) {
    session_.copy(label, from, first * block_words_, to, at * block_words_, blocks * block_words_);
}

}  // namespace raya
