#pragma once

#include <array>
#include <cstddef>
#include <istream>
#include <optional>
#include <streambuf>
#include <string>
#include <string_view>

#include "luminaire/error.h"

namespace lumifield {

/// Wavefront text between a file and a loader that trusts its input: the loader reads from this buffer, line by line,
/// only what was checked, in its plainest spelling; keywords that are not shown are dropped. At the first fault the
/// text ends and status() tells it with `name:line`. Thread-bound.
class CheckedText : public std::streambuf {
 public:
  const Status& status() const { return status_; }

 protected:
  CheckedText(std::istream& source, std::string name) : source_(*source.rdbuf()), name_(std::move(name)) {}
  /// The line to hand on, "" to drop it; or refuses.
  virtual std::string plain(std::string_view keyword, std::string_view rest) = 0;
  std::string refuse(std::string what, std::string remedy);
  int_type underflow() override;

 private:
  bool read_line();
  std::streambuf& source_;
  std::string name_;
  Status status_;
  std::size_t line_number_ = 0;
  std::string line_, given_;
};

/// OBJ: v, vn, vt, f, usemtl, mtllib. Refuses a position or normal that is not three finite floats, texture coordinates
/// that are not one or two, a face of fewer than three corners or with a corner that names nothing read so far, and
/// more than `most_triangles` triangles (polygons counted as cut) or three times as many positions.
class ObjText final : public CheckedText {
 public:
  ObjText(std::istream& source, std::string name, std::size_t most_triangles)
      : CheckedText(source, std::move(name)), most_triangles_(most_triangles) {}
  std::size_t triangles() const { return triangles_; }

 protected:
  std::string plain(std::string_view keyword, std::string_view rest) override;

 private:
  std::string vertex(std::string_view keyword, std::string_view rest);
  std::string texture_coordinates(std::string_view rest);
  std::string face(std::string_view rest);
  std::optional<std::string> corner(std::string_view word) const;
  std::size_t most_triangles_, triangles_ = 0;
  std::size_t positions_ = 0, normals_ = 0, texture_coordinates_ = 0;
};

/// MTL: newmtl, Kd, Ks, Ns, Pr, Pm, map_Kd. Refuses a Kd or Ks that is not three numbers from 0 to 1, a Pr or Pm that
/// is not one, and an Ns that is not from 0 to 1e5. To the loader a Pr of 0 is one that is absent: it reads least_pr. A
/// texture without a Kd before it gets one of 1.
class MtlText final : public CheckedText {
 public:
  MtlText(std::istream& source, std::string name) : CheckedText(source, std::move(name)) {}
  static constexpr float least_pr = 1e-6F;

 protected:
  std::string plain(std::string_view keyword, std::string_view rest) override;

 private:
  std::string colour(std::string_view keyword, std::string_view rest);
  std::string share(std::string_view keyword, std::string_view rest, float most);
  bool has_kd_ = false;  ///< of the material begun last
};

}  // namespace lumifield
