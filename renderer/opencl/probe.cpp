#include "renderer/opencl/probe.h"

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <map>
#include <mutex>
#include <optional>
#include <poll.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "renderer/opencl/device.h"
#include "renderer/renderer.h"

namespace lumifield {

namespace {

std::atomic<bool> opencl_in_use = false;

/// A first kernel may have to be compiled on a busy machine.
constexpr std::chrono::seconds deadline(60);
constexpr const char* remedy = "repair or remove this driver (PoCL needs /sys mounted), or use --device host";

/// The child's answer: "+name" or "-what\0where\0remedy".
[[noreturn]] void answer(int pipe) {
  // The driver's own complaints are not for the terminal.
  const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere >= 0) dup2(nowhere, STDERR_FILENO);
  const Result<std::string> tried = try_opencl();
  const std::string text =
      tried ? "+" + *tried : "-" + tried.error().what + '\0' + tried.error().where + '\0' + tried.error().remedy;
  for (std::size_t sent = 0; sent < text.size();) {
    const ssize_t n = write(pipe, text.data() + sent, text.size() - sent);
    if (n <= 0 && errno != EINTR) break;
    if (n > 0) sent += static_cast<std::size_t>(n);
  }
  _exit(0);
}

/// All that comes through the pipe until it closes; nothing when the deadline passes.
std::optional<std::string> receive(int pipe) {
  const auto end = std::chrono::steady_clock::now() + deadline;
  std::string text;
  while (true) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    pollfd ready{pipe, POLLIN, 0};
    const int polled = left.count() > 0 ? poll(&ready, 1, static_cast<int>(left.count())) : 0;
    if (polled < 0 && errno == EINTR) continue;
    if (polled <= 0) return std::nullopt;
    char part[4096];
    const ssize_t n = read(pipe, part, sizeof part);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return text;
    text.append(part, static_cast<std::size_t>(n));
  }
}

/// `answered` is nothing when the deadline passed, and empty when the child ended before it could answer.
Result<std::string> understand(const std::optional<std::string>& answered, int status) {
  if (!answered)
    return fail("the OpenCL driver did not answer within " + std::to_string(deadline.count()) + " s", "OpenCL", remedy);
  const std::string& text = *answered;
  if (text.empty()) {
    const std::string how = WIFSIGNALED(status) ? "signal " + std::to_string(WTERMSIG(status))
                                                : "exit status " + std::to_string(WEXITSTATUS(status));
    return fail("the OpenCL driver ended with " + how, "OpenCL", remedy);
  }
  if (text[0] == '+') return text.substr(1);
  const std::size_t first = text.find('\0'), second = text.find('\0', first + 1);
  return fail(text.substr(1, first - 1), text.substr(first + 1, second - first - 1), text.substr(second + 1));
}

Result<std::string> probe_in_child() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return fail(std::strerror(errno), "probing OpenCL", "close other programs");
  const pid_t child = fork();
  if (child < 0) {
    close(ends[0]);
    close(ends[1]);
    return fail(std::strerror(errno), "probing OpenCL", "close other programs");
  }
  if (child == 0) answer(ends[1]);
  close(ends[1]);
  const std::optional<std::string> text = receive(ends[0]);
  close(ends[0]);
  kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return understand(text, status);
}

}  // namespace

void note_opencl_in_use() { opencl_in_use = true; }

Result<std::string> probe_opencl() {
  static std::mutex mutex;
  static std::map<std::string, Result<std::string>> known;
  const char* wanted = std::getenv("LUMIFIELD_OPENCL");
  const std::lock_guard lock(mutex);
  const auto found = known.find(wanted ? wanted : "");
  if (found != known.end()) return found->second;
  Result<std::string> result = opencl_in_use ? try_opencl() : probe_in_child();
  return known.emplace(wanted ? wanted : "", std::move(result)).first->second;
}

}  // namespace lumifield
