#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

namespace lumifield {

/// Lines of comma-separated values, without quotes. Reentrant; what is returned points into the text.

/// Without spaces, tabs and carriage returns at either end.
std::string_view trimmed(std::string_view text);

/// The fields of a line, trimmed; of a line with more than `most` fields the first `most` + 1.
std::vector<std::string_view> csv_fields(std::string_view line, std::size_t most);

}  // namespace lumifield
