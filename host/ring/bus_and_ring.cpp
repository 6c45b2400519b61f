#include "host/ring/bus_and_ring.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <utility>

#include "host/error.hpp"
#include "host/model/budget.hpp"

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

namespace {

constexpr std::size_t kColours = 3;

}  // namespace

NeighbourExchange::NeighbourExchange(Session& session, Communication& communication, const raya_mapping& mapping,
                                     std::uint32_t capacity, std::uint32_t band, ExchangeMethod method,
                                     const Distribution& pes)
    : pes_(mapping.pes),
      capacity_(capacity),
      band_(band),
      method_(method),
      ring_(session, communication, pes, kColours, band),
      bus_(session, communication, pes) {
    for (raya_u32 side = 0; side < RAYA_SIDES; ++side) distances_[side] = neighbour_distances(mapping, side);
    if (method == ExchangeMethod::kBroadcast)
        broadcast_blocks_ = session.buffer<float>("blocks that were broadcast", std::size_t{pes_} * kColours * band);
}

void NeighbourExchange::visit(const Buffer<float>& pixels, std::initializer_list<raya_u32> sides,
                              const ArrivalCallback& on_arrival) {
    for (std::uint32_t begin = 0; begin < capacity_; begin += band_) {
        if (method_ == ExchangeMethod::kBroadcast) exchange_by_broadcast(pixels, sides, begin, on_arrival);
        for (const raya_u32 side : sides) {
            if (method_ == ExchangeMethod::kRing) exchange_by_rotation(pixels, side, begin, on_arrival);
            if (method_ == ExchangeMethod::kBus) exchange_by_transfers(pixels, side, begin, on_arrival);
        }
    }
}

// Rotates the ring along the shortest route, and reports an arrival at each stop.
void NeighbourExchange::exchange_by_rotation(const Buffer<float>& pixels, raya_u32 side, std::uint32_t begin,
                                             const ArrivalCallback& on_arrival) {
    for (const Leg& leg : shortest_route(pes_, distances_[side])) {
        ring_.load(pixels, capacity_, begin);
        std::uint32_t rotations = 0;
        for (const std::uint32_t stop : leg.stops) {
            for (; rotations < stop; ++rotations) ring_.rotate(leg.direction);
            on_arrival({ring_.blocks(), side, leg.direction == RingDirection::kDown ? stop : pes_ - stop, begin});
        }
    }
}

// For each distance, sends the block of PE (i + distance) mod P over the bus to each PE i.
void NeighbourExchange::exchange_by_transfers(const Buffer<float>& pixels, raya_u32 side, std::uint32_t begin,
                                              const ArrivalCallback& on_arrival) {
    for (const std::uint32_t distance : distances_[side]) {
        if (distance == 0) ring_.load(pixels, capacity_, begin);
        for (std::size_t pe = 0; distance > 0 && pe < pes_; ++pe)
            bus_.send(pixels, {(pe + distance) % pes_, capacity_, begin, kColours}, ring_.blocks(),
                      {pe, band_, 0, kColours}, band_pixels(begin));
        on_arrival({ring_.blocks(), side, distance, begin});
    }
}

// Broadcasts the block of each PE in turn. Broadcasts nothing if every PE itself owns all its pixels' neighbours.
void NeighbourExchange::exchange_by_broadcast(const Buffer<float>& pixels, std::initializer_list<raya_u32> sides,
                                              std::uint32_t begin, const ArrivalCallback& on_arrival) {
    const bool any_distant = std::ranges::any_of(
        sides, [&](raya_u32 side) { return !distances_[side].empty() && distances_[side].back() > 0; });
    for (std::size_t pe = 0; any_distant && pe < pes_; ++pe)
        bus_.broadcast_from(pixels, {pe, capacity_, begin, kColours}, *broadcast_blocks_, {pe, band_, 0, kColours},
                            band_pixels(begin));
    for (const raya_u32 side : sides)
        for (const std::uint32_t distance : distances_[side]) {
            distance == 0 ? ring_.load(pixels, capacity_, begin) : ring_.take(*broadcast_blocks_, distance);
            on_arrival({ring_.blocks(), side, distance, begin});
        }
}

// Returns the number of pixels of the band that starts at `begin`; the last band may be shorter.
std::size_t NeighbourExchange::band_pixels(std::uint32_t begin) const { return std::min(band_, capacity_ - begin); }

