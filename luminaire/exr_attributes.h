#pragma once

#include <string_view>

namespace lumifield {

/// Whether every attribute of an OpenEXR header is as long as its type says and lies within `bytes`, internal to this
/// room. The library takes memory by an attribute's own word, and reads on in the wrong place after one of a wrong
/// length; so files are walked first. True says nothing about the attributes' values.
bool exr_attributes_fit(std::string_view bytes);

}  // namespace lumifield
