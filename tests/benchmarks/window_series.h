#pragma once

#include <QCoreApplication>
#include <QString>
#include <QTimer>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>
#include <unistd.h>
#include <vector>

#include "app/views/main_window.h"
#include "app/views/preview_view.h"

namespace lumifield {

/// What the window's figures are made of: series of times, the event loop's latency, the pictures shown.

using Clock = std::chrono::steady_clock;

inline double ms_since(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct Series {
  std::vector<double> values;
  double at(double share) {
    if (values.empty()) return 0;
    std::sort(values.begin(), values.end());
    return values[std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())))];
  }
  void print(const char* what, const char* unit) {
    std::printf("%s: n %zu, median %.1f, p95 %.1f, p99 %.1f, max %.1f %s\n", what, values.size(), at(0.5), at(0.95),
                at(0.99), at(1), unit);
  }
};

/// Posts an event to the GUI thread every 10 ms and measures when it is handled.
class LoopLatency : public QObject {
 public:
  LoopLatency()
      : thread_([this](std::stop_token stop) {
          while (!stop.stop_requested()) {
            const auto posted = Clock::now();
            QMetaObject::invokeMethod(this, [this, posted] { series.values.push_back(ms_since(posted)); });
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
          }
        }) {}
  ~LoopLatency() override {
    thread_.request_stop();
    thread_.join();
  }
  Series series;

 private:
  std::jthread thread_;
};

inline double resident_mb() {
  std::ifstream statm("/proc/self/statm");
  long pages = 0, resident = 0;
  statm >> pages >> resident;
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1e6;
}

inline void shoot(MainWindow& window, const QString& folder, const QString& name) {
  if (folder.isEmpty()) return;
  std::filesystem::create_directories(folder.toStdString());
  window.grab().save(folder + "/" + name + ".png");
}

/// Handles events as they come until `done`, which QTest::qWaitFor would look at every 10 ms only.
template <class Done>
bool wait_until(Done done, int patience_ms) {
  QTimer timer;  // wakes the loop, so that patience ends
  timer.start(200);
  const auto start = Clock::now();
  while (!done()) {
    if (ms_since(start) > patience_ms) return false;
    QCoreApplication::processEvents(QEventLoop::AllEvents | QEventLoop::WaitForMoreEvents);
  }
  return true;
}

struct Shown {
  explicit Shown(MainWindow& window) {
    QObject::connect(window.findChild<PreviewView*>(), &PreviewView::painted,
                     [this](const std::shared_ptr<const PreviewFrame>& frame) {
                       ++pictures;
                       last = frame;
                       if (frame->handed_in != Clock::time_point{})
                         latency.values.push_back(ms_since(frame->handed_in));
                     });
  }
  int pictures = 0;
  std::shared_ptr<const PreviewFrame> last;
  Series latency;
};

}  // namespace lumifield
