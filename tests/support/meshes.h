#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "renderer/scene/mesh.h"

namespace lumifield {

/// Bodies for tests, of flat triangles of one material. mm.
using TestTriangle = std::array<Vec3, 3>;

inline void add_quad(std::vector<TestTriangle>& to, const Vec3& corner, const Vec3& a, const Vec3& b) {
  to.push_back({corner, corner + a, corner + a + b});
  to.push_back({corner, corner + a + b, corner + b});
}

inline void add_box(std::vector<TestTriangle>& to, const Vec3& low, const Vec3& high) {
  const Vec3 size = high - low;
  for (int k = 0; k < 3; ++k) {
    const Vec3 a = Vec3::Unit((k + 1) % 3) * size[(k + 1) % 3], b = Vec3::Unit((k + 2) % 3) * size[(k + 2) % 3];
    add_quad(to, low, b, a);
    add_quad(to, high - a - b, a, b);
  }
}

/// An upright prism with a regular foot that stands in for a cylinder along y.
inline void add_cylinder(std::vector<TestTriangle>& to, const Vec3& foot, double radius, double height, int facets) {
  const auto at = [&](int k) {
    const double angle = 2 * std::numbers::pi * k / facets;
    return Vec3(foot + radius * Vec3(std::cos(angle), 0, std::sin(angle)));
  };
  for (int k = 0; k < facets; ++k) add_quad(to, at(k), Vec3(0, height, 0), at(k + 1) - at(k));
}

/// By longitude and latitude, corners on the sphere.
inline void add_sphere(std::vector<TestTriangle>& to, const Vec3& center, double radius, int parts) {
  const auto at = [&](int i, int j) {
    const double phi = 2 * std::numbers::pi * (i % (2 * parts)) / (2 * parts), theta = std::numbers::pi * j / parts;
    const double off_axis = j == parts ? 0 : std::sin(theta);
    return Vec3(center + radius * Vec3(off_axis * std::cos(phi), off_axis * std::sin(phi), std::cos(theta)));
  };
  for (int j = 0; j < parts; ++j)
    for (int i = 0; i < 2 * parts; ++i) {
      to.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
      to.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
    }
}

/// Triangles given in the luminaire's frame, placed in the scene by `pose`.
inline Mesh mesh_of(const std::vector<TestTriangle>& triangles, const Pose& pose = Pose::Identity()) {
  Mesh mesh;
  mesh.materials.push_back({.name = "grey"});
  for (const TestTriangle& t : triangles) {
    const Eigen::Vector3f n = transform_direction(pose, (t[1] - t[0]).cross(t[2] - t[0])).normalized().cast<float>();
    for (const Vec3& p : t) {
      const Eigen::Vector3f q = transform_point(pose, p).cast<float>();
      mesh.vertices.push_back({{q.x(), q.y(), q.z()}, {n.x(), n.y(), n.z()}});
    }
    mesh.material.push_back(0);
  }
  return mesh;
}

/// Turned about an axis that is none of the frame's, and moved.
inline Pose tilted_pose() {
  Pose pose = Pose::Identity();
  pose.topLeftCorner<3, 3>() = Eigen::AngleAxisd(1.1, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();
  pose.topRightCorner<3, 1>() = Vec3(1200, -350, 800);
  return pose;
}

/// Receivers as TileShadows takes them.
struct TestReceivers {
  std::vector<float> p_xyzw, face_xyzw;

  void add(const Vec3& p, const Vec3& n) {
    for (const double x : {p.x(), p.y(), p.z(), 1.0}) p_xyzw.push_back(static_cast<float>(x));
    for (const double x : {n.x(), n.y(), n.z(), 0.0}) face_xyzw.push_back(static_cast<float>(x));
  }
  std::size_t size() const { return p_xyzw.size() / 4; }
  Vec3 p(std::size_t k) const { return Eigen::Map<const Eigen::Vector3f>(p_xyzw.data() + 4 * k).cast<double>(); }
  Vec3 n(std::size_t k) const { return Eigen::Map<const Eigen::Vector3f>(face_xyzw.data() + 4 * k).cast<double>(); }
};

/// Points drawn evenly from a mesh's surfaces, with their faces' normals to a side drawn, in the luminaire's frame.
inline TestReceivers surface_receivers(const Mesh& mesh, const Pose& pose, std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const Pose to_luminaire = pose.inverse();
  std::vector<TestTriangle> triangles;
  std::vector<double> areas;
  for (std::size_t k = 0; k < mesh.triangles(); ++k) {
    TestTriangle t;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto& p = mesh.vertices[3 * k + i].position_mm;
      t[i] = transform_point(to_luminaire, Vec3(p[0], p[1], p[2]));
    }
    triangles.push_back(t);
    areas.push_back((t[1] - t[0]).cross(t[2] - t[0]).norm());
  }
  std::discrete_distribution<std::size_t> triangle(areas.begin(), areas.end());
  TestReceivers receivers;
  while (receivers.size() < count) {
    const TestTriangle& t = triangles[triangle(random)];
    const double a = std::sqrt(unit(random)), b = unit(random);
    const Vec3 p = (1 - a) * t[0] + a * (1 - b) * t[1] + a * b * t[2];
    const Vec3 n = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    receivers.add(p, unit(random) < 0.5 ? n : Vec3(-n));
  }
  return receivers;
}

}  // namespace lumifield
