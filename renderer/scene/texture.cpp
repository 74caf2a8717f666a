#include "renderer/scene/texture.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfStdIO.h>
#include <OpenEXR/ImfTileDescriptionAttribute.h>
#include <OpenEXR/ImfVersion.h>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <csetjmp>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <png.h>
#include <string_view>
#include <utility>

#include "luminaire/exr_reason.h"
#include "luminaire/file_io.h"
#include "renderer/srgb.h"

namespace lumifield {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t max_texture_bytes = std::uintmax_t{256} << 20;
constexpr std::string_view png_begins = "\x89PNG\r\n\x1a\n", exr_begins = "\x76\x2f\x31\x01";
constexpr const char* again = "export the texture again";
constexpr const char* alpha_note = "its alpha is not shown";

Status check_size(long long width, long long height, std::size_t most_pixels, const fs::path& file) {
  const std::string size = std::to_string(width) + " x " + std::to_string(height) + " pixels";
  if (width < 1 || height < 1 || width > max_texture_px || height > max_texture_px)
    return fail("a texture of " + size, file.string(), "give 1 to " + std::to_string(max_texture_px) + " a side");
  if (static_cast<std::size_t>(width) * static_cast<std::size_t>(height) > most_pixels)
    return fail("a texture of " + size + " is more than the textures may have together", file.string(),
                "make the textures smaller");
  return {};
}

/// libpng reading from memory. Its errors jump back into `step`, past what has no destructor.
class PngReader {
 public:
  explicit PngReader(std::string_view bytes) : rest_(bytes) {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, stop, [](png_structp, png_const_charp) {});
    info = png ? png_create_info_struct(png) : nullptr;
    if (info) png_set_read_fn(png, this, give);
  }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }

  /// False with `message` set. What is called keeps no object with a destructor.
  bool step(void (*what)(PngReader&)) {
    if (!info) return false;
    if (setjmp(png_jmpbuf(png))) return false;
    what(*this);
    return true;
  }

  png_structp png = nullptr;
  png_infop info = nullptr;
  std::string message = "no memory";
  std::vector<png_bytep> rows;

 private:
  [[noreturn]] static void stop(png_structp png, png_const_charp message) {
    static_cast<PngReader*>(png_get_error_ptr(png))->message = message;
    png_longjmp(png, 1);
  }
  static void give(png_structp png, png_bytep to, std::size_t count) {
    std::string_view& rest = static_cast<PngReader*>(png_get_io_ptr(png))->rest_;
    if (count > rest.size()) png_error(png, "the file ends early");
    rest.copy(reinterpret_cast<char*>(to), count);
    rest.remove_prefix(count);
  }
  std::string_view rest_;
};

/// All kinds of PNG become three codes of 16 bits, of which 257 is one of 8 bits.
void begin_png(PngReader& reader) {
  png_read_info(reader.png, reader.info);
  png_set_expand(reader.png);
  png_set_expand_16(reader.png);
  png_set_gray_to_rgb(reader.png);
  png_set_strip_alpha(reader.png);
  if constexpr (std::endian::native == std::endian::little) png_set_swap(reader.png);
  png_set_interlace_handling(reader.png);
}

void finish_png(PngReader& reader) {
  png_read_update_info(reader.png, reader.info);
  png_read_image(reader.png, reader.rows.data());
  png_read_end(reader.png, nullptr);
}

/// The light of each code: sRGB's, but for a file with a gamma that is neither sRGB's nor 1/2.2, which stands for it.
std::vector<float> light_of_codes(const PngReader& reader) {
  png_fixed_point gamma = 0;
  int intent = 0;
  const bool own = !png_get_sRGB(reader.png, reader.info, &intent) &&
                   png_get_gAMA_fixed(reader.png, reader.info, &gamma) && gamma > 0 && std::abs(gamma - 45455) > 500;
  std::vector<float> light(65536);
  for (std::size_t k = 0; k < light.size(); ++k) {
    const double code = static_cast<double>(k) / 65535;
    light[k] = static_cast<float>(own ? std::pow(code, 1e5 / gamma) : srgb_decode(code));
  }
  return light;
}

