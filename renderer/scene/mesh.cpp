#include "renderer/scene/mesh.h"

#include <Eigen/Geometry>
#include <fstream>
#include <sstream>
#include <tiny_obj_loader.h>

#include "luminaire/file_io.h"
#include "renderer/scene/checked_text.h"

namespace lumifield {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t max_obj_bytes = std::uintmax_t{16} << 30;
constexpr std::uintmax_t max_mtl_bytes = std::uintmax_t{64} << 20;

/// Opens an ordinary file of bounded size.
Result<std::ifstream> open(const fs::path& file, std::uintmax_t max_bytes) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return fail("no such file", file.string(), "check the name");
  const std::uintmax_t bytes = fs::file_size(file, error);
  if (error || bytes > max_bytes)
    return fail("larger than " + std::to_string(max_bytes >> 20) + " MiB", file.string(), "simplify the mesh");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return fail("cannot be opened", file.string(), "check its permissions");
  return stream;
}

/// Gives tinyobjloader the material libraries of one folder; keeps what is wrong with them.
class LibraryReader : public tinyobj::MaterialReader {
 public:
  explicit LibraryReader(fs::path folder) : folder_(std::move(folder)) {}

  bool operator()(const std::string& name, std::vector<tinyobj::material_t>* materials, std::map<std::string, int>* ids,
                  std::string* warning, std::string* error) override {
    const Result<fs::path> inside = path_inside(folder_, name, folder_.string() + ": mtllib");
    if (!inside) {
      status = tl::unexpected(inside.error());
      return false;
    }
    const fs::path& file = *inside;
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) {
      notes.push_back(file.string() + ": the material library is missing; its materials show as grey 0.5");
      return false;
    }
    Result<std::ifstream> stream = open(file, max_mtl_bytes);
    if (!stream) {
      status = tl::unexpected(stream.error());
      return false;
    }
    MtlText text(*stream, file.string());
    std::istream checked(&text);
    tinyobj::LoadMtl(ids, materials, &checked, warning, error);
    status = text.status();
    if (!status) return false;
    return true;
  }

  Status status;
  std::vector<std::string> notes;

 private:
  fs::path folder_;
};

Eigen::Vector3f vector_at(const std::vector<float>& list, int index) {
  return Eigen::Map<const Eigen::Vector3f>(list.data() + 3 * static_cast<std::size_t>(index));
}

std::array<float, 3> array_of(const Eigen::Vector3f& v) { return {v.x(), v.y(), v.z()}; }

/// What the loader made of the files.
struct Loaded {
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
};

/// Appends one triangle; false where it has no area.
bool add_triangle(const tinyobj::attrib_t& attributes, const tinyobj::index_t* corners, Mesh& mesh) {
  std::array<Eigen::Vector3f, 3> p;
  for (std::size_t k = 0; k < 3; ++k) p[k] = vector_at(attributes.vertices, corners[k].vertex_index);
  const Vec3 face = (p[1] - p[0]).cast<double>().cross((p[2] - p[0]).cast<double>());
  if (face.squaredNorm() == 0) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    Vec3 normal = face;
    if (corners[k].normal_index >= 0) {
      const Vec3 given = vector_at(attributes.normals, corners[k].normal_index).cast<double>();
      if (given.squaredNorm() > 0) normal = given;
    }
    mesh.vertices.push_back({array_of(p[k]), array_of(normal.normalized().cast<float>())});
  }
  return true;
}

void add_materials(const std::vector<tinyobj::material_t>& materials, Mesh& mesh) {
  for (const tinyobj::material_t& m : materials) {
    mesh.materials.push_back({m.name, {m.diffuse[0], m.diffuse[1], m.diffuse[2]}});
    if (!m.diffuse_texname.empty())
      mesh.notes.push_back("material \"" + m.name + "\": the texture " + m.diffuse_texname +
                           " (map_Kd) is not shown; its colour Kd is");
    if (m.specular[0] > 0 || m.specular[1] > 0 || m.specular[2] > 0)
      mesh.notes.push_back("material \"" + m.name + "\": its gloss (Ks) is not shown; surfaces are diffuse");
  }
}

