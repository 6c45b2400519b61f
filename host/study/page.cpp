#include "host/study/page.hpp"

#include <algorithm>
#include <stdexcept>

namespace raya {
namespace {

template <class T>
const T& found(const std::vector<T>& items, std::string T::*name, const std::string& wanted) {
    const auto at = std::ranges::find(items, wanted, name);
    if (at == items.end()) throw std::out_of_range("there is no '" + wanted + "'");
    return *at;
}

}  // namespace

double Cell::number() const {
    if (const auto* count = std::get_if<std::int64_t>(this)) return static_cast<double>(*count);
    return std::get<double>(*this);
}

const Cell& StudyTable::at(std::size_t row, const std::string& label) const {
    const Heading& column = found(columns, &Heading::label, label);
    return rows.at(row).at(static_cast<std::size_t>(&column - columns.data()));
}

const StudyTable& StudyPage::table(const std::string& wanted) const { return found(tables, &StudyTable::name, wanted); }

const Comparison& StudyPage::comparison(const std::string& what) const {
    return found(comparisons, &Comparison::what, what);
}

}  // namespace raya
