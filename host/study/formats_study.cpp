#include "host/study/formats_study.hpp"

#include <algorithm>
#include <memory>

#include "host/embedded.hpp"
#include "host/ring/mapping.hpp"
#include "host/scene/nff_reader.hpp"
#include "tests/reference/reference.hpp"

namespace raya {
namespace {

// Steps that are done, of those there are.
class Steps {
  public:
    Steps(std::size_t all, const ProgressCallback& progress) : all_(all), progress_(progress) {}

    void done() {
        ++done_;
        if (progress_) progress_(static_cast<double>(done_) / static_cast<double>(all_));
    }

  private:
    std::size_t all_, done_ = 0;
    const ProgressCallback& progress_;
};

RingSettings ring_settings(const FormatsSettings& settings) {
    RingSettings ring;
    ring.machine = machine_named("grande");
    ring.mapping = make_mapping(cyclic_mapping(ring.machine.mapping.parameter % std::max(settings.width, 1u)),
                                {settings.width, settings.height}, settings.width);
    ring.bounces = ring.machine.bounces;
    ring.kernels.lanes = settings.lanes;
    return ring;
}

// Renderers for one scene, fp32's first.
std::vector<std::unique_ptr<RingRenderer>> make_renderers(Session& session, const Scene& scene, RingSettings ring,
                                                          const std::vector<NumberFormat>& formats, Steps& steps) {
    std::vector<std::unique_ptr<RingRenderer>> renderers;
    for (const NumberFormat& format : formats) {
        ring.format = format;
        renderers.push_back(std::make_unique<RingRenderer>(session, scene, ring));
        steps.done();
    }
    return renderers;
}

// What a first render tells of a format.
FormatRow first_row(const NumberFormat& format, const reference::Image& expected, const RingResult& result) {
    return {format, image_difference(expected.pixels, result.image.rgb, kShownStep), pixel_hash(result.image),
            trace_seconds(result), 0};
}

SceneRows study_scene(Session& session, const LabelledScene& labelled, const RingSettings& ring,
                      const std::vector<NumberFormat>& formats, FormatsStudy& study, Steps& steps) {
    const reference::Image expected = reference::render(labelled.scene, {.width = static_cast<int>(study.width),
                                                                         .height = static_cast<int>(study.height),
                                                                         .bounces = static_cast<int>(study.bounces)});
    steps.done();
    const auto renderers = make_renderers(session, labelled.scene, ring, formats, steps);
    SceneRows scene{labelled.label, labelled.scene.object_count(), {}};
    for (int sample = 0; sample < study.samples; ++sample)
        for (std::size_t i = 0; i < formats.size(); ++i) {
            const RingResult result = renderers[i]->render();
            study.lanes = result.lanes;
            study.group_size = result.group_size;
            if (sample == 0) scene.rows.push_back(first_row(formats[i], expected, result));
            scene.rows[i].kernel_s = std::min(scene.rows[i].kernel_s, trace_seconds(result));
            steps.done();
        }
    for (FormatRow& row : scene.rows) row.ratio_to_fp32 = row.kernel_s / scene.rows.front().kernel_s;
    return scene;
}

}  // namespace

std::vector<NumberFormat> reduced_formats() {
    std::vector<NumberFormat> formats;
    for (const char* name : {"e8m21", "e8m18", "e8m15", "e7m15", "e6m15", "e6m14", "e6m13"})
        for (const bool truncates : {false, true}) {
            formats.push_back(parse_format(name));
            formats.back().truncates = truncates;
        }
    return formats;
}

FormatsStudy run_formats_study(Session& session, const std::vector<LabelledScene>& scenes,
                               const FormatsSettings& settings, const ProgressCallback& progress) {
    const RingSettings ring = ring_settings(settings);
    std::vector<NumberFormat> formats = {NumberFormat{}};
    formats.insert(formats.end(), settings.formats.begin(), settings.formats.end());

    FormatsStudy study{.width = settings.width,
                       .height = settings.height,
                       .bounces = ring.bounces,
                       .machine = ring.machine.name,
                       .pes = ring.mapping.pes,
                       .offset = ring.mapping.parameter,
                       .device = session.device(),
                       .samples = settings.samples,
                       .scenes = {}};
    const std::size_t steps_of_scene = 1 + formats.size() * (1 + static_cast<std::size_t>(settings.samples));
    Steps steps(scenes.size() * steps_of_scene, progress);
    for (const LabelledScene& scene : scenes)
        study.scenes.push_back(study_scene(session, scene, ring, formats, study, steps));
    return study;
}

}  // namespace raya
