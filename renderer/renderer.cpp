#include "renderer/renderer.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "luminaire/dataset.h"
#include "renderer/methods/closed_form.h"
#include "renderer/opengl/gbuffer.h"
#include "renderer/scene/mesh.h"

namespace lumifield {
namespace {

constexpr const char* left_out = "surfaces are diffuse, and light passes through objects: no shadows";

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

/// Positions and normals of a G-buffer as each placement's luminaire sees them, one placement after the other.
struct Receivers {
  std::vector<float> p, n;
};

Receivers receivers_of(const GBuffer& gbuffer, const std::vector<ScenePlacement>& placements) {
  Receivers receivers;
  receivers.p.resize(gbuffer.position.size() * placements.size());
  receivers.n.resize(receivers.p.size());
  std::size_t out = 0;
  for (const ScenePlacement& placement : placements) {
    const Eigen::Matrix3d to_luminaire = placement.pose.topLeftCorner<3, 3>().transpose();
    const Vec3 origin = placement.pose.topRightCorner<3, 1>();
    for (std::size_t i = 0; i < gbuffer.position.size(); i += 4, out += 4) {
      if (gbuffer.position[i + 3] == 0) continue;
      const Eigen::Map<const Eigen::Vector3f> p(&gbuffer.position[i]), n(&gbuffer.normal[i]);
      Eigen::Map<Eigen::Vector3f>(&receivers.p[out]) = (to_luminaire * (p.cast<double>() - origin)).cast<float>();
      Eigen::Map<Eigen::Vector3f>(&receivers.n[out]) = (to_luminaire * n.cast<double>()).cast<float>();
    }
  }
  return receivers;
}

}  // namespace

struct Renderer::Impl {
  // The context outlives what draws with it.
  std::unique_ptr<EglContext> context;
  std::unique_ptr<GBufferPass> pass;
  std::vector<Material> materials;
  std::vector<ScenePlacement> placements;
  RendererInfo info;
  GBuffer gbuffer;

  std::optional<LuminaireGeometry> geometry;
  std::unique_ptr<ClosedFormDevice> device;
  std::vector<std::shared_ptr<const CellImage>> cells;  ///< by Sampling::flat, null while unmeasured
  bool stale = false;                                   ///< the device's sums are not those of `cells`

  Status need_luminaire() const {
    if (device) return {};
    return fail("no luminaire is set", "renderer", "set one first");
  }
  Status sum_again();
  void shade(const std::vector<float>& irradiance, Picture& picture) const;
};

/// Hands the device the receivers of the present view and all cells.
Status Renderer::Impl::sum_again() {
  stale = true;
  const Receivers receivers = receivers_of(gbuffer, placements);
  if (const Status set = device->set_receivers(receivers.p, receivers.n); !set) return set;
  std::vector<CellIndex> indices;
  std::vector<const CellImage*> images;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    if (!cells[k]) continue;
    indices.push_back(geometry->sampling.index(static_cast<int>(k)));
    images.push_back(cells[k].get());
  }
  if (!indices.empty())
    if (const Status added = device->add_cells(indices, images); !added) return added;
  stale = false;
  return {};
}

/// radiance = reflectance/π · Σ scale·E.
void Renderer::Impl::shade(const std::vector<float>& irradiance, Picture& picture) const {
  const std::size_t pixels = picture.coverage.size();
  const std::size_t channels = geometry->channels.size();
  for (std::size_t i = 0; i < pixels; ++i) {
    picture.coverage[i] = gbuffer.position[4 * i + 3];
    if (picture.coverage[i] == 0) continue;
    const Material& material = materials[static_cast<std::size_t>(gbuffer.normal[4 * i + 3])];
    for (std::size_t c = 0; c < 3; ++c) {
      double e = 0;
      for (std::size_t l = 0; l < placements.size(); ++l)
        e += placements[l].scale * irradiance[(l * pixels + i) * channels + (channels == 1 ? 0 : c)];
      picture.rgb[3 * i + c] = static_cast<float>(material.diffuse[c] / std::numbers::pi * e);
    }
  }
}

Renderer::Renderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Renderer::~Renderer() = default;

