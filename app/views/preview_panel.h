#pragma once

#include <QList>
#include <QWidget>
#include <filesystem>
#include <memory>
#include <optional>

#include "app/session/live_preview.h"
#include "app/views/operator_notice.h"

class QAction;
class QToolButton;

namespace lumifield {

class ElidedLabel;
class LampArrangement;
class PictureSaver;
class PreviewInbox;
class PreviewLookBar;
class PreviewMethodBar;
class PreviewView;
class SceneMenu;
struct PreviewCells;

/// The preview with its tools: scene, lamps, exposure or false colours, method, view, saving; below, the value under
/// the cursor or what the picture leaves out. GUI thread.
class PreviewPanel : public QWidget {
  Q_OBJECT

 public:
  explicit PreviewPanel(QWidget* parent = nullptr);

  /// Shows what the render thread says, but late frames of a former luminaire, and tells it camera, lamps, size,
  /// look and method from now on. Both outlive the panel's use of them.
  void connect_to(PreviewInbox& inbox, LivePreview& live);

  /// Scene files to choose from, besides those opened.
  void set_scenes(const std::vector<std::filesystem::path>& files);
  /// This one is being shown: frames count from the renderer's next `ready` on.
  void set_scene(const Scene& scene, const std::filesystem::path& file);
  void set_luminaire(const LuminaireGeometry& geometry);

  void show_frame(const std::shared_ptr<const PreviewFrame>& frame);
  void show_ready(const RendererInfo& info);
  void show_failure(const Error& error);
  /// Of the luminaire, be they in a picture or not.
  void set_cells(PreviewCells cells);
  /// Writes the latest picture, PNG or EXR by the name's end; `noticed` tells how it went.
  void save_picture(const std::filesystem::path& file);
  /// Writes the scene as it is seen and lit now; `noticed` tells how it went. Mesh and environment stay where they are.
  void save_scene(const std::filesystem::path& file);

  PreviewView& view() { return *view_; }
  PreviewLookBar& look_bar() { return *look_; }
  PreviewMethodBar& method_bar() { return *method_; }
  LampArrangement& lamps();
  /// For a menu, with mnemonics and without keys: open scene, save scene, lamps, their handles, reset view, brighter,
  /// darker, hold average, false colour, save picture.
  QList<QAction*> panel_actions() const;
  SceneMenu* scene_menu() const { return scenes_; }

 signals:
  void sceneChosen(const QString& file);
  void noticed(const lumifield::OperatorNotice& notice);
  /// The list of the lamps is to be seen.
  void lampsWanted();

 private:
  void make_tools();
  void set_tab_order();
  void show_notes();
  void tell_chosen();
  void ask_for_file();
  void ask_for_scene_file();
  void allow_saving();

  PreviewView* view_;
  PreviewLookBar* look_;
  PreviewMethodBar* method_;
  SceneMenu* scenes_;
  PictureSaver* saver_;
  ElidedLabel* status_;
  QWidget* tools_ = nullptr;
  QToolButton* scene_button_ = nullptr;
  QAction *lamps_, *handles_, *reset_, *save_;
  std::optional<Scene> scene_;  ///< as its file has it
  std::filesystem::path scene_file_;
  RendererInfo info_;
  QString value_;  ///< under the cursor
  bool awaits_scene_ = false;
};

}  // namespace lumifield
