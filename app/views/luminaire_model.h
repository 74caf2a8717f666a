#pragma once

#include <QObject>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>

#include "app/views/neighbour_differences.h"
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
    /// NaN without neighbours. A slipped stage or a wrong filter stands out. Computed on another thread: NaN until
    /// then, or of the images before; cellChanged tells.
    double neighbour_difference = std::numeric_limits<double>::quiet_NaN();
  };
  enum class State { unmeasured, measuring, waiting, measured, warned, damaged };

  explicit LuminaireModel(QObject* parent = nullptr);
  ~LuminaireModel() override;

  /// Empty before a luminaire is there.
  const std::optional<LuminaireGeometry>& geometry() const { return geometry_; }
  const QString& name() const { return name_; }
  /// Null while unmeasured.
  const Cell* cell(CellIndex index) const;
  State state(CellIndex index) const;
  /// Why a cell of the dataset could not be read; empty of others.
  QString damage(CellIndex index) const;
  int damaged() const { return static_cast<int>(damaged_.size()); }
  int measured() const { return static_cast<int>(cells_.size()); }
  int total() const { return geometry_ ? geometry_->sampling.cells() : 0; }

  /// Another luminaire, without cells.
  void reset(const LuminaireGeometry& geometry, const QString& name);
  /// Adds or replaces one.
  void put(const CellEntry& entry, std::shared_ptr<const CellImage> image);
  /// The one that the bench works on, and those that wait to be taken again.
  void set_measuring(std::optional<CellIndex> cell);
  void set_waiting(const std::set<CellIndex>& cells);

  /// Reads a dataset in a thread of its own: resetDone and loadBegan, then cellChanged for each, then loaded; or
  /// loadFailed, which changes nothing but where memory ends amid the cells: those that came stay. A load under way
  /// goes on until this one begins. Of several that have not begun the last counts. One that hangs is left behind
  /// (beside.h): nothing waits for it.
  void load(const std::filesystem::path& folder);
  /// One that has not begun.
  void give_up_opening() { give_up(opening_); }
  bool loading() const { return opening_ || arriving_; }

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
  void clear();
  void take_damage(CellIndex index, const QString& why);
  void wish_differences(CellIndex around);
  void take_difference(CellIndex index, double difference);
  struct Load;
  using LoadPointer = std::shared_ptr<Load>;
  static void give_up(LoadPointer& load);
  static void read(const LoadPointer& load, const std::filesystem::path& folder);
  static void end(const LoadPointer& load, const Error& error);
  void take_begun(const LoadPointer& load, const Manifest& manifest);

  std::optional<LuminaireGeometry> geometry_;
  QString name_;
  std::map<CellIndex, Cell> cells_;
  NeighbourDifferences differences_;
  std::optional<CellIndex> measuring_;
  std::set<CellIndex> waiting_;
  std::map<CellIndex, QString> damaged_;  ///< and why
  LoadPointer opening_;                   ///< null but before a load begins
  LoadPointer arriving_;                  ///< null but while cells come
};

}  // namespace lumifield
