#pragma once

#include <QObject>
#include <atomic>
#include <filesystem>
#include <optional>
#include <set>

#include "app/session/live_preview.h"
#include "app/views/latest_reading.h"
#include "app/views/luminaire_model.h"
#include "app/views/scan_controller.h"

namespace lumifield {

/// What the window works on, and the rules between its parts: a luminaire is opened or scanned, its cells go to the
/// preview, a scan that ended can go on, and cells can be taken again. Files are read in threads of their own. GUI
/// thread.
class Workbench : public QObject {
  Q_OBJECT

 public:
  explicit Workbench(LivePreview& preview, BenchDevices devices = {}, QObject* parent = nullptr);
  ~Workbench() override;

  LuminaireModel& model() { return model_; }
  ScanController& scan() { return scan_; }
  LivePreview& live_preview() { return preview_; }
  /// The dataset that is shown; empty before there is one.
  const std::filesystem::path& folder() const { return folder_; }
  /// What would be scanned; empty without a bench.
  const std::optional<ScanRequest>& request() const { return request_; }
  /// Empty when a scan can start; else why not and what to do.
  QString why_not_start() const;
  /// The same for taking cells again.
  QString why_not_retake() const;

  /// Shows a dataset, whole or half; one that cannot be opened changes nothing but for a notice. Not while a scan runs.
  void open(const std::filesystem::path& folder);
  /// Takes a bench and a plan for the next scan, into `out`; what `out` holds already is shown and gone on with.
  /// `prepared` follows, or a notice of what is wrong.
  void prepare(const std::filesystem::path& bench, const std::filesystem::path& plan, const std::filesystem::path& out);
  void show_scene(const std::filesystem::path& scene);

 public slots:
  /// Starts, or goes on with what is there.
  void start();
  /// Tries the scan in small.
  void rehearse();
  /// Next in a scan that runs; else the scan goes on and takes them too.
  void retake(const std::vector<lumifield::CellIndex>& cells);

 signals:
  void prepared();
  /// `scene` is the file.
  void sceneRead(const lumifield::Scene& scene, const QString& file);
  void noticed(const lumifield::OperatorNotice& notice);
  /// `folder`, `request` or what may start has changed.
  void changed();

 private:
  void take_opened();
  void take_prepared(ScanRequest request, bool exists);
  void begin(std::vector<CellIndex> retakes);
  void report(OperatorNotice::Level level, const QString& text) { emit noticed({level, text}); }
  void take_refused(const QString& message);
  void go_on();

  LivePreview& preview_;
  LuminaireModel model_;
  ScanController scan_;
  std::filesystem::path folder_, opening_;  ///< the latter: asked for last, folder_ once it has begun
  std::optional<ScanRequest> request_;
  std::set<CellIndex> waiting_;
  std::atomic<bool> keep_cells_{false};                ///< the scan goes on with the luminaire that the preview holds
  bool exists_ = false;                                ///< the request's dataset is there
  std::optional<std::vector<CellIndex>> when_loaded_;  ///< begin with these
  LatestReading scene_{this}, request_files_{this};
};

}  // namespace lumifield
