#pragma once

#include <QString>
#include <string_view>
#include <vector>

#include "luminaire/light_field.h"

namespace lumifield {

/// A number for people, `digits` significant: "0.0123", "1.2·10⁻⁵", "12 300"; NaN: "not known".
QString value_text(double value, int digits = 3);

/// A unit as it is written, "W/(m² sr)" for "W/(m^2 sr)".
QString unit_text(std::string_view unit);

/// Unit of C_m, the dataset's per mm²: "cd/m² per mm²".
QString cell_unit_text(Quantity quantity);

/// At most `most` round values (1, 2 or 5 times a power of ten apart) within [least, largest], ascending.
std::vector<double> axis_ticks(double least, double largest, int most);

/// The decades within [least, largest], at most `most` of them. Both ends positive.
std::vector<double> decade_ticks(double least, double largest, int most);

}  // namespace lumifield
