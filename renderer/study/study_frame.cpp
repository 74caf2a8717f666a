#include "renderer/study/study_frame.h"

#include <cstdio>
#include <numbers>

#include "renderer/sampling/sequence.h"
#include "renderer/shading.h"

namespace lumifield {

std::string StudyLook::name() const {
  std::string name;
  if (roughness > 0) {
    char text[32];
    std::snprintf(text, sizeof text, "GGX %g", roughness);
    name = text;
  }
  if (visibility == Visibility::none) return name;
  return (name.empty() ? "" : name + ", ") + std::string("in shadow");
}

Picture StudyFrame::picture(const StudyLight& light, std::size_t channels) const {
  Picture picture{gbuffer.width_px,
                  gbuffer.height_px,
                  std::vector<float>(3 * receivers.size()),
                  std::vector<float>(receivers.size()),
                  {}};
  shade(gbuffer, materials, {placement}, {light.irradiance, channels, light.gloss, appearance.gloss_channels(channels)},
        {}, picture);
  return picture;
}

std::vector<double> StudyFrame::seen(const StudyLight& light, std::size_t k, std::size_t pixel,
                                     std::size_t channels) const {
  const auto begin = light.irradiance.begin() + static_cast<std::ptrdiff_t>(k * channels);
  std::vector<double> seen(begin, begin + static_cast<std::ptrdiff_t>(channels));
  if (light.gloss.empty()) return seen;
  const float* rho = diffuse_at(gbuffer, materials, pixel);
  const double mean = (static_cast<double>(rho[0]) + rho[1] + rho[2]) / 3;
  for (std::size_t c = 0; c < channels; ++c)
    seen[c] = mean * std::numbers::inv_pi * seen[c] + light.gloss[k * channels + c];
  return seen;
}

std::vector<Receiver> StudyFrame::receivers_at(const std::vector<std::size_t>& chosen) const {
  std::vector<Receiver> some;
  for (const std::size_t k : chosen) some.push_back(receivers[k]);
  return some;
}

Appearance StudyFrame::appearance_at(const std::vector<std::size_t>& chosen) const {
  Appearance some;
  if (!appearance.gloss.empty())
    for (const std::size_t k : chosen) some.gloss.push_back(appearance.gloss[k]);
  if (appearance.visible.empty()) return some;
  some.visible = {appearance.visible.grid, appearance.visible.weighing};
  const std::size_t words = appearance.visible.receiver_words();
  for (const std::size_t k : chosen) {
    const auto begin = appearance.visible.words.begin() + static_cast<std::ptrdiff_t>(k * words);
    some.visible.words.insert(some.visible.words.end(), begin, begin + static_cast<std::ptrdiff_t>(words));
  }
  return some;
}

std::vector<std::size_t> stratified_receivers(const StudyFrame& frame, std::uint32_t seed) {
  constexpr int strata = 32, tries = 16;
  std::vector<std::size_t> chosen;
  const int width = frame.gbuffer.width_px, height = frame.gbuffer.height_px;
  for (int k = 0; k < strata * strata; ++k)
    for (std::uint32_t tried = 0; tried < tries; ++tried) {
      const float x = unit(hash(2 * tried, std::uint32_t(k), seed)),
                  y = unit(hash(2 * tried + 1, std::uint32_t(k), seed));
      const int i = static_cast<int>(static_cast<float>(width) * (static_cast<float>(k % strata) + x) / strata);
      const int j = static_cast<int>(static_cast<float>(height) * (static_cast<float>(k / strata) + y) / strata);
      const auto pixel = static_cast<std::size_t>(j) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i);
      if (pixel >= frame.receivers.size() || frame.receivers[pixel].n == Vec3(0, 0, 0)) continue;
      chosen.push_back(pixel);
      break;
    }
  return chosen;
}

Result<std::unique_ptr<StudyCamera>> StudyCamera::create(const Scene& scene) {
  if (scene.luminaires.empty())
    return fail("no luminaire is placed in the scene", "luminaires", "add one with its pose to the scene file");
  auto mesh = read_mesh(scene.mesh, scene.materials);
  if (!mesh) return tl::unexpected(mesh.error());
  auto context = EglContext::create();
  if (!context) return tl::unexpected(context.error());
  auto pass = GBufferPass::create(**context, *mesh);
  if (!pass) return tl::unexpected(pass.error());
  std::unique_ptr<StudyCamera> camera(new StudyCamera);
  camera->scene_ = scene;
  camera->context_ = std::move(*context);
  camera->pass_ = std::move(*pass);
  camera->materials_ = mesh->materials;
  camera->shadows_ = std::make_unique<SceneShadows>(*camera->context_, std::move(*mesh));
  return camera;
}

Result<StudyFrame> StudyCamera::frame(int width_px, int height_px, const LightField& light_field,
                                      const StudyLook& look) {
  auto gbuffer = pass_->draw(scene_.camera, width_px, height_px);
  if (!gbuffer) return tl::unexpected(gbuffer.error());
  StudyFrame frame{std::move(*gbuffer), materials_, scene_.luminaires.front(), {}, {}};
  if (look.roughness > 0)
    for (Material& m : frame.materials) {
      m.lobe = LOBE_GGX;
      m.shape = static_cast<float>(look.roughness * look.roughness);
      m.specular = {common_f0, common_f0, common_f0};
    }
  const std::vector<ScenePlacement> placements{frame.placement};
  if (look.roughness > 0)
    frame.appearance.gloss = lobes_of(frame.gbuffer, frame.materials, placements, scene_.camera.position_mm);
  const Receivers seen = receivers_of(frame.gbuffer, placements);
  if (look.visibility == Visibility::published) {
    shadows_->forget_positions();
    shadows_->take_positions(light_field.geometry(), images_by_cell(light_field));
  }
  const LuminaireGeometry& geometry = light_field.geometry();
  if (const Status there =
          shadows_->see(placements, geometry, look.visibility, false, seen.p, seen.face, frame.appearance);
      !there)
    return tl::unexpected(there.error());
  const double separation_mm = geometry.planes.separation_mm;
  frame.receivers = as_receivers(seen);
  for (Receiver& r : frame.receivers)
    if (!(r.p_mm.z() > separation_mm)) r = {{0, 0, 2 * separation_mm}, {0, 0, 0}};
  return frame;
}

}  // namespace lumifield
