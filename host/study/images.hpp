// Column split and cyclic mapping over many images, as a function of their cost images.
#pragma once
#include <vector>

#include "host/study/laboratory.hpp"
#include "host/study/page.hpp"

namespace raya {

/// `images`: one at least, of `pes` columns or more, in the order of the table.
StudyPage images_page(std::uint32_t pes, const std::vector<const Costs*>& images);

}  // namespace raya
