// lumifield-bench: the virtual camera and stage around a command, and the truth about its lamps.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <sys/wait.h>
#include <unistd.h>
#include <vector>

#include "acquisition/virtual/bench_devices.h"
#include "acquisition/virtual/truth_table.h"

namespace lumifield::virtual_bench {
namespace {

struct Options : DeviceOptions {
  std::string filter = "bell:7.5:4", size = "1024x768", carries = "slide", change = "stage", knobs, points, out, line;
  std::vector<std::string> command, set;
  bool projected = false;
  TruthGrid grid;
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

// "bell:7.5:4"
Status apply_filter(const std::string& text, WorldOptions& world) {
  char basis_name[16], rest;
  double spacing_mm = 0;
  const int fields = std::sscanf(text.c_str(), "%15[^:]:%lf:%d%c", basis_name, &spacing_mm, &world.window, &rest);
  const auto basis = basis_from_string(fields == 3 ? basis_name : "");
  if (!basis) return fail("not a filter", "--filter " + text, "give BASIS:SPACING_MM:WINDOW, for example bell:7.5:4");
  world.basis = *basis;
  world.spacing_mm = {spacing_mm, spacing_mm};
  return check(world);
}

// "1024x768"
Status apply_size(const std::string& text, WorldOptions& world) {
  char rest;
  if (std::sscanf(text.c_str(), "%dx%d%c", &world.width_px, &world.height_px, &rest) != 2)
    return fail("not a sensor's size", "--size " + text, "give WIDTHxHEIGHT, for example 1024x768");
  return check(world);
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

int run_bench(Options& options, Devices& devices, const KnobPanel& panel, char** argv) {
  if (options.command.empty()) return report({"no command given", "", "lumifield-bench --lamp bike -- COMMAND…"}, 2);
  if (options.has_usb()) UsbBus::enter(argv);
  // All threads inherit this, so that only run_command sees these signals.
  sigset_t handled;
  sigemptyset(&handled);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGCHLD}) sigaddset(&handled, signal);
  sigprocmask(SIG_BLOCK, &handled, nullptr);

  const TemporaryFolder folder;
  if (folder.path().empty()) return report({"no temporary folder can be made", "", "check TMPDIR"});
  const Result<Bench> bench = start_devices(options, devices, folder.path());
  if (!bench) return report(bench.error());

  for (std::string setting : options.set) {
    std::ranges::replace(setting, '=', ' ');
    if (const std::string answer = turn(panel, setting); answer != "ok")
      return report({answer, "--set " + setting, "give NAME=NUMBER of a knob that --help lists"}, 2);
  }
  Result<std::unique_ptr<Knobs>> knobs;
  if (!options.knobs.empty()) knobs = Knobs::start(options.knobs, panel);
  if (!knobs) return report(knobs.error());

