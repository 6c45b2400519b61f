#include "host/ring/turns.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <bit>
#include <numeric>
#include <utility>

#include "host/error.hpp"

namespace raya {
namespace {

constexpr std::uint32_t kSlotAlignment = 16;  // maximum number of lanes

using Words = std::vector<std::uint32_t>;

// Returns the words of the part that consists of the objects `begin` to `end` - 1.
Words part_of(const PackedJob& job, std::uint32_t begin, std::uint32_t end) {
    Words words, numbers(end - begin);
    std::iota(numbers.begin(), numbers.end(), begin);
    ObjectCopier copier(job, words, kWordsOf<raya_part>);
    copier.append_surfaces(numbers);
    copier.fill_row();
    raya_part part{};
    part.objects = copier.append_objects(numbers);
    copier.fill_row();
    part.first = begin;
    copier.put(0, part);
    return words;
}

Words base_of(const PackedJob& job) {
    raya_job header = job.header();
    const auto lights = job.words().begin() + header.lights_at;
    Words base(kWordsOf<raya_job>);
    header.lights_at = kWordsOf<raya_job>;
    base.insert(base.end(), lights, lights + std::ptrdiff_t{header.lights} * RAYA_LIGHT_WORDS);
    base.resize(padded_to_rows(base.size()));
    put_record(base, 0, header);
    return base;
}

constexpr std::uint32_t kMaxDividedLights = 32;  // `meet` marks blocked shadow rays in a word

StoredScene store_in_parts(const PackedJob& job, const RingSettings& settings, const std::string& scene,
                           std::uint32_t parts) {
    StoredScene stored;
    if (parts > 1) stored.parts = divide_objects(job, parts);
    PeDemand demand = pe_demand(settings, scene, stored.words(job).size());
    demand.parts = parts;
    if (stored.parts) demand.part_words = stored.parts->part_words;
    demand.divisible = parts < settings.mapping.pes && settings.accel.kind == AccelKind::kNone && !settings.dynamic;
    stored.memory = plan_pe_memory(settings.machine, demand);
    return stored;
}

}  // namespace

ObjectParts divide_objects(const PackedJob& job, std::uint32_t parts) {
    ObjectParts divided{.base = base_of(job), .words = {}, .parts = parts};
    const std::uint64_t objects = raya_first_object(job.header().objects, RAYA_OBJECT_KINDS);
    std::vector<Words> packed;
    for (std::uint64_t i = 0; i < parts; ++i) {
        packed.push_back(part_of(job, static_cast<std::uint32_t>(objects * i / parts),
                                 static_cast<std::uint32_t>(objects * (i + 1) / parts)));
        divided.part_words = std::max(divided.part_words, static_cast<std::uint32_t>(packed.back().size()));
    }
    for (Words& part : packed) {
        part.resize(divided.part_words);
        divided.words.insert(divided.words.end(), part.begin(), part.end());
    }
    return divided;
}

StoredScene store_scene(const PackedJob& job, const RingSettings& settings, const std::string& scene) {
    const std::uint32_t pes = settings.mapping.pes, lights = job.header().lights;
    if (settings.split > 1 && lights > kMaxDividedLights)
        throw UserError(
            fmt::format("{}: --split {} with {} lights: at most {} are supported; use --split 1 or fewer "
                        "lights",
                        scene, settings.split, lights, kMaxDividedLights));
    if (settings.split > 0 || settings.accel.kind != AccelKind::kNone || settings.dynamic || lights > kMaxDividedLights)
        return store_in_parts(job, settings, scene, std::max(settings.split, 1u));
    for (std::uint32_t parts = 1;; ++parts) try {
            if (pes % parts == 0) return store_in_parts(job, settings, scene, parts);
        } catch (const DoesNotFit&) {
            if (parts == pes) throw;
        }
}

Turns::Turns(Kernels& kernels, Communication& communication, const Distribution& pes, std::uint32_t capacity,
             const ObjectParts& parts, std::uint32_t slots)
    : SampleTracer(kernels, kernels.program(AdvanceKernel::kFile).options(), pes, capacity),
      parts_(parts),
      communication_(communication),
      slots_(slots),
      stride_((slots + kSlotAlignment - 1) / kSlotAlignment * kSlotAlignment),
      ring_(session_, communication, pes, 1, parts.part_words),
      advance_(kernels.get<AdvanceKernel>()),
      meet_(kernels.get<MeetKernel>()),
      state_(session_.buffer<std::uint32_t>(
          "trees in flight", std::size_t{pes.count()} * stride_ * (raya_flight_words(options_.bounces) + RAYA_EVENTS))),
      spent_(session_.buffer<std::uint64_t>("cycles of a turn",
                                            std::size_t{parts.parts + 1} * pes.count() * options_.group_size)) {}

void Turns::load_parts(std::uint64_t rotations) {
    std::vector<float> blocks;
    blocks.reserve(std::size_t{pes_.count()} * parts_.part_words);
    const std::uint64_t behind = parts_.parts - rotations % parts_.parts;
    for (const std::uint32_t pe : pes_.own())
        for (const std::uint32_t word : parts_.part(static_cast<std::uint32_t>((pe + behind) % parts_.parts)))
            blocks.push_back(std::bit_cast<float>(word));
    session_.write("bus.broadcast parts", ring_.blocks(), blocks);
}

void Turns::broadcast_parts() {
    load_parts(0);
    in_flight_ = false;
    communication_.broadcasts += parts_.parts;
    communication_.broadcast_words += parts_.words.size();
}

void Turns::visit_state(RenderState& state, std::uint64_t turns) {
    state.buffer(progress_);
    state.buffer(state_);
    if (!state.restores()) return;
    load_parts(turns * (parts_.parts - 1));
    in_flight_ = true;
}

void Turns::start(const TracePass& pass) {
    reset_progress(pass);
    session_.write(pass.label, state_, std::vector<std::uint32_t>(state_.size()));
}

void Turns::warm_up(const TracePass& pass) {
    start(pass);
    load_parts(0);
    advance(pass, true);
    meet(pass, 1);
}

void Turns::trace(const TracePass& pass, const ProgressCallback& progress) {
    std::vector<std::uint64_t>& turn_cycles = pass.counters.turn_cycles;
    bool fresh = !std::exchange(in_flight_, false);
    if (fresh) start(pass);
    for (;; fresh = false) {
        double done = 0;
        advance(pass, fresh);
        const LaunchEnd ended = read_progress(pass, [&](double fraction) { done = fraction; });
        if (ended.truncated) throw truncated_loops_error(pass.label, session_.device().name, "a larger --split");
        if (progress) progress(done);
        const std::vector<std::uint32_t> left = pes_.ranks().all_gather(std::uint32_t{!ended.done});
        const bool ends = std::count(left.begin(), left.end(), 1u) == 0;
        for (std::uint32_t step = 0; step < parts_.parts && !ends; ++step) {
            if (step > 0) ring_.rotate(RingDirection::kUp);
            meet(pass, step + 1);
        }
        const std::uint64_t cycles = barrier_cycles(pass.label, ends ? 1 : parts_.parts + 1);
        if (!ends)
            turn_cycles.push_back(cycles);
        else if (!turn_cycles.empty())
            turn_cycles.back() += cycles;  // the lights of the last hits
        if (ends) return;
        if (after_turn_) after_turn_(done);
    }
}

void Turns::advance(const TracePass& pass, bool fresh) {
    session_.launch(pass.label, advance_, pes_.count(), options_.group_size, pass.job,
                    Uint<"word_count">{cl_uint(pass.job.size())}, Uint<"window_start">{pass.range.window_start},
                    Uint<"capacity">{capacity_}, Uint<"end">{pass.range.end}, Uint<"points">{pass.points},
                    Uint<"first_pe">{pes_.first()}, Uint<"slots">{slots_}, Uint<"stride">{stride_},
                    Uint<"fresh">{fresh}, pass.marks, LocalMemory<raya_trace_progress>{1}, local_words(pass.job.size()),
                    pass.pixels, pass.counters.cycles, pass.counters.events, progress_, state_, spent_);
}

void Turns::meet(const TracePass& pass, std::uint32_t step) {
    session_.launch(pass.label, meet_, pes_.count(), options_.group_size, pass.job,
                    Uint<"word_count">{cl_uint(pass.job.size())}, ring_.blocks(),
                    Uint<"part_words_count">{parts_.part_words}, Uint<"slots">{slots_}, Uint<"stride">{stride_},
                    Uint<"step">{step}, local_words(pass.job.size() + parts_.part_words), progress_, state_, spent_);
}

std::uint64_t Turns::barrier_cycles(const std::string& label, std::uint32_t steps) {
    const std::size_t per_pe = options_.group_size, per_step = pes_.count() * per_pe;
    std::vector<std::uint64_t> spent(steps * per_step), busiest(steps);
    session_.read(label, spent_, spent);
    for (std::size_t n = 0; n < spent.size(); n += per_pe) {
        std::uint64_t& most = busiest[n / per_step];
        most = std::max(most, sum_of(std::span(spent).subspan(n, per_pe)));
    }
    const std::vector<std::uint64_t> all = pes_.ranks().all_gather(std::span<const std::uint64_t>(busiest));
    for (std::size_t n = 0; n < all.size(); ++n) busiest[n % steps] = std::max(busiest[n % steps], all[n]);
    return sum_of(busiest);
}

}  // namespace raya