Result<Texture> read_png(const std::string& bytes, std::size_t most_pixels, const fs::path& file) {
  PngReader reader(bytes);
  const auto broken = [&] { return fail("libpng says: " + reader.message, file.string(), again); };
  if (!reader.step(begin_png)) return broken();
  const std::size_t width = png_get_image_width(reader.png, reader.info),
                    height = png_get_image_height(reader.png, reader.info);
  if (const Status good = check_size(static_cast<long long>(width), static_cast<long long>(height), most_pixels, file);
      !good)
    return tl::unexpected(good.error());
  Texture texture{static_cast<int>(width), static_cast<int>(height), {}, {}};
  if (png_get_color_type(reader.png, reader.info) & PNG_COLOR_MASK_ALPHA ||
      png_get_valid(reader.png, reader.info, PNG_INFO_tRNS))
    texture.note = alpha_note;
  std::vector<std::uint16_t> codes(3 * width * height);
  for (std::size_t j = 0; j < height; ++j)
    reader.rows.push_back(reinterpret_cast<png_bytep>(codes.data() + 3 * width * j));
  if (!reader.step(finish_png)) return broken();
  const std::vector<float> light = light_of_codes(reader);
  texture.rgb.reserve(codes.size());
  for (const std::uint16_t code : codes) texture.rgb.push_back(light[code]);
  return texture;
}

/// The channels that are taken as R, G and B.
Result<std::array<std::string, 3>> exr_channels(const Imf::Header& header, const fs::path& file) {
  const Imf::ChannelList& channels = header.channels();
  const bool grey = !channels.findChannel("R") && channels.findChannel("Y");
  const std::array<std::string, 3> names =
      grey ? std::array<std::string, 3>{"Y", "Y", "Y"} : std::array<std::string, 3>{"R", "G", "B"};
  for (const std::string& name : names) {
    const Imf::Channel* channel = channels.findChannel(name);
    if (!channel || channel->type == Imf::UINT || channel->xSampling != 1 || channel->ySampling != 1)
      return fail("has no channel " + name + " of HALF or FLOAT at every pixel", file.string(),
                  "write R, G and B, or Y");
  }
  return names;
}

Status check_window(const Imath::Box2i& window, const char* name, std::size_t most_pixels, const fs::path& file) {
  const auto side = [](int low, int high) { return static_cast<long long>(high) - low + 1; };
  if (const Status good =
          check_size(side(window.min.x, window.max.x), side(window.min.y, window.max.y), most_pixels, file);
      !good)
    return good;
  // Beyond this the library's own addresses of pixels overflow.
  constexpr int farthest = 1 << 20;
  if (window.min.x < -farthest || window.min.x > farthest || window.min.y < -farthest || window.min.y > farthest)
    return fail("has its " + std::string(name) + " window too far from the origin", file.string(),
                "let it begin at (0, 0)");
  return {};
}

Status check_exr(const Imf::Header& header, std::size_t most_pixels, const fs::path& file) {
  for (const auto& [window, name] : {std::pair(header.dataWindow(), "data"), {header.displayWindow(), "display"}})
    if (const Status good = check_window(window, name, most_pixels, file); !good) return good;
  if (!header.dataWindow().intersects(header.displayWindow()))
    return fail("has its data window outside of its display window", file.string(), again);
  constexpr unsigned int largest_tile = 1024;
  if (header.hasTileDescription() &&
      (header.tileDescription().xSize > largest_tile || header.tileDescription().ySize > largest_tile))
    return fail("has tiles of more than 1024 pixels a side", file.string(), "write scanlines");
  return {};
}

/// R, G and B of the data window's pixels. May throw what OpenEXR throws.
std::vector<float> read_pixels(Imf::InputFile& input, const std::array<std::string, 3>& names) {
  const Imath::Box2i window = input.header().dataWindow();
  const auto width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
  const auto height = static_cast<std::size_t>(window.max.y - window.min.y + 1);
  std::vector<float> rgb(3 * width * height);
  constexpr std::size_t x_stride = 3 * sizeof(float);
  const bool grey = names[1] == names[0];
  Imf::FrameBuffer pixels;
  for (std::size_t c = 0; c < (grey ? 1U : 3U); ++c)
    pixels.insert(names[c], Imf::Slice::Make(Imf::FLOAT, rgb.data() + c, window, x_stride, x_stride * width));
  input.setFrameBuffer(pixels);
  input.readPixels(window.min.y, window.max.y);
  for (std::size_t i = 0; grey && i < rgb.size(); i += 3) rgb[i + 1] = rgb[i + 2] = rgb[i];
  return rgb;
}

