#include "app/views/grid_map.h"

#include <QAction>
#include <QApplication>
#include <QContextMenuEvent>
#include <QHelpEvent>
#include <QKeyEvent>
#include <QMenu>
#include <QToolTip>
#include <algorithm>
#include <cmath>

namespace lumifield {

namespace {

using State = LuminaireModel::State;

QString how_it_lies() {
  return GridMap::tr("Seen facing the lamp, its light coming towards you: +x to the right, +y up, rows count upwards");
}

}  // namespace

GridMap::GridMap(const LuminaireModel& model, QWidget* parent) : QWidget(parent), model_(model), figures_(model) {
  setFocusPolicy(Qt::StrongFocus);
  setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Expanding);
  setAccessibleName(tr("Grid of cells"));
  setAccessibleDescription(how_it_lies());
  const auto repaint = [this] { update(); };
  connect(&model, &LuminaireModel::cellChanged, this, repaint);
  connect(&model, &LuminaireModel::stateChanged, this, repaint);
  connect(&model, &LuminaireModel::resetDone, this, &GridMap::forget);
}

QSize GridMap::sizeHint() const { return {380, 320}; }
QSize GridMap::minimumSizeHint() const { return {200, 125}; }

void GridMap::forget() {
  figures_.forget();
  selection_.clear();
  refresh_scale();
  emit selectionChanged();
}

void GridMap::set_figure(std::optional<CellFigure> figure) {
  figure_ = figure;
  refresh_scale();
}

void GridMap::refresh_scale() {
  if (figure_) scale_ = figures_.scale(*figure_);
  update();
}

void GridMap::set_retake_possible(bool possible, const QString& reason) {
  retake_possible_ = possible;
  retake_reason_ = reason;
}

std::vector<CellIndex> GridMap::retakable() const {
  std::vector<CellIndex> cells;
  std::ranges::copy_if(selection_.selected(), std::back_inserter(cells), [this](CellIndex cell) {
    const State state = model_.state(cell);
    return state == State::measured || state == State::warned;
  });
  return cells;
}

void GridMap::request_retake() {
  const std::vector<CellIndex> cells = retakable();
  if (retake_possible_ && !cells.empty()) emit retakeRequested(cells);
}

void GridMap::select(const GridSelection& selection) {
  const std::optional<CellIndex> before = selection_.current();
  const bool same = selection_.selected() == selection.selected();
  selection_ = selection;
  update();
  if (!same) emit selectionChanged();
  if (selection_.current() == before || !selection_.current()) return;
  setAccessibleDescription(figures_.summary(*selection_.current()) + u'\n' + how_it_lies());
  emit cellSelected(*selection_.current());
}

void GridMap::choose(CellIndex cell) {
  if (!model_.geometry() || !model_.geometry()->sampling.contains(cell)) return;
  GridSelection chosen = selection_;
  chosen.choose(cell);
  select(chosen);
}

void GridMap::select_warned() {
  std::set<CellIndex> cells;
  for (int k = 0; k < model_.total(); ++k)
    if (const CellIndex at = model_.geometry()->sampling.index(k); model_.state(at) == State::warned) cells.insert(at);
  GridSelection chosen = selection_;
  chosen.set(std::move(cells));
  select(chosen);
}

void GridMap::select_all() {
  std::set<CellIndex> cells;
  for (int k = 0; k < model_.total(); ++k) cells.insert(model_.geometry()->sampling.index(k));
  GridSelection chosen = selection_;
  chosen.set(std::move(cells));
  select(chosen);
}

QString GridMap::text_at(const QPointF& position) const {
  const std::optional<CellIndex> cell = cell_at(position);
  return cell ? figures_.summary(*cell) + u'\n' + how_it_lies() : how_it_lies();
}

bool GridMap::event(QEvent* event) {
  if (event->type() != QEvent::ToolTip) return QWidget::event(event);
  const auto* help = static_cast<QHelpEvent*>(event);
  const std::optional<CellIndex> cell = cell_at(help->pos());
  const QRect kept = cell ? cell_rect(*cell).toAlignedRect() : QRect();
  QToolTip::showText(help->globalPos(), text_at(help->pos()), this, kept);
  return true;
}

void GridMap::mousePressEvent(QMouseEvent* event) {
  if (event->button() != Qt::LeftButton) return QWidget::mousePressEvent(event);
  pressed_ = event->position();
}

