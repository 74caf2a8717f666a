#include "app/views/luminaire_model.h"

#include <QStringList>
#include <array>
#include <mutex>
#include <utility>

#include "app/session/beside.h"
#include "app/session/guarded.h"
#include "app/session/preview_memory.h"
#include "renderer/methods/table_memory.h"

namespace lumifield {

namespace {

QString text(const std::string& utf8) { return QString::fromStdString(utf8); }

QStringList texts(const std::vector<std::string>& all) {
  QStringList list;
  for (const std::string& one : all) list << text(one);
  return list;
}

}  // namespace

LuminaireModel::LuminaireModel(QObject* parent) : QObject(parent) {
  connect(&differences_, &NeighbourDifferences::known, this, &LuminaireModel::take_difference);
}

LuminaireModel::~LuminaireModel() {
  give_up(opening_);
  give_up(arriving_);
}

const LuminaireModel::Cell* LuminaireModel::cell(CellIndex index) const {
  const auto found = cells_.find(index);
  return found == cells_.end() ? nullptr : &found->second;
}

LuminaireModel::State LuminaireModel::state(CellIndex index) const {
  if (measuring_ == index) return State::measuring;
  if (waiting_.contains(index)) return State::waiting;
  const Cell* known = cell(index);
  if (!known) return damaged_.contains(index) ? State::damaged : State::unmeasured;
  return known->entry.quality && !known->entry.quality->warnings.empty() ? State::warned : State::measured;
}

void LuminaireModel::reset(const LuminaireGeometry& geometry, const QString& name) {
  give_up(opening_);
  give_up(arriving_);
  geometry_ = geometry;
  name_ = name;
  clear();
  emit resetDone();
}

void LuminaireModel::clear() {
  cells_.clear();
  differences_.forget();
  measuring_.reset();
  waiting_.clear();
  damaged_.clear();
}

QString LuminaireModel::damage(CellIndex index) const {
  const auto found = damaged_.find(index);
  return found == damaged_.end() ? QString() : found->second;
}

void LuminaireModel::take_damage(CellIndex index, const QString& why) {
  if (cells_.contains(index)) return;
  damaged_[index] = why;
  emit stateChanged(index);
}

void LuminaireModel::put(const CellEntry& entry, std::shared_ptr<const CellImage> image) {
  if (!geometry_ || !geometry_->sampling.contains(entry.cell)) return;
  Cell& cell = cells_[entry.cell];
  cell.entry = entry;
  cell.image = std::move(image);
  waiting_.erase(entry.cell);
  damaged_.erase(entry.cell);
  emit cellChanged(entry.cell);
  wish_differences(entry.cell);
}

/// Of a cell and of those to which it is a neighbour.
void LuminaireModel::wish_differences(CellIndex around) {
  const auto cross = [](CellIndex at) {
    return std::array{at, CellIndex{at.row - 1, at.column}, CellIndex{at.row + 1, at.column},
                      CellIndex{at.row, at.column - 1}, CellIndex{at.row, at.column + 1}};
  };
  for (const CellIndex at : cross(around)) {
    if (!cells_.contains(at)) continue;
    NeighbourDifferences::Images images;
    for (const CellIndex beside : cross(at))
      if (const Cell* known = cell(beside)) images[beside] = known->image;
    differences_.wish(geometry_->sampling, at, std::move(images));
  }
}

void LuminaireModel::take_difference(CellIndex index, double difference) {
  const auto found = cells_.find(index);
  if (found == cells_.end()) return;
  found->second.neighbour_difference = difference;
  emit cellChanged(index);
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

/// A load's way back to the model.
struct LuminaireModel::Load {
  explicit Load(LuminaireModel* owner) : model(owner) {}

  bool given_up() {
    const std::lock_guard lock(mutex);
    return !model;
  }
  /// `take` gets the model on the GUI thread, unless the load is given up by then.
  template <class Take>
  void post(const LoadPointer& self, Take take) {
    const std::lock_guard lock(mutex);
    if (!model) return;
    QMetaObject::invokeMethod(
        model,
        [self, take = std::move(take)] {
          if (self->model) take(*self->model);  // null by the GUI thread alone
        },
        Qt::QueuedConnection);
  }

  std::mutex mutex;
  LuminaireModel* model;  ///< null once given up
};

void LuminaireModel::give_up(LoadPointer& load) {
  const LoadPointer given_up = std::exchange(load, nullptr);
  if (!given_up) return;
  const std::lock_guard lock(given_up->mutex);
  given_up->model = nullptr;
}

void LuminaireModel::load(const std::filesystem::path& folder) {
  give_up(opening_);
  opening_ = std::make_shared<Load>(this);
  run_beside(
      "opening", [load = opening_, folder] { read(load, folder); },
      [load = opening_](const Error& error) { end(load, error); });
}

/// Whether it has begun or not.
void LuminaireModel::end(const LoadPointer& load, const Error& error) {
  load->post(load, [load, message = text(error.message())](LuminaireModel& model) {
    for (LoadPointer* each : {&model.opening_, &model.arriving_})
      if (*each == load) each->reset();
    emit model.loadFailed(message);
  });
}

void LuminaireModel::take_begun(const LoadPointer& load, const Manifest& manifest) {
  give_up(arriving_);
  arriving_ = load;
  opening_.reset();
  geometry_ = manifest.geometry;
  name_ = text(manifest.name);
  clear();
  emit resetDone();
  emit loadBegan();
}

/// On the load's thread.
void LuminaireModel::read(const LoadPointer& load, const std::filesystem::path& folder) {
  const Result<DatasetIndex> index = read_dataset_index(folder);
  if (!index) return end(load, index.error());
  // Every cell's image is kept.
  if (const Status fits = check_preview_memory(index->manifest.geometry, host_memory_bytes()); !fits)
    return end(load, fits.error());
  load->post(load, [load, manifest = index->manifest](LuminaireModel& model) { model.take_begun(load, manifest); });
  QStringList notes = texts(index->notes);
  for (const CellEntry& entry : index->manifest.cells) {
    if (load->given_up()) return;
    Result<CellImage> image = guarded("opening", [&] { return read_cell(*index, entry); });
    if (!image) {
      notes << text(image.error().message());
      load->post(load,
                 [cell = entry.cell, why = notes.last()](LuminaireModel& model) { model.take_damage(cell, why); });
      continue;
    }
    image->variance = std::vector<float>();
    if (entry.quality) image->quality = *entry.quality;
    load->post(load, [entry, shared = std::make_shared<const CellImage>(std::move(*image))](LuminaireModel& model) {
      emit model.cellLoaded(entry.cell, shared);
      model.put(entry, shared);
    });
  }
  load->post(load, [where = text(folder.string()), notes](LuminaireModel& model) {
    model.arriving_.reset();
    emit model.loaded(where, notes);
  });
}

}  // namespace lumifield
