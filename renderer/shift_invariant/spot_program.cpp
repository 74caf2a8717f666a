#include "renderer/shift_invariant/spot_program.h"

#include <cmath>
#include <cstdio>
#include <epoxy/gl.h>
#include <functional>
#include <utility>

#include "renderer/opengl/gl_objects.h"
#include "renderer/shift_invariant/spot_images.h"
#include "renderer/shift_invariant/spot_shaders.h"
#include "renderer/visibility/tile_grid.h"

namespace lumifield {

namespace {

/// A list of GLSL of one number of each of the basis' pieces.
std::string list_of(const Basis& basis, const std::function<double(const Basis::Piece&)>& number) {
  std::string text;
  for (const Basis::Piece& piece : basis.pieces()) {
    char one[40];
    std::snprintf(one, sizeof one, "%.9e", number(piece));
    text += (text.empty() ? "" : ", ") + std::string(one);
  }
  return text;
}

/// Where φ is 0 at an end of the support, that is its origin, so that it keeps its digits there.
double origin_of(const Basis& basis, const Basis::Piece& piece) {
  if (basis.pieces().size() == 1) return 0;
  const double half = basis.half_support();
  return piece.begin == -half ? -half : piece.end == half ? half : 0;
}

std::string basis_defines(const Basis& basis) {
  using Piece = Basis::Piece;
  const auto define = [&](const char* name, const std::function<double(const Piece&)>& number) {
    return "#define " + std::string(name) + " " + list_of(basis, number) + "\n";
  };
  const auto origin = [&](const Piece& p) { return origin_of(basis, p); };
  return "#define PIECES " + std::to_string(basis.pieces().size()) + "\n" +
         define("BEGINS", [](const Piece& p) { return p.begin; }) +
         define("ENDS", [](const Piece& p) { return p.end; }) + define("ORIGINS", origin) +
         define("C0", [&](const Piece& p) { return p(origin(p)); }) +
         define("C1", [&](const Piece& p) { return p.c[1] + 2 * p.c[2] * origin(p); }) +
         define("C2", [](const Piece& p) { return p.c[2]; });
}

SpotLayout layout_of(const LuminaireGeometry& geometry, const SpotSettings& settings) {
  return {geometry.measurement.width_px, geometry.measurement.height_px, settings.look_up == SpotLookUp::textured};
}

std::string add_all(int cells) {
  std::string text;
  for (int k = 0; k < cells; ++k) text += "add(r, face, eye, lobe, no, " + std::to_string(k) + "); ";
  return text + "\n";
}

std::string head_of(const LuminaireGeometry& geometry, const SpotSettings& settings, const SpotVariant& variant) {
  const auto define = [](const char* name, int value) {
    return "#define " + std::string(name) + " " + std::to_string(value) + "\n";
  };
  return "#version 430 core\n" + define("CHANNELS", static_cast<int>(geometry.channels.size())) +
         define("CELLS", variant.cells) + "#define ADD_ALL " + add_all(variant.cells) +
         define("LEVELS", static_cast<int>(layout_of(geometry, settings).levels.size())) +
         define("WEIGHTED", settings.look_up == SpotLookUp::weighted) +
         define("SHADOW", static_cast<int>(variant.shadow)) + define("TEXELS", settings.shadow_texels) +
         define("GLOSSY", variant.glossy) + define("SRGBE", settings.sums == SpotSums::srgbe) +
         basis_defines(Basis(geometry.sampling.basis));
}

void set_vec2(GLint at, const Vec2& v) { glUniform2f(at, static_cast<float>(v.x()), static_cast<float>(v.y())); }

}  // namespace

Result<SpotProgram> SpotProgram::create(const LuminaireGeometry& geometry, const SpotSettings& settings,
                                        const SpotVariant& variant) {
  namespace shaders = spot_shaders;
  const std::string vertex = std::string("#version 430 core\n") + shaders::vertex;
  const bool weighted = settings.look_up == SpotLookUp::weighted;
  const std::string fragment = head_of(geometry, settings, variant) + shaders::types +
                               (weighted ? shaders::weighted : shaders::textured) + shaders::shadow + shaders::gloss +
                               shaders::srgbe + shaders::main;
  const auto compiled = compile_program("the spotlights", {vertex.c_str(), nullptr, fragment.c_str()});
  if (!compiled) return tl::unexpected(compiled.error());
  SpotProgram program(geometry, settings, variant);
  program.program_ = *compiled;
  glGenVertexArrays(1, &program.vertices_);
  glUseProgram(program.program_);
  program.set_luminaire();
  program.set_textures();
  if (const Status set = gl_status("spotlights"); !set) return tl::unexpected(set.error());
  return program;
}

SpotProgram::SpotProgram(SpotProgram&& other) noexcept
    : geometry_(std::move(other.geometry_)),
      settings_(other.settings_),
      variant_(other.variant_),
      program_(std::exchange(other.program_, 0)),
      vertices_(std::exchange(other.vertices_, 0)) {}

SpotProgram& SpotProgram::operator=(SpotProgram&& other) noexcept {
  std::swap(geometry_, other.geometry_);
  std::swap(settings_, other.settings_);
  std::swap(variant_, other.variant_);
  std::swap(program_, other.program_);
  std::swap(vertices_, other.vertices_);
  return *this;
}

SpotProgram::~SpotProgram() {
  if (program_ != 0) glDeleteProgram(program_);
  if (vertices_ != 0) glDeleteVertexArrays(1, &vertices_);
}

int SpotProgram::at(const char* name) const { return glGetUniformLocation(program_, name); }

void SpotProgram::set_textures() const {
  for (const auto& [name, unit] : {std::pair("positions", SpotUnits::positions),
                                   {"normals", SpotUnits::normals},
                                   {"images", SpotUnits::images},
                                   {"faces", SpotUnits::faces},
                                   {"depths", SpotUnits::depths},
                                   {"lobe_eyes", SpotUnits::lobe_eyes},
                                   {"lobe_colours", SpotUnits::lobe_colours},
                                   {"irradiance_before", SpotUnits::irradiance_before},
                                   {"radiance_before", SpotUnits::radiance_before}})
    glUniform1i(at(name), unit);
}

void SpotProgram::set_luminaire() const {
  const Measurement& m = geometry_.measurement;
  const Vec2 a = geometry_.sampling.spacing_mm, corner = m.corner_mm();
  if (settings_.look_up == SpotLookUp::weighted) {
    glUniform2d(at("spacing"), a.x(), a.y());
    glUniform2d(at("corner"), corner.x(), corner.y());
    glUniform2d(at("pixel"), m.pixel_mm.x(), m.pixel_mm.y());
    glUniform1d(at("separation"), geometry_.planes.separation_mm);
    glUniform2i(at("size"), m.width_px, m.height_px);
  } else {
    const SpotLayout layout = layout_of(geometry_, settings_);
    std::vector<float> places;
    for (const SpotLayout::Level& each : layout.levels)
      for (const int number : {each.x_px, each.y_px, each.width_px, each.height_px})
        places.push_back(static_cast<float>(number));
    glUniform1f(at("separation"), static_cast<float>(geometry_.planes.separation_mm));
    glUniform1f(at("area"), static_cast<float>(a.prod()));
    set_vec2(at("corner"), corner);
    set_vec2(at("per_pixel"), m.pixel_mm.cwiseInverse());
    set_vec2(at("per_layer"), Vec2(layout.width_px, layout.height_px).cwiseInverse());
    glUniform4fv(at("level_places"), static_cast<GLsizei>(layout.levels.size()), places.data());
    set_vec2(at("width"), spot_width(Basis(geometry_.sampling.basis)) * a.cwiseQuotient(m.pixel_mm));
  }
  const TileGrid grid(geometry_.sampling);
  const int row_words = (grid.columns + 31) / 32;
  glUniform1i(at("row_words"), row_words);
  glUniform1i(at("receiver_words"), row_words * grid.rows);
  glUniform1i(at("per_support"), grid.per_support);
}

void SpotProgram::set_cells(std::span<const SpotCell> cells) const {
  std::vector<float> cell, map, map_step;
  std::vector<double> center;
  std::vector<int> tile;
  const auto put = [](auto& list, std::initializer_list<double> numbers) {
    for (const double n : numbers) list.push_back(static_cast<std::remove_reference_t<decltype(list[0])>>(n));
  };
  for (const SpotCell& each : cells) {
    const Vec2 u = geometry_.sampling.cell_center_mm(each.index);
    const Vec2 step = (each.view.high - each.view.low) / settings_.shadow_map_px;
    put(cell, {u.x(), u.y(), each.sign, double(geometry_.sampling.flat(each.index))});
    put(center, {u.x(), u.y()});
    put(map, {each.view.low.x(), each.view.low.y(), 1 / step.x(), 1 / step.y()});
    put(map_step, {step.x(), step.y(), each.kept});
    put(tile, {double(each.index.column), double(each.index.row)});
  }
  const auto count = static_cast<GLsizei>(cells.size());
  glUniform4fv(at("cell"), count, cell.data());
  if (settings_.look_up == SpotLookUp::weighted) glUniform2dv(at("center"), count, center.data());
  if (variant_.shadow == SpotShadow::maps) {
    glUniform4fv(at("map"), count, map.data());
    glUniform3fv(at("map_step"), count, map_step.data());
  }
  if (variant_.shadow == SpotShadow::tiles) glUniform2iv(at("tile"), count, tile.data());
}

void SpotProgram::draw(std::span<const SpotCell> cells, int columns) {
  glUseProgram(program_);
  glBindVertexArray(vertices_);
  set_cells(cells);
  glUniform1i(at("columns"), columns);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

}  // namespace lumifield
