#include "app/views/recent_luminaires.h"

#include <QDir>
#include <QSettings>

namespace lumifield {

namespace {
constexpr const char* key = "recent/luminaires";
}

RecentLuminaires::RecentLuminaires(QObject* parent) : QObject(parent), folders_(QSettings().value(key).toStringList()) {}

void RecentLuminaires::add(const QString& folder) {
  const QString path = QDir::cleanPath(QDir(folder).absolutePath());
  folders_.removeAll(path);
  folders_.prepend(path);
  while (folders_.size() > most) folders_.removeLast();
  keep();
}

void RecentLuminaires::clear() {
  folders_.clear();
  keep();
}

void RecentLuminaires::keep() {
  QSettings().setValue(key, folders_);
  emit changed();
}

}  // namespace lumifield
