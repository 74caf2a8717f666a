#include "renderer/visibility/tile_shadows.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "renderer/opencl/device.h"
#include "renderer/visibility/shadow_map_pass.h"
#include "renderer/visibility/tile_visibility_shared.h"

namespace lumifield {
namespace {

constexpr std::size_t work_group = 64;
/// Receivers of a work-item on a processor.
constexpr std::size_t cpu_width = 8;

ShadowTileMap map_of(const ShadowView& view, std::size_t number, const ShadowSettings& settings) {
  const int map_px = settings.map_px;
  const Vec2 step = (view.high - view.low) / map_px;
  const auto f = [](double x) { return static_cast<float>(x); };
  const std::size_t texels = static_cast<std::size_t>(map_px) * static_cast<std::size_t>(map_px);
  return {f(view.eye_mm.x()),
          f(view.eye_mm.y()),
          f(view.low.x()),
          f(view.low.y()),
          f(step.x()),
          f(step.y()),
          f(1 / step.x()),
          f(1 / step.y()),
          f(1 - bias_of(view, settings)),
          static_cast<int>(number * texels)};
}

/// Of all blocks from U, then of those from S, if any: where in the buffer each has its map. None: it has none.
std::vector<std::optional<ShadowView>> places_of(const ShadowPlan& plan) {
  std::vector<std::optional<ShadowView>> places;
  for (const std::vector<int>& set : plan.maps_of)
    for (const int view : set)
      places.push_back(view < 0 ? std::nullopt : std::optional(plan.views[static_cast<std::size_t>(view)]));
  return places;
}

std::vector<ShadowTileMap> maps_of(const ShadowPlan& plan, const ShadowSettings& settings) {
  ShadowTileMap none{};
  none.first = -1;
  std::vector<ShadowTileMap> maps;
  for (const auto& view : places_of(plan)) maps.push_back(view ? map_of(*view, maps.size(), settings) : none);
  return maps;
}

}  // namespace

/// What all maps of a scene share.
struct TileShadows::Tools {
  std::unique_ptr<ShadowMapPass> pass;
  std::unique_ptr<OpenClDevice> device;
  DeviceKernel kernel;
  std::size_t width = 1;  ///< receivers of a work-item
  DeviceBuffer positions, faces, words;
};

struct TileShadows::Impl {
  std::shared_ptr<Tools> tools;
  DeviceBuffer maps, depths;

  std::optional<ShadowPlan> plan;  ///< of the maps that there are, with the pose and settings
  Pose pose;
  ShadowSettings settings;
  int times_made = 0, maps_drawn = 0;
  double last_kernel_s = 0;

