#pragma once

#include <QMenu>
#include <filesystem>
#include <vector>

namespace lumifield {

/// Scene files to choose from: those given, those opened since, and one more from the disk; and the scene of now to be
/// saved. GUI thread.
class SceneMenu : public QMenu {
  Q_OBJECT

 public:
  explicit SceneMenu(QWidget* parent = nullptr);

  void set_scenes(const std::vector<std::filesystem::path>& files);
  /// Marks the one that is shown, and keeps it in the menu.
  void set_current(const std::filesystem::path& file);
  QAction* open_action() const { return open_; }
  QAction* save_action() const { return save_; }

 signals:
  void sceneChosen(const QString& file);

 private:
  QAction* add_scene(const std::filesystem::path& file);
  void ask();

  QAction *before_, *open_, *save_;
  QActionGroup* scenes_;
};

}  // namespace lumifield
