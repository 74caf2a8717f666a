#include "app/views/notices_model.h"

#include <algorithm>

namespace lumifield {

QString level_text(OperatorNotice::Level level) {
  switch (level) {
    case OperatorNotice::Level::information:
      return "information";
    case OperatorNotice::Level::warning:
      return "warning";
    case OperatorNotice::Level::fault:
      return "fault";
  }
  return {};
}

NoticesModel::NoticesModel(QObject* parent, Clock clock) : QAbstractListModel(parent), clock_(std::move(clock)) {}

void NoticesModel::add(const OperatorNotice& notice) {
  if (fold(notice)) return;
  if (rowCount() >= most_notices) {
    beginRemoveRows({}, 0, 0);
    entries_.pop_front();
    endRemoveRows();
  }
  beginInsertRows({}, rowCount(), rowCount());
  const QDateTime now = clock_();
  entries_.push_back({notice, now, now, 1});
  endInsertRows();
  tell_counts();
}

bool NoticesModel::fold(const OperatorNotice& notice) {
  const auto same = std::find_if(entries_.rbegin(), entries_.rend(), [&](const Entry& entry) {
    return entry.notice.level == notice.level && entry.notice.text == notice.text;
  });
  if (same == entries_.rend()) return false;
  const auto at = std::prev(same.base());
  const int row = static_cast<int>(at - entries_.begin()), last = rowCount() - 1;
  if (row != last) {
    beginMoveRows({}, row, row, {}, last + 1);
    std::rotate(at, at + 1, entries_.end());
    endMoveRows();
  }
  ++entries_.back().times;
  entries_.back().last = clock_();
  emit dataChanged(index(last), index(last));
  return true;
}

void NoticesModel::clear() {
  beginResetModel();
  entries_.clear();
  endResetModel();
  tell_counts();
}

int NoticesModel::count(OperatorNotice::Level level) const {
  return static_cast<int>(std::count_if(entries_.begin(), entries_.end(),
                                        [level](const Entry& entry) { return entry.notice.level == level; }));
}

void NoticesModel::tell_counts() {
  using enum OperatorNotice::Level;
  emit countsChanged(count(information), count(warning), count(fault));
}

QString NoticesModel::line(int row) const {
  const Entry& entry = entries_.at(static_cast<std::size_t>(row));
  QString text =
      entry.last.toString("yyyy-MM-dd HH:mm:ss") + "  " + level_text(entry.notice.level) + "  " + entry.notice.text;
  if (entry.times > 1) text += QString("  (%1 times since %2)").arg(entry.times).arg(entry.first.toString("HH:mm:ss"));
  return text;
}

int NoticesModel::rowCount(const QModelIndex& parent) const {
  return parent.isValid() ? 0 : static_cast<int>(entries_.size());
}

QVariant NoticesModel::data(const QModelIndex& index, int role) const {
  if (!checkIndex(index, CheckIndexOption::IndexIsValid)) return {};
  const Entry& entry = entries_.at(static_cast<std::size_t>(index.row()));
  switch (role) {
    case Qt::DisplayRole:
      return entry.notice.text;
    case Qt::ToolTipRole:
    case Qt::AccessibleTextRole:
      return line(index.row());
    case level_role:
      return static_cast<int>(entry.notice.level);
    case time_role:
      return entry.last;
    case times_role:
      return entry.times;
    default:
      return {};
  }
}

}  // namespace lumifield
