// The studies of the load laboratory: one function each, and the list from which `raya study` makes its commands.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "study/laboratory.hpp"
#include "study/page.hpp"

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

}  // namespace raya
