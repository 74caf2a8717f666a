#pragma once

#include "luminaire/light_field.h"
#include "renderer/methods/method.h"

namespace lumifield {

/// What a method makes on the host beside the cells, bytes: summed-area tables of their importance for
/// position-dependent, and cdfs of it too as printed; of precomputed-lights, its kernel's too, the lights and the
/// tables of one cell, which are not kept; of filtered-brdf and mis the tables of directions; of the closed form |C|,
/// and levels of detail. `cells`: measured ones.
double host_table_bytes(const LuminaireGeometry& geometry, const MethodSettings& settings, int cells);
/// Of these the tables of directions, which kernels have too; 0 of methods that draw none.
double lobe_table_bytes(const MethodSettings& settings);

/// Refuses tables that take more than the settings allow, or by these half of `memory_bytes`. To be asked before any is
/// taken. Reentrant.
Status check_table_memory(const MethodSettings& settings, double table_bytes, double memory_bytes);

/// Of this machine, bytes.
double host_memory_bytes();

}  // namespace lumifield
