#include "renderer/methods/gloss.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <unistd.h>
#include <vector>

#include "renderer/opencl/device.h"

namespace lumifield {
namespace {

constexpr double pi = std::numbers::pi;
const Vec3 up(0, 0, 1);

GlossLobe lobe_of(int kind, double shape, const Vec3& eye, float reflectance = 1) {
  const Eigen::Vector3f o = eye.normalized().cast<float>();
  return {o.x(), o.y(), o.z(), static_cast<float>(shape), reflectance, reflectance, reflectance, kind};
}

Vec3 at_angle(double theta, double phi = 0) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

/// ∫ g(ω) dω over the upper hemisphere: midpoints of ξ and φ, sin²θ spread so that most are near the pole, as GGX's
/// normals of this width are.
double over_normals(double alpha, const std::function<double(const Vec3&)>& g) {
  constexpr int rings = 2000, around = 256;
  const double a2 = alpha * alpha;
  double sum = 0;
  for (int i = 0; i < rings; ++i) {
    const double x = (i + 0.5) / rings, tan2 = a2 * x / (1 - x), c = 1 / std::sqrt(1 + tan2);
    const double density = a2 * c / (pi * std::pow((a2 - 1) * c * c + 1, 2));
    double ring = 0;
    for (int j = 0; j < around; ++j) ring += g(at_angle(std::acos(c), 2 * pi * (j + 0.5) / around));
    sum += ring / density;
  }
  return sum / (rings * around);
}

/// ∫ f cosθ_i dω: the lights are mirrored at the normals above.
double albedo(const GlossLobe& lobe, double alpha) {
  const Vec3 o = Vec3(lobe.eye_x, lobe.eye_y, lobe.eye_z).normalized();
  return over_normals(alpha, [&](const Vec3& h) {
    const double oh = o.dot(h);
    const Vec3 i = 2 * oh * h - o;
    return oh > 0 && i.z() > 0 ? glossy_brdf(lobe, up, i)[0] * i.z() * 4 * oh : 0;
  });
}

TEST(Gloss, IsTheSameWithLightAndEyeExchanged) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int k = 0; k < 2000; ++k) {
    const Eigen::Vector3f i = at_angle(unit(random) * pi / 2, 2 * pi * unit(random)).cast<float>();
    const Vec3 o = at_angle(unit(random) * pi / 2, 2 * pi * unit(random));
    GlossLobe there = lobe_of(1 + k % 2, k % 2 ? std::pow(10, -3 * unit(random)) : 40 * unit(random), o, 0.3F);
    const Vec3 back = Vec3(there.eye_x, there.eye_y, there.eye_z).normalized();
    const double f = glossy_brdf(there, up, i.cast<double>().normalized())[0];
    const double g = glossy_brdf(lobe_of(there.kind, there.shape, i.cast<double>(), 0.3F), up, back)[0];
    EXPECT_NEAR(g, f, 1e-5 * f + 1e-12) << "of directions rounded to float";
  }
}

TEST(Gloss, ShinesOnlyAboveTheSurfaceAndAsItsColourSays) {
  for (const int kind : {LOBE_PHONG, LOBE_GGX}) {
    const GlossLobe lobe = lobe_of(kind, 0.5, Vec3(0.3, 0, 1));
    EXPECT_EQ(glossy_brdf(lobe, up, Vec3(0.8, 0, -0.6))[0], 0);
    EXPECT_EQ(glossy_brdf(lobe, up, Vec3(1, 0, 0))[0], 0);
    EXPECT_EQ(glossy_brdf(lobe, -up, Vec3(0, 0, -1))[0], 0) << "the eye is behind";
    EXPECT_GT(glossy_brdf(lobe, up, up)[0], 0);
    GlossLobe red = lobe;
    red.g = red.b = 0;
    const auto f = glossy_brdf(red, up, up);
    EXPECT_GT(f[0], 10 * f[1]);
    EXPECT_FALSE(is_grey(red));
  }
  EXPECT_EQ(glossy_brdf(lobe_of(LOBE_NONE, 1, up), up, up)[0], 0);
}

TEST(Gloss, GgxNormalsProjectToTheSurface) {
  // With light and eye along h, f is D(h)/(4 cosθ s): G = 2 cos²θ/(2 cosθ s).
  for (const double alpha : {0.001, 0.01, 0.04, 0.25, 1.0})
    EXPECT_NEAR(over_normals(alpha,
                             [&](const Vec3& h) {
                               const double a2 = std::pow(double(float(alpha)), 2), c = h.z();
                               const double s = std::sqrt(a2 + (1 - a2) * c * c);
                               return 4 * c * s * glossy_brdf(lobe_of(LOBE_GGX, alpha, h), up, h)[0] * c;
                             }),
                1, 2e-4)
        << alpha << ": D's integral, but for the eye's rounding to float";
}