/// The display window is the picture: pixels of the data window stand in it where the file says, and 0 around them.
Texture placed(std::vector<float> rgb, const Imath::Box2i& data, const Imath::Box2i& display) {
  Texture texture{display.max.x - display.min.x + 1, display.max.y - display.min.y + 1, {}, {}};
  if (data == display) {
    texture.rgb = std::move(rgb);
    return texture;
  }
  texture.rgb.resize(std::size_t{3} * static_cast<std::size_t>(texture.width_px) *
                     static_cast<std::size_t>(texture.height_px));
  const Imath::Box2i both(Imath::V2i(std::max(data.min.x, display.min.x), std::max(data.min.y, display.min.y)),
                          Imath::V2i(std::min(data.max.x, display.max.x), std::min(data.max.y, display.max.y)));
  const auto at = [](const Imath::Box2i& window, int x, int y) {
    return 3 * (static_cast<std::ptrdiff_t>(y - window.min.y) * (window.max.x - window.min.x + 1) + x - window.min.x);
  };
  for (int y = both.min.y; y <= both.max.y; ++y)
    std::copy_n(rgb.begin() + at(data, both.min.x, y), 3 * (both.max.x - both.min.x + 1),
                texture.rgb.begin() + at(display, both.min.x, y));
  if (both != display) texture.note = "it is black where its data window ends before its display window";
  return texture;
}

/// May throw what OpenEXR throws.
Result<Texture> read_exr(const std::string& bytes, std::size_t most_pixels, const fs::path& file) {
  // Look at the header alone: the library takes memory for the image when it opens a file.
  Imf::StdISStream first;
  first.str(bytes);
  first.seekg(8);
  if (bytes.size() < 8) return fail("the file ends early", file.string(), again);
  int version = static_cast<unsigned char>(bytes[4]) | static_cast<unsigned char>(bytes[5]) << 8;
  if (Imf::isMultiPart(version) || Imf::isNonImage(version))
    return fail("has several parts or deep pixels", file.string(), "write one part with one value a pixel");
  Imf::Header header;
  header.readFrom(first, version);
  if (const Status good = check_exr(header, most_pixels, file); !good) return tl::unexpected(good.error());
  const auto names = exr_channels(header, file);
  if (!names) return tl::unexpected(names.error());

  // Read it.
  Imf::StdISStream stream;
  stream.str(bytes);
  Imf::InputFile input(stream, 0);
  Texture texture = placed(read_pixels(input, *names), header.dataWindow(), header.displayWindow());
  if (header.channels().findChannel("A"))
    texture.note = texture.note.empty() ? alpha_note : alpha_note + std::string("; ") + texture.note;
  for (std::size_t i = 0; i < texture.rgb.size(); ++i)
    if (!(texture.rgb[i] >= 0 && std::isfinite(texture.rgb[i])))
      return fail("pixel " + std::to_string(i / 3) + " is negative or not finite", file.string(), again);
  return texture;
}

}  // namespace

bool is_texture_file(const fs::path& file) {
  std::array<char, 8> first{};
  std::ifstream stream(file, std::ios::binary);
  stream.read(first.data(), first.size());
  const std::string_view begins(first.data(), static_cast<std::size_t>(stream.gcount()));
  return begins.starts_with(png_begins) || begins.starts_with(exr_begins);
}

Result<Texture> read_texture(const fs::path& file, std::size_t most_pixels) try {
  const Result<std::string> bytes = read_file(file, max_texture_bytes);
  if (!bytes) return tl::unexpected(bytes.error());
  if (bytes->starts_with(png_begins)) return read_png(*bytes, most_pixels, file);
  if (bytes->starts_with(exr_begins)) return read_exr(*bytes, most_pixels, file);
  return fail("is neither PNG nor OpenEXR", file.string(), "convert it to PNG");
} catch (const std::exception& exception) {
  return fail("OpenEXR says: " + exr_reason(exception), file.string(), again);
}

}  // namespace lumifield
