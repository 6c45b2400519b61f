#include "host/ring/bus_and_ring.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "host/error.hpp"
#include "host/model/budget.hpp"

namespace raya {
namespace {

// Returns the layout of the words in a buffer whose first PE is `first_pe`.
Session::Blocks layout_of(const PeWords& words, std::size_t first_pe) {
    return {words.offset, words.pitch, (words.pe - first_pe) * words.rows * words.pitch};
}

constexpr std::size_t kColours = 3;

}  // namespace

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
    if (sends && receives)
        return session_.copy_blocks("bus.send", pe_memory, layout_of(source, pes_.first()), blocks,
                                    layout_of(target, pes_.first()), words, source.rows);
    if (sends)
        pes_.ranks().send(pes_.rank_of(target.pe), std::span<const float>(read("bus.send", pe_memory, source, words)));
    if (receives) {
        std::vector<float> received(target.rows * words);
        pes_.ranks().receive(pes_.rank_of(source.pe), std::span(received));
        write("bus.send", blocks, layout_of(target, pes_.first()), target.rows, received);
    }
}

void Bus::broadcast_from(const Buffer<float>& pe_memory, PeWords source, Buffer<float>& all_blocks, PeWords target,
                         std::size_t words) {
    communication_.pe_broadcasts += 1;
    communication_.pe_broadcast_words += source.rows * words;
    if (pes_.count() == pes_.all())
        return session_.copy_blocks("bus.broadcast_from", pe_memory, layout_of(source, 0), all_blocks,
                                    layout_of(target, 0), words, source.rows);
    std::vector<float> sent;
    if (pes_.has(source.pe)) sent = read("bus.broadcast_from", pe_memory, source, words);
    std::vector<std::size_t> sizes(pes_.ranks().count());
    sizes[pes_.rank_of(source.pe)] = source.rows * words;
    write("bus.broadcast_from", all_blocks, layout_of(target, 0), target.rows,
          pes_.ranks().all_gather(std::span<const float>(sent), sizes));
}

void Bus::gather(const Buffer<float>& blocks, std::span<float> target, std::uint64_t words) {
    session_.read("bus.gather", blocks, target);
    communication_.gather_words += words;
}

std::vector<float> Bus::read(const char* label, const Buffer<float>& pe_memory, const PeWords& source,
                             std::size_t words) {
    std::vector<float> words_read(source.rows * words);
    const auto [offset, pitch, first] = layout_of(source, pes_.first());
    for (std::size_t row = 0; row < source.rows; ++row)
        session_.read(label, pe_memory, std::span(words_read).subspan(row * words, words),
                      first + row * pitch + offset);
    return words_read;
}

