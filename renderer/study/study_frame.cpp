#include "renderer/study/study_frame.h"

#include "renderer/sampling/sequence.h"
#include "renderer/shading.h"

namespace lumifield {

Picture StudyFrame::picture(const std::vector<double>& irradiance, std::size_t channels) const {
  Picture picture{gbuffer.width_px, gbuffer.height_px, std::vector<float>(3 * receivers.size()),
                  std::vector<float>(receivers.size()), left_out(Visibility::none)};
  shade(gbuffer, materials, {placement}, {irradiance, channels}, picture);
  return picture;
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
  camera->materials_ = std::move(mesh->materials);
  return camera;
}

Result<StudyFrame> StudyCamera::frame(int width_px, int height_px, double separation_mm) {
  auto gbuffer = pass_->draw(scene_.camera, width_px, height_px);
  if (!gbuffer) return tl::unexpected(gbuffer.error());
  StudyFrame frame{std::move(*gbuffer), materials_, scene_.luminaires.front(), {}};
  const Receivers seen = receivers_of(frame.gbuffer, {frame.placement});
  for (std::size_t k = 0; k < seen.p.size(); k += 4) {
    Receiver r{{seen.p[k], seen.p[k + 1], seen.p[k + 2]}, {seen.n[k], seen.n[k + 1], seen.n[k + 2]}};
    if (!(r.p_mm.z() > separation_mm)) r = {{0, 0, 2 * separation_mm}, {0, 0, 0}};
    frame.receivers.push_back(r);
  }
  return frame;
}

}  // namespace lumifield
