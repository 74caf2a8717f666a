#include "app/views/study_chart.h"

#include <QApplication>
#include <QBuffer>
#include <QEvent>
#include <QGraphicsView>
#include <QImage>
#include <QPainter>
#include <QRegularExpression>
#include <QVBoxLayout>
#include <QtSvg/QSvgGenerator>
#include <algorithm>
#include <optional>

#include "app/views/study_drawing.h"
#include "app/views/theme.h"
#include "luminaire/file_io.h"

namespace lumifield {

namespace {

constexpr int dots_per_inch = 96, fine = 2;

/// Three plots in a row at most.
QSizeF file_size(const Study& study) {
  const auto count = static_cast<int>(plots_of(study).plots.size());
  const int columns = std::clamp(count, 1, 3), rows = std::max(1, (count + 2) / 3);
  return QSizeF(columns == 1 ? 640 : 420 * columns, 380 * rows + 110);
}

QFont file_font() {
  QFont font("DejaVu Sans");
  font.setStyleHint(QFont::SansSerif);
  font.setPixelSize(13);
  return font;
}

QByteArray svg_of(StudyDrawing& drawing) {
  QByteArray bytes;
  QBuffer buffer(&bytes);
  QSvgGenerator generator;
  generator.setOutputDevice(&buffer);
  generator.setResolution(dots_per_inch);
  generator.setSize(drawing.sceneRect().size().toSize());
  generator.setViewBox(drawing.sceneRect());
  generator.setTitle("Error against time");
  generator.setDescription(drawing.description());
  QPainter painter(&generator);
  drawing.render(&painter);
  painter.end();
  // Half of what Qt writes are groups that hold nothing.
  static const QRegularExpression empty_group("<g [^>]*>\\s*</g>\\s*");
  return QString::fromUtf8(bytes).remove(empty_group).toUtf8();
}

QByteArray png_of(StudyDrawing& drawing) {
  QImage image(fine * drawing.sceneRect().size().toSize(), QImage::Format_RGB32);
  image.fill(drawing.backgroundBrush().color());
  QPainter painter(&image);
  painter.setRenderHints(QPainter::Antialiasing | QPainter::TextAntialiasing);
  drawing.render(&painter);
  painter.end();
  QByteArray bytes;
  QBuffer buffer(&bytes);
  image.save(&buffer, "PNG");
  return bytes;
}

std::string_view view_of(const QByteArray& bytes) {
  return {bytes.constData(), static_cast<std::size_t>(bytes.size())};
}

Status write_files(const Study& study, const std::filesystem::path& folder) {
  StudyDrawing drawing(study, palette_of(Theme::light), file_font());
  drawing.lay_out(file_size(study));
  // Lines and axes follow their chart's size by events.
  QCoreApplication::sendPostedEvents();
  const QByteArray svg = svg_of(drawing), png = png_of(drawing);
  if (Status written = write_file_durably(folder / "study.svg", view_of(svg)); !written) return written;
  return write_file_durably(folder / "study.png", view_of(png));
}

}  // namespace

StudyChart::StudyChart(QWidget* parent) : QWidget(parent), view_(new QGraphicsView(this)) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  column->addWidget(view_);
  view_->setFrameShape(QFrame::NoFrame);
  view_->setRenderHint(QPainter::Antialiasing);
  view_->setAlignment(Qt::AlignLeft | Qt::AlignTop);
  view_->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  for (QWidget* part : {static_cast<QWidget*>(view_), view_->viewport()})
    part->setAccessibleName("Chart of error against time");
  view_->viewport()->installEventFilter(this);
  draw();
}

StudyChart::~StudyChart() = default;

void StudyChart::set_study(const Study& study) {
  study_ = study;
  draw();
}

void StudyChart::draw() {
  auto drawing = std::make_unique<StudyDrawing>(study_, palette(), font());
  view_->setScene(drawing.get());
  view_->setAccessibleDescription(drawing->description());
  drawing_ = std::move(drawing);
  fit();
}

void StudyChart::fit() { drawing_->lay_out(view_->viewport()->size()); }

bool StudyChart::eventFilter(QObject* watched, QEvent* event) {
  if (watched == view_->viewport() && event->type() == QEvent::Resize) fit();
  return QWidget::eventFilter(watched, event);
}

void StudyChart::changeEvent(QEvent* event) {
  QWidget::changeEvent(event);
  if (event->type() == QEvent::PaletteChange || event->type() == QEvent::FontChange) draw();
}

Status write_study_chart(const Study& study, const std::filesystem::path& folder) {
  std::optional<QApplication> application;
  int count = 3;
  char name[] = "lumifield", option[] = "-platform", platform[] = "offscreen";
  char* arguments[] = {name, option, platform, nullptr};
  if (!QCoreApplication::instance()) application.emplace(count, arguments);
  return write_files(study, folder);
}

}  // namespace lumifield