/// Appends all triangles; those without a material get one more, "default".
Mesh mesh_of(const Loaded& loaded, std::size_t triangles) {
  Mesh mesh;
  mesh.vertices.reserve(3 * triangles);
  mesh.material.reserve(triangles);
  add_materials(loaded.materials, mesh);
  const auto grey = static_cast<std::uint32_t>(mesh.materials.size());
  std::size_t without_material = 0, without_area = 0;
  for (const tinyobj::shape_t& shape : loaded.shapes)
    for (std::size_t i = 0; i < shape.mesh.material_ids.size(); ++i) {
      if (!add_triangle(loaded.attributes, &shape.mesh.indices[3 * i], mesh)) {
        ++without_area;
        continue;
      }
      const int id = shape.mesh.material_ids[i];
      without_material += id < 0;
      mesh.material.push_back(id < 0 ? grey : static_cast<std::uint32_t>(id));
    }
  if (without_material > 0) {
    mesh.materials.push_back({.name = "default"});
    mesh.notes.push_back(std::to_string(without_material) +
                         " triangles without a material show as grey 0.5 (\"default\")");
  }
  if (without_area > 0) mesh.notes.push_back(std::to_string(without_area) + " triangles without area are left out");
  return mesh;
}

Status apply(const std::map<std::string, MaterialOverride>& overrides, const fs::path& obj, Mesh& mesh) {
  for (const auto& [name, values] : overrides) {
    bool found = false;
    for (Material& material : mesh.materials) {
      if (material.name != name) continue;
      found = true;
      if (!values.diffuse) continue;
      for (std::size_t k = 0; k < 3; ++k) {
        const double reflectance = (*values.diffuse)[k];
        if (!(reflectance >= 0 && reflectance <= 1))
          return fail("the diffuse reflectance is not 0 to 1", "materials: " + name, "give three numbers from 0 to 1");
        material.diffuse[k] = static_cast<float>(reflectance);
      }
    }
    if (found) continue;
    std::string names;
    for (const Material& material : mesh.materials) names += " " + material.name;
    return fail("no such material in " + obj.string(), "materials: " + name, "use one of:" + names);
  }
  return {};
}

void add_lines(const std::string& text, std::vector<std::string>& notes) {
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (!line.empty()) notes.push_back(line);
}

}  // namespace

Result<Mesh> read_mesh(const fs::path& obj, const std::map<std::string, MaterialOverride>& overrides) try {
  // Load what the check lets through, cutting polygons into triangles.
  Result<std::ifstream> stream = open(obj, max_obj_bytes);
  if (!stream) return tl::unexpected(stream.error());
  ObjText text(*stream, obj.string(), max_triangles);
  std::istream checked(&text);
  Loaded loaded;
  LibraryReader libraries(obj.parent_path());
  std::string warning, error;
  const bool ok = tinyobj::LoadObj(&loaded.attributes, &loaded.shapes, &loaded.materials, &warning, &error, &checked,
                                   &libraries, true, false);
  if (!text.status()) return tl::unexpected(text.status().error());
  if (stream->bad()) return fail("cannot be read to its end", obj.string(), "check the disk");
  if (!libraries.status) return tl::unexpected(libraries.status.error());
  if (text.triangles() == 0) return fail("no triangles", obj.string(), "export the mesh with faces (f lines)");
  if (!ok || !error.empty()) return fail("tinyobjloader says: " + error, obj.string(), "export the mesh again");

  // Turn into one list, with what the user should know.
  Mesh mesh = mesh_of(loaded, text.triangles());
  if (mesh.triangles() == 0) return fail("no triangle has an area", obj.string(), "export the mesh again");
  mesh.notes.insert(mesh.notes.begin(), libraries.notes.begin(), libraries.notes.end());
  add_lines(warning, mesh.notes);
  if (const Status applied = apply(overrides, obj, mesh); !applied) return tl::unexpected(applied.error());
  return mesh;
} catch (const std::exception& exception) {
  return fail(std::string("cannot be loaded: ") + exception.what(), obj.string(), "use a smaller mesh");
}

}  // namespace lumifield
