#include "renderer/methods/method.h"

#include <algorithm>
#include <array>

namespace lumifield {

namespace {

constexpr std::array all{
    MethodInfo{Method::closed_form, "closed-form", "exact sum over the pixels of every cell, or over coarser ones",
               MethodCost::pixels_per_support, 0},
    MethodInfo{Method::position_dependent, "position-dependent",
               "samples of the cells' images within what each receiver sees (Lu 2015, corrected)", MethodCost::samples,
               200},
    MethodInfo{Method::position_dependent_printed, "position-dependent-printed",
               "the same as published: biased, kept to show by how much; takes no pixel below 0, which scans have",
               MethodCost::samples, 200},
    MethodInfo{Method::uniform_box, "uniform-box", "as many uniform samples in the support of each cell",
               MethodCost::samples, 200},
    MethodInfo{Method::precomputed_lights, "precomputed-lights",
               "light samples of the whole luminaire, the same for all receivers", MethodCost::lights, 10'000},
    MethodInfo{Method::filtered_brdf, "filtered-brdf",
               "samples of what each surface reflects, so many of its lobe and of its diffuse part, of averaged light "
               "(Colbert 2007)",
               MethodCost::samples, 200},
    MethodInfo{Method::mis, "mis",
               "light samples and samples of what each surface reflects, weighed against each other (Veach 1995)",
               MethodCost::samples, 200},
    MethodInfo{Method::far_field, "far-field", "the luminaire as a point with an intensity distribution",
               MethodCost::none, 0},
    MethodInfo{Method::shift_invariant, "shift-invariant",
               "a textured spotlight at the centre of each cell, by OpenGL (Granier 2003): a fast preview",
               MethodCost::none, 0},
    MethodInfo{Method::reference, "reference",
               "closed-form in double precision on the host, exact: what kernels are judged by", MethodCost::none, 0},
};

}  // namespace

std::span<const MethodInfo> methods() { return all; }

const MethodInfo& info(Method method) { return all[static_cast<std::size_t>(method)]; }

std::string_view to_string(Method method) { return info(method).name; }

std::optional<Method> method_from_string(std::string_view name) {
  const auto found = std::ranges::find(all, name, &MethodInfo::name);
  return found == all.end() ? std::nullopt : std::optional(found->method);
}

bool has_own_shadows(Method method) { return method == Method::shift_invariant; }

std::string_view shadows_of(Method method, Visibility visibility) {
  return visibility != Visibility::none && has_own_shadows(method) ? "cell" : to_string(visibility);
}

bool is_additive(Method method) { return method == Method::closed_form || method == Method::shift_invariant; }

bool needs_opencl(Method method) { return method != Method::shift_invariant && method != Method::reference; }

}  // namespace lumifield
