#include "app/views/luminaire_model.h"

#include <QStringList>
#include <utility>

#include "app/session/guarded.h"
#include "app/session/preview_memory.h"
#include "luminaire/neighbours.h"

namespace lumifield {

namespace {

QString text(const std::string& utf8) { return QString::fromStdString(utf8); }

QStringList texts(const std::vector<std::string>& all) {
  QStringList list;
  for (const std::string& one : all) list << text(one);
  return list;
}

}  // namespace

LuminaireModel::LuminaireModel(QObject* parent) : QObject(parent) {}

LuminaireModel::~LuminaireModel() { stop_loading(); }

const LuminaireModel::Cell* LuminaireModel::cell(CellIndex index) const {
  const auto found = cells_.find(index);
  return found == cells_.end() ? nullptr : &found->second;
}

LuminaireModel::State LuminaireModel::state(CellIndex index) const {
  if (measuring_ == index) return State::measuring;
  if (waiting_.contains(index)) return State::waiting;
  const Cell* known = cell(index);
  if (!known) return State::unmeasured;
  return known->entry.quality && !known->entry.quality->warnings.empty() ? State::warned : State::measured;
}

void LuminaireModel::reset(const LuminaireGeometry& geometry, const QString& name) {
  stop_loading();
  geometry_ = geometry;
  name_ = name;
  cells_.clear();
  measuring_.reset();
  waiting_.clear();
  emit resetDone();
}

void LuminaireModel::put(const CellEntry& entry, std::shared_ptr<const CellImage> image) {
  if (!geometry_ || !geometry_->sampling.contains(entry.cell)) return;
  cells_[entry.cell] = {entry, std::move(image), 0};
  waiting_.erase(entry.cell);
  update_differences(entry.cell);
}

void LuminaireModel::update_differences(CellIndex around) {
  const auto [row, column] = around;
  for (const CellIndex at : {around, CellIndex{row - 1, column}, CellIndex{row + 1, column}, CellIndex{row, column - 1},
                             CellIndex{row, column + 1}}) {
    const auto found = cells_.find(at);
    if (found == cells_.end()) continue;
    found->second.neighbour_difference = difference(at);
    emit cellChanged(at);
  }
}

double LuminaireModel::difference(CellIndex index) const {
  return neighbour_difference(geometry_->sampling, index, [this](CellIndex at) {
    const Cell* known = cell(at);
    return known ? known->image.get() : nullptr;
  });
}

void LuminaireModel::set_measuring(std::optional<CellIndex> cell) {
  if (measuring_ == cell) return;
  const std::optional<CellIndex> before = std::exchange(measuring_, cell);
  if (before) emit stateChanged(*before);
  if (measuring_) emit stateChanged(*measuring_);
}

void LuminaireModel::set_waiting(const std::set<CellIndex>& cells) {
  const std::set<CellIndex> before = std::exchange(waiting_, cells);
  for (const CellIndex cell : before)
    if (!waiting_.contains(cell)) emit stateChanged(cell);
  for (const CellIndex cell : waiting_)
    if (!before.contains(cell)) emit stateChanged(cell);
}

void LuminaireModel::stop_loading() {
  ++load_number_;
  is_loading_ = false;
  if (!loading_.joinable()) return;
  loading_.request_stop();
  loading_.join();  // at most the reading of one cell
}

void LuminaireModel::load(const std::filesystem::path& folder) {
  stop_loading();
  is_loading_ = true;
  loading_ = std::jthread([this, folder, number = load_number_](std::stop_token stop) {
    // What arrives after a newer load or a reset is not taken.
    const auto post = [this, number](auto&& take) {
      QMetaObject::invokeMethod(
          this,
          [this, number, take = std::forward<decltype(take)>(take)] {
            if (number == load_number_) take();
          },
          Qt::QueuedConnection);
    };
    const auto give_up = [&](const Error& error) {
      post([this, message = text(error.message())] {
        is_loading_ = false;
        emit loadFailed(message);
      });
    };
    const Result<DatasetIndex> index = guarded("opening", [&] { return read_dataset_index(folder); });
    if (!index) return give_up(index.error());
    // Every cell's image is kept.
    if (const Status fits = check_preview_memory(index->manifest.geometry, physical_memory_bytes()); !fits)
      return give_up(fits.error());
    post([this, geometry = index->manifest.geometry, name = text(index->manifest.name)] {
      geometry_ = geometry;
      name_ = name;
      cells_.clear();
      measuring_.reset();
      waiting_.clear();
      emit resetDone();
      emit loadBegan();
    });
    QStringList notes = texts(index->notes);
    for (const CellEntry& entry : index->manifest.cells) {
      if (stop.stop_requested()) return;
      Result<CellImage> image = guarded("opening", [&] { return read_cell(*index, entry); });
      if (!image) {
        notes << text(image.error().message());
        continue;
      }
      image->variance = std::vector<float>();
      if (entry.quality) image->quality = *entry.quality;
      post([this, entry, shared = std::make_shared<const CellImage>(std::move(*image))] {
        emit cellLoaded(entry.cell, shared);
        put(entry, shared);
      });
    }
    post([this, where = text(folder.string()), notes] {
      is_loading_ = false;
      emit loaded(where, notes);
    });
  });
}

}  // namespace lumifield
