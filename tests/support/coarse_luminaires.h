#pragma once

#include "luminaire/light_field.h"

namespace lumifield {

/// A luminaire as a level of detail has it, written down from the definition: images of means over 2^level×2^level
/// pixels, those beyond the image counted as 0. Shares no code with the renderer.

/// The same luminaire with whole numbers in its images, of which the means below are exact in float.
LightField whole_numbers(const LightField& field);

/// Images of the means, on coarser pixels with the same corner.
LightField mean_luminaire(const LightField& field, int level);

/// Images of max(C_max − C̄, C̄ − C_min), C the values whose mean C̄ is: its irradiance bounds the error of the mean.
LightField deviation_luminaire(const LightField& field, int level);

/// The level of detail at which a support spans at most `pixels_per_support` pixels an axis; 0 where that is 0.
int expected_level(const LuminaireGeometry& geometry, double p_z_mm, double pixels_per_support);

}  // namespace lumifield
