// lumifield-bench: the virtual camera and stage around a command, and the truth about its lamps.

#include <CLI/CLI.hpp>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "acquisition/virtual/gige_camera.h"
#include "acquisition/virtual/grbl_controller.h"
#include "acquisition/virtual/knobs.h"
#include "acquisition/virtual/truth_table.h"
#include "acquisition/virtual/world.h"

namespace lumifield::virtual_bench {
namespace {

struct Options {
  WorldOptions world;
  GigeCameraOptions camera;
  GrblOptions stage;
  std::string carries = "slide", filter, pixel_format, noise = "on", optics = "on", knobs;
  std::vector<std::string> command, set;
  bool projected = false;
  TruthGrid grid;
  std::string points, out;
};

/// A folder under the system's temporary one, removed with all that it holds.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "lumifield-bench-XXXXXX").string();
    if (mkdtemp(name.data()) != nullptr) path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

int report(const Error& error, int code = 1) {
  std::fprintf(stderr, "lumifield-bench: %s\n", error.message().c_str());
  return code;
}

void add_world_options(CLI::App& app, Options& options) {
  app.add_option("--lamp", options.world.lamp, "bike, headlight or led-array")
      ->check(CLI::IsMember({"bike", "headlight", "led-array"}));
  app.add_option("--filter", options.filter, "BASIS:SPACING_MM:WINDOW, for example bell:7.5:4");
}

// "bell:7.5:4"
Status apply_filter(const std::string& text, WorldOptions& world) {
  if (text.empty()) return {};
  const std::size_t first = text.find(':'), second = text.find(':', first + 1);
  char* spacing_end = nullptr;
  char* window_end = nullptr;
  const auto basis = basis_from_string(text.substr(0, first));
  const double spacing = second == std::string::npos ? 0 : std::strtod(text.c_str() + first + 1, &spacing_end);
  const long window = second == std::string::npos ? 0 : std::strtol(text.c_str() + second + 1, &window_end, 10);
  if (!basis || second == std::string::npos || *spacing_end != ':' || *window_end != '\0' || !(spacing > 0) ||
      spacing > 1000 || window < 1 || window > 64)
    return fail("not a filter", "--filter " + text, "give BASIS:SPACING_MM:WINDOW, for example bell:7.5:4");
  world.basis = *basis;
  world.spacing_mm = {spacing, spacing};
  world.window = int(window);
  return {};
}

std::map<std::string, Knob> make_knobs(World& world, GigeCamera& camera, GrblController& stage) {
  const auto act = [](auto action) { return Knob{[action](double value) { return action(value), Status(); }, {}}; };
  std::map<std::string, Knob> knobs;
  for (const char* name : {"noise", "lamp_drift"})
    knobs[name] = {[&world, name](double value) { return world.set(name, value); }, {}};
  knobs["lost_steps"] = act([&stage](double value) { stage.lose_steps(value); });
  knobs["stuck_stage"] = act([&stage](double value) { stage.stick(value != 0); });
  knobs["silent_stage"] = act([&stage](double value) { stage.silence(value != 0); });
  knobs["stage_alarm"] = act([&stage](double value) { value != 0 ? stage.trip_limit() : void(); });
  knobs["frozen_camera"] = act([&camera](double value) { camera.freeze(value != 0); });
  knobs["frames"] = {{}, [&camera] { return std::to_string(camera.frames_sent()); }};
  knobs["true_position"] = {{}, [&stage] {
                              const Vec2 at = stage.true_position_mm();
                              char text[64];
                              std::snprintf(text, sizeof text, "%.6f %.6f", at.x(), at.y());
                              return std::string(text);
                            }};
  return knobs;
}

// "silent_stage=1"
Status apply_setting(const std::string& text, const std::map<std::string, Knob>& knobs) {
  const std::size_t equals = text.find('=');
  const auto knob = knobs.find(text.substr(0, equals));
  char* end = nullptr;
  const double value = equals == std::string::npos ? 0 : std::strtod(text.c_str() + equals + 1, &end);
  if (knob == knobs.end() || !knob->second.set || end == nullptr || end == text.c_str() + equals + 1 || *end != '\0')
    return fail("not a knob and its value", "--set " + text, "give NAME=NUMBER, for example silent_stage=1");
  return knob->second.set(value);
}

/// Runs the command with the signals of `handled`, blocked in this process, passed on to it. 128 + n when a signal n
/// ended it, 127 when it cannot be run.
int run_command(const std::vector<std::string>& command, const sigset_t& handled) {
  std::vector<char*> arguments;
  for (const std::string& argument : command) arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    sigprocmask(SIG_UNBLOCK, &handled, nullptr);
    execvp(arguments[0], arguments.data());
    std::fprintf(stderr, "lumifield-bench: %s: %s\n", arguments[0], std::strerror(errno));
    _exit(127);
  }
  if (child < 0) return report({std::string("no process: ") + std::strerror(errno), command[0], {}});
  for (;;) {
    siginfo_t info{};
    const int signal = sigwaitinfo(&handled, &info);
    int status = 0;
    if (waitpid(child, &status, WNOHANG) == child)
      return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
    // The terminal's own Ctrl-C reaches the command by itself.
    if (signal > 0 && signal != SIGCHLD && info.si_code != SI_KERNEL) kill(child, signal);
  }
}

int run_bench(Options& options) {
  if (options.command.empty()) return report({"no command given", "", "lumifield-bench --lamp bike -- COMMAND…"}, 2);
  // All threads inherit this, so that only run_command sees these signals.
  sigset_t handled;
  sigemptyset(&handled);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGCHLD}) sigaddset(&handled, signal);
  sigprocmask(SIG_BLOCK, &handled, nullptr);

  const TemporaryFolder folder;
  if (folder.path().empty()) return report({"no temporary folder can be made", "", "check TMPDIR"});
  const auto world = World::create(options.world);
  if (!world) return report(world.error());
  Bench bench = (*world)->bench();

  // The stage reads 0 … travel, which holds the bench's limits.
  if (options.stage.path.empty()) options.stage.path = folder.path() / "stage";
  options.stage.travel_mm = bench.limits.high_mm;
  const auto stage = GrblController::start(options.stage, [&](const Vec2& at) { (*world)->prepare(at); });
  if (!stage) return report(stage.error());

  options.camera.pixel_format = options.world.pixel_format;
  options.camera.width_px = options.world.width_px;
  options.camera.height_px = options.world.height_px;
  options.camera.serial = "LF" + std::to_string(options.world.seed % 1'000'000);
  const Sight sight{.stage_mm = [&] { return (*stage)->true_position_mm(); },
                    .wait_ready = [&](const Vec2& at) { (*world)->wait_ready(at); },
                    .expose =
                        [&](const Exposure& e, std::span<std::uint16_t> dn) {
                          (*world)->expose(e.stage_mm, e.exposure_s, e.gain_db, e.width_px, e.height_px, e.offset_x_px,
                                           e.offset_y_px, dn);
                        }};
  const auto camera = GigeCamera::start(options.camera, sight);
  if (!camera) return report(camera.error());
  const std::map<std::string, Knob> all_knobs = make_knobs(**world, **camera, **stage);
  for (const std::string& setting : options.set)
    if (const Status set = apply_setting(setting, all_knobs); !set) return report(set.error(), 2);
  Result<std::unique_ptr<Knobs>> knobs;
  if (!options.knobs.empty()) knobs = Knobs::start(options.knobs, all_knobs);
  if (!knobs) return report(knobs.error());

  bench.camera.address = options.camera.address;
  bench.stage.path = options.stage.path;
  const std::filesystem::path file = folder.path() / "bench.json";
  if (!(std::ofstream(file) << to_json(bench) << std::flush))
    return report({"cannot be written", file.string(), "check the space there"});
  setenv("LUMIFIELD_BENCH", file.c_str(), 1);
  return run_command(options.command, handled);
}

