#pragma once

#include <QString>
#include <QWidget>
#include <cstdint>
#include <optional>
#include <vector>

namespace lumifield {

/// How often values fall into bins of equal width.
struct Histogram {
  std::vector<std::uint64_t> counts;
  double from = 0, to = 1;  ///< outer edges of the first and the last bin
  QString axis;             ///< what the values are, "signal"
  QString unit;             ///< of the values, "DN"
  QString counted;          ///< what is counted, "pixels"
};

/// A histogram with its value axis in units and a marker line, e.g. at saturation. Where bins are narrower than the
/// screen's pixels the highest of them shows. Counts linear or logarithmic (key L): an empty bin stays empty. The
/// tooltip tells the bin under the cursor. Legible at 380 × 120. GUI thread.
class HistogramView : public QWidget {
  Q_OBJECT
  Q_PROPERTY(bool logarithmic READ logarithmic WRITE set_logarithmic NOTIFY logarithmicChanged)

 public:
  explicit HistogramView(QWidget* parent = nullptr);

  /// Without counts: the placeholder's text is shown.
  void set_histogram(Histogram histogram);
  const Histogram& histogram() const { return histogram_; }
  /// A line at `value` with its name; empty: none.
  void set_marker(std::optional<double> value, const QString& name = {});
  void set_placeholder(const QString& text);
  bool logarithmic() const { return logarithmic_; }

  /// The plot without its axes.
  QRectF plot_rect() const;
  /// "1 200 … 1 264 DN: 35 pixels"; empty beside the plot.
  QString text_at(const QPointF& position) const;

  QSize sizeHint() const override;
  QSize minimumSizeHint() const override;

 public slots:
  void set_logarithmic(bool logarithmic);

 signals:
  void logarithmicChanged(bool logarithmic);

 protected:
  bool event(QEvent* event) override;
  void paintEvent(QPaintEvent* event) override;
  void keyPressEvent(QKeyEvent* event) override;

 private:
  void describe();
  double height_share(std::uint64_t count) const;
  double x_of(double value) const;
  void paint_bars(QPainter& painter) const;
  void paint_value_axis(QPainter& painter) const;
  void paint_count_axis(QPainter& painter) const;
  void paint_marker(QPainter& painter) const;

  Histogram histogram_;
  std::uint64_t highest_ = 0;
  std::optional<double> marker_;
  QString marker_name_, placeholder_;
  bool logarithmic_ = false;
};

}  // namespace lumifield
