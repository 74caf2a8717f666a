#include "renderer/scene/material.h"

#include <Eigen/Core>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "renderer/scene/mesh.h"

namespace lumifield {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
namespace fs = std::filesystem;

/// A mesh of one triangle with each of the materials of an MTL file.
class MaterialTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string path = (fs::temp_directory_path() / "material_test_XXXXXX").string();
    ASSERT_NE(mkdtemp(path.data()), nullptr);
    folder_ = path;
  }
  void TearDown() override { fs::remove_all(folder_); }
  Result<Mesh> read(const std::string& mtl, const std::map<std::string, MaterialOverride>& overrides = {}) {
    std::ofstream(folder_ / "a.mtl") << mtl;
    std::ofstream(folder_ / "a.obj") << "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    return read_mesh(folder_ / "a.obj", overrides);
  }
  /// The first material; the mesh's notes but for the triangle's.
  Material first(const std::string& mtl, const MaterialOverride& override = {}) {
    auto mesh = read(mtl, {{"a", override}});
    if (!mesh) {
      ADD_FAILURE() << mesh.error().message();
      return {};
    }
    notes_ = mesh->notes;
    std::erase_if(notes_, [](const std::string& note) { return note.find("without a material") != note.npos; });
    return mesh->materials.front();
  }
  std::string error_of(const std::string& mtl, const MaterialOverride& override) {
    const auto mesh = read(mtl, {{"a", override}});
    return mesh ? "" : mesh.error().message();
  }
  fs::path folder_;
  std::vector<std::string> notes_;
};

TEST_F(MaterialTest, KsAndNsArePhongs) {
  const Material m = first("newmtl a\nKd 0.5 0.25 0\nKs 0.5 0.5 0.25\nNs 96.5\n");
  EXPECT_EQ(m.lobe, LOBE_PHONG);
  EXPECT_EQ(m.shape, 96.5F);
  EXPECT_THAT(m.specular, ElementsAre(0.5F, 0.5F, 0.25F));
  EXPECT_THAT(m.diffuse, ElementsAre(0.5F, 0.25F, 0.0F));
  EXPECT_THAT(notes_, IsEmpty());
  EXPECT_EQ(first("newmtl a\nKd 0.5 0.25 0\nKs 0 0 0\nNs 96.5\n").lobe, LOBE_NONE);
  EXPECT_EQ(first("newmtl a\nKd 1 1 1\n").lobe, LOBE_NONE);
}

TEST_F(MaterialTest, PrAndPmAreGgx) {
  Material m = first("newmtl a\nKd 0.5 0.25 0\nPr 0.5\n");
  EXPECT_EQ(m.lobe, LOBE_GGX);
  EXPECT_EQ(m.shape, 0.25F);
  EXPECT_THAT(m.specular, ElementsAre(0.04F, 0.04F, 0.04F));
  EXPECT_THAT(m.diffuse, ElementsAre(0.5F, 0.25F, 0.0F));
  m = first("newmtl a\nKd 0.5 0.25 0\nKs 0.1 0.1 0.2\nNs 20\nPr 0.5\n");
  EXPECT_EQ(m.lobe, LOBE_GGX);
  EXPECT_THAT(m.specular, ElementsAre(0.1F, 0.1F, 0.2F));
  m = first("newmtl a\nKd 0.5 0.25 0\nPr 0.5\nPm 0.75\n");
  EXPECT_THAT(m.diffuse, ElementsAre(0.125F, 0.0625F, 0.0F));
  EXPECT_THAT(m.specular, ElementsAre(testing::FloatEq(0.385F), testing::FloatEq(0.1975F), testing::FloatEq(0.01F)));
  EXPECT_THAT(notes_, IsEmpty());
  EXPECT_EQ(first("newmtl a\nKd 0.5 0.25 0\nPm 0.75\n").lobe, LOBE_NONE);
  EXPECT_THAT(notes_, Contains(HasSubstr("\"a\": it has no roughness (Pr)")));
  EXPECT_FLOAT_EQ(first("newmtl a\nKd 0.5 0.5 0.5\nPr 0\n").shape, 0.0009F);
  EXPECT_THAT(notes_, Contains(HasSubstr("below 0.03 and shows as 0.03")));
}

