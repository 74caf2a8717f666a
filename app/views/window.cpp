#include "app/views/window.h"

#include <QApplication>
#include <QSettings>
#include <QSocketNotifier>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <unistd.h>

#include "app/session/beside.h"
#include "app/views/main_window.h"
#include "app/views/theme.h"

namespace lumifield {

namespace {

constexpr const char* no_display =
    "lumifield: no display to open the window on: set DISPLAY or WAYLAND_DISPLAY, or use a sub-command, such as "
    "lumifield scan (see lumifield --help)";

/// Qt ends the program with a core dump where a display does not answer: this says what to do instead.
bool opened = false;

void tell(QtMsgType type, const QMessageLogContext&, const QString& message) {
  if (type == QtFatalMsg && !opened) {
    std::fprintf(stderr, "%s\nlumifield: Qt says: %s\n", no_display, qPrintable(message));
    _exit(1);
  }
  if (type != QtDebugMsg && type != QtInfoMsg) std::fprintf(stderr, "lumifield: Qt: %s\n", qPrintable(message));
}

int signal_pipe[2];

/// SIGINT, SIGTERM and SIGHUP close the window, which ends a scan as its closing does but does not ask.
class CloseOnSignal {
 public:
  explicit CloseOnSignal(MainWindow& window) {
    if (pipe2(signal_pipe, O_CLOEXEC | O_NONBLOCK) != 0) return;
    auto* notifier = new QSocketNotifier(signal_pipe[0], QSocketNotifier::Read, &window);
    QObject::connect(notifier, &QSocketNotifier::activated, &window, [&window, notifier] {
      notifier->setEnabled(false);
      window.close_without_asking();
    });
    for (const int signal : {SIGINT, SIGTERM, SIGHUP})
      std::signal(signal, [](int) {
        const char byte = 0;
        (void)!write(signal_pipe[1], &byte, 1);
      });
  }
};

QString text(const std::string& utf8) { return QString::fromStdString(utf8); }

int show_window(int argc, char** argv, const WindowOptions& options) {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY") && !std::getenv("QT_QPA_PLATFORM")) {
    std::fprintf(stderr, "%s\n", no_display);
    return 1;
  }
  qInstallMessageHandler(tell);
  QApplication application(argc, argv);
  QApplication::setOrganizationName("Lumifield");
  QApplication::setApplicationName("lumifield");
  QApplication::setApplicationDisplayName("Lumifield");
  set_style();

  MainWindow window;
  window.show();
  opened = true;
  const CloseOnSignal closer(window);
  if (!options.scene.empty()) window.show_scene(text(options.scene));
  if (!options.luminaire.empty()) window.open(text(options.luminaire));
  if (!options.bench.empty() && !options.plan.empty())
    window.new_scan(text(options.bench), text(options.plan), text(options.out), options.start);
  return QApplication::exec();
}

}  // namespace

int run_window(int argc, char** argv, const WindowOptions& options) {
  const int code = show_window(argc, argv, options);
  if (beside_ended(std::chrono::seconds(1))) return code;
  std::fflush(nullptr);
  _exit(code);
}

}  // namespace lumifield
