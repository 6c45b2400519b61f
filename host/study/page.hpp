// What a study has found, as plain data: from this its files, its page and its plots are made.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace raya {

using Cell = std::variant<std::string, std::int64_t, double>;

struct StudyTable {
    std::string name;  // stem of its file: "fig8" or "fig8-scenes"
    std::string title;
    std::vector<std::string> columns;     // with units: "u", "load (cycles)"
    std::vector<std::vector<Cell>> rows;  // a cell for each column
    bool on_page = true;                  // false: CSV and JSON only, for long ones
};

enum class PlotStyle {
    kLine,
    kPoints,
    kSteps,
    kPaper  // the paper's printed points, marked as such
};

struct PlotSeries {
    std::string label;
    std::vector<double> x, y;  // of one length
    PlotStyle style = PlotStyle::kLine;
};

struct StudyPlot {
    std::string name;  // stem of its files
    std::string title;
    std::string x_label, y_label;  // with units
    bool log_x = false, log_y = false;
    std::vector<PlotSeries> series{};
};

/// One figure that the paper printed, or might have, beside ours. The ratio ours / paper is made when it is written.
struct Comparison {
    std::string what;
    std::string unit;             // empty for a plain number
    std::optional<double> paper;  // empty where the paper has none
    double ours = 0;
    std::string remark;
};

struct StudyPage {
    std::string name;  // stem of its files: "fig8"
    std::string title;
    std::string question;             // what the reader wants to know, a sentence
    std::vector<std::string> method;  // how it was done, a sentence or two each
    std::vector<Comparison> comparisons;
    std::vector<StudyTable> tables;
    std::vector<StudyPlot> plots;
    std::vector<std::string> findings;  // a sentence each, the chief one first
    nlohmann::ordered_json settings;
};

}  // namespace raya
