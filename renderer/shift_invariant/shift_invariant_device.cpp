#include "renderer/shift_invariant/shift_invariant_device.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <epoxy/gl.h>
#include <optional>

#include "renderer/bands.h"
#include "renderer/opengl/gl_objects.h"
#include "renderer/shift_invariant/spot_depths.h"
#include "renderer/shift_invariant/spot_program.h"
#include "renderer/shift_invariant/spot_receivers.h"
#include "renderer/shift_invariant/spot_textures.h"
#include "renderer/shift_invariant/spot_totals.h"

namespace lumifield {

namespace {

/// The receivers of one placement.
struct Part {
  SpotReceivers receivers;
  SpotTotals totals;
  SpotDepths depths;
};

/// Of the first three. A product with 0 is 0 unless a factor is NaN or Inf.
bool is_not_finite(std::span<const float> v) { return v[0] * 0 + v[1] * 0 + v[2] * 0 != 0; }

std::vector<double> numbers_of(std::span<const float> p, std::span<const float> n) {
  std::vector<double> numbers(p.size() / 4 * 6);
  in_bands(p.size() / 4, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) {
      double* out = numbers.data() + 6 * k;
      for (std::size_t c = 0; c < 3; ++c) {
        out[c] = static_cast<double>(p[4 * k + c]);
        out[c + 3] = static_cast<double>(n[4 * k + c]);
      }
      out[2] = lit_height_mm(out[2]);
    }
  });
  return numbers;
}

}  // namespace

struct ShiftInvariantDevice::Impl {
  Impl(EglContext& c, const LuminaireGeometry& g, const SpotSettings& s)
      : context(c), geometry(g), settings(s), grid(g.sampling) {}
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  ~Impl() { (void)context.make_current(); }

  std::unique_ptr<EglContext> owned;
  EglContext& context;
  LuminaireGeometry geometry;
  SpotSettings settings;
  TileGrid grid;
  std::optional<SpotTextures> images;
  std::vector<SpotProgram> programs;
  std::unique_ptr<ShadowMapPass> occluders;
  SpotScene scene;
  std::vector<Part> parts;
  SpotVariant variant;
  std::size_t count = 0, gloss_channels = 0;
  bool has_receivers = false;
  int lighting_passes = 0, depth_passes = 0, times_drawn = 0;
  double last_kernel_s = 0;

  bool weighted() const { return settings.look_up == SpotLookUp::weighted; }
  Status take(std::span<const float> p, std::span<const float> n, std::span<const double> numbers,
              const Appearance& appearance);
  Status take_part(std::size_t number, std::span<const float> p, std::span<const float> n,
                   std::span<const double> numbers, const Appearance& appearance);
  Result<SpotProgram*> program(int cells);
  Status draw_maps(std::span<const CellIndex> cells);
  Status light(std::span<const CellIndex> cells, double sign);
  Status pass(std::span<const SpotCell> cells);
  template <class Add>
  Status timed(const Add& add);
  Status read(bool radiance, std::size_t channels, std::vector<double>& values);
};

