#include "renderer/picture.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStdIO.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <png.h>
#include <string_view>

#include "luminaire/exr_reason.h"
#include "luminaire/file_io.h"
#include "renderer/bands.h"
#include "renderer/srgb.h"

namespace lumifield {
namespace {

double luminance(const float* rgb) { return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2]; }

/// The radiance from which on each code 1 … 255 shows: the tone curve backwards at the codes' rounding borders. The
/// last stands beyond all.
std::array<double, 256> code_thresholds(double exposure, double average) {
  std::array<double, 256> thresholds{};
  for (std::size_t k = 0; k < 255; ++k) {
    const double v = srgb_decode((static_cast<double>(k) + 0.5) / 255);
    thresholds[k] = -std::log1p(-v) * average / exposure;
  }
  thresholds[255] = std::numeric_limits<double>::infinity();
  return thresholds;
}

/// The number of thresholds at or below a radiance: a table on the upper bits of the float, whose steps of 1/128 are
/// finer than the codes', leaves at most a step or two to compare.
class CodeTable {
 public:
  explicit CodeTable(const std::array<double, 256>& thresholds) : thresholds_(thresholds) {
    for (std::uint32_t upper = 0, code = 0; upper < first_.size(); ++upper) {
      const double least = std::bit_cast<float>(upper << 16);
      while (code < 255 && thresholds_[code] <= least) ++code;
      first_[upper] = static_cast<std::uint8_t>(code);
    }
  }

  std::uint8_t operator()(float radiance) const {
    if (!(radiance > 0)) return 0;
    std::uint8_t code = first_[std::bit_cast<std::uint32_t>(radiance) >> 16];
    while (code < 255 && thresholds_[code] <= radiance) ++code;
    return code;
  }

 private:
  std::array<double, 256> thresholds_;
  std::array<std::uint8_t, 0x7f81> first_{};  ///< up to infinity
};

Status size_status(int width_px, int height_px, std::size_t values, const std::filesystem::path& file) {
  if (width_px > 0 && height_px > 0 &&
      values == 3 * static_cast<std::size_t>(width_px) * static_cast<std::size_t>(height_px))
    return {};
  return fail("an empty picture", file.string(), "render one first");
}

}  // namespace

double average_luminance(const Picture& picture) {
  // Blocks of fixed size keep the sum the same on any number of threads.
  constexpr std::size_t block = 1 << 12;
  struct Part {
    double sum = 0;
    std::size_t lit = 0;
  };
  const std::size_t pixels = picture.rgb.size() / 3;
  std::vector<Part> parts((pixels + block - 1) / block);
  in_bands(pixels, [&](std::size_t begin, std::size_t end) {
    // A band has the blocks that begin in it.
    for (std::size_t k = (begin + block - 1) / block; k * block < end; ++k) {
      Part part;
      for (std::size_t i = k * block; i < std::min(pixels, (k + 1) * block); ++i) {
        const double l = luminance(&picture.rgb[3 * i]);
        if (!(l > 0)) continue;
        part.sum += l;
        ++part.lit;
      }
      parts[k] = part;
    }
  });
  Part all;
  for (const Part& part : parts) {
    all.sum += part.sum;
    all.lit += part.lit;
  }
  return all.lit == 0 ? 0 : all.sum / static_cast<double>(all.lit);
}

Picture8 tone_map(const Picture& picture, const ToneCurve& curve) {
  const double average = curve.white > 0 ? curve.white : average_luminance(picture);
  Picture8 mapped{picture.width_px, picture.height_px, std::vector<std::uint8_t>(picture.rgb.size(), 0)};
  if (!(average > 0 && curve.exposure > 0)) return mapped;
  const CodeTable codes(code_thresholds(curve.exposure, average));
  in_bands(picture.rgb.size(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) mapped.srgb[i] = codes(picture.rgb[i]);
  });
  return mapped;
}

Status write_png(const Picture8& picture, const std::filesystem::path& file) {
  if (const Status sized = size_status(picture.width_px, picture.height_px, picture.srgb.size(), file); !sized)
    return sized;
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(picture.width_px);
  image.height = static_cast<png_uint_32>(picture.height_px);
  image.format = PNG_FORMAT_RGB;
  std::string bytes(PNG_IMAGE_PNG_SIZE_MAX(image), '\0');
  png_alloc_size_t size = bytes.size();
  if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, picture.srgb.data(), 0, nullptr))
    return fail(std::string("libpng says: ") + image.message, file.string(), "render a smaller picture");
  return write_file_durably(file, std::string_view(bytes).substr(0, size));
}

Status write_exr(const Picture& picture, const std::filesystem::path& file) try {
  if (const Status sized = size_status(picture.width_px, picture.height_px, picture.rgb.size(), file); !sized)
    return sized;
  Imf::Header header(picture.width_px, picture.height_px);
  header.compression() = Imf::ZIP_COMPRESSION;
  if (!picture.note.empty()) Imf::addComments(header, picture.note);
  Imf::FrameBuffer pixels;
  constexpr std::size_t x_stride = 3 * sizeof(float);
  const std::size_t y_stride = x_stride * static_cast<std::size_t>(picture.width_px);
  for (std::size_t c = 0; c < 3; ++c) {
    const char name[] = {"RGB"[c], 0};
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    char* first = reinterpret_cast<char*>(const_cast<float*>(picture.rgb.data() + c));
    pixels.insert(name, Imf::Slice(Imf::FLOAT, first, x_stride, y_stride));
  }
  Imf::StdOSStream stream;
  {
    Imf::OutputFile output(stream, header);
    output.setFrameBuffer(pixels);
    output.writePixels(picture.height_px);
  }
  return write_file_durably(file, stream.str());
} catch (const std::exception& exception) {
  return fail("OpenEXR says: " + exr_reason(exception), file.string(), "render a smaller picture");
}

}  // namespace lumifield
