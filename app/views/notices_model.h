#pragma once

#include <QAbstractListModel>
#include <QDateTime>
#include <deque>
#include <functional>

#include "app/views/operator_notice.h"

namespace lumifield {

/// What the operator was told, newest last. A notice that is told again moves to the end and is counted; beyond
/// `most_notices` the oldest goes. GUI thread.
class NoticesModel : public QAbstractListModel {
  Q_OBJECT

 public:
  static constexpr int most_notices = 1000;
  enum Role { level_role = Qt::UserRole, time_role, times_role };
  using Clock = std::function<QDateTime()>;

  explicit NoticesModel(
      QObject* parent = nullptr, Clock clock = [] { return QDateTime::currentDateTime(); });

  void add(const OperatorNotice& notice);
  void clear();
  /// One line of plain text: time, level, text, how often.
  QString line(int row) const;
  int count(OperatorNotice::Level level) const;

  int rowCount(const QModelIndex& parent = {}) const override;
  QVariant data(const QModelIndex& index, int role = Qt::DisplayRole) const override;

 signals:
  /// How many different notices of each level there are.
  void countsChanged(int information, int warnings, int faults);

 private:
  struct Entry {
    OperatorNotice notice;
    QDateTime first, last;
    int times = 1;
  };
  bool fold(const OperatorNotice& notice);
  void tell_counts();

  Clock clock_;
  std::deque<Entry> entries_;
};

/// "information", "warning", "fault".
QString level_text(OperatorNotice::Level level);

}  // namespace lumifield
