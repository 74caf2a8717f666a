#include "luminaire/cell_exr.h"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfTileDescription.h>
#include <ImfTileDescriptionAttribute.h>
#include <ImfVersion.h>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <limits>
#include <stdexcept>

#include "luminaire/exr_attributes.h"
#include "luminaire/exr_reason.h"

namespace lumifield {
namespace {

constexpr const char* variance_suffix = ".variance";
constexpr const char* damaged = "measure the cell again, or copy its file anew";

class MemoryOutput : public Imf::OStream {
 public:
  MemoryOutput() : OStream("cell in memory") {}
  void write(const char bytes[], int n) override {
    const auto count = static_cast<std::size_t>(n);
    if (at_ + count > text_.size()) text_.resize(at_ + count);
    std::memcpy(text_.data() + at_, bytes, count);
    at_ += count;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t at) override { at_ = at; }
  void reserve(std::size_t bytes) { text_.reserve(bytes); }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
  std::size_t at_ = 0;
};

class MemoryInput : public Imf::IStream {
 public:
  explicit MemoryInput(std::string_view bytes) : IStream("cell in memory"), bytes_(bytes) {}
  bool read(char to[], int n) override {
    const auto count = static_cast<std::size_t>(n);
    if (n < 0 || at_ > bytes_.size() || count > bytes_.size() - at_) throw std::runtime_error("the file ends early");
    std::memcpy(to, bytes_.data() + at_, count);
    at_ += count;
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t at) override { at_ = at; }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

/// One slice per channel of the file, over the planes of `image`.
Imf::FrameBuffer planes_of(CellImage& image, const std::vector<std::string>& channels, const Imath::V2i& origin) {
  Imf::FrameBuffer buffer;
  const auto add = [&](const std::string& name, float* plane) {
    const auto width = static_cast<std::size_t>(image.width_px);
    buffer.insert(name, Imf::Slice::Make(Imf::FLOAT, plane, origin, image.width_px, image.height_px, sizeof(float),
                                         width * sizeof(float)));
  };
  for (std::size_t c = 0; c < channels.size(); ++c) {
    add(channels[c], image.value.data() + c * image.plane());
    if (!image.variance.empty()) add(channels[c] + variance_suffix, image.variance.data() + c * image.plane());
  }
  return buffer;
}

Status check_windows(const Imf::Header& header, const Measurement& m, std::string_view where) {
  const Imath::Box2i data = header.dataWindow(), display = header.displayWindow();
  const auto side = [](int low, int high) { return static_cast<long long>(high) - low + 1; };
  const long long width = side(data.min.x, data.max.x), height = side(data.min.y, data.max.y);
  if (width != m.width_px || height != m.height_px)
    return fail("is an image of " + std::to_string(width) + " x " + std::to_string(height) + " pixels, not of " +
                    std::to_string(m.width_px) + " x " + std::to_string(m.height_px),
                std::string(where), "check the manifest's measurement");
  if (data != display)
    return fail("has a data window other than its display window", std::string(where), "write the whole image");
  // Beyond this the library's own addresses of pixels overflow.
  constexpr int farthest = 1 << 20;
  if (std::abs(static_cast<long long>(data.min.x)) > farthest ||
      std::abs(static_cast<long long>(data.min.y)) > farthest)
    return fail("has its data window too far from the origin", std::string(where), "let it begin at (0, 0)");
  if (header.hasTileDescription()) {
    const Imf::TileDescription& tiles = header.tileDescription();
    constexpr unsigned int largest = 1024;
    if (tiles.xSize > largest || tiles.ySize > largest)
      return fail("has tiles of more than 1024 pixels a side", std::string(where), "write scanlines");
  }
  return {};
}

/// Which of the luminaire's channels the file has. True when it has their variance too.
Result<bool> check_channels(const Imf::Header& header, const LuminaireGeometry& geometry, std::string_view where) {
  constexpr int most_channels = 64;
  int count = 0;
  for (auto each = header.channels().begin(); each != header.channels().end(); ++each) ++count;
  if (count > most_channels)
    return fail("has more than 64 channels", std::string(where), "remove those not of the luminaire");
  std::size_t with_variance = 0;
  for (const std::string& name : geometry.channels)
    for (const std::string& full : {name, name + variance_suffix}) {
      const Imf::Channel* channel = header.channels().findChannel(full);
      if (!channel && full == name) return fail("has no channel " + name, std::string(where), damaged);
      if (!channel) continue;
      if (channel->type == Imf::UINT || channel->xSampling != 1 || channel->ySampling != 1)
        return fail("has channel " + full + " neither HALF nor FLOAT, or not at every pixel", std::string(where),
                    "write it as FLOAT");
      with_variance += full != name;
    }
  if (with_variance != 0 && with_variance != geometry.channels.size())
    return fail("has the variance of some channels only", std::string(where), "write that of all, or of none");
  return with_variance != 0;
}

std::optional<int> int_attribute(const Imf::Header& header, const char* name) {
  const auto* attribute = header.findTypedAttribute<Imf::IntAttribute>(name);
  return attribute ? std::optional<int>(attribute->value()) : std::nullopt;
}

/// May throw what OpenEXR throws.
Result<CellExr> decode(std::string_view bytes, const LuminaireGeometry& geometry, std::string_view where) {
  // Look at the header alone: the library takes memory for the whole image when it opens a file.
  MemoryInput first(bytes);
  first.seekg(8);
  int version = static_cast<unsigned char>(bytes[4]) | static_cast<unsigned char>(bytes[5]) << 8;
  if (Imf::isMultiPart(version) || Imf::isNonImage(version))
    return fail("has several parts or deep pixels", std::string(where), "write one part with one value a pixel");
  Imf::Header header;
  header.readFrom(first, version);
  const Measurement& m = geometry.measurement;
  if (Status ok = check_windows(header, m, where); !ok) return tl::unexpected(ok.error());
  const Result<bool> variance = check_channels(header, geometry, where);
  if (!variance) return tl::unexpected(variance.error());

  MemoryInput input(bytes);
  Imf::InputFile file(input, 0);
  CellExr cell;
  cell.image.width_px = m.width_px;
  cell.image.height_px = m.height_px;
  cell.image.channels = static_cast<int>(geometry.channels.size());
  cell.image.value.resize(m.pixels() * geometry.channels.size());
  if (*variance) cell.image.variance.resize(cell.image.value.size());
  cell.image.quality = unknown_quality();
  const Imath::Box2i window = header.dataWindow();
  file.setFrameBuffer(planes_of(cell.image, geometry.channels, window.min));
  file.readPixels(window.min.y, window.max.y);
  cell.row = int_attribute(header, "lumifield.row");
  cell.column = int_attribute(header, "lumifield.column");
  cell.generation = int_attribute(header, "lumifield.generation");
  return cell;
}

}  // namespace

Quality unknown_quality() {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  return {unknown, unknown, unknown, unknown, unknown, unknown, {}, {}};
}

Result<std::string> encode_cell_exr(const CellImage& image, const LuminaireGeometry& geometry, CellIndex cell,
                                    int generation) {
  try {
    Imf::Header header(image.width_px, image.height_px);
    header.compression() = Imf::NO_COMPRESSION;
    for (const std::string& name : geometry.channels) {
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      if (!image.variance.empty()) header.channels().insert(name + variance_suffix, Imf::Channel(Imf::FLOAT));
    }
    header.insert("lumifield.row", Imf::IntAttribute(cell.row));
    header.insert("lumifield.column", Imf::IntAttribute(cell.column));
    header.insert("lumifield.generation", Imf::IntAttribute(generation));
    MemoryOutput output;
    output.reserve((image.value.size() + image.variance.size()) * sizeof(float) +
                   64 * geometry.measurement.pixels() / 256 + 65536);
    {
      Imf::OutputFile file(output, header, 0);
      // OpenEXR's slices are writable by type; writing a file only reads them.
      file.setFrameBuffer(planes_of(const_cast<CellImage&>(image), geometry.channels, {0, 0}));
      file.writePixels(image.height_px);
    }
    return output.take();
  } catch (const std::exception& e) {
    return fail("could not be encoded as OpenEXR (" + exr_reason(e) + ")", "cell " + to_string(cell));
  }
}

Result<CellExr> decode_cell_exr(std::string_view bytes, const LuminaireGeometry& geometry, std::string_view where) {
  constexpr std::string_view magic = "\x76\x2f\x31\x01";
  if (bytes.size() < 8 || bytes.substr(0, 4) != magic) return fail("is no OpenEXR file", std::string(where), damaged);
  if (!exr_attributes_fit(bytes))
    return fail("ends within its header, or has a damaged one", std::string(where), damaged);
  try {
    Result<CellExr> cell = decode(bytes, geometry, where);
    if (!cell) return cell;
    if (Status ok = check_image(geometry, cell->image, where); !ok) return tl::unexpected(ok.error());
    return cell;
  } catch (const std::exception& e) {
    return fail("is damaged or ends early (" + exr_reason(e) + ")", std::string(where), damaged);
  }
}

}  // namespace lumifield
