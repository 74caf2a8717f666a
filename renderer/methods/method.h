#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include "renderer/sampling/cdf_inversion.h"
#include "renderer/sampling/sequence.h"
#include "renderer/shift_invariant/spot_settings.h"
#include "renderer/visibility/visibility.h"

namespace lumifield {

/// The ways to compute the irradiance of a diffuse, unoccluded receiver. Each has a host form in double precision
/// (host_method.h) and, but for the reference, a device's (device_method.h): in OpenCL, or of shift_invariant in
/// OpenGL.
enum class Method {
  closed_form,
  position_dependent,
  position_dependent_printed,
  uniform_box,
  precomputed_lights,
  filtered_brdf,
  mis,
  far_field,
  shift_invariant,
  reference,
};

/// What a method's cost is counted in.
enum class MethodCost { none, pixels_per_support, samples, lights };

struct MethodInfo {
  Method method;
  std::string_view name;  ///< in files, options and the window
  std::string_view what;  ///< one line for people
  MethodCost cost;
  double samples;  ///< usual, of those that take any: K per receiver, or lights in all
};

/// All of them, in the order of the enumeration.
std::span<const MethodInfo> methods();
const MethodInfo& info(Method method);
std::string_view to_string(Method method);
std::optional<Method> method_from_string(std::string_view name);
/// Its cells share nothing: one that comes is added to what there is (running_sums.h).
bool is_additive(Method method);
/// Of a method that makes a depth map of each cell for itself, whatever Visibility is asked for but none.
bool has_own_shadows(Method method);
/// What casts shadows, for people and files: the visibility's name, or "cell" by a map of each cell.
std::string_view shadows_of(Method method, Visibility visibility);
/// Its device is one of OpenCL.
bool needs_opencl(Method method);

inline constexpr double most_samples = 1e7, most_lights = 4e6;
/// Below one pixel a support a level of detail is nonsense: all that an image has of a cell would be one value.
inline constexpr double least_lod = 1;

/// What is chosen about a method. Value type.
struct MethodSettings {
  Method method = Method::closed_form;
  double lod = 0;        ///< closed form: level of detail T, pixels per support and axis; 0 is exact
  double samples = 200;  ///< K per receiver; precomputed-lights: lights in all (MethodInfo::samples)
  double k_max = 0;      ///< bound of the samples of a receiver in one cell; 0: none. Of the position-dependent alone
  std::uint32_t seed = 1;
  PointSequence sequence = PointSequence::halton;
  bool filter = true;                       ///< a lobe sample stands for a footprint, not for a ray
  Inversion inversion = Inversion::secant;  ///< in a cdf; another, or a depth, is of the host forms alone
  int depth = whole_depth;                  ///< of the search
  double memory_bytes = 0;                  ///< that tables may take on the host, or the device; 0: half of what it has
  SpotSettings spots{};                     ///< of shift-invariant alone
};

/// Whether its samples can be filtered (MethodSettings::filter).
inline bool averages_light(Method method) { return method == Method::filtered_brdf || method == Method::mis; }
/// Of a method that draws whole samples for each receiver.
inline int whole_samples(double samples) { return static_cast<int>(samples + 0.5); }

}  // namespace lumifield
