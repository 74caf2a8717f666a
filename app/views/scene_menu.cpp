#include "app/views/scene_menu.h"

#include <QAction>
#include <QActionGroup>
#include <QFileDialog>
#include <QFileInfo>

namespace lumifield {
namespace {

QString text_of(const std::filesystem::path& file) { return QString::fromStdString(file.lexically_normal().string()); }

/// Scene files are often called alike: the folder tells them apart.
QString name_of(const QString& file) {
  const QFileInfo info(file);
  return info.completeBaseName() == "scene" ? info.dir().dirName() : info.completeBaseName();
}

}  // namespace

SceneMenu::SceneMenu(QWidget* parent) : QMenu("&Scene", parent), scenes_(new QActionGroup(this)) {
  setToolTipsVisible(true);
  before_ = addSeparator();
  open_ = addAction("&Open scene…");
  open_->setToolTip("Open a scene file (JSON, format lumifield-scene)");
  save_ = addAction(tr("Save s&cene as…"));
  save_->setToolTip(tr("Save camera and lamps as they are now as a scene file, beside the scene's mesh or above"));
  save_->setEnabled(false);
  connect(open_, &QAction::triggered, this, &SceneMenu::ask);
}

void SceneMenu::set_scenes(const std::vector<std::filesystem::path>& files) {
  for (const std::filesystem::path& file : files) add_scene(file);
}

QAction* SceneMenu::add_scene(const std::filesystem::path& file) {
  const QString path = text_of(file);
  for (QAction* known : scenes_->actions())
    if (known->data() == path) return known;
  auto* action = new QAction(name_of(path).replace("&", "&&"), scenes_);
  action->setCheckable(true);
  action->setData(path);
  action->setToolTip(path);
  insertAction(before_, action);
  // Marked once it is shown: it may fail.
  connect(action, &QAction::triggered, this, [this, action, path] {
    action->setChecked(false);
    emit sceneChosen(path);
  });
  return action;
}

void SceneMenu::set_current(const std::filesystem::path& file) { add_scene(file)->setChecked(true); }

void SceneMenu::ask() {
  auto* dialog = new QFileDialog(parentWidget(), "Open scene", {}, "Scenes (*.json);;All files (*)");
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setFileMode(QFileDialog::ExistingFile);
  connect(dialog, &QFileDialog::fileSelected, this, &SceneMenu::sceneChosen);
  dialog->open();
}

}  // namespace lumifield
