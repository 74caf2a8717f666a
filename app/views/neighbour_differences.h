#pragma once

#include <QObject>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <thread>

#include "luminaire/light_field.h"

namespace lumifield {

/// The neighbour_difference of cells, computed on a thread of its own: of several wishes for a cell only the last
/// counts. GUI thread.
class NeighbourDifferences : public QObject {
  Q_OBJECT

 public:
  using Images = std::map<CellIndex, std::shared_ptr<const CellImage>>;

  explicit NeighbourDifferences(QObject* parent = nullptr);
  /// Waits for the cell at hand.
  ~NeighbourDifferences() override;

  /// `images`: of the cell and of those around it that are measured.
  void wish(const Sampling& sampling, CellIndex cell, Images images);
  /// Of another luminaire: none of those before is told any more.
  void forget();

 signals:
  void known(lumifield::CellIndex cell, double difference);

 private:
  struct Wish {
    Sampling sampling;
    Images images;
  };
  void run(const std::stop_token& stop);

  std::mutex mutex_;
  std::condition_variable_any came_;
  std::map<CellIndex, Wish> wishes_;
  std::uint64_t luminaire_ = 0;
  std::jthread thread_;  ///< the last, so that it ends before what it uses
};

}  // namespace lumifield