RingFilter::RingFilter(Kernels& kernels, const ExchangeSetup& setup)
    : session_(kernels.session()),
      group_size_(kernels.options().group_size),
      setup_(setup),
      add_neighbours_(kernels.get<AddNeighboursKernel>()),
      take_means_(kernels.get<TakeMeansKernel>()),
      sums_(session_.buffer<float>("filter sums", 3ull * setup.pes.count() * setup.capacity)) {
    Buffer<float> no_blocks = session_.buffer<float>("no blocks", 3);
    add_neighbours("warm-up", {no_blocks, RAYA_LEFT, 0, 0}, 0, 0);
    session_.launch("warm-up", take_means_, setup.pes.count(), group_size_, setup.broadcast, Uint<"capacity">{0},
                    Uint<"first_pe">{0}, sums_);
}

void RingFilter::apply(Buffer<float>& pixels, NeighbourExchange& exchange) {
    const SpanLog::Span span = session_.span("filter");
    sum_two_sides(pixels, exchange, "filter.sum_rows", RAYA_LEFT, RAYA_RIGHT);
    sum_two_sides(pixels, exchange, "filter.sum_columns", RAYA_ABOVE, RAYA_BELOW);
    session_.launch("filter.take_means", take_means_, setup_.pes.count(), group_size_, setup_.broadcast,
                    Uint<"capacity">{setup_.capacity}, Uint<"first_pe">{setup_.pes.first()}, pixels);
}

// Computes pixels = (pixels + neighbours on the first side) + neighbours on the second side. The rounded sum depends on
// the order, so the sides are exchanged one after the other.
void RingFilter::sum_two_sides(Buffer<float>& pixels, NeighbourExchange& exchange, const std::string& label,
                               raya_u32 first_side, raya_u32 second_side) {
    session_.copy("filter.begin_sums", pixels, 0, sums_, 0, pixels.size());
    for (const raya_u32 side : {first_side, second_side})
        exchange.visit(pixels, {side}, [&](const Arrival& arrival) {
            add_neighbours(label, arrival, exchange.band(), setup_.capacity);
        });
    std::swap(pixels, sums_);
}

void RingFilter::add_neighbours(const std::string& label, const Arrival& arrival, std::uint32_t band,
                                std::uint32_t capacity) {
    session_.launch(label, add_neighbours_, setup_.pes.count(), group_size_, setup_.broadcast,
                    Uint<"side">{arrival.side}, Uint<"distance">{arrival.distance}, Uint<"begin">{arrival.begin},
                    Uint<"band">{band}, Uint<"capacity">{capacity}, Uint<"first_pe">{setup_.pes.first()},
                    arrival.blocks, sums_);
}

RingContrast::RingContrast(Kernels& kernels, const ExchangeSetup& setup, float threshold)
    : session_(kernels.session()),
      group_size_(kernels.options().group_size),
      setup_(setup),
      threshold_(threshold),
      mark_contrasts_(kernels.get<MarkContrastsKernel>()),
      marks_(session_.buffer<std::uint8_t>("marks", std::size_t{setup.pes.count()} * setup.capacity)) {
    Buffer<float> no_blocks = session_.buffer<float>("no blocks", 3);
    mark_contrasts("warm-up", {no_blocks, RAYA_LEFT, 0, 0}, 0, 0, no_blocks);
}

void RingContrast::apply(const Buffer<float>& pixels, NeighbourExchange& exchange) {
    session_.write("clear marks", marks_, std::vector<std::uint8_t>(marks_.size()));
    exchange.visit(pixels, {RAYA_LEFT, RAYA_RIGHT, RAYA_ABOVE, RAYA_BELOW}, [&](const Arrival& arrival) {
        mark_contrasts("supersample.compare", arrival, exchange.band(), setup_.capacity, pixels);
    });
}

void RingContrast::mark_contrasts(const std::string& label, const Arrival& arrival, std::uint32_t band,
                                  std::uint32_t capacity, const Buffer<float>& pixels) {
    session_.launch(label, mark_contrasts_, setup_.pes.count(), group_size_, setup_.broadcast,
                    Uint<"side">{arrival.side}, Uint<"distance">{arrival.distance}, Uint<"begin">{arrival.begin},
                    Uint<"band">{band}, Uint<"capacity">{capacity}, Uint<"first_pe">{setup_.pes.first()}, threshold_,
                    arrival.blocks, pixels, marks_);
}

namespace {

// Names of the methods, in the order of AntialiasMethod.
constexpr std::array<const char*, 3> kMethods = {"none", "filter", "supersample"};

}  // namespace

std::string antialias_name(AntialiasMethod method) { return kMethods.at(static_cast<std::size_t>(method)); }

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