TEST_F(MaterialTest, WhatReflectsMoreThanItGetsIsNotedAndKept) {
  const Material m = first("newmtl a\nKd 0.75 0.5 0.5\nKs 0.5 0.5 0.5\nNs 10\n");
  EXPECT_THAT(notes_, ElementsAre("material \"a\": its diffuse and specular reflectances add up to 1.25; it reflects "
                                  "more than it gets"));
  EXPECT_EQ(m.diffuse[0], 0.75F);
  first("newmtl a\nKd 0.75 0.5 0.5\nKs 0.25 0.5 0.5\nNs 10\n");
  EXPECT_THAT(notes_, IsEmpty());
}

TEST_F(MaterialTest, OverridesSetTheLobe) {
  const std::string plain = "newmtl a\nKd 0.5 0.5 0.5\n", shiny = plain + "Ks 0.25 0.25 0.25\nNs 10\n";
  Material m = first(plain, {.roughness = 0.5});
  EXPECT_EQ(m.lobe, LOBE_GGX);
  EXPECT_EQ(m.shape, 0.25F);
  EXPECT_THAT(m.specular, ElementsAre(0.04F, 0.04F, 0.04F));
  m = first(shiny, {.roughness = 0.5});
  EXPECT_THAT(m.specular, ElementsAre(0.25F, 0.25F, 0.25F));
  m = first(plain, {.specular = {{0.5, 0.25, 0}}, .exponent = 40});
  EXPECT_EQ(m.lobe, LOBE_PHONG);
  EXPECT_EQ(m.shape, 40);
  EXPECT_THAT(m.specular, ElementsAre(0.5F, 0.25F, 0.0F));
  EXPECT_EQ(first(shiny, {.specular = {{0.5, 0.25, 0}}}).shape, 10) << "the file's exponent stays";
  EXPECT_EQ(first(shiny, {.specular = {{0, 0, 0}}}).lobe, LOBE_NONE);
  EXPECT_THAT(first(plain + "Pr 0.5\nPm 1\n", {.diffuse = {{0.25, 0, 0}}}).diffuse, ElementsAre(0.25F, 0, 0));

  EXPECT_THAT(error_of(plain, {.specular = {{0.5, 0, 0}}}), HasSubstr("materials: a: a specular reflectance without"));
  EXPECT_THAT(error_of(plain, {.exponent = 40}), HasSubstr("an exponent without a specular reflectance"));
  EXPECT_THAT(error_of(plain, {.roughness = 0.5, .exponent = 40}), HasSubstr("a roughness and an exponent"));
  EXPECT_THAT(error_of(plain, {.roughness = 0.01}), HasSubstr("the roughness is not 0.03 to 1"));
  EXPECT_THAT(error_of(shiny, {.exponent = 2e5}), HasSubstr("the exponent is not 1 to 100000"));
  EXPECT_THAT(error_of(plain, {.specular = {{0, 1.5, 0}}}), HasSubstr("the specular reflectance is not 0 to 1"));
}

TEST_F(MaterialTest, RefusesValuesOutOfTheirRangesWithTheLine) {
  for (const auto& [line, says] : {std::pair{"Pr 1.5", "Pr is not a number from 0 to 1"},
                                   {"Pm -0.1", "Pm is not a number from 0 to 1"},
                                   {"Pm nan", "Pm is not a number"},
                                   {"Ns -1", "Ns is not a number from 0 to 100000"},
                                   {"Ns 1e6", "Ns is not a number from 0 to 100000"},
                                   {"Ns", "Ns is not a number"}})
    EXPECT_THAT(error_of(std::string("newmtl a\n") + line + "\n", {}), HasSubstr(std::string("a.mtl:2: ") + says));
}

}  // namespace
}  // namespace lumifield
