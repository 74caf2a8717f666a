#pragma once

#include <QObject>
#include <QStringList>

namespace lumifield {

/// The datasets opened or scanned last, the latest first, kept with the settings. GUI thread.
class RecentLuminaires : public QObject {
  Q_OBJECT

 public:
  static constexpr int most = 10;

  explicit RecentLuminaires(QObject* parent = nullptr);

  const QStringList& folders() const { return folders_; }
  /// Moves it to the front.
  void add(const QString& folder);
  void clear();

 signals:
  void changed();

 private:
  void keep();

  QStringList folders_;
};

}  // namespace lumifield