ShiftInvariantDevice::ShiftInvariantDevice(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ShiftInvariantDevice::~ShiftInvariantDevice() {
  // What is on the context goes before it, and while it is current.
  (void)impl_->context.make_current();
  const std::unique_ptr<EglContext> owned = std::move(impl_->owned);
  impl_.reset();
}
std::string ShiftInvariantDevice::device_name() const { return impl_->context.description(); }
double ShiftInvariantDevice::last_kernel_s() const { return impl_->last_kernel_s; }
int ShiftInvariantDevice::lighting_passes() const { return impl_->lighting_passes; }
int ShiftInvariantDevice::depth_passes() const { return impl_->depth_passes; }
int ShiftInvariantDevice::times_drawn() const { return impl_->times_drawn; }

Result<std::unique_ptr<ShiftInvariantDevice>> ShiftInvariantDevice::create(const LuminaireGeometry& geometry,
                                                                           const SpotSettings& settings) {
  auto context = EglContext::create();
  if (!context) return tl::unexpected(context.error());
  auto made = create(**context, geometry, settings);
  if (made) (*made)->impl_->owned = std::move(*context);
  return made;
}

Result<std::unique_ptr<ShiftInvariantDevice>> ShiftInvariantDevice::create(EglContext& context,
                                                                           const LuminaireGeometry& geometry,
                                                                           const SpotSettings& settings) {
  if (geometry.channels.size() != 1 && geometry.channels.size() != 3)
    return fail("a luminaire of " + std::to_string(geometry.channels.size()) + " channels cannot be rendered",
                "channels", "give it the channel Y, or R, G, B");
  if (const Status current = context.make_current(); !current) return tl::unexpected(current.error());
  auto impl = std::make_unique<Impl>(context, geometry, settings);
  auto images = SpotTextures::create(geometry, settings.look_up);
  if (!images) return tl::unexpected(images.error());
  impl->images.emplace(std::move(*images));
  return std::unique_ptr<ShiftInvariantDevice>(new ShiftInvariantDevice(std::move(impl)));
}

Status ShiftInvariantDevice::set_occluders(const Mesh& mesh) {
  auto pass = ShadowMapPass::create(impl_->context, mesh);
  if (!pass) return tl::unexpected(pass.error());
  impl_->occluders = std::move(*pass);
  forget_maps();
  return {};
}

void ShiftInvariantDevice::forget_maps() {
  for (Part& part : impl_->parts) part.depths.forget();
}

Status ShiftInvariantDevice::set_scene(SpotScene scene) {
  if (!scene.face_xyzw.empty() && !impl_->occluders)
    return fail("nothing is there that casts shadows", "shadows", "set the occluders first");
  impl_->scene = std::move(scene);
  return {};
}

Status ShiftInvariantDevice::set_receivers(std::span<const Receiver> receivers, const Appearance& appearance) {
  std::vector<float> p, n;
  std::vector<double> numbers;
  for (const Receiver& r : receivers) {
    const Vec3 at(r.p_mm.x(), r.p_mm.y(), lit_height_mm(r.p_mm.z()));
    for (std::size_t c = 0; c < 4; ++c) {
      p.push_back(c < 3 ? static_cast<float>(at[static_cast<Eigen::Index>(c)]) : 0.0F);
      n.push_back(c < 3 ? static_cast<float>(r.n[static_cast<Eigen::Index>(c)]) : 0.0F);
    }
    numbers.insert(numbers.end(), {at.x(), at.y(), at.z(), r.n.x(), r.n.y(), r.n.z()});
  }
  impl_->scene = {};
  if (!impl_->weighted()) numbers.clear();
  return impl_->take(p, n, numbers, appearance);
}

Status ShiftInvariantDevice::set_receivers(std::span<const float> p, std::span<const float> n,
                                           const Appearance& appearance) {
  if (p.size() != n.size() || p.size() % 4 != 0)
    return fail("positions and normals are not 4 floats each", "receivers", "give as many of both");
  return impl_->take(p, n, impl_->weighted() ? numbers_of(p, n) : std::vector<double>{}, appearance);
}

Status ShiftInvariantDevice::Impl::take(std::span<const float> p, std::span<const float> n,
                                        std::span<const double> numbers, const Appearance& appearance) {
  has_receivers = false;
  const std::size_t all = p.size() / 4;
  const auto bad = first_where(
      all, [&](std::size_t k) { return is_not_finite(p.subspan(4 * k)) || is_not_finite(n.subspan(4 * k)); });
  if (bad) return fail("has NaN or Inf", "receiver " + std::to_string(*bad), "give finite numbers");
  if (const Status good = check_appearance(appearance, grid, all); !good) return good;
  const bool shadows = !scene.face_xyzw.empty();
  const std::size_t placements = std::max<std::size_t>(scene.poses.size(), 1);
  if (all % placements != 0 || (shadows && scene.face_xyzw.size() != p.size()))
    return fail("they are not as many as the scene has faces, or not alike for its placements", "receivers",
                "set the scene of these");
  if (const Status current = context.make_current(); !current) return current;
  variant = {1,
             shadows                       ? SpotShadow::maps
             : !appearance.visible.empty() ? SpotShadow::tiles
                                           : SpotShadow::none,
             !appearance.gloss.empty()};
  gloss_channels = appearance.gloss_channels(geometry.channels.size());
  parts.resize(placements);
  for (std::size_t k = 0; k < placements; ++k)
    if (const Status taken = take_part(k, p, n, numbers, appearance); !taken) return taken;
  count = all;
  lighting_passes = depth_passes = 0;
  scene.face_xyzw = {};  // not looked at again
  has_receivers = true;
  return {};
}

Status ShiftInvariantDevice::Impl::take_part(std::size_t number, std::span<const float> p, std::span<const float> n,
                                             std::span<const double> numbers, const Appearance& appearance) {
  Part& part = parts[number];
  const std::size_t each = p.size() / 4 / parts.size(), first = number * each;
  const auto part_of = [&](auto list, std::size_t width) {
    return list.empty() ? list : list.subspan(first * width, each * width);
  };
  const SpotReceivers::Given given{part_of(p, 4),
                                   part_of(n, 4),
                                   part_of(scene.face_xyzw, 4),
                                   part_of(numbers, 6),
                                   part_of(std::span(appearance.gloss), 1),
                                   part_of(std::span(appearance.visible.words), appearance.visible.receiver_words()),
                                   scene.columns};
  if (const Status set = part.receivers.set(geometry, given); !set) return set;
  if (variant.shadow == SpotShadow::maps)
    if (const Status set = part.depths.set(scene.poses[number], geometry, settings.shadow_map_px); !set) return set;
  if (part.receivers.empty()) return {};
  const SpotOrder& order = part.receivers.order();
  auto totals = SpotTotals::create(settings.sums, variant.glossy, order.columns, order.rows);
  if (!totals) return tl::unexpected(totals.error());
  part.totals = std::move(*totals);
  return {};
}

Result<SpotProgram*> ShiftInvariantDevice::Impl::program(int cells) {
  variant.cells = cells;
  const auto made = std::ranges::find_if(programs, [&](const SpotProgram& each) { return each.variant() == variant; });
  if (made != programs.end()) return &*made;
  auto program = SpotProgram::create(geometry, settings, variant);
  if (!program) return tl::unexpected(program.error());
  programs.push_back(std::move(*program));
  return &programs.back();
}

Status ShiftInvariantDevice::Impl::draw_maps(std::span<const CellIndex> cells) {
  if (variant.shadow != SpotShadow::maps) return {};
  for (std::size_t k = 0; k < parts.size(); ++k) {
    SpotDepths& depths = parts[k].depths;
    const int before = depths.drawn();
    if (const Status drawn = depths.draw(*occluders, cells); !drawn) return drawn;
    times_drawn += depths.drawn() > before;
    if (k == 0) depth_passes += depths.drawn() - before;
  }
  return {};
}

Status ShiftInvariantDevice::Impl::pass(std::span<const SpotCell> cells) {
  const auto drawing = program(static_cast<int>(cells.size()));
  if (!drawing) return tl::unexpected(drawing.error());
  for (Part& part : parts) {
    if (part.receivers.empty()) continue;
    part.receivers.bind();
    images->bind(SpotUnits::images);
    if (variant.shadow == SpotShadow::maps) part.depths.bind(SpotUnits::depths);
    part.totals.begin_pass();
    (*drawing)->draw(cells, part.receivers.order().columns);
  }
  ++lighting_passes;
  return gl_status("spotlights");
}

/// Cells whose images are held, X at a time; what is left in a pass of half as many, or a quarter, so that there are
/// few programs.
Status ShiftInvariantDevice::Impl::light(std::span<const CellIndex> cells, double sign) {
  if (const Status drawn = draw_maps(cells); !drawn) return drawn;
  for (std::size_t begin = 0; begin < cells.size();) {
    auto size = static_cast<std::size_t>(settings.cells_per_pass);
    while (size / 2 >= cells.size() - begin) size /= 2;
    std::vector<SpotCell> of_pass;
    for (std::size_t k = 0; k < size; ++k) {
      const bool none = begin + k >= cells.size();
      const CellIndex cell = cells[none ? begin : begin + k];
      const ShadowView view = spot_view(geometry, cell, settings.shadow_map_px);
      of_pass.push_back({cell, none ? 0 : sign, view, spot_depth_kept(view, settings.shadow_map_px)});
    }
    if (const Status done = pass(of_pass); !done) return done;
    begin += size;
  }
  return {};
}

template <class Add>
Status ShiftInvariantDevice::Impl::timed(const Add& add) {
  last_kernel_s = 0;
  if (!has_receivers) return fail("no receivers are set", "shift-invariant", "set them first");
  if (const Status current = context.make_current(); !current) return current;
  const auto start = std::chrono::steady_clock::now();
  const Status added = add();
  glFinish();
  last_kernel_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return added;
}

Status ShiftInvariantDevice::add_cells(std::span<const CellIndex> cells,
                                       std::span<const std::shared_ptr<const CellImage>> images) {
  if (cells.size() != images.size())
    return fail(std::to_string(cells.size()) + " cells came with " + std::to_string(images.size()) + " images", "cells",
                "give one image each");
  return impl_->timed([&]() -> Status {
    std::vector<CellIndex> there;
    for (std::size_t k = 0; k < cells.size(); ++k) {
      if (!images[k]) continue;
      if (const Status held = impl_->images->hold(cells[k], images[k]); !held) return held;
      there.push_back(cells[k]);
    }
    if (impl_->count == 0) return {};
    return impl_->light(there, 1);
  });
}

Status ShiftInvariantDevice::replace_cell(CellIndex cell, const std::shared_ptr<const CellImage>& image,
                                          const std::shared_ptr<const CellImage>& before) {
  return impl_->timed([&]() -> Status {
    if (impl_->count == 0) return check_cell(impl_->geometry, cell, *image);
    const auto light = [&](const std::shared_ptr<const CellImage>& of, double sign) -> Status {
      if (const Status held = impl_->images->hold(cell, of); !held) return held;
      return impl_->light(std::span(&cell, 1), sign);
    };
    if (before)
      if (const Status taken = light(before, -1); !taken) return taken;
    return light(image, 1);
  });
}

Status ShiftInvariantDevice::Impl::read(bool radiance, std::size_t channels, std::vector<double>& values) {
  values.assign(count * channels, 0.0);
  if (const Status current = context.make_current(); !current) return current;
  std::vector<float> rgb;
  double* out = values.data();
  for (Part& part : parts) {
    const std::vector<std::uint32_t>& receiver = part.receivers.order().receiver;
    if (!receiver.empty())
      if (const Status read = part.totals.read(radiance, rgb); !read) return read;
    for (std::size_t k = 0; k < receiver.size(); ++k) {
      if (receiver[k] == SpotOrder::none) continue;
      for (std::size_t c = 0; c < channels; ++c) {
        const float value = rgb[3 * k + c];
        if (!std::isfinite(value))
          return fail("its sum exceeds what a float holds", "receiver " + std::to_string(receiver[k]),
                      "use closed-form, or take it away from U");
        out[receiver[k] * channels + c] = static_cast<double>(value);
      }
    }
    out += part.receivers.count() * channels;
  }
  return {};
}

Status ShiftInvariantDevice::read(std::vector<double>& irradiance) {
  if (!impl_->has_receivers) return fail("no receivers are set", "shift-invariant", "set them first");
  return impl_->read(false, impl_->geometry.channels.size(), irradiance);
}

Status ShiftInvariantDevice::read_gloss(std::vector<double>& radiance) {
  radiance.clear();
  if (!impl_->has_receivers || impl_->gloss_channels == 0) return {};
  return impl_->read(true, impl_->gloss_channels, radiance);
}

}  // namespace lumifield