  Status make(const ShadowPlan& wanted, const std::optional<ShadowPlan>& there);
  ShadowTiles shared(std::size_t receivers) const;
};

/// Draws those that are not there.
Status TileShadows::Impl::make(const ShadowPlan& wanted, const std::optional<ShadowPlan>& there) {
  const auto places = places_of(wanted);
  auto had = there ? places_of(*there) : decltype(places){};
  if (had.size() != places.size()) had.assign(places.size(), std::nullopt);
  std::vector<std::size_t> at;
  std::vector<ShadowView> views;
  for (std::size_t k = 0; k < places.size(); ++k)
    if (places[k] && places[k] != had[k]) {
      at.push_back(k);
      views.push_back(*places[k]);
    }
  const Result<ShadowMaps> drawn = tools->pass->draw(pose, views, settings.map_px);
  if (!drawn) return tl::unexpected(drawn.error());
  maps_drawn += static_cast<int>(views.size());

  // As many places as before have the same buffer. Those side by side are written at once.
  const std::size_t bytes = drawn->texels() * sizeof(float);
  if (const Status room = tools->device->make_room(depths, places.size() * bytes, "shadow maps"); !room) return room;
  for (std::size_t begin = 0, end = 0; begin < at.size(); begin = end) {
    for (end = begin + 1; end < at.size() && at[end] == at[end - 1] + 1;) ++end;
    const auto part = std::as_bytes(std::span(drawn->depth_mm)).subspan(begin * bytes, (end - begin) * bytes);
    if (const Status written = tools->device->write(depths, at[begin] * bytes, part); !written) return written;
  }
  return {};
}

ShadowTiles TileShadows::Impl::shared(std::size_t receivers) const {
  return {.columns = plan->grid.columns,
          .rows = plan->grid.rows,
          .block = plan->block,
          .block_columns = plan->columns,
          .block_rows = plan->rows,
          .row_words = (plan->grid.columns + 31) / 32,
          .map_px = settings.map_px,
          .published = settings.position == ShadowPosition::published,
          .receivers = static_cast<int>(receivers),
          .separation = static_cast<float>(plan->separation_mm)};
}

TileShadows::TileShadows(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
TileShadows::~TileShadows() = default;
int TileShadows::maps() const { return impl_->plan ? static_cast<int>(impl_->plan->views.size()) : 0; }
int TileShadows::maps_drawn() const { return impl_->maps_drawn; }
int TileShadows::times_made() const { return impl_->times_made; }
double TileShadows::last_kernel_s() const { return impl_->last_kernel_s; }
std::string TileShadows::device_name() const { return impl_->tools->device->name(); }
std::optional<Pose> TileShadows::pose() const { return impl_->plan ? std::optional(impl_->pose) : std::nullopt; }

Result<std::unique_ptr<TileShadows>> TileShadows::create(EglContext& context, const Mesh& mesh) {
  auto tools = std::make_shared<Tools>();
  auto device = OpenClDevice::create();
  if (!device) return tl::unexpected(device.error());
  tools->device = std::move(*device);
  tools->width = tools->device->is_cpu() ? cpu_width : 1;
  auto kernel =
      tools->device->build("tile_visibility", "-DRECEIVERS=" + std::to_string(tools->width), "tile_visibility");
  if (!kernel) return tl::unexpected(kernel.error());
  tools->kernel = *kernel;
  auto pass = ShadowMapPass::create(context, mesh);
  if (!pass) return tl::unexpected(pass.error());
  tools->pass = std::move(*pass);
  auto impl = std::make_unique<Impl>();
  impl->tools = std::move(tools);
  return std::unique_ptr<TileShadows>(new TileShadows(std::move(impl)));
}

std::unique_ptr<TileShadows> TileShadows::another() const {
  auto impl = std::make_unique<Impl>();
  impl->tools = impl_->tools;
  return std::unique_ptr<TileShadows>(new TileShadows(std::move(impl)));
}

bool TileShadows::has(const Pose& pose, const LuminaireGeometry& geometry, const ShadowSettings& settings,
                      const std::optional<TilePositions>& positions) const {
  if (!impl_->plan || impl_->pose != pose || impl_->settings.map_px != settings.map_px) return false;
  const Result<ShadowPlan> plan = plan_shadows(geometry, settings, positions);
  return plan && *plan == *impl_->plan;
}

Status TileShadows::set(const Pose& pose, const LuminaireGeometry& geometry, const ShadowSettings& settings,
                        const std::optional<TilePositions>& positions) {
  const std::optional<ShadowPlan> before = std::exchange(impl_->plan, std::nullopt);
  Result<ShadowPlan> plan = plan_shadows(geometry, settings, positions);
  if (!plan) return tl::unexpected(plan.error());
  const bool alike = before && impl_->pose == pose && impl_->settings.map_px == settings.map_px;
  impl_->pose = pose;
  impl_->settings = settings;
  if (!alike || before != *plan) {
    if (const Status made = impl_->make(*plan, alike ? before : std::nullopt); !made) return made;
    ++impl_->times_made;
  }
  const std::vector<ShadowTileMap> list = maps_of(*plan, settings);
  if (const Status done = impl_->tools->device->fill(impl_->maps, list, "the list of shadow maps"); !done) return done;
  impl_->plan = std::move(*plan);
  return {};
}

Result<TileVisibility> TileShadows::see(std::span<const float> p_xyzw, std::span<const float> face_xyzw) {
  if (!impl_->plan) return fail("no light is set", "shadows", "set it first");
  if (p_xyzw.size() != face_xyzw.size() || p_xyzw.size() % 4 != 0)
    return fail(
        std::to_string(p_xyzw.size()) + " floats of positions and " + std::to_string(face_xyzw.size()) + " of faces",
        "receivers", "give four of each to a receiver");
  Tools& tools = *impl_->tools;
  TileVisibility visibility{impl_->plan->grid, impl_->settings.weighing, {}};
  const std::size_t receivers = p_xyzw.size() / 4, filled = (receivers + tools.width - 1) / tools.width * tools.width;
  const std::size_t receiver_bytes = visibility.receiver_words() * sizeof(std::uint32_t);
  if (filled > max_visibility_bytes / receiver_bytes)
    return fail(
        std::to_string(receivers) + " receivers of " + std::to_string(visibility.grid.tiles()) + " tiles exceed 1 GiB",
        "receivers", "render in parts");
  if (receivers == 0) return visibility;

  // Hand the receivers over. What fills the last work-item is whatever lies there, and is not read back.
  const auto hand = [&](DeviceBuffer& buffer, std::span<const float> all, std::string_view purpose) -> Status {
    if (const Status there = tools.device->make_room(buffer, filled * 4 * sizeof(float), purpose); !there) return there;
    return tools.device->write(buffer, 0, std::as_bytes(all));
  };
  if (const Status done = hand(tools.positions, p_xyzw, "receivers"); !done) return tl::unexpected(done.error());
  if (const Status done = hand(tools.faces, face_xyzw, "their faces"); !done) return tl::unexpected(done.error());
  if (const Status done = tools.device->make_room(tools.words, filled * receiver_bytes, "visibility"); !done)
    return tl::unexpected(done.error());

  // Test them.
  DeviceKernel& kernel = tools.kernel;
  kernel.set(0, impl_->shared(filled));
  kernel.set(1, impl_->maps);
  kernel.set(2, impl_->depths);
  kernel.set(3, tools.positions);
  kernel.set(4, tools.faces);
  kernel.set(5, tools.words);
  const Result<double> ran = tools.device->run(kernel, filled / tools.width, work_group);
  if (!ran) return tl::unexpected(ran.error());
  impl_->last_kernel_s = *ran;
  visibility.words.resize(receivers * visibility.receiver_words());
  if (const Status read = tools.device->read(tools.words, std::as_writable_bytes(std::span(visibility.words))); !read)
    return tl::unexpected(read.error());
  return visibility;
}

}  // namespace lumifield
