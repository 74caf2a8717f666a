#pragma once

#include <cstddef>
#include <istream>
#include <string>
#include <string_view>

#include "luminaire/error.h"

namespace lumifield {

/// Reads Wavefront text line by line before a loader that is lenient about it does: takes no memory but the counts.

struct ObjCounts {
  std::size_t positions = 0, normals = 0, texture_coordinates = 0;
  std::size_t triangles = 0;  ///< after cutting polygons
};

/// Errors, each with `name:line`: a position or normal that is not three finite numbers within float's range, a face of
/// fewer than three corners, an index that is not a number or out of range, more than `max_triangles`. Reentrant.
Result<ObjCounts> check_obj(std::istream& obj, const std::string& name, std::size_t max_triangles);

/// Errors: a Kd that is not three numbers from 0 to 1. Reentrant.
Status check_mtl(std::istream& mtl, const std::string& name);

}  // namespace lumifield
