#pragma once

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "renderer/methods/closed_form.h"
#include "renderer/opengl/gbuffer.h"
#include "renderer/renderer.h"
#include "renderer/scene/mesh.h"

namespace lumifield::test {

inline constexpr int width = 40, height = 30;

inline LuminaireGeometry geometry_of(std::vector<std::string> channels) {
  LuminaireGeometry g;
  g.planes.separation_mm = 150;
  g.sampling = {BasisKind::bell, {7.5, 6}, 3, 2, {1, -2}};
  g.measurement = {40, 30, {6, 6}, {3, 1}};
  g.channels = std::move(channels);
  g.quantity = Quantity::radiance;
  return g;
}

inline std::shared_ptr<const CellImage> image_of(const LuminaireGeometry& g, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(-0.1F, 1);
  CellImage image;
  image.width_px = g.measurement.width_px;
  image.height_px = g.measurement.height_px;
  image.channels = static_cast<int>(g.channels.size());
  image.value.resize(image.plane() * g.channels.size());
  for (float& v : image.value) v = uniform(random);
  return std::make_shared<const CellImage>(std::move(image));
}

inline LightField light_field_of(const LuminaireGeometry& g) {
  LightField field(g);
  for (int k = 0; k < g.sampling.cells(); ++k)
    EXPECT_TRUE(field.add(g.sampling.index(k), image_of(g, static_cast<unsigned>(k) + 1)));
  return field;
}

/// A rotation about a slanted axis, then a shift.
inline Pose pose_of(double angle, const Vec3& axis, const Vec3& shift) {
  Pose pose = Pose::Identity();
  pose.topLeftCorner<3, 3>() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  pose.topRightCorner<3, 1>() = shift;
  return pose;
}

/// Largest difference of two pictures over the largest value.
inline double difference(const Picture& a, const Picture& b) {
  EXPECT_EQ(a.rgb.size(), b.rgb.size());
  EXPECT_EQ(a.coverage, b.coverage);
  double most = 0, apart = 0;
  for (std::size_t i = 0; i < std::min(a.rgb.size(), b.rgb.size()); ++i) {
    most = std::max(most, static_cast<double>(std::abs(a.rgb[i])));
    apart = std::max(apart, static_cast<double>(std::abs(a.rgb[i] - b.rgb[i])));
  }
  EXPECT_GT(most, 0);
  return apart / most;
}

/// A floor and a wall, 700 mm before lamps that shine down and aside.
class RendererTest : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto gl = probe_opengl(); !gl) GTEST_SKIP() << gl.error().message();
    if (const auto cl = probe_opencl(); !cl) GTEST_SKIP() << cl.error().message();
    std::string path = (std::filesystem::temp_directory_path() / "renderer_test_XXXXXX").string();
    ASSERT_NE(mkdtemp(path.data()), nullptr);
    folder_ = path;
    std::ofstream(folder_ / "room.mtl") << "newmtl floor\nKd 0.5 0.25 0.75\nnewmtl wall\nKd 0.8 0.8 0.8\n";
    std::ofstream(folder_ / "room.obj")
        << "mtllib room.mtl\nv -800 -500 0\nv 800 -500 0\nv 800 700 0\nv -800 700 0\nv -800 700 500\nv 800 700 500\n"
           "usemtl floor\nf 1 2 3 4\nusemtl wall\nf 4 3 6 5\n";
    scene_.mesh = folder_ / "room.obj";
    scene_.camera.position_mm = {300, -1200, 900};
    scene_.camera.target_mm = {0, 200, 150};
    scene_.luminaires = {{pose_of(2.6, {1, 0.2, 0}, {50, 100, 700}), 1}};
  }
  void TearDown() override {
    if (!folder_.empty()) std::filesystem::remove_all(folder_);
  }
  std::unique_ptr<Renderer> renderer_of(const Scene& scene, const LuminaireGeometry& geometry) {
    auto renderer = Renderer::create(scene, width, height);
    EXPECT_TRUE(renderer) << renderer.error().message();
    const Status set = (*renderer)->set_luminaire(geometry);
    EXPECT_TRUE(set) << set.error().message();
    return std::move(*renderer);
  }
  Picture fresh(const Scene& scene, const LightField& field) {
    auto renderer = renderer_of(scene, field.geometry());
    const Status added = renderer->add_all(field);
    EXPECT_TRUE(added) << added.error().message();
    return *renderer->picture();
  }
  /// The picture by the host's closed form at the G-buffer's positions.
  Picture expected(const LightField& field, double lod = 0);

  std::filesystem::path folder_;
  Scene scene_;
};

inline Picture RendererTest::expected(const LightField& field, double lod) {
  const ClosedForm closed_form(field, lod);
  const auto mesh = read_mesh(scene_.mesh);
  auto context = EglContext::create();
  const auto g = (*GBufferPass::create(**context, *mesh))->draw(scene_.camera, width, height);
  Picture picture{width, height, std::vector<float>(3 * width * height), std::vector<float>(width * height), {}};
  for (std::size_t i = 0; i < picture.coverage.size(); ++i) {
    picture.coverage[i] = g->position[4 * i + 3];
    if (picture.coverage[i] == 0) continue;
    std::array<double, 3> sum{};
    for (const ScenePlacement& placement : scene_.luminaires) {
      const Pose inverse = placement.pose.inverse();
      const Vec3 p(g->position[4 * i], g->position[4 * i + 1], g->position[4 * i + 2]);
      const Vec3 n(g->normal[4 * i], g->normal[4 * i + 1], g->normal[4 * i + 2]);
      const auto e = closed_form.irradiance({transform_point(inverse, p), transform_direction(inverse, n)});
      for (std::size_t c = 0; c < 3; ++c) sum[c] += placement.scale * e[e.size() == 3 ? c : 0];
    }
    const Material& material = mesh->materials[static_cast<std::size_t>(g->normal[4 * i + 3])];
    for (std::size_t c = 0; c < 3; ++c)
      picture.rgb[3 * i + c] = static_cast<float>(material.diffuse[c] * sum[c] / std::numbers::pi);
  }
  return picture;
}

}  // namespace lumifield::test
