#include "app/views/cell_view.h"

#include <QCheckBox>
#include <QComboBox>
#include <QHBoxLayout>
#include <QLabel>
#include <QSignalBlocker>
#include <QVBoxLayout>
#include <algorithm>

#include "app/views/cell_marks.h"
#include "app/views/colour_bar.h"
#include "app/views/figure_grid.h"
#include "app/views/image_view.h"
#include "app/views/value_text.h"

namespace lumifield {

namespace {

std::vector<FigureGrid::Entry> figure_entries() {
  std::vector<FigureGrid::Entry> entries;
  for (const CellFigure figure : all_cell_figures)
    entries.push_back({figure_name(figure), QStringLiteral("0.00123 DN")});
  return entries;
}

}  // namespace

CellView::CellView(const LuminaireModel& model, QWidget* parent)
    : QWidget(parent),
      model_(model),
      figures_(model),
      title_(new QLabel(this)),
      colours_(new QComboBox(this)),
      range_(new QComboBox(this)),
      channel_(new QComboBox(this)),
      image_(new ImageView(this)),
      bar_(new ColourBar(this)),
      reading_(new QLabel(this)),
      histogram_(new HistogramView(this)),
      quality_(new FigureGrid(figure_entries(), this)),
      warnings_(new QLabel(this)) {
  QFont bold = title_->font();
  bold.setBold(true);
  title_->setFont(bold);
  title_->setWordWrap(true);
  reading_->setMinimumHeight(2 * reading_->fontMetrics().lineSpacing());
  reading_->setAlignment(Qt::AlignLeft | Qt::AlignTop);
  reading_->setAccessibleName(tr("Value under the cursor"));
  warnings_->setWordWrap(true);
  warnings_->setTextInteractionFlags(Qt::TextSelectableByMouse);
  quality_->set_columns(2);
  image_->setAccessibleName(tr("Image of the cell"));
  image_->setToolTip(tr("C on S, seen facing the lamp, its light coming towards you: +x to the right, +y up") + u'\n' +
                     image_->toolTip());
  image_->setAccessibleDescription(image_->toolTip());
  histogram_->setAccessibleName(tr("Histogram of the cell's values"));

  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(6, 6, 6, 6);
  column->setSpacing(4);
  column->addWidget(title_);
  column->addWidget(make_choices());
  auto* beside = new QHBoxLayout;
  beside->addWidget(image_, 1);
  beside->addWidget(quality_, 0, Qt::AlignTop);
  column->addLayout(beside, 1);
  column->addWidget(bar_);
  column->addWidget(reading_);
  column->addWidget(histogram_);
  column->addWidget(warnings_);
  make_histogram_choice();

  soon_.setSingleShot(true);
  soon_.setInterval(40);
  connect(&soon_, &QTimer::timeout, this, &CellView::refresh_image);
  connect(image_, &ImageView::hovered, this, &CellView::refresh_reading);
  connect(&model, &LuminaireModel::resetDone, this, &CellView::take_geometry);
  connect(&model, &LuminaireModel::stateChanged, this, &CellView::refresh_title);
  connect(&model, &LuminaireModel::cellChanged, this, [this](CellIndex changed) {
    if (changed == cell_)
      refresh();
    else if (look_.range == CellLook::Range::common && !soon_.isActive())
      soon_.start();
  });
  take_geometry();
}

void CellView::add_choice(QComboBox* choice, const QString& name, const QString& tip) {
  choice->setAccessibleName(name);
  choice->setToolTip(tip);
  connect(choice, &QComboBox::currentIndexChanged, this, &CellView::take_look);
}

QWidget* CellView::make_choices() {
  auto* row = new QWidget(this);
  auto* line = new QHBoxLayout(row);
  line->setContentsMargins(0, 0, 0, 0);
  colours_->addItems({tr("False colour"), tr("Grey")});
  range_->addItems({tr("Own maximum"), tr("Maximum of all cells"), tr("Logarithmic")});
  line->addWidget(colours_);
  line->addWidget(range_, 1);
  line->addWidget(channel_);
  add_choice(colours_, tr("Colours"), tr("Negative values take the colour of 0"));
  add_choice(range_, tr("Scale"),
             tr("Where the scale ends: at this cell's largest value, at the largest of all cells measured, or "
                "logarithmic over four decades below this cell's largest"));
  add_choice(channel_, tr("Channel"), tr("The channel shown and counted, in the camera's primaries"));
  return row;
}

void CellView::make_histogram_choice() {
  // In the corner above the bars.
  auto* over = new QHBoxLayout(histogram_);
  over->setContentsMargins(0, 0, 10, 0);
  auto* logarithmic = new QCheckBox(tr("&Log counts"), histogram_);
  logarithmic->setToolTip(tr("Counts of pixels on a logarithmic scale, so that rare values show"));
  over->addStretch(1);
  over->addWidget(logarithmic, 0, Qt::AlignTop);
  connect(logarithmic, &QCheckBox::toggled, histogram_, &HistogramView::set_logarithmic);
  connect(histogram_, &HistogramView::logarithmicChanged, logarithmic, &QCheckBox::setChecked);
}

QString CellView::unit() const { return model_.geometry() ? cell_unit_text(model_.geometry()->quantity) : QString(); }

void CellView::take_look() {
  look_ = {std::max(0, channel_->currentIndex()), colours_->currentIndex() == 1,
           static_cast<CellLook::Range>(range_->currentIndex())};
  refresh();
}

void CellView::take_geometry() {
  figures_.forget();
  cell_.reset();
  shown_.reset();
  const QSignalBlocker quiet(channel_);
  channel_->clear();
  if (const auto& geometry = model_.geometry()) {
    for (const std::string& name : geometry->channels) channel_->addItem(QString::fromStdString(name));
    image_->set_pixel_aspect(geometry->measurement.pixel_mm.y() / geometry->measurement.pixel_mm.x());
  }
  channel_->setVisible(channel_->count() > 1);
  take_look();
}

void CellView::show_cell(CellIndex cell) {
  if (!model_.geometry() || !model_.geometry()->sampling.contains(cell)) return;
  cell_ = cell;
  refresh();
}

void CellView::refresh() {
  refresh_title();
  refresh_image();
  refresh_histogram();
  refresh_figures();
  refresh_reading();
}

void CellView::refresh_title() {
  if (!cell_) {
    title_->setText(tr("No cell chosen"));
    image_->set_placeholder(model_.geometry() ? tr("Choose a cell in the grid") : tr("No luminaire yet"));
    return;
  }
  QString text = tr("Cell (row %1, column %2)").arg(cell_->row).arg(cell_->column);
  const QString why = model_.damage(*cell_);
  image_->set_placeholder(why.isEmpty() ? tr("%1: not measured yet").arg(text) : tr("%1: damaged: %2").arg(text, why));
  if (const LuminaireModel::Cell* cell = known()) text += tr(", generation %1").arg(cell->entry.generation);
  title_->setText(text + QStringLiteral(": ") + state_name(model_.state(*cell_)));
}

void CellView::refresh_image() {
  const LuminaireModel::Cell* cell = known();
  bar_->setVisible(cell);
  if (!cell) {
    shown_.reset();
    return image_->set_image({});
  }
  const auto channel = static_cast<std::size_t>(look_.channel);
  const double common = look_.range == CellLook::Range::common ? figures_.largest(look_.channel) : 0;
  const ValueScale scale = scale_of(look_, double(figures_.look_at(*cell_).largest.at(channel)), common);
  if (shown_ == cell->image && shown_channel_ == look_.channel && scale == scale_) return;
  shown_ = cell->image;
  shown_channel_ = look_.channel;
  scale_ = scale;
  image_->set_image(colour_image(shown_->channel(look_.channel), shown_->width_px, shown_->height_px, scale));
  bar_->set_scale(scale, tr("C, %1").arg(channel_->currentText()), unit());
}

void CellView::refresh_histogram() {
  const LuminaireModel::Cell* cell = known();
  histogram_->setVisible(cell);
  if (!cell || (counted_ == cell->image && counted_channel_ == look_.channel)) return;
  counted_ = cell->image;
  counted_channel_ = look_.channel;
  histogram_->set_histogram(histogram_of(*counted_, look_.channel, unit()));
}

void CellView::refresh_figures() {
  const LuminaireModel::Cell* cell = known();
  quality_->setVisible(cell);
  warnings_->setVisible(cell);
  if (!cell) return;
  for (std::size_t k = 0; k < all_cell_figures.size(); ++k)
    quality_->show_figure(static_cast<int>(k), figures_.text(all_cell_figures[k], *cell_),
                          figure_meaning(all_cell_figures[k]));
  QStringList lines;
  if (!cell->entry.quality)
    lines << tr("No quality figures on record");
  else if (cell->entry.quality->warnings.empty())
    lines << tr("No warnings");
  else
    for (const std::string& warning : cell->entry.quality->warnings)
      lines << tr("⚠ Warning: %1").arg(QString::fromStdString(warning));
  if (const QString note = figures_.geometry_note(*cell_); !note.isEmpty()) lines << note;
  warnings_->setText(lines.join(u'\n'));
}

void CellView::refresh_reading() {
  const std::optional<QPoint>& pixel = image_->hovered_pixel();
  reading_->setVisible(shown_ != nullptr);
  if (!shown_ || !pixel) return reading_->setText(tr("Point at the image to read C there"));
  const int i = pixel->x(), j = shown_->height_px - 1 - pixel->y();
  QStringList values;
  for (int c = 0; c < shown_->channels; ++c)
    values << channel_->itemText(c) + u' ' + value_text(double(shown_->at(c, i, j)));
  const Vec2 at = model_.geometry()->measurement.pixel_center_mm(i, j);
  reading_->setText(
      values.join(QStringLiteral("  ")) + u' ' + unit() + u'\n' +
      tr("at (%1, %2) mm on S, pixel (%3, %4)").arg(value_text(at.x(), 5), value_text(at.y(), 5)).arg(i).arg(j));
}

}  // namespace lumifield