TEST(Gloss, GgxGivesBackNoMoreThanItGets) {
  for (const double alpha : {0.01, 0.04, 0.25, 1.0})
    for (const double theta : {0.0, 0.5, 1.0, 1.3, 1.5}) {
      const double all = albedo(lobe_of(LOBE_GGX, alpha, at_angle(theta)), alpha);
      EXPECT_LE(all, 1 + 1e-4) << alpha << " at " << theta;
      if (alpha <= 0.04 && theta <= 1) {
        EXPECT_GT(all, 0.99) << "little is shadowed: " << alpha << " at " << theta;
      }
      // Schlick's share of white comes on top of F0.
      const double some = albedo(lobe_of(LOBE_GGX, alpha, at_angle(theta), 0.04F), alpha);
      EXPECT_LE(some, all);
      EXPECT_GE(some, 0.04 * all);
      if (theta == 0 && alpha <= 0.04) {
        EXPECT_NEAR(some, 0.04 * all, 1e-4);
      }
    }
}

TEST(Gloss, PhongAlongTheNormalGivesItsShare) {
  for (const double n : {1.0, 10.0, 200.0, 1e5})
    EXPECT_NEAR(albedo(lobe_of(LOBE_PHONG, n, up, 0.25F), std::min(1.0, std::sqrt(2 / n))), 0.25, 1e-5) << n;
  // Elsewhere a part of the lobe is below the surface.
  EXPECT_LT(albedo(lobe_of(LOBE_PHONG, 10, at_angle(1.2), 0.25F), 0.5), 0.25);
}

/// The kernels' lobe, built as kernels of the program are: its text stands where they look for the probe's.
class GlossKernel : public testing::Test {
 protected:
  void SetUp() override {
    auto made = OpenClDevice::create();
    if (!made) GTEST_SKIP() << made.error().message();
    device_ = std::move(*made);
    namespace fs = std::filesystem;
    const fs::path root = fs::temp_directory_path() / ("gloss-" + std::to_string(getpid()));
    fs::create_directories(root / "renderer/opencl");
    fs::create_symlink(LUMIFIELD_SOURCE_DIR "/renderer/methods", root / "renderer/methods");
    std::ofstream(root / "renderer/opencl/probe.cl") << R"CL(
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#define INLINE inline __attribute__((always_inline))
#include "renderer/methods/gloss_shared.h"
#include "renderer/methods/gloss.clh"
__kernel void lobes(__global const GlossLobe* lobe, __global const float4* normal, __global const float4* light,
                    __global float4* f) {
  const int k = (int)get_global_id(0);
  const GlossLobe own = lobe[k];
  const float3 n = normal[k].xyz, to_light = light[k].xyz;
  const float facing = (float)((double)n.x * to_light.x + (double)n.y * to_light.y + (double)n.z * to_light.z);
  f[k] = (float4)(glossy_brdf(&own, n, towards_eye(&own, n.x, n.y, n.z), to_light, facing), 0);
}
)CL";
    setenv("LUMIFIELD_KERNELS", root.c_str(), 1);
    auto kernel = device_->build("probe", "", "lobes");
    unsetenv("LUMIFIELD_KERNELS");
    fs::remove_all(root);
    ASSERT_TRUE(kernel) << kernel.error().message();
    kernel_ = std::move(*kernel);
  }

  /// Of each lobe, normal and light (four floats each).
  std::vector<float> values(const std::vector<GlossLobe>& lobes, const std::vector<float>& normals,
                            const std::vector<float>& lights) {
    std::vector<float> f(4 * lobes.size());
    const auto buffer = [&](unsigned number, std::span<const std::byte> bytes) {
      const auto on = device_->allocate(bytes.size(), "a test").value();
      EXPECT_TRUE(device_->write(on, 0, bytes));
      kernel_.set(number, on);
      return on;
    };
    const DeviceBuffer lobes_on = buffer(0, std::as_bytes(std::span(lobes)));
    const DeviceBuffer normals_on = buffer(1, std::as_bytes(std::span(normals)));
    const DeviceBuffer lights_on = buffer(2, std::as_bytes(std::span(lights)));
    const DeviceBuffer out = buffer(3, std::as_bytes(std::span(f)));
    EXPECT_TRUE(device_->run(kernel_, lobes.size(), 1));
    EXPECT_TRUE(device_->read(out, std::as_writable_bytes(std::span(f))));
    return f;
  }

  std::unique_ptr<OpenClDevice> device_;
  DeviceKernel kernel_;
};

