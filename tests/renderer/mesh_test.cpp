#include "renderer/scene/mesh.h"

#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sstream>

#include "renderer/scene/checked_text.h"

namespace lumifield {
namespace {

using testing::Contains;
using testing::HasSubstr;
namespace fs = std::filesystem;

class MeshTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string path = (fs::temp_directory_path() / "mesh_test_XXXXXX").string();
    ASSERT_NE(mkdtemp(path.data()), nullptr);
    folder_ = path;
  }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path write(const std::string& name, const std::string& text) {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  /// The error's message, empty when it reads.
  std::string error_of(const std::string& obj) {
    const auto mesh = read_mesh(write("bad.obj", obj));
    return mesh ? "" : mesh.error().message();
  }
  fs::path folder_;
};

TEST_F(MeshTest, ReadsTrianglesNormalsAndMaterials) {
  write("a.mtl", "newmtl red\nKd 0.8 0.1 0.25\nnewmtl blue\nKd 0 0 1\n");
  const auto mesh =
      read_mesh(write("a.obj",
                      "mtllib a.mtl\nv 0 0 0\nv 2 0 0\nv 2 3 0\nv 0 3 0\nv 0 0 -1.5e1\nvn 0 0 5\nvn 1 0 1\n"
                      "usemtl blue\nf 1 2 3 4\nusemtl red\nf 1//1 2//2 5//1\n"));
  ASSERT_TRUE(mesh) << mesh.error().message();
  ASSERT_EQ(mesh->triangles(), 3U);
  ASSERT_EQ(mesh->vertices.size(), 9U);
  EXPECT_THAT(mesh->notes, testing::IsEmpty());
  ASSERT_EQ(mesh->materials.size(), 2U);
  EXPECT_EQ(mesh->materials[mesh->material[0]].name, "blue");
  EXPECT_EQ(mesh->materials[mesh->material[2]].name, "red");
  EXPECT_EQ(mesh->materials[mesh->material[2]].diffuse, (std::array{0.8F, 0.1F, 0.25F}));

  // Face normals where the file has none, else the file's, of unit length.
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(mesh->vertices[i].normal, (std::array{0.0F, 0.0F, 1.0F}));
  EXPECT_EQ(mesh->vertices[6].normal, (std::array{0.0F, 0.0F, 1.0F}));
  EXPECT_FLOAT_EQ(mesh->vertices[7].normal[0], std::sqrt(0.5F));
  EXPECT_EQ(mesh->vertices[8].position_mm, (std::array{0.0F, 0.0F, -15.0F}));
}

TEST_F(MeshTest, NegativeIndicesCountBack) {
  const auto mesh = read_mesh(write("a.obj", "v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\n"));
  ASSERT_TRUE(mesh) << mesh.error().message();
  EXPECT_EQ(mesh->vertices[0].position_mm, (std::array{0.0F, 0.0F, 0.0F}));
  EXPECT_EQ(mesh->vertices[2].position_mm, (std::array{0.0F, 1.0F, 0.0F}));
}

TEST_F(MeshTest, WhatIsNotShownIsNoted) {
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  auto mesh = read_mesh(write("a.obj", "mtllib absent.mtl\n" + triangle + "usemtl wall\nf 1 2 3\n"));
  ASSERT_TRUE(mesh) << mesh.error().message();
  EXPECT_THAT(mesh->notes, Contains(HasSubstr("absent.mtl: the material library is missing")));
  EXPECT_EQ(mesh->materials[mesh->material[0]].name, "default");
  EXPECT_EQ(mesh->materials[mesh->material[0]].diffuse, (std::array{0.5F, 0.5F, 0.5F}));

  write("b.mtl", "newmtl wall\nKd 1 1 1\nKs 0.2 0.2 0.2\nmap_Kd bricks.png\n");
  mesh = read_mesh(write("b.obj", "mtllib b.mtl\n" + triangle + "usemtl wall\nf 1 2 3\nf 1 1 2\n"));
  ASSERT_TRUE(mesh) << mesh.error().message();
  EXPECT_THAT(mesh->notes, Contains(HasSubstr("bricks.png (map_Kd) is missing; its plain colour is shown")));
  EXPECT_THAT(mesh->notes, Contains("1 triangles without area are left out"));
}

TEST_F(MeshTest, OverridesReplaceByName) {
  write("a.mtl", "newmtl wall\nKd 1 1 1\nnewmtl floor\nKd 0.25 0.25 0.25\n");
  const fs::path obj = write("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl wall\nf 1 2 3\n");
  const auto mesh = read_mesh(obj, {{"wall", {{{0.5, 0.75, 0}}}}, {"floor", {}}});
  ASSERT_TRUE(mesh) << mesh.error().message();
  EXPECT_EQ(mesh->materials[0].diffuse, (std::array{0.5F, 0.75F, 0.0F}));
  EXPECT_EQ(mesh->materials[1].diffuse, (std::array{0.25F, 0.25F, 0.25F}));
  EXPECT_THAT(read_mesh(obj, {{"roof", {}}}).error().message(), HasSubstr("materials: roof: no such material"));
  EXPECT_THAT(read_mesh(obj, {{"wall", {{{1.5, 0, 0}}}}}).error().message(), HasSubstr("not 0 to 1"));
}

TEST_F(MeshTest, RefusesBrokenFilesWithTheLine) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  EXPECT_THAT(read_mesh(folder_ / "absent.obj").error().message(), HasSubstr("absent.obj: no such file"));
  EXPECT_THAT(read_mesh(folder_).error().message(), HasSubstr("no such file"));
  EXPECT_THAT(error_of(""), HasSubstr("bad.obj: no triangles"));
  EXPECT_THAT(error_of(vertices), HasSubstr("bad.obj: no triangles"));
  EXPECT_THAT(error_of(vertices + "f 1 1 2\n"), HasSubstr("no triangle has an area"));
  EXPECT_THAT(error_of("v 0 nan 0\n" + vertices + "f 1 2 3\n"), HasSubstr("bad.obj:1: not three finite numbers"));
  for (const char* number : {"inf", "1e39", "-1e400", "one", "1.0x", ""})
    EXPECT_THAT(error_of(vertices + "v 0 0 " + number + "\nf 1 2 3\n"), HasSubstr("bad.obj:4:")) << number;
  EXPECT_THAT(error_of(vertices + "vn 0 0 -nan\nf 1 2 3\n"), HasSubstr("bad.obj:4:"));
  EXPECT_THAT(error_of(vertices + "vt 0 nan\nf 1 2 3\n"), HasSubstr("bad.obj:4: not one or two finite numbers"));
  EXPECT_THAT(error_of("f 1 2 3\n" + vertices), HasSubstr("bad.obj:1: the face's corner \"1\""));
  EXPECT_THAT(error_of(vertices + "f 1//1 2//1 3//1\n"), HasSubstr("corner \"1//1\" names nothing"));
  for (const char* face :
       {"0 1 2", "-4 1 2", "1 2 x", "1 2 3/", "1 2 99999999999", "1/2/3/4 2 3", "1 2 3\\", "1 2 4", "1 2 3/0"})
    EXPECT_THAT(error_of(vertices + "f " + face + "\n"), HasSubstr("bad.obj:4:")) << face;
  EXPECT_THAT(error_of(vertices + "f 1 2\n"), HasSubstr("bad.obj:4: a face of fewer than 3 corners"));
}