void GridMap::mouseMoveEvent(QMouseEvent* event) {
  if (!pressed_ || !model_.geometry()) return;
  const QPointF far = event->position() - *pressed_;
  if (band_.isNull() && far.manhattanLength() < QApplication::startDragDistance()) return;
  band_ = QRectF(*pressed_, event->position()).normalized();
  update();
}

void GridMap::mouseReleaseEvent(QMouseEvent* event) {
  if (event->button() != Qt::LeftButton || !pressed_ || !model_.geometry()) return;
  const QPointF from = *std::exchange(pressed_, std::nullopt);
  const QRectF band = std::exchange(band_, QRectF());
  const bool control = event->modifiers().testFlag(Qt::ControlModifier);
  GridSelection chosen = selection_;
  if (!band.isNull()) {
    update();
    const CellIndex corner = nearest_cell(from), other = nearest_cell(event->position());
    const QRectF cells = cell_rect(corner).united(cell_rect(other));
    if (!cells.intersects(band)) return;  // drawn beside the grid
    chosen.span(corner, other, control);
  } else if (const std::optional<CellIndex> cell = cell_at(from)) {
    if (control)
      chosen.toggle(*cell);
    else if (event->modifiers().testFlag(Qt::ShiftModifier))
      chosen.extend_to(*cell);
    else
      chosen.choose(*cell);
  }
  select(chosen);
}

void GridMap::mouseDoubleClickEvent(QMouseEvent* event) {
  if (const std::optional<CellIndex> cell = cell_at(event->position())) emit cellOpened(*cell);
}

void GridMap::move_current(int rows, int columns, bool extend) {
  if (!model_.geometry() || model_.total() == 0) return;
  const Sampling& sampling = model_.geometry()->sampling;
  CellIndex to{0, 0};
  if (const std::optional<CellIndex>& at = selection_.current())
    to = {std::clamp(at->row + rows, 0, sampling.rows - 1), std::clamp(at->column + columns, 0, sampling.columns - 1)};
  GridSelection chosen = selection_;
  extend ? chosen.extend_to(to) : chosen.choose(to);
  select(chosen);
}

void GridMap::keyPressEvent(QKeyEvent* event) {
  const bool extend = event->modifiers().testFlag(Qt::ShiftModifier);
  if (event->matches(QKeySequence::SelectAll)) return select_all();
  switch (event->key()) {
    case Qt::Key_Up:
      return move_current(1, 0, extend);
    case Qt::Key_Down:
      return move_current(-1, 0, extend);
    case Qt::Key_Left:
      return move_current(0, -1, extend);
    case Qt::Key_Right:
      return move_current(0, 1, extend);
    case Qt::Key_Return:
    case Qt::Key_Enter:
      if (selection_.current()) emit cellOpened(*selection_.current());
      return;
    case Qt::Key_Space:
      if (selection_.current() && event->modifiers().testFlag(Qt::ControlModifier)) {
        GridSelection chosen = selection_;
        chosen.toggle(*selection_.current());
        return select(chosen);
      }
      break;
    default:
      break;
  }
  QWidget::keyPressEvent(event);
}

void GridMap::contextMenuEvent(QContextMenuEvent* event) {
  if (!model_.geometry()) return;
  // On a cell outside the selection the menu is about that cell.
  const std::optional<CellIndex> under = cell_at(event->pos());
  if (event->reason() == QContextMenuEvent::Mouse && under && !selection_.selected().contains(*under)) choose(*under);
  QMenu menu(this);
  menu.setToolTipsVisible(true);
  QAction* retake = menu.addAction(tr("Retake selected cells"), this, &GridMap::request_retake);
  retake->setEnabled(retake_possible_ && !retakable().empty());
  retake->setToolTip(retake_possible_ ? tr("Cells measured are taken again, next") : retake_reason_);
  menu.addSeparator();
  menu.addAction(tr("Select cells with warnings"), this, &GridMap::select_warned);
  menu.addAction(tr("Select all"), this, &GridMap::select_all);
  const bool keyboard = event->reason() == QContextMenuEvent::Keyboard && selection_.current();
  menu.exec(keyboard ? mapToGlobal(cell_rect(*selection_.current()).center().toPoint()) : event->globalPos());
}

}  // namespace lumifield
