#include "renderer/scene/mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <fstream>
#include <optional>
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
    Vertex vertex{array_of(p[k]), array_of(normal.normalized().cast<float>())};
    if (const int t = corners[k].texcoord_index; t >= 0)
      vertex.uv = {attributes.texcoords[2 * static_cast<std::size_t>(t)],
                   attributes.texcoords[2 * static_cast<std::size_t>(t) + 1]};
    mesh.vertices.push_back(vertex);
  }
  return true;
}

MtlMaterial mtl_of(const tinyobj::material_t& m) {
  const auto three = [](const float* v) { return std::array{v[0], v[1], v[2]}; };
  return {m.name, three(m.diffuse), three(m.specular), m.shininess, m.roughness, m.metallic, m.diffuse_texname};
}

/// Whether a texture's line has options (-s, -o, -clamp …) that are not the standard.
bool has_options(const tinyobj::texture_option_t& t) {
  const auto all = [](const float* v, float standard) {
    return v[0] == standard && v[1] == standard && v[2] == standard;
  };
  return !all(t.origin_offset, 0) || !all(t.scale, 1) || !all(t.turbulence, 0) || t.clamp || t.brightness != 0 ||
         t.contrast != 1 || !t.colorspace.empty();
}

/// Reads the textures of materials, each file once.
class TextureShelf {
 public:
  TextureShelf(fs::path folder, Mesh& mesh) : folder_(std::move(folder)), mesh_(mesh) {}

  /// The file's place in the mesh; none, and a note, where it is not shown.
  Result<std::optional<std::size_t>> place(const std::string& material, std::string name) {
    std::ranges::replace(name, '\\', '/');
    const auto not_shown = [&](const char* why) {
      mesh_.notes.push_back("material \"" + material + "\": the texture " + name + " (map_Kd) " + why +
                            "; its plain colour is shown");
      return std::nullopt;
    };
    const Result<fs::path> file = path_inside(folder_, name, folder_.string() + ": map_Kd");
    if (!file) return not_shown("is not in the mesh's folder");
    if (const auto known = places_.find(*file); known != places_.end()) return known->second;
    std::error_code ignored;
    if (!fs::is_regular_file(*file, ignored)) return not_shown("is missing");
    if (!is_texture_file(*file)) return not_shown("is neither PNG nor OpenEXR");
    Result<Texture> texture = read_texture(*file, max_texture_pixels - pixels_);
    if (!texture) return tl::unexpected(texture.error());
    pixels_ += texture->rgb.size() / 3;
    if (!texture->note.empty()) mesh_.notes.push_back(file->string() + ": " + texture->note);
    mesh_.textures.push_back(std::move(*texture));
    return places_[*file] = mesh_.textures.size() - 1;
  }

 private:
  fs::path folder_;
  Mesh& mesh_;
  std::map<fs::path, std::size_t> places_;
  std::size_t pixels_ = 0;
};

Status add_materials(const std::vector<tinyobj::material_t>& materials, const fs::path& folder, Mesh& mesh) {
  TextureShelf shelf(folder, mesh);
  for (const tinyobj::material_t& m : materials) {
    MtlMaterial mtl = mtl_of(m);
    std::optional<std::size_t> texture;
    if (!mtl.map_kd.empty()) {
      const auto place = shelf.place(m.name, mtl.map_kd);
      if (!place) return tl::unexpected(place.error());
      texture = *place;
    }
    const auto note = [&](const char* text) { mesh.notes.push_back("material \"" + m.name + "\": " + text); };
    if (texture && mtl.kd == std::array{0.0F, 0.0F, 0.0F}) {
      mtl.kd = {1, 1, 1};
      note("its Kd is 0 beside a texture, which shows as it is");
    }
    if (texture && has_options(m.diffuse_texopt)) note("the options of its texture (map_Kd) are not shown");
    if (!texture) mtl.map_kd.clear();
    mesh.materials.push_back(material_of(mtl, mesh.notes));
    mesh.materials.back().texture = texture;
  }
  return {};
}

/// Appends all triangles; those without a material get one more, "default".
void add_triangles(const Loaded& loaded, std::size_t triangles, Mesh& mesh) {
  mesh.vertices.reserve(3 * triangles);
  mesh.material.reserve(triangles);
  const auto grey = static_cast<std::uint32_t>(mesh.materials.size());
  std::size_t without_material = 0, without_area = 0, without_place = 0;
  for (const tinyobj::shape_t& shape : loaded.shapes)
    for (std::size_t i = 0; i < shape.mesh.material_ids.size(); ++i) {
      if (!add_triangle(loaded.attributes, &shape.mesh.indices[3 * i], mesh)) {
        ++without_area;
        continue;
      }
      const int id = shape.mesh.material_ids[i];
      without_material += id < 0;
      mesh.material.push_back(id < 0 ? grey : static_cast<std::uint32_t>(id));
      without_place +=
          id >= 0 && mesh.materials[mesh.material.back()].texture && shape.mesh.indices[3 * i].texcoord_index < 0;
    }
  if (without_material > 0) {
    mesh.materials.push_back({.name = "default"});
    mesh.notes.push_back(std::to_string(without_material) +
                         " triangles without a material show as grey 0.5 (\"default\")");
  }
  if (without_area > 0) mesh.notes.push_back(std::to_string(without_area) + " triangles without area are left out");
  if (without_place > 0)
    mesh.notes.push_back(std::to_string(without_place) +
                         " triangles of textured materials have no texture coordinates and show the texture's corner");
}

Status apply(const std::map<std::string, MaterialOverride>& overrides, const fs::path& obj, Mesh& mesh) {
  for (const auto& [name, values] : overrides) {
    bool found = false;
    for (Material& material : mesh.materials) {
      if (material.name != name) continue;
      found = true;
      if (Status replaced = apply_override(values, material); !replaced) return replaced;
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
  Mesh mesh;
  if (const Status added = add_materials(loaded.materials, obj.parent_path(), mesh); !added)
    return tl::unexpected(added.error());
  add_triangles(loaded, text.triangles(), mesh);
  if (mesh.triangles() == 0) return fail("no triangle has an area", obj.string(), "export the mesh again");
  mesh.notes.insert(mesh.notes.begin(), libraries.notes.begin(), libraries.notes.end());
  add_lines(warning, mesh.notes);
  if (const Status applied = apply(overrides, obj, mesh); !applied) return tl::unexpected(applied.error());
  for (const Material& material : mesh.materials) note_energy(material, mesh.notes);
  return mesh;
} catch (const std::exception& exception) {
  return fail(std::string("cannot be loaded: ") + exception.what(), obj.string(), "use a smaller mesh");
}

}  // namespace lumifield