int parse_and_run(int argc, char** argv) {
  Options options;
  CLI::App app("The virtual camera and stage of a light-source bench, around a command.", "lumifield-bench");
  const CLI::IsMember on_off({"on", "off"});
  add_world_options(app, options);
  app.add_option("--seed", options.world.seed, "of the noise");
  app.add_option("--address", options.camera.address, "the camera's, of an interface of this machine");
  app.add_option("--serial-path", options.stage.path, "where the stage's terminal is linked");
  app.add_option("--knobs", options.knobs, "Unix socket that takes lines `name value`");
  app.add_option("--set", options.set, "NAME=VALUE of a knob from the start; may be repeated")->allow_extra_args(false);
  app.add_option("--loss", options.camera.lost_packet_ratio, "share of stream packets lost")
      ->check(CLI::Range(0.0, 1.0));
  app.add_option("--carries", options.carries, "slide or lamp")->check(CLI::IsMember({"slide", "lamp"}));
  app.add_option("--pixel-format", options.pixel_format, "Mono12, Mono16 or BayerRG12")
      ->check(CLI::IsMember({"Mono12", "Mono16", "BayerRG12"}));
  app.add_option("--noise", options.noise)->check(on_off);
  app.add_option("--optics", options.optics, "off: an ideal pinhole")->check(on_off);
  app.add_option("--stage-speed", options.stage.rapid_mm_s, "mm/s")->check(CLI::Range(0.1, 1e4));
  app.add_option("--stage-acceleration", options.stage.acceleration_mm_s2, "mm/s²")->check(CLI::Range(0.1, 1e6));
  app.add_option("command", options.command, "what to run, after --");
  CLI::App* truth = app.add_subcommand("truth", "irradiance at points, by quadrature of the lamp itself");
  add_world_options(*truth, options);
  CLI::Option* projected =
      truth->add_flag("--projected", options.projected, "of the lamp projected on the filter's basis");
  for (auto& [name, count] : {std::pair{"--columns", &options.grid.columns}, {"--rows", &options.grid.rows}})
    truth->add_option(name, *count, "of the plan's grid; else as many as touch the lamp")
        ->check(CLI::Range(1, 1000))
        ->needs(projected);
  truth->add_option("--points", options.points, "CSV: x_mm,y_mm,z_mm,nx,ny,nz")->required();
  truth->add_option("--out", options.out, "the same with E_Y,E_R,E_G,E_B")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }

  if (const Status filter = apply_filter(options.filter, options.world); !filter) return report(filter.error(), 2);
  options.world.carries = options.carries == "lamp" ? StageCarries::lamp : StageCarries::slide;
  options.world.noise = options.noise == "on";
  options.world.optics = options.optics == "on";
  options.world.pixel_format = options.world.lamp == "led-array" ? "BayerRG12" : "Mono12";
  if (!options.pixel_format.empty()) options.world.pixel_format = options.pixel_format;
  if (!*truth) return run_bench(options);
  const Status written = write_truth(options.world, options.projected, options.points, options.out, options.grid);
  return written ? 0 : report(written.error());
}

}  // namespace
}  // namespace lumifield::virtual_bench

int main(int argc, char** argv) { return lumifield::virtual_bench::parse_and_run(argc, argv); }
