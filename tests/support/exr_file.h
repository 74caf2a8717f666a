#pragma once

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace lumifield::support {

/// An EXR file as another program might write it.
struct ExrFile {
  Imath::Box2i data_window, display_window;
  Imf::Compression compression = Imf::ZIP_COMPRESSION;
  Imf::LineOrder line_order = Imf::INCREASING_Y;
  bool tiled = false;
  std::map<std::string, Imf::PixelType> channels;
  std::map<std::string, std::vector<float>> pixels;  ///< of the data window, row by row

  ExrFile(int width, int height) : data_window({0, 0}, {width - 1, height - 1}), display_window(data_window) {}

  void write(const std::filesystem::path& file) const {
    Imf::Header header(display_window, data_window);
    header.compression() = compression;
    header.lineOrder() = line_order;
    const auto width = static_cast<std::size_t>(data_window.max.x - data_window.min.x + 1);
    const auto height = static_cast<std::size_t>(data_window.max.y - data_window.min.y + 1);
    Imf::FrameBuffer buffer;
    std::map<std::string, std::vector<std::uint32_t>> raw;
    for (const auto& [name, type] : channels) {
      header.channels().insert(name, Imf::Channel(type));
      std::vector<std::uint32_t>& plane = raw[name];
      plane.resize(width * height);
      for (std::size_t k = 0; k < plane.size(); ++k) {
        const float value = pixels.at(name)[k];
        if (type == Imf::HALF)
          *reinterpret_cast<half*>(&plane[k]) = half(value);
        else if (type == Imf::FLOAT)
          *reinterpret_cast<float*>(&plane[k]) = value;
        else
          plane[k] = static_cast<std::uint32_t>(value);
      }
      buffer.insert(name, Imf::Slice::Make(type, plane.data(), data_window, 4, 4 * width));
    }
    if (tiled) {
      header.setTileDescription(Imf::TileDescription(2, 3));
      Imf::TiledOutputFile out(file.c_str(), header);
      out.setFrameBuffer(buffer);
      out.writeTiles(0, out.numXTiles() - 1, 0, out.numYTiles() - 1);
    } else {
      Imf::OutputFile out(file.c_str(), header);
      out.setFrameBuffer(buffer);
      out.writePixels(static_cast<int>(height));
    }
  }
};

}  // namespace lumifield::support
