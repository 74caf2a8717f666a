#include "renderer/opengl/egl_context.h"

#include <array>
#include <epoxy/egl.h>
#include <epoxy/gl.h>
#include <string_view>
#include <vector>

#include "renderer/renderer.h"

namespace lumifield {
namespace {

constexpr std::string_view no_driver = "install an OpenGL driver (Debian: libegl1 and libgl1-mesa-dri)";

/// A display worth trying, not yet initialised.
struct Candidate {
  EGLDisplay display;
  std::string name;
};

std::string egl_error() {
  constexpr std::array<std::string_view, 15> names = {
      "EGL_SUCCESS",       "EGL_NOT_INITIALIZED", "EGL_BAD_ACCESS",        "EGL_BAD_ALLOC",
      "EGL_BAD_ATTRIBUTE", "EGL_BAD_CONFIG",      "EGL_BAD_CONTEXT",       "EGL_BAD_CURRENT_SURFACE",
      "EGL_BAD_DISPLAY",   "EGL_BAD_MATCH",       "EGL_BAD_NATIVE_PIXMAP", "EGL_BAD_NATIVE_WINDOW",
      "EGL_BAD_PARAMETER", "EGL_BAD_SURFACE",     "EGL_CONTEXT_LOST"};
  const int code = eglGetError() - EGL_SUCCESS;
  return code >= 0 && code < static_cast<int>(names.size()) ? std::string(names[code]) : std::to_string(code);
}

std::vector<EGLDeviceEXT> devices() {
  if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_enumeration") &&
      !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base"))
    return {};
  EGLint count = 0;
  if (!eglQueryDevicesEXT(0, nullptr, &count) || count <= 0) return {};
  std::vector<EGLDeviceEXT> found(static_cast<std::size_t>(count));
  if (!eglQueryDevicesEXT(count, found.data(), &count)) return {};
  found.resize(static_cast<std::size_t>(count));
  return found;
}

bool is_software(EGLDeviceEXT device) {
  if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_query") &&
      !epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_device_base"))
    return false;
  const char* extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
  return extensions && std::string_view(extensions).find("EGL_MESA_device_software") != std::string_view::npos;
}

std::vector<Candidate> candidates() {
  std::vector<Candidate> found, software;
  const bool platforms = epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_base");
  if (platforms && epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_EXT_platform_device"))
    for (EGLDeviceEXT device : devices())
      (is_software(device) ? software : found)
          .push_back({eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, device, nullptr), "device"});
  if (platforms && epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
    found.push_back(
        {eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr), "surfaceless"});
  found.insert(found.end(), software.begin(), software.end());
  found.push_back({eglGetDisplay(EGL_DEFAULT_DISPLAY), "default display"});
  return found;
}

std::string gl_string(GLenum name) {
  const GLubyte* text = glGetString(name);
  return text ? reinterpret_cast<const char*>(text) : "unknown";
}

}  // namespace

/// Displays are shared by all contexts of a process, so they stay initialised when a context goes.
struct EglContext::Impl {
  EGLDisplay display = EGL_NO_DISPLAY;
  EGLContext context = EGL_NO_CONTEXT;
  EGLSurface surface = EGL_NO_SURFACE;
  std::string name;

  ~Impl() {
    if (display == EGL_NO_DISPLAY) return;
    if (context != EGL_NO_CONTEXT && eglGetCurrentContext() == context)
      eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    if (surface != EGL_NO_SURFACE) eglDestroySurface(display, surface);
    if (context != EGL_NO_CONTEXT) eglDestroyContext(display, context);
  }

  Status open(const Candidate& candidate) {
    const auto broken = [&](std::string what) { return fail(std::move(what), "EGL " + candidate.name); };
    display = candidate.display;
    if (display == EGL_NO_DISPLAY) return broken("no display");
    if (!eglInitialize(display, nullptr, nullptr)) return broken("eglInitialize says " + egl_error());
    if (!eglBindAPI(EGL_OPENGL_API)) return broken("no desktop OpenGL");

    // Without surfaceless contexts a pbuffer of one pixel stands in.
    const bool surfaceless = epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context");
    const EGLint config_attributes[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE,
                                        surfaceless ? 0 : EGL_PBUFFER_BIT, EGL_NONE};
    EGLConfig config = nullptr;
    EGLint configs = 0;
    if (!eglChooseConfig(display, config_attributes, &config, 1, &configs) || configs == 0)
      return broken("no configuration for OpenGL");
    const EGLint context_attributes[] = {
        EGL_CONTEXT_MAJOR_VERSION,           4,       EGL_CONTEXT_MINOR_VERSION, 3, EGL_CONTEXT_OPENGL_PROFILE_MASK,
        EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT, EGL_NONE};
    context = eglCreateContext(display, config, EGL_NO_CONTEXT, context_attributes);
    if (context == EGL_NO_CONTEXT) return broken("no OpenGL 4.3 core context (" + egl_error() + ")");
    if (!surfaceless) {
      const EGLint pbuffer[] = {EGL_WIDTH, 1, EGL_HEIGHT, 1, EGL_NONE};
      surface = eglCreatePbufferSurface(display, config, pbuffer);
      if (surface == EGL_NO_SURFACE) return broken("no pbuffer (" + egl_error() + ")");
    }
    if (!eglMakeCurrent(display, surface, surface, context)) return broken("eglMakeCurrent says " + egl_error());
    name = gl_string(GL_RENDERER) + ", OpenGL " + gl_string(GL_VERSION) + " (" + candidate.name + ")";
    return {};
  }
};

EglContext::EglContext(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
EglContext::~EglContext() = default;

Result<std::unique_ptr<EglContext>> EglContext::create() {
  if (!epoxy_has_egl()) return fail("libEGL is not there", "OpenGL", std::string(no_driver));
  std::string reasons;
  for (const Candidate& candidate : candidates()) {
    auto impl = std::make_unique<Impl>();
    const Status opened = impl->open(candidate);
    if (opened) return std::unique_ptr<EglContext>(new EglContext(std::move(impl)));
    if (!reasons.empty()) reasons += "; ";
    reasons += opened.error().message();
  }
  return fail("no context of OpenGL 4.3 core (" + reasons + ")", "OpenGL", std::string(no_driver));
}

Status EglContext::make_current() {
  if (eglGetCurrentContext() == impl_->context) return {};
  if (!eglBindAPI(EGL_OPENGL_API) || !eglMakeCurrent(impl_->display, impl_->surface, impl_->surface, impl_->context))
    return fail("the context cannot be made current (" + egl_error() + ")", "OpenGL",
                "use it from the thread that made it");
  return {};
}

std::string EglContext::description() const { return impl_->name; }

Result<std::string> probe_opengl() {
  return EglContext::create().map([](const std::unique_ptr<EglContext>& context) { return context->description(); });
}

}  // namespace lumifield
