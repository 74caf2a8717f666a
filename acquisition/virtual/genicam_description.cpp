#include "acquisition/virtual/genicam_description.h"

#include <sstream>

#include "acquisition/virtual/genicam_pixels.h"

namespace lumifield::virtual_bench {

extern const char* const virtual_camera_xml;

namespace {

void replace_all(std::string& text, const std::string& what, const std::string& by) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
    text.replace(at, what.size(), by);
}

}  // namespace

std::string genicam_description(const std::string& pixel_format, const std::map<std::string, double>& stuck) {
  const GenicamPixelFormat format = genicam_pixel_format(pixel_format).value();
  std::string xml = virtual_camera_xml;
  replace_all(xml, "PIXEL_FORMAT_NAME", pixel_format);
  replace_all(xml, "PIXEL_FORMAT_CODE", std::to_string(format.code));
  replace_all(xml, "BITS_PER_PIXEL", std::to_string(format.bits_per_pixel()));
  for (const auto& [feature, value] : stuck) {
    const std::string name = feature + "Register", kept = feature + "Kept";
    const std::string tag = xml.find("<FloatReg Name=\"" + name) != std::string::npos ? "Converter" : "IntConverter";
    replace_all(xml, "Reg Name=\"" + name, "Reg Name=\"" + kept);
    std::ostringstream number;
    number << value;
    xml.insert(xml.rfind("  <Port "), "  <" + tag + " Name=\"" + name + "\" NameSpace=\"Custom\"><FormulaTo>" +
                                          number.str() + "</FormulaTo><FormulaFrom>TO</FormulaFrom><pValue>" + kept +
                                          "</pValue></" + tag + ">\n");
  }
  return xml;
}

std::string move_registers(std::string xml, std::uint32_t by) {
  const std::string begin = "<Address>", end = "</Address>";
  for (std::size_t at = xml.find(begin); at != std::string::npos; at = xml.find(begin, at)) {
    at += begin.size();
    const std::size_t length = xml.find(end, at) - at;
    xml.replace(at, length, std::to_string(std::stoul(xml.substr(at, length), nullptr, 16) + by));
  }
  return xml;
}

}  // namespace lumifield::virtual_bench
