// What a study has found, as plain data: from this its files, its page and its plots are made.
#pragma once
#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "host/base/json.hpp"

namespace raya {

/// A word, a count or a figure.
struct Cell : std::variant<std::string, std::int64_t, double> {
    Cell(std::string text) : variant(std::move(text)) {}                           // NOLINT: implicit
    Cell(const char* text) : variant(std::string(text)) {}                         // NOLINT: implicit
    Cell(std::integral auto count) : variant(static_cast<std::int64_t>(count)) {}  // NOLINT: implicit
    Cell(double value) : variant(value) {}                                         // NOLINT: implicit

    /// Of a count or a figure; std::bad_variant_access for a word.
    double number() const;
    const std::string& text() const { return std::get<std::string>(*this); }
};

/// What stands above a column, and on a plot's axis: "load (cycles)".
struct Heading {
    std::string label;      // by which tests and programs ask for the column
    std::string unit = {};  // empty for plain numbers and words
    std::string text() const { return unit.empty() ? label : label + " (" + unit + ")"; }
};

struct StudyTable {
    std::string name;  // stem of its file: "fig8" or "fig8-scenes"
    std::string title;
    std::vector<Heading> columns;
    std::vector<std::vector<Cell>> rows = {};  // a cell for each column
    bool on_page = true;                       // false: CSV and JSON only, for long ones

    /// The cell of row `row` under a label. std::out_of_range for a row or a label that there is not.
    const Cell& at(std::size_t row, const std::string& label) const;
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
    std::vector<double> half_widths = {};  // of the 95 % intervals of y, which are drawn as bars; empty: none are known
};

enum class Axes { kLinear, kLogX, kLogY, kLogBoth };

struct StudyPlot {
    std::string name;  // stem of its files
    std::string title;
    std::string x_label, y_label;  // with units
    Axes axes = Axes::kLinear;
    std::vector<PlotSeries> series = {};
};

/// An image that was rendered.
struct StudyPicture {
    std::string name;   // stem of its file
    std::string title;  // a line
    std::string words;  // what is seen, for those who do not see it
    std::string png;    // the file's bytes
};

/// Where a figure of a paper stands.
enum class Source {
    kPrinted,
    kDerived  // arithmetic on printed figures
};

/// One figure that a paper printed, or might have, beside ours. The ratio ours / paper is made when it is written.
struct Comparison {
    std::string what;
    std::string unit;             // empty for a plain number
    std::optional<double> paper;  // empty where the paper has none
    double ours = 0;
    std::string remark = {};
    Source source = Source::kPrinted;
    std::optional<double> half_width = {};  // of our 95 % interval; empty where ours is a single figure
};

enum class ClaimVerdict { kReproduced, kNotReproduced, kCannotTell };

/// What a paper says, and whether it was seen.
struct Claim {
    std::string paper;  // authors and year: one of paper.hpp
    std::string place;  // "Fig. 8"
    std::string words;  // what it says, a sentence
    ClaimVerdict verdict = ClaimVerdict::kCannotTell;
    std::string why;  // the figures that the verdict rests on, a sentence
};

/// What made a page: with it, and with the page's settings, each of its figures can be had again.
struct RunRecord {
    std::string version;                   // of raya
    std::string command;                   // that makes this page and no other
    std::string device, platform, driver;  // as OpenCL names them
};

struct StudyPage {
    std::string name;  // stem of its files: "fig8"
    std::string title;
    std::string question;                  // what the reader wants to know, a sentence
    std::vector<std::string> method = {};  // how it was done, a sentence or two each
    Json settings = {};
    std::string clock = {};  // by what times on the page are told; empty where it has none
    std::vector<Comparison> comparisons = {};
    std::vector<Claim> claims = {};
    std::vector<std::string> findings = {};  // a sentence each, the chief one first
    std::vector<StudyTable> tables = {};
    std::vector<StudyPlot> plots = {};
    std::vector<std::string> news = {};  // what no paper has, a sentence each
    std::vector<StudyPicture> pictures = {};
    std::string beside = {};  // whose figures stand in `comparisons`, as in paper.hpp; empty: nobody's
    RunRecord run = {};       // empty until a command has run the study

    /// By its name, by what is compared. std::out_of_range where there is none.
    const StudyTable& table(const std::string& name) const;
    const Comparison& comparison(const std::string& what) const;
    /// The figure of a table's row under a label.
    double value(const std::string& table_name, std::size_t row, const std::string& label) const {
        return table(table_name).at(row, label).number();
    }
};

}  // namespace raya