void Bus::write(const char* label, Buffer<float>& blocks, Session::Blocks target, std::size_t rows,
                std::span<const float> words) {
    for (std::size_t row = 0, count = words.size() / rows; row < rows; ++row)
        session_.write(label, blocks, words.subspan(row * count, count),
                       target.first + row * target.pitch + target.offset);
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

// The block for another rank is sent first, so that its transfer overlaps with the copies within this rank. With a
// single rank, the block at one end moves to the other end.
void Ring::rotate(RingDirection direction) {
    const bool down = direction == RingDirection::kDown, crosses_ranks = pes_.count() < pes_.all();
    const char* const label = down ? "ring.rotate_down" : "ring.rotate_up";
    const std::size_t last = pes_.count() - 1;
    if (crosses_ranks) send_block(down);
    move(label, front_, down ? 1 : 0, back_, down ? 0 : 1, last);
    if (crosses_ranks) {
        session_.flush();
        pes_.ranks().wait();
        session_.write("ring.arrive", back_, incoming_, down ? last * block_words_ : 0);
    } else {
        move(label, front_, down ? 0 : last, back_, down ? last : 0, 1);
    }
    communication_.rotations += 1;
    communication_.rotation_words += pes_.all() * block_words_;
    std::swap(front_, back_);
}

void Ring::send_block(bool down) {
    const std::uint32_t below = pes_.rank_of((pes_.first() + pes_.all() - 1) % pes_.all()),
                        above = pes_.rank_of((pes_.first() + pes_.count()) % pes_.all());
    outgoing_.resize(block_words_);
    incoming_.resize(block_words_);
    session_.read("ring.leave", front_, outgoing_, down ? 0 : (pes_.count() - 1) * block_words_);
    const OutgoingMessage out{down ? below : above, 0, std::as_bytes(std::span(outgoing_))};
    const IncomingMessage in{down ? above : below, 0, std::as_writable_bytes(std::span(incoming_))};
    pes_.ranks().start({&out, 1}, {&in, 1});
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

NeighbourExchange::NeighbourExchange(Session& session, Communication& communication, const raya_mapping& mapping,
                                     std::uint32_t capacity, std::uint32_t band, ExchangeMethod method,
                                     const Distribution& pes)
    : pes_(pes),
      capacity_(capacity),
      band_(band),
      method_(method),
      ring_(session, communication, pes, kColours, band),
      bus_(session, communication, pes) {
    for (raya_u32 side = 0; side < RAYA_SIDES; ++side) distances_[side] = neighbour_distances(mapping, side);
    if (method == ExchangeMethod::kBroadcast)
        broadcast_blocks_ =
            session.buffer<float>("blocks that were broadcast", std::size_t{mapping.pes} * kColours * band);
}

void NeighbourExchange::visit(const Buffer<float>& pixels, std::initializer_list<raya_u32> sides,
                              const std::function<void(const Arrival&)>& on_arrival) {
    for (std::uint32_t begin = 0; begin < capacity_; begin += band_) {
        if (method_ == ExchangeMethod::kBroadcast) broadcast_band(pixels, sides, begin);
        for (const raya_u32 side : sides) {
            const auto arrive = [&](std::uint32_t distance) {
                on_arrival({ring_.blocks(), side, distance, begin, band_, capacity_});
            };
            if (method_ == ExchangeMethod::kRing) {
                rotate_band(pixels, side, begin, arrive);
                continue;
            }
            for (const std::uint32_t distance : distances_[side]) {
                fetch_blocks(pixels, distance, begin);
                arrive(distance);
            }
        }
    }
}

// Rotates the ring along the shortest route, and calls arrive(distance) at each stop.
void NeighbourExchange::rotate_band(const Buffer<float>& pixels, raya_u32 side, std::uint32_t begin,
                                    const std::function<void(std::uint32_t)>& arrive) {
    for (const Leg& leg : shortest_route(pes_.all(), distances_[side])) {
        ring_.load(pixels, capacity_, begin);
        std::uint32_t rotations = 0;
        for (const std::uint32_t stop : leg.stops) {
            for (; rotations < stop; ++rotations) ring_.rotate(leg.direction);
            arrive(leg.direction == RingDirection::kDown ? stop : pes_.all() - stop);
        }
    }
}

// Broadcasts the block of each PE in turn. Broadcasts nothing if every PE itself owns all its pixels' neighbours.
void NeighbourExchange::broadcast_band(const Buffer<float>& pixels, std::initializer_list<raya_u32> sides,
                                       std::uint32_t begin) {
    const bool any_distant = std::ranges::any_of(
        sides, [&](raya_u32 side) { return !distances_[side].empty() && distances_[side].back() > 0; });
    for (std::size_t pe = 0; any_distant && pe < pes_.all(); ++pe)
        bus_.broadcast_from(pixels, {pe, capacity_, begin, kColours}, *broadcast_blocks_, {pe, band_, 0, kColours},
                            band_pixels(begin));
}

// Brings the block of PE (i + distance) mod P to each PE i: over the bus, or from the blocks that were broadcast.
void NeighbourExchange::fetch_blocks(const Buffer<float>& pixels, std::uint32_t distance, std::uint32_t begin) {
    if (distance == 0) return ring_.load(pixels, capacity_, begin);
    if (broadcast_blocks_) return ring_.take(*broadcast_blocks_, distance);
    for (std::size_t pe = 0; pe < pes_.all(); ++pe)
        bus_.send(pixels, {(pe + distance) % pes_.all(), capacity_, begin, kColours}, ring_.blocks(),
                  {pe, band_, 0, kColours}, band_pixels(begin));
}

// Returns the number of pixels of the band that starts at `begin`; the last band may be shorter.
std::size_t NeighbourExchange::band_pixels(std::uint32_t begin) const { return std::min(band_, capacity_ - begin); }

RingFilter::RingFilter(Kernels& kernels, NeighbourExchange exchange, const Buffer<std::uint32_t>& broadcast)
    : NeighbourPass(kernels, std::move(exchange), broadcast),
      add_neighbours_(kernels.get<AddNeighboursKernel>()),
      take_means_(kernels.get<TakeMeansKernel>()),
      sums_(session_.buffer<float>("filter sums", kColours * exchange_.pes().count() * exchange_.capacity())) {
    Buffer<float> no_blocks = session_.buffer<float>("no blocks", kColours);
    launch("warm-up", add_neighbours_, {no_blocks}, no_blocks, sums_);
    take_means("warm-up", 0, sums_);
}

void RingFilter::apply(Buffer<float>& pixels) {
    const SpanLog::Span span = session_.span("filter");
    sum_two_sides(pixels, "filter.sum_rows", RAYA_LEFT, RAYA_RIGHT);
    sum_two_sides(pixels, "filter.sum_columns", RAYA_ABOVE, RAYA_BELOW);
    take_means("filter.take_means", exchange_.capacity(), pixels);
}

// Computes pixels = (pixels + neighbours on the first side) + neighbours on the second side. The rounded sum depends on
// the order, so the sides are exchanged one after the other.
void RingFilter::sum_two_sides(Buffer<float>& pixels, const std::string& label, raya_u32 first_side,
                               raya_u32 second_side) {
    session_.copy("filter.begin_sums", pixels, 0, sums_, 0, pixels.size());
    for (const raya_u32 side : {first_side, second_side})
        exchange_.visit(pixels, {side}, [&](const Arrival& arrival) {
            launch(label, add_neighbours_, arrival, arrival.blocks, sums_);
        });
    std::swap(pixels, sums_);
}

void RingFilter::take_means(const std::string& label, std::uint32_t capacity, Buffer<float>& sums) {
    session_.launch(label, take_means_, exchange_.pes().count(), group_size_, broadcast_, Uint<"capacity">{capacity},
                    Uint<"first_pe">{exchange_.pes().first()}, sums);
}

RingContrast::RingContrast(Kernels& kernels, NeighbourExchange exchange, const Buffer<std::uint32_t>& broadcast,
                           float threshold)
    : NeighbourPass(kernels, std::move(exchange), broadcast),
      threshold_(threshold),
      mark_contrasts_(kernels.get<MarkContrastsKernel>()),
      marks_(session_.buffer<std::uint8_t>("marks", std::size_t{exchange_.pes().count()} * exchange_.capacity())) {
    Buffer<float> no_blocks = session_.buffer<float>("no blocks", kColours);
    launch("warm-up", mark_contrasts_, {no_blocks}, threshold_, no_blocks, no_blocks, marks_);
}

void RingContrast::apply(const Buffer<float>& pixels) {
    session_.write("clear marks", marks_, std::vector<std::uint8_t>(marks_.size()));
    exchange_.visit(pixels, {RAYA_LEFT, RAYA_RIGHT, RAYA_ABOVE, RAYA_BELOW}, [&](const Arrival& arrival) {
        launch("supersample.compare", mark_contrasts_, arrival, threshold_, arrival.blocks, pixels, marks_);
    });
}

std::string antialias_name(AntialiasMethod method) {
    return std::array{"none", "filter", "supersample"}.at(static_cast<std::size_t>(method));
}

void check_antialias(AntialiasMethod method, const raya_mapping& mapping, bool dynamic) {
    if (dynamic && method != AntialiasMethod::kNone)
        throw UserError(
            fmt::format("--antialias {} with a dynamic or hybrid --mapping: the owner of a neighbour is only known at "
                        "run time; use cyclic, column, rows, blocks, grid or tiles",
                        antialias_name(method)));
    if (method == AntialiasMethod::kNone || mapping.kind != RAYA_RANDOM) return;
    throw UserError(fmt::format(
        "--antialias {} with --mapping {}: the neighbours of a pixel are on random PEs of the ring; use cyclic, "
        "column, rows, blocks, grid or tiles",
        antialias_name(method), mapping_text(mapping)));
}

MovesOfSides smoothing_moves(const Antialias& antialias, const raya_mapping& mapping) {
    if (antialias.method == AntialiasMethod::kNone) return {};
    return exchange_moves(mapping, antialias.exchange, antialias.method == AntialiasMethod::kSupersample);
}

SmoothingCycles smoothing_cycles(AntialiasMethod method, std::uint64_t pixels) {
    SmoothingCycles cycles;
    if (method == AntialiasMethod::kFilter) cycles.filter = filter_cycles(pixels);
    if (method == AntialiasMethod::kSupersample) cycles.compare = compare_cycles(pixels);
    return cycles;
}

std::string points_name(raya_u32 points) { return points == RAYA_POINTS_DIAGONALS ? "diagonals" : "axes"; }

}  // namespace raya
