#pragma once

#include <QWidget>
#include <vector>

class QGridLayout;
class QLabel;

namespace lumifield {

/// Named figures side by side, or three to a row: a small name above, the value below. GUI thread.
class FigureGrid : public QWidget {
 public:
  /// `widest` reserves the room, so that nothing jumps.
  struct Entry {
    QString name, widest;
  };
  FigureGrid(const std::vector<Entry>& entries, QWidget* parent);

  /// At least 1; as many as there are figures makes one line.
  void set_columns(int columns);
  /// `warn` paints it in the colour of warnings and tells it to screen readers too.
  void show_figure(int index, const QString& value, const QString& tip, bool warn = false);
  QString value(int index) const;

 protected:
  void changeEvent(QEvent* event) override;

 private:
  struct Figure {
    QLabel* name = nullptr;
    QLabel* value = nullptr;
    bool warn = false;
  };
  void colour(const Figure& figure);

  QGridLayout* grid_;
  std::vector<Figure> figures_;
};

}  // namespace lumifield
