#pragma once

#include <span>
#include <string>

#include "luminaire/light_field.h"
#include "renderer/shift_invariant/spot_settings.h"
#include "renderer/visibility/shadow_plan.h"

namespace lumifield {

/// What tells a receiver's shadows.
enum class SpotShadow { none, maps, tiles };

/// What a program is made for.
struct SpotVariant {
  int cells = 1;  ///< of a pass
  SpotShadow shadow = SpotShadow::none;
  bool glossy = false;
  bool operator==(const SpotVariant&) const = default;
};

/// A cell of a pass.
struct SpotCell {
  CellIndex index;
  double sign = 1;    ///< −1 takes away, 0 is none
  ShadowView view{};  ///< of its depth map
  double kept = 1;    ///< of a receiver's depth, for the bias
};

/// The pass's textures, by unit.
struct SpotUnits {
  static constexpr int positions = 0, normals = 1, images = 2, faces = 3, depths = 4, lobe_eyes = 5, lobe_colours = 6,
                       irradiance_before = 7, radiance_before = 8;
};
/// Its buffers, by binding.
struct SpotBindings {
  static constexpr int receivers = 0, words = 1;
};

/// The lighting pass of shift-invariant as a program of OpenGL: some cells onto all receivers. Thread-bound to the
/// context that is current when it is made.
class SpotProgram {
 public:
  /// Errors: the driver's.
  static Result<SpotProgram> create(const LuminaireGeometry& geometry, const SpotSettings& settings,
                                    const SpotVariant& variant);
  SpotProgram(SpotProgram&& other) noexcept;
  SpotProgram& operator=(SpotProgram&& other) noexcept;
  ~SpotProgram();

  const SpotVariant& variant() const { return variant_; }
  /// Draws one pass of as many cells as the variant has into what is bound; `columns` of receivers.
  void draw(std::span<const SpotCell> cells, int columns);

 private:
  SpotProgram(const LuminaireGeometry& geometry, const SpotSettings& settings, const SpotVariant& variant)
      : geometry_(geometry), settings_(settings), variant_(variant) {}
  int at(const char* name) const;
  void set_luminaire() const;
  void set_textures() const;
  void set_cells(std::span<const SpotCell> cells) const;

  LuminaireGeometry geometry_;
  SpotSettings settings_;
  SpotVariant variant_;
  unsigned program_ = 0, vertices_ = 0;
};

}  // namespace lumifield