TEST_F(GlossKernel, AgreesWithTheHostUpToWhatDirectionsInFloatSay) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<GlossLobe> lobes;
  std::vector<float> normals, lights;
  const auto push = [](std::vector<float>& to, const Vec3& v) {
    for (int c = 0; c < 3; ++c) to.push_back(static_cast<float>(v[c]));
    to.push_back(0);
  };
  for (int k = 0; k < 40000; ++k) {
    // Directions anywhere above the normal, near grazing, or about the mirrored eye.
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5).normalized();
    const auto angle = [&] { return k % 4 == 1 ? pi / 2 - std::pow(10, -6 * unit(random)) : pi / 2 * unit(random); };
    const Vec3 o = at_angle(angle(), 2 * pi * unit(random));
    const bool phong = k % 2 == 0;
    const double shape = phong ? std::pow(10, 5 * unit(random)) : std::pow(10, -3 * unit(random));
    Vec3 i = at_angle(angle(), 2 * pi * unit(random));
    if (k % 4 >= 2) {
      const double width = 3 * (phong ? 1 / std::sqrt(shape) : shape);
      i = (Vec3(-o.x(), -o.y(), o.z()) + width * Vec3(unit(random) - 0.5, unit(random) - 0.5, unit(random) - 0.5));
    }
    lobes.push_back(lobe_of(phong ? LOBE_PHONG : LOBE_GGX, shape, turn * o, 0.3F));
    push(normals, turn * up);
    push(lights, turn * i * (50 + 3000 * unit(random)));
  }
  const std::vector<float> f = values(lobes, normals, lights);
  int sharp = 0;
  for (std::size_t k = 0; k < lobes.size(); ++k) {
    const auto vec = [&](const std::vector<float>& from) {
      return Vec3(from[4 * k], from[4 * k + 1], from[4 * k + 2]);
    };
    const GlossLobe& l = lobes[k];
    const Vec3 n = vec(normals).normalized(), i = vec(lights).normalized(),
               o = Vec3(l.eye_x, l.eye_y, l.eye_z).normalized();
    const double exact = glossy_brdf(l, n, i)[0];
    ASSERT_TRUE(std::isfinite(exact) && std::isfinite(f[4 * k])) << k;
    if (std::abs(n.dot(i)) < 1e-7 || std::abs(n.dot(o)) < 1e-7) continue;  // above or below is rounding's word
    // What f changes by, relatively, when a direction turns: d ln f/dθ, at grazing angles of h.
    const Vec3 mirrored = 2 * n.dot(o) * n - o;
    const double bend = l.kind == LOBE_GGX ? 2 / l.shape / std::min(1.0, (i + o).norm())
                                           : l.shape * mirrored.cross(i).norm() / std::max(mirrored.dot(i), 1e-9);
    sharp += bend > 300;
    constexpr double rounding = 2.5e-7;  // of a direction in float, normalised and mirrored there
    EXPECT_NEAR(f[4 * k], exact, (2e-5 + rounding * bend) * exact + 1e-30)
        << (l.kind == LOBE_GGX ? "GGX " : "Phong ") << l.shape << ", n·i " << n.dot(i) << ", n·o " << n.dot(o);
  }
  EXPECT_LT(sharp, 14000) << "for the others the bound is 1e-4";
}

TEST_F(GlossKernel, IsANumberForDirectionsOfAllKinds) {
  std::vector<GlossLobe> lobes;
  std::vector<float> normals, lights;
  const float heights[] = {-1e-3F, 0, 1e-38F, 1e-30F, 1e-20F, 1e-12F, 1e-6F, 1e-2F, 1};
  for (const auto& [kind, shape] : {std::pair(LOBE_PHONG, 1.0F), {LOBE_PHONG, 1e5F}, {LOBE_GGX, 1e-3F}, {LOBE_GGX, 1}})
    for (const float eye : heights)
      for (const float light : heights)
        for (const float way : {-1.0F, 0.0F, 1.0F}) {
          if (way == 0 && std::abs(light) < 1) continue;
          const float across = eye == 1 ? 0.0F : 1.0F;
          lobes.push_back({across, 0, eye, shape, 1, 1, 1, kind});
          normals.insert(normals.end(), {0, 0, 1, 0});
          lights.insert(lights.end(), {way, 0, light, 0});
        }
  const std::vector<float> f = values(lobes, normals, lights);
  for (std::size_t k = 0; k < lobes.size(); ++k) {
    const Vec3 i = Vec3(lights[4 * k], 0, lights[4 * k + 2]).normalized();
    const bool faces = lobes[k].eye_z > 0 && lights[4 * k + 2] > 0;
    const double host = glossy_brdf(lobes[k], up, i)[0];
    for (const double value : {host, double(f[4 * k])}) {
      EXPECT_TRUE(std::isfinite(value)) << lobes[k].shape << ", " << lobes[k].eye_z << ", " << lights[4 * k + 2];
      EXPECT_TRUE(faces ? value >= 0 : value == 0);
    }
  }
}

}  // namespace
}  // namespace lumifield