Result<std::unique_ptr<Renderer>> Renderer::create(const Scene& scene, int width_px, int height_px) {
  if (const Status placed = check_placements(scene.luminaires); !placed) return tl::unexpected(placed.error());
  const Result<std::string> opencl = probe_opencl();
  if (!opencl) return tl::unexpected(opencl.error());
  Result<Mesh> mesh = read_mesh(scene.mesh, scene.materials);
  if (!mesh) return tl::unexpected(mesh.error());
  Result<std::unique_ptr<EglContext>> context = EglContext::create();
  if (!context) return tl::unexpected(context.error());
  Result<std::unique_ptr<GBufferPass>> pass = GBufferPass::create(**context, *mesh);
  if (!pass) return tl::unexpected(pass.error());

  auto impl = std::make_unique<Impl>();
  impl->info = {(*context)->description(), *opencl, std::move(mesh->notes)};
  impl->info.notes.emplace_back(left_out);
  if (scene.environment) impl->info.notes.emplace_back("the environment is not shown");
  impl->context = std::move(*context);
  impl->pass = std::move(*pass);
  impl->materials = std::move(mesh->materials);
  impl->placements = scene.luminaires;
  std::unique_ptr<Renderer> renderer(new Renderer(std::move(impl)));
  if (const Status viewed = renderer->set_view(scene.camera, width_px, height_px); !viewed)
    return tl::unexpected(viewed.error());
  return renderer;
}

RendererInfo Renderer::info() const { return impl_->info; }

Status Renderer::set_luminaire(const LuminaireGeometry& geometry) {
  if (geometry.channels.size() != 1 && geometry.channels.size() != 3)
    return fail(std::to_string(geometry.channels.size()) + " channels", "luminaire", "use Y, or R, G and B");
  Result<std::unique_ptr<ClosedFormDevice>> device = ClosedFormDevice::create(geometry);
  if (!device) return tl::unexpected(device.error());
  impl_->geometry = geometry;
  impl_->device = std::move(*device);
  impl_->cells.assign(static_cast<std::size_t>(geometry.sampling.cells()), nullptr);
  impl_->info.opencl = impl_->device->device_name();
  return impl_->sum_again();
}

Status Renderer::set_view(const SceneCamera& camera, int width_px, int height_px) {
  Result<GBuffer> gbuffer = impl_->pass->draw(camera, width_px, height_px);
  if (!gbuffer) return tl::unexpected(gbuffer.error());
  impl_->gbuffer = std::move(*gbuffer);
  return impl_->device ? impl_->sum_again() : Status{};
}

Status Renderer::add_cell(CellIndex cell, std::shared_ptr<const CellImage> image) {
  if (const Status ready = impl_->need_luminaire(); !ready) return ready;
  if (!image) return fail("comes without an image", "cell " + to_string(cell), "measure the cell again");
  if (const Status fits = check_cell(*impl_->geometry, cell, *image); !fits) return fits;
  std::shared_ptr<const CellImage>& kept = impl_->cells[static_cast<std::size_t>(impl_->geometry->sampling.flat(cell))];
  const std::shared_ptr<const CellImage> before = std::exchange(kept, image);
  if (impl_->stale) return impl_->sum_again();
  const Status added = impl_->device->add_cell(cell, *image, before.get());
  impl_->stale = !added;
  return added;
}

Status Renderer::add_all(const LightField& light_field) {
  if (const Status ready = impl_->need_luminaire(); !ready) return ready;
  if (const auto difference = first_difference(light_field.geometry(), *impl_->geometry))
    return fail("the cells are of another luminaire: its " + *difference, "renderer", "set the luminaire first");
  for (int k = 0; k < impl_->geometry->sampling.cells(); ++k)
    if (auto image = light_field.cell(impl_->geometry->sampling.index(k)))
      impl_->cells[static_cast<std::size_t>(k)] = std::move(image);
  return impl_->sum_again();
}

Result<Picture> Renderer::picture() {
  if (const Status ready = impl_->need_luminaire(); !ready) return tl::unexpected(ready.error());
  if (impl_->stale)
    if (const Status summed = impl_->sum_again(); !summed) return tl::unexpected(summed.error());
  std::vector<float> irradiance;
  if (const Status read = impl_->device->read(irradiance); !read) return tl::unexpected(read.error());
  const std::size_t pixels = impl_->gbuffer.position.size() / 4;
  Picture picture{impl_->gbuffer.width_px, impl_->gbuffer.height_px, std::vector<float>(3 * pixels, 0.0F),
                  std::vector<float>(pixels, 0.0F), left_out};
  impl_->shade(irradiance, picture);
  return picture;
}

double Renderer::last_kernel_s() const { return impl_->device ? impl_->device->last_kernel_s() : 0; }

}  // namespace lumifield