  const std::filesystem::path file = folder.path() / "bench.json";
  if (!(std::ofstream(file) << to_json(*bench) << std::flush))
    return report({"cannot be written", file.string(), "check the space there"});
  setenv("LUMIFIELD_BENCH", file.c_str(), 1);
  return run_command(options.command, handled);
}

int parse_and_run(int argc, char** argv) {
  Options options;
  Devices devices;
  const KnobPanel panel = make_knobs(devices);
  std::string knob_names = "Knobs, for --set and --knobs:";
  for (const auto& [name, knob] : panel) knob_names += "\n  " + name + " (" + knob.values + ")";

  CLI::App app("The virtual camera and stage of a light-source bench, around a command.", "lumifield-bench");
  app.footer(knob_names);
  app.option_defaults()->always_capture_default();
  WorldOptions& world = options.world;
  bool stage_limits = true;
  const auto of = [](std::set<std::string> names) { return CLI::IsMember(std::move(names)); };
  app.add_option("--lamp", world.lamp, "what is measured")->check(of({"bike", "headlight", "led-array"}));
  app.add_option("--filter", options.filter, "BASIS:SPACING_MM:WINDOW of the slide");
  app.add_option("--seed", world.seed, "of the noise");
  app.add_option("--camera", options.camera_kind,
                 "how it is reached: GigE Vision, USB3 Vision on a virtual bus, or V4L2 on a FUSE file")
      ->check(of({"gige", "usb3", "v4l2"}));
  app.add_option("--address", options.camera.address, "the GigE camera's, of an interface of this machine");
  app.add_option("--stage", options.stage_kind,
                 "GRBL on a terminal, or Thorlabs on USB: a pair of units, or a rack's bays")
      ->check(of({"grbl", "apt", "apt-rack", "apt-servo-rack"}));
  app.add_option("--serial-path", options.stage.path,
                 "where the GRBL stage's terminal is linked; else a temporary path");
  app.add_option("--knobs", options.knobs, "Unix socket that takes lines `NAME VALUE` and `get NAME`");
  app.add_option("--set", options.set, "NAME=VALUE of a knob from the start; may be repeated")->allow_extra_args(false);
  app.add_option("--loss", options.camera.lost_packet_ratio, "share of GigE Vision packets lost")
      ->check(CLI::Range(0., 1.));
  app.add_option("--carries", options.carries, "what the stage moves")->check(of({"slide", "lamp"}));
  app.add_option("--change", options.change, "who changes the pass; by the operator: knob slide, at first 1")
      ->check(of({"stage", "operator"}));
  CLI::Option* format = app.add_option("--pixel-format", world.pixel_format, "BayerRG12 is the led-array's default")
                            ->check(of({"Mono12", "Mono16", "BayerRG12"}));
  app.add_option("--size", options.size, "WIDTHxHEIGHT of the sensor, px");
  app.add_option("--noise", world.noise, "on or off: shot and read noise, dark current, hot pixels");
  app.add_option("--optics", world.optics, "on or off: distortion, vignetting and blur; off is an ideal pinhole");
  app.add_option("--stage-speed", options.stage.rapid_mm_s, "mm/s")->check(CLI::Range(0.1, 1e4));
  app.add_option("--stage-acceleration", options.stage.acceleration_mm_s2, "mm/s²")->check(CLI::Range(0.1, 1e6));
  app.add_option("--stage-limits", stage_limits, "on or off: soft and hard limits, $20 and $21");
  app.add_option("command", options.command, "what to run, after --");
  CLI::App* truth =
      app.add_subcommand("truth", "irradiance at points by quadrature, of --lamp behind --filter")->fallthrough();
  CLI::Option* projected = truth->add_flag("--projected", options.projected, "of the lamp projected on the basis");
  for (auto& [name, count] : {std::pair{"--columns", &options.grid.columns}, {"--rows", &options.grid.rows}})
    truth->add_option(name, *count, "of the plan's grid; 0: as many as touch the lamp")
        ->check(CLI::Range(1, 1000))
        ->needs(projected);
  truth->add_option("--points", options.points, "CSV: x_mm,y_mm,z_mm,nx,ny,nz")->required();
  truth->add_option("--out", options.out, "the same with E_Y,E_R,E_G,E_B")->required();
  CLI::App* knob = app.add_subcommand("knob", "turns or reads a knob of a bench that runs with --knobs SOCKET");
  knob->add_option("socket", options.knobs, "the running bench's")->required();
  knob->add_option("line", options.line, "`NAME VALUE` or `get NAME`")->required();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }

  if (*knob) {
    const Result<std::string> answer = say_to_knobs(options.knobs, options.line);
    if (!answer) return report(answer.error());
    std::puts(answer->c_str());
    return answer->starts_with("error") ? 1 : 0;
  }
  options.stage.soft_limits = options.stage.hard_limits = stage_limits;
  world.carries = options.carries == "lamp" ? StageCarries::lamp : StageCarries::slide;
  world.change = options.change == "operator" ? PassChange::by_operator : PassChange::stage;
  if (const Status filter = apply_filter(options.filter, world); !filter) return report(filter.error(), 2);
  if (const Status size = apply_size(options.size, world); !size) return report(size.error(), 2);
  if (format->empty() && world.lamp == "led-array") world.pixel_format = "BayerRG12";
  if (!*truth) return run_bench(options, devices, panel, argv);
  const Status written = write_truth(world, options.projected, options.points, options.out, options.grid);
  return written ? 0 : report(written.error());
}

}  // namespace
}  // namespace lumifield::virtual_bench

int main(int argc, char** argv) { return lumifield::virtual_bench::parse_and_run(argc, argv); }
