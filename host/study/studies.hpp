// The studies of the load laboratory: one function each, and the list from which `raya study` makes its commands.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "host/study/laboratory.hpp"
#include "host/study/page.hpp"

namespace raya {

/// A study by name. `scenes` are those that the user named; empty: the study's own.
struct Study {
    std::string name, summary;
    bool one_scene;  // takes the first of several
    StudyPage (*run)(Laboratory& laboratory, const std::vector<LabelledScene>& scenes);
};

/// In the order in which they tell the story.
std::span<const Study> studies();

// Kohata & Ito 1993, figure by figure and table by table.
StudyPage study_fig7(Laboratory&, const std::vector<LabelledScene>&);    // load of each PE, p = 0 and 16
StudyPage study_fig8(Laboratory&, const std::vector<LabelledScene>&);    // u against p
StudyPage study_fig9(Laboratory&, const std::vector<LabelledScene>&);    // speed-up against P
StudyPage study_table2(Laboratory&, const std::vector<LabelledScene>&);  // times, and this machine's beside them
StudyPage study_table3(Laboratory&, const std::vector<LabelledScene>&);  // the filter
StudyPage study_table4(Laboratory&, const std::vector<LabelledScene>&);  // supersampling
StudyPage study_fig12(Laboratory&, const std::vector<LabelledScene>&);   // load of each PE in supersampling
StudyPage study_fig13(Laboratory&, const std::vector<LabelledScene>&);   // u against p in supersampling
StudyPage study_images(Laboratory&, const std::vector<LabelledScene>&);  // ten scenes, two sizes

// Beyond the paper.
StudyPage study_lattice(Laboratory&, const std::vector<LabelledScene>&);            // offsets beyond sqrt(P)
StudyPage study_scale(Laboratory&, const std::vector<LabelledScene>&);              // P = 2^4..2^20
StudyPage study_static_vs_dynamic(Laboratory&, const std::vector<LabelledScene>&);  // Heirich & Arvo's claim
StudyPage study_best_offset(Laboratory&, const std::vector<LabelledScene>&);        // p for the user's scene

// Voxels in one machine.
StudyPage study_divisions(Laboratory&, const std::vector<LabelledScene>&);  // Yoshitani & Yamazaki's Fig. 3
StudyPage study_havran(Laboratory&, const std::vector<LabelledScene>&);     // tests and steps a ray, Havran & Sixta

// The torus machine: Yoshitani & Yamazaki, and beyond.
StudyPage study_objects(Laboratory&, const std::vector<LabelledScene>&);  // Fig. 4: time against objects
StudyPage study_nodes(Laboratory&, const std::vector<LabelledScene>&);    // 1..4096 nodes
StudyPage study_inject(Laboratory&, const std::vector<LabelledScene>&);   // the root makes all primary rays, or all do
StudyPage study_hybrid(Laboratory&, const std::vector<LabelledScene>&);   // groups share the screen

}  // namespace raya
