#include "renderer/opengl/gl_objects.h"

#include <epoxy/gl.h>
#include <utility>

namespace lumifield {

Status gl_status(const std::string& what) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return {};
  while (glGetError() != GL_NO_ERROR) {
  }
  if (error == GL_OUT_OF_MEMORY)
    return fail(what + ": the graphics device is out of memory", "OpenGL", "use a smaller picture or mesh");
  return fail(what + ": OpenGL error " + std::to_string(error), "OpenGL", "update the graphics driver");
}

Result<unsigned> compile_program(const std::string& whose, const ShaderTexts& texts) {
  const std::array<std::pair<GLenum, const char*>, 3> stages = {
      {{GL_VERTEX_SHADER, texts.vertex}, {GL_GEOMETRY_SHADER, texts.geometry}, {GL_FRAGMENT_SHADER, texts.fragment}}};
  const GLuint program = glCreateProgram();
  std::array<char, 2048> log{};
  for (const auto& [stage, source] : stages) {
    if (!source) continue;
    const GLuint shader = glCreateShader(stage);
    glShaderSource(shader, 1, &source, nullptr);
    glCompileShader(shader);
    GLint compiled = 0;
    glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
    if (!compiled && log[0] == 0) glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program);
  GLint linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked) return program;
  if (log[0] == 0) glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
  glDeleteProgram(program);
  return fail("the driver refuses the shaders of " + whose + ": " + std::string(log.data()), "OpenGL",
              "update the graphics driver");
}

GlTexture::GlTexture(GlTexture&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
GlTexture& GlTexture::operator=(GlTexture&& other) noexcept {
  std::swap(id_, other.id_);
  return *this;
}
GlTexture::~GlTexture() {
  if (id_ != 0) glDeleteTextures(1, &id_);
}
unsigned GlTexture::id() {
  if (id_ == 0) glGenTextures(1, &id_);
  return id_;
}

GlBuffer::GlBuffer(GlBuffer&& other) noexcept : id_(std::exchange(other.id_, 0)) {}
GlBuffer& GlBuffer::operator=(GlBuffer&& other) noexcept {
  std::swap(id_, other.id_);
  return *this;
}
GlBuffer::~GlBuffer() {
  if (id_ != 0) glDeleteBuffers(1, &id_);
}
unsigned GlBuffer::id() {
  if (id_ == 0) glGenBuffers(1, &id_);
  return id_;
}

Result<RenderTarget> RenderTarget::create(const std::string& picture, int width_px, int height_px,
                                          std::span<const unsigned> colour_formats, bool depth) {
  constexpr std::array<GLenum, 4> colours = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2,
                                             GL_COLOR_ATTACHMENT3};
  RenderTarget target;
  glGenFramebuffers(1, &target.framebuffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer_);
  glGenRenderbuffers(static_cast<GLsizei>(target.images_.size()), target.images_.data());
  const auto attach = [&](std::size_t i, GLenum format, GLenum attachment) {
    glBindRenderbuffer(GL_RENDERBUFFER, target.images_[i]);
    glRenderbufferStorage(GL_RENDERBUFFER, format, width_px, height_px);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, attachment, GL_RENDERBUFFER, target.images_[i]);
  };
  for (std::size_t i = 0; i < colour_formats.size(); ++i) attach(i, colour_formats[i], colours.at(i));
  if (depth) attach(colour_formats.size(), GL_DEPTH_COMPONENT32F, GL_DEPTH_ATTACHMENT);
  glDrawBuffers(static_cast<GLsizei>(colour_formats.size()), colours.data());
  if (const Status made = gl_status(picture); !made) return tl::unexpected(made.error());
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    return fail("no framebuffer for " + picture, "OpenGL", "use a smaller picture or another driver");
  return target;
}

RenderTarget::RenderTarget(RenderTarget&& other) noexcept
    : framebuffer_(std::exchange(other.framebuffer_, 0)), images_(std::exchange(other.images_, {})) {}

RenderTarget::~RenderTarget() {
  if (framebuffer_ == 0) return;
  glDeleteFramebuffers(1, &framebuffer_);
  glDeleteRenderbuffers(static_cast<GLsizei>(images_.size()), images_.data());
}

}  // namespace lumifield