TEST_F(MeshTest, RefusesBrokenLibraries) {
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  EXPECT_THAT(error_of("mtllib ../../x.mtl\n" + obj), HasSubstr("mtllib: leads out of the folder"));
  EXPECT_THAT(error_of("mtllib /etc/passwd\n" + obj), HasSubstr("mtllib: is an absolute path"));
  for (const char* value : {"1.5 0 0", "-0.1 0 0", "nan 0 0", "0.5", "spectral a.rfl"}) {
    write("bad.mtl", std::string("newmtl a\nKd ") + value + "\n");
    EXPECT_THAT(error_of("mtllib bad.mtl\n" + obj), HasSubstr("bad.mtl:2: Kd is not three numbers")) << value;
  }
}

TEST_F(MeshTest, LinesEndInAnyWayAndBinaryIsRefused) {
  EXPECT_EQ(error_of("v 0 0 0\rv 1 0 0\r\nv 0 1 0\n\tf\t1 2  3"), "");
  EXPECT_THAT(error_of("v 0 0 0\r\nv 1 0 0\rv 0 one 0\n"), HasSubstr("bad.obj:3:"));
  std::string binary = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  binary.push_back('\0');
  EXPECT_THAT(error_of(binary + "f 1 2 3"), HasSubstr("bad.obj:4: not lines of text"));
}

/// All that the loader gets to read.
std::string handed_on(const std::string& obj, std::size_t most, Status& status) {
  std::istringstream source(obj);
  ObjText text(source, "a.obj", most);
  std::string read((std::istreambuf_iterator<char>(&text)), {});
  status = text.status();
  return read;
}

TEST(ObjText, HandsOnPlainLines) {
  Status status;
  const std::string read = handed_on(
      "# words\nv +.5 1e0 -2 1 0 0\nv 1 0 0\nv 0 1 0\nvt .5 -2 1\np 7\nf -3/-1 2/1 3\nusemtl  a b\nusemtl\nl 4 5\n", 9,
      status);
  EXPECT_TRUE(status);
  EXPECT_EQ(
      read,
      "v 5.00000000e-01 1.00000000e+00 -2.00000000e+00\nv 1.00000000e+00 0.00000000e+00 0.00000000e+00\n"
      "v 0.00000000e+00 1.00000000e+00 0.00000000e+00\nvt 5.00000000e-01 -2.00000000e+00\nf 1/1 2/1 3\nusemtl a b\n");
}

TEST(ObjText, CountsTrianglesOfPolygonsAgainstTheirLimit) {
  const std::string four = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 2 0\nf 1 2 3 4 5\nf 1 2 3\n";
  Status status;
  handed_on(four, 4, status);
  EXPECT_TRUE(status);
  handed_on(four, 3, status);
  EXPECT_EQ(status.error().message(), "a.obj:7: more than 3 triangles; simplify the mesh");
}

}  // namespace
}  // namespace lumifield
