#pragma once

#include <QObject>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <thread>

#include "luminaire/dataset.h"

namespace lumifield {

/// The luminaire in the window: geometry, cells with their images and quality. Whoever shows cells listens to it.
/// GUI thread.
class LuminaireModel : public QObject {
  Q_OBJECT

 public:
  struct Cell {
    CellEntry entry;
    std::shared_ptr<const CellImage> image;
    /// Σ|C − N| / Σ(|C| + |N|), N the mean of the measured cells beside, above and below: 0 alike, 1 nothing in common,
    /// NaN without neighbours. A slipped stage or a wrong filter stands out.
    double neighbour_difference = 0;
  };
  enum class State { unmeasured, measuring, waiting, measured, warned };

  explicit LuminaireModel(QObject* parent = nullptr);
  ~LuminaireModel() override;

  /// Empty before a luminaire is there.
  const std::optional<LuminaireGeometry>& geometry() const { return geometry_; }
  const QString& name() const { return name_; }
  /// Null while unmeasured.
  const Cell* cell(CellIndex index) const;
  State state(CellIndex index) const;
  int measured() const { return static_cast<int>(cells_.size()); }
  int total() const { return geometry_ ? geometry_->sampling.cells() : 0; }

  /// Another luminaire, without cells.
  void reset(const LuminaireGeometry& geometry, const QString& name);
  /// Adds or replaces one.
  void put(const CellEntry& entry, std::shared_ptr<const CellImage> image);
  /// The one that the bench works on, and those that wait to be taken again.
  void set_measuring(std::optional<CellIndex> cell);
  void set_waiting(const std::set<CellIndex>& cells);

  /// Reads a dataset in a thread of its own: resetDone, then cellChanged for each, then loaded or loadFailed. A load
  /// under way is given up.
  void load(const std::filesystem::path& folder);
  bool loading() const { return is_loading_; }

 signals:
  void resetDone();
  /// After resetDone, when the cells come from a dataset; each is told by cellLoaded, too.
  void loadBegan();
  void cellLoaded(lumifield::CellIndex cell, std::shared_ptr<const lumifield::CellImage> image);
  void cellChanged(lumifield::CellIndex cell);
  void stateChanged(lumifield::CellIndex cell);
  /// `notes`: torn lines, damaged files, defaults taken.
  void loaded(const QString& folder, const QStringList& notes);
  void loadFailed(const QString& message);

 private:
  void update_differences(CellIndex around);
  double difference(CellIndex index) const;
  void stop_loading();

  std::optional<LuminaireGeometry> geometry_;
  QString name_;
  std::map<CellIndex, Cell> cells_;
  std::optional<CellIndex> measuring_;
  std::set<CellIndex> waiting_;
  std::jthread loading_;
  std::uint64_t load_number_ = 0;
  bool is_loading_ = false;
};

}  // namespace lumifield
