#include "renderer/renderer.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "luminaire/dataset.h"
#include "renderer/methods/host_method.h"
#include "renderer/renderer_impl.h"
#include "renderer/shading.h"

namespace lumifield {
namespace {

Status check_placements(const std::vector<ScenePlacement>& placements) {
  if (placements.empty())
    return fail("no luminaire is placed in the scene", "luminaires", "add one with its pose to the scene file");
  for (std::size_t k = 0; k < placements.size(); ++k) {
    const Eigen::Matrix3d r = placements[k].pose.topLeftCorner<3, 3>();
    const bool rigid = placements[k].pose.allFinite() && (r.transpose() * r).isIdentity(1e-6) && r.determinant() > 0;
    if (!rigid || !std::isfinite(placements[k].scale))
      return fail("the pose is not rigid or the scale not finite", "luminaires[" + std::to_string(k) + "]",
                  "give a rotation and a translation in mm, row by row");
  }
  return {};
}

}  // namespace

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Renderer::~Renderer() = default;

Result<std::unique_ptr<Renderer>> Renderer::create(const Scene& scene, int width_px, int height_px,
                                                   const std::stop_token& stop) {
  if (const Status placed = check_placements(scene.luminaires); !placed) return tl::unexpected(placed.error());
  Result<Mesh> mesh = read_mesh(scene.mesh, scene.materials);
  if (!mesh) return tl::unexpected(mesh.error());
  Result<std::unique_ptr<EglContext>> context = EglContext::create();
  if (!context) return tl::unexpected(context.error());
  Result<std::unique_ptr<GBufferPass>> pass = GBufferPass::create(**context, *mesh);
  if (!pass) return tl::unexpected(pass.error());

  auto impl = std::make_unique<Impl>();
  const Result<std::string> opencl = probe_opencl();
  if (!opencl) impl->no_opencl = opencl.error();
  impl->info = {(*context)->description(), opencl.value_or(""), std::move(mesh->notes), {}};
  if (!opencl) impl->info.notes.push_back("without OpenCL: " + opencl.error().message());
  if (scene.environment) {
    auto environment = EnvironmentLight::read(*scene.environment, scene.environment_scale, {}, stop);
    if (!environment) return tl::unexpected(environment.error());
    impl->environment = std::move(*environment);
    impl->environment_on = true;
    const auto& notes = impl->environment->notes();
    impl->info.notes.insert(impl->info.notes.end(), notes.begin(), notes.end());
  }
  impl->materials = std::move(mesh->materials);
  mesh->textures.clear();  // the pass has its own
  impl->shadows = std::make_unique<SceneShadows>(**context, std::move(*mesh));
  impl->context = std::move(*context);
  impl->pass = std::move(*pass);
  impl->placements = scene.luminaires;
  std::unique_ptr<Renderer> renderer(new Renderer(std::move(impl)));
  if (const Status viewed = renderer->set_view(scene.camera, width_px, height_px); !viewed)
    return tl::unexpected(viewed.error());
  return renderer;
}

RendererInfo Renderer::info() const {
  RendererInfo info = impl_->info;
  info.left_out = left_out(impl_->visibility, impl_->environment_on, impl_->settings);
  info.has_environment = impl_->environment != nullptr;
  return info;
}

Status Renderer::set_luminaire(const LuminaireGeometry& geometry) {
  if (geometry.channels.size() != 1 && geometry.channels.size() != 3)
    return fail(std::to_string(geometry.channels.size()) + " channels", "luminaire", "use Y, or R, G and B");
  const std::optional<LuminaireGeometry> before = std::exchange(impl_->geometry, geometry);
  if (const Status made = impl_->make_method(); !made) {
    impl_->geometry = before;
    return made;
  }
  impl_->cells.assign(static_cast<std::size_t>(geometry.sampling.cells()), nullptr);
  impl_->shadows->forget_positions();
  impl_->receiver_s = 0;
  impl_->clear();
  return {};
}

Status Renderer::set_method(const MethodSettings& settings) {
  if (const Status good = check_settings(settings); !good) return good;
  const MethodSettings before = std::exchange(impl_->settings, settings);
  if (const Status made = impl_->geometry ? impl_->make_method() : impl_->need_opencl(); !made) {
    impl_->settings = before;
    return made;
  }
  if (!impl_->geometry) return {};
  impl_->receiver_s = 0;
  impl_->clear();
  return {};
}

Status Renderer::set_view(const SceneCamera& camera, int width_px, int height_px, double lod) {
  if (!(lod >= 0 && std::isfinite(lod)))
    return fail("a level of detail of " + std::to_string(lod) + " pixels", "picture", "give 0 (exact) or more");
  Result<GBuffer> gbuffer = impl_->pass->draw(camera, width_px, height_px);
  if (!gbuffer) return tl::unexpected(gbuffer.error());
  impl_->gbuffer = std::move(*gbuffer);
  impl_->eye_mm = camera.position_mm;
  impl_->environment_pixels = 0;
  impl_->lod = lod;
  impl_->clear();
  return {};
}

Status Renderer::set_placements(const std::vector<ScenePlacement>& placements) {
  if (const Status placed = check_placements(placements); !placed) return placed;
  impl_->placements = placements;
  impl_->clear();
  return {};
}

Status Renderer::set_visibility(Visibility visibility) {
  if (visibility == impl_->visibility) return {};
  impl_->visibility = visibility;
  impl_->clear();
  return {};
}

Visibility Renderer::visibility() const { return impl_->visibility; }

Status Renderer::set_environment(bool on) {
  if (on && !impl_->environment) return fail("the scene has none", "environment", "name one in the scene file");
  impl_->environment_on = on;
  return {};
}

bool Renderer::environment() const { return impl_->environment_on; }

bool Renderer::surround(double seconds) { return impl_->surround(seconds); }

double Renderer::share_surrounded() const {
  const double pixels = static_cast<double>(impl_->gbuffer.position.size()) / 4;
  return impl_->environment_on ? static_cast<double>(impl_->environment_pixels) / std::max(pixels, 1.0) : 1;
}

void Renderer::refresh_shadows() {
  impl_->shadows->forget_positions();
  impl_->clear();
}

int Renderer::shadow_maps_made() const {
  return impl_->shadows->times_made() + impl_->spot_maps_before + (impl_->spots ? impl_->spots->times_drawn() : 0);
}

Status Renderer::hand_over() { return impl_->hand_over(); }

Status Renderer::keep_cell(CellIndex cell, std::shared_ptr<const CellImage> image) {
  return impl_->keep(cell, std::move(image));
}

Status Renderer::add_cell(CellIndex cell, std::shared_ptr<const CellImage> image) {
  const bool others = !impl_->waiting.empty();
  if (const Status kept = impl_->keep(cell, std::move(image)); !kept || others) return kept;
  if (const Status handed = impl_->hand_over(); !handed) return handed;
  // Receivers that had to be handed over anew have all wait.
  return impl_->method || impl_->waiting.size() == 1 ? impl_->sum(1) : Status{};
}

Status Renderer::keep_all(const LightField& light_field) {
  if (const Status ready = impl_->need_luminaire(); !ready) return ready;
  if (const auto difference = first_difference(light_field.geometry(), *impl_->geometry))
    return fail("the cells are of another luminaire: its " + *difference, "renderer", "set the luminaire first");
  for (int k = 0; k < impl_->geometry->sampling.cells(); ++k)
    if (auto image = light_field.cell(impl_->geometry->sampling.index(k)))
      impl_->cells[static_cast<std::size_t>(k)] = std::move(image);
  impl_->method_has_cells = false;
  impl_->clear();
  return {};
}

Status Renderer::add_all(const LightField& light_field) {
  if (const Status kept = keep_all(light_field); !kept) return kept;
  return impl_->sum(impl_->cells.size());
}

int Renderer::waiting() const { return static_cast<int>(impl_->waiting.size()); }

bool Renderer::waits(CellIndex cell) const {
  return impl_->geometry && impl_->waiting.contains(impl_->geometry->sampling.flat(cell));
}

int Renderer::summed() const {
  return static_cast<int>(std::ranges::count_if(impl_->summed, [](const auto& image) { return image != nullptr; }));
}

double Renderer::share_summed() const {
  if (impl_->waiting.empty()) return 1;
  if (impl_->method) return impl_->handed_over && impl_->method_has_cells ? impl_->method->share_done() : 0;
  const double done = summed();
  return done / (done + waiting());
}

double Renderer::cell_s() const { return impl_->receiver_s * impl_->receivers(); }

Status Renderer::sum_some(double seconds) {
  if (const Status ready = impl_->need_luminaire(); !ready) return ready;
  if (impl_->method) return impl_->evaluate(seconds);
  const double fit = cell_s() > 0 ? seconds / cell_s() : 1;
  return impl_->sum(std::max(static_cast<std::size_t>(std::clamp(fit, 1.0, 1e6)), impl_->first_row()));
}

Result<Picture> Renderer::picture() {
  if (const Status ready = impl_->need_luminaire(); !ready) return tl::unexpected(ready.error());
  if (const Status summed = impl_->sum(impl_->cells.size()); !summed) return tl::unexpected(summed.error());
  return picture_so_far();
}

Result<Picture> Renderer::picture_so_far() {
  if (const Status handed = impl_->hand_over(); !handed) return tl::unexpected(handed.error());
  if (impl_->device)
    if (const Status read = impl_->read_sums(); !read) return tl::unexpected(read.error());
  const std::size_t pixels = impl_->gbuffer.position.size() / 4;
  Picture picture{impl_->gbuffer.width_px, impl_->gbuffer.height_px, std::vector<float>(3 * pixels),
                  std::vector<float>(pixels), left_out(impl_->visibility, impl_->environment_on, impl_->settings)};
  impl_->surround(HUGE_VAL);
  shade(impl_->gbuffer, impl_->materials, impl_->placements,
        {impl_->irradiance, impl_->geometry->channels.size(), impl_->gloss, impl_->gloss_channels},
        impl_->environment_on ? std::span<const float>(impl_->environment_radiance) : std::span<const float>(),
        picture);
  return picture;
}

double Renderer::last_kernel_s() const {
  if (impl_->method) return impl_->method->kernel_s();
  return impl_->device ? impl_->device->last_kernel_s() : 0;
}

}  // namespace lumifield
