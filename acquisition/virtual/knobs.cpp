#include "acquisition/virtual/knobs.h"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <thread>
#include <unistd.h>
#include <vector>

namespace lumifield::virtual_bench {

namespace {
constexpr std::size_t most_line_bytes = 256;
struct Client {
  int socket;
  std::string line;
};
}  // namespace

std::string turn(const KnobPanel& knobs, const std::string& line) {
  const std::size_t space = line.find(' ');
  if (space == std::string::npos) return "error: a line is `name value` or `get name`";
  const std::string first = line.substr(0, space), second = line.substr(space + 1);
  const bool asks = first == "get";
  const auto knob = knobs.find(asks ? second : first);
  if (knob == knobs.end() || (asks && !knob->second.get)) return "error: no such knob: " + (asks ? second : first);
  if (asks) return knob->second.get();
  if (!knob->second.set) return "error: " + first + " can only be read";
  double value = 0;
  const char* end = second.data() + second.size();
  const auto [rest, fault] = std::from_chars(second.data(), end, value);
  if (fault != std::errc() || rest != end || !std::isfinite(value)) return "error: not a number: " + second;
  const Status set = knob->second.set(value);
  return set ? "ok" : "error: " + set.error().message();
}

namespace {

Result<sockaddr_un> socket_name(const std::filesystem::path& path) {
  sockaddr_un name{};
  name.sun_family = AF_UNIX;
  if (path.string().size() >= sizeof name.sun_path) return fail("the socket's path is too long", path.string());
  std::strcpy(name.sun_path, path.c_str());
  return name;
}

}  // namespace

Result<std::string> say_to_knobs(const std::filesystem::path& path, const std::string& line) {
  const Result<sockaddr_un> name = socket_name(path);
  if (!name) return tl::unexpected(name.error());
  const int link = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const std::string text = line + "\n";
  std::string answer;
  if (link >= 0 && connect(link, reinterpret_cast<const sockaddr*>(&*name), sizeof *name) == 0 &&
      send(link, text.data(), text.size(), MSG_NOSIGNAL) == ssize_t(text.size())) {
    char byte;
    while (read(link, &byte, 1) == 1 && byte != '\n') answer += byte;
  }
  if (link >= 0) close(link);
  if (answer.empty()) return fail("no bench answers there", path.string(), "start one with --knobs and this path");
  return answer;
}

struct Knobs::Impl {
  std::filesystem::path path;
  KnobPanel knobs;
  int listener = -1;
  bool bound = false;
  std::vector<Client> clients;
  std::jthread thread;

  ~Impl() {
    thread = {};  // ends it
    for (const Client& client : clients) close(client.socket);
    if (listener >= 0) close(listener);
    if (bound) unlink(path.c_str());
  }

  Status open() {
    const Result<sockaddr_un> name = socket_name(path);
    if (!name) return tl::unexpected(name.error());
    listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
    bound = listener >= 0 && bind(listener, reinterpret_cast<const sockaddr*>(&*name), sizeof *name) == 0;
    if (!bound || listen(listener, 4) != 0)
      return fail(std::string("the knobs' socket cannot be made: ") + std::strerror(errno), path.string(),
                  "give another --knobs, or remove what is there");
    return {};
  }

  void run(std::stop_token stop) {
    while (!stop.stop_requested()) {
      std::vector<pollfd> sockets{{listener, POLLIN, 0}};
      for (const Client& client : clients) sockets.push_back({client.socket, POLLIN, 0});
      poll(sockets.data(), sockets.size(), 20);
      for (std::size_t i = clients.size(); i-- > 0;)
        if (sockets[i + 1].revents != 0 && !serve(clients[i])) {
          close(clients[i].socket);
          clients.erase(clients.begin() + std::ptrdiff_t(i));
        }
      if (sockets[0].revents == 0) continue;
      if (const int client = accept4(listener, nullptr, nullptr, SOCK_CLOEXEC); client >= 0)
        clients.push_back({client, {}});
    }
  }

  // False when the client has gone, or sends lines without an end.
  bool serve(Client& client) {
    char bytes[most_line_bytes];
    const ssize_t count = read(client.socket, bytes, sizeof bytes);
    if (count <= 0) return false;
    client.line.append(bytes, std::size_t(count));
    for (std::size_t end; (end = client.line.find('\n')) != std::string::npos;) {
      const std::string reply = turn(knobs, client.line.substr(0, end)) + "\n";
      client.line.erase(0, end + 1);
      if (send(client.socket, reply.data(), reply.size(), MSG_NOSIGNAL) < 0) return false;
    }
    return client.line.size() < most_line_bytes;
  }
};

Result<std::unique_ptr<Knobs>> Knobs::start(const std::filesystem::path& socket, KnobPanel knobs) {
  auto impl = std::make_unique<Impl>();
  impl->path = socket;
  impl->knobs = std::move(knobs);
  if (auto opened = impl->open(); !opened) return tl::unexpected(opened.error());
  impl->thread = std::jthread([self = impl.get()](std::stop_token stop) { self->run(stop); });
  return std::unique_ptr<Knobs>(new Knobs(std::move(impl)));
}

Knobs::Knobs(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Knobs::~Knobs() = default;

}  // namespace lumifield::virtual_bench
