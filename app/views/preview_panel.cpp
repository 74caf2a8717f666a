#include "app/views/preview_panel.h"

#include <QAction>
#include <QCheckBox>
#include <QFileDialog>
#include <QHBoxLayout>
#include <QToolButton>
#include <QVBoxLayout>

#include "app/views/elided_label.h"
#include "app/views/lamp_arrangement.h"
#include "app/views/picture_saver.h"
#include "app/views/preview_inbox.h"
#include "app/views/preview_look_bar.h"
#include "app/views/preview_method_bar.h"
#include "app/views/preview_view.h"
#include "app/views/scene_menu.h"

namespace lumifield {
namespace {

QToolButton* button_of(QAction* action, QWidget* parent) {
  auto* button = new QToolButton(parent);
  button->setDefaultAction(action);
  button->setFocusPolicy(Qt::TabFocus);
  return button;
}

}  // namespace

PreviewPanel::PreviewPanel(QWidget* parent)
    : QWidget(parent),
      view_(new PreviewView(this)),
      look_(new PreviewLookBar(this)),
      method_(new PreviewMethodBar(this)),
      scenes_(new SceneMenu(this)),
      saver_(new PictureSaver(this)),
      status_(new ElidedLabel(this)),
      lamps_(new QAction(tr("&Lamps"), this)),
      handles_(new QAction(tr("Lamp &handles"), this)),
      reset_(new QAction("&Reset view", this)),
      save_(new QAction("&Save picture…", this)) {
  lamps_->setToolTip(tr("Where the scene's lamps stand: a list with numbers, lamps to add and remove"));
  handles_->setToolTip(tr("Whether the lamps' handles lie over the picture"));
  handles_->setCheckable(true);
  handles_->setChecked(true);
  reset_->setIconText("Reset");
  reset_->setToolTip("Back to the scene's own camera (double click, R)");
  save_->setToolTip("Save the picture: PNG as it is shown, or EXR with its linear values");
  save_->setIconText("Save…");
  save_->setEnabled(false);
  status_->setAccessibleName("Value under the cursor, or what the picture leaves out");
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(4, 4, 4, 2);
  column->setSpacing(4);
  make_tools();
  column->addWidget(tools_);
  column->addWidget(look_);
  column->addWidget(method_);
  column->addWidget(view_, 1);
  column->addWidget(status_);
  set_tab_order();

  connect(scenes_, &SceneMenu::sceneChosen, this, &PreviewPanel::sceneChosen);
  connect(scenes_->save_action(), &QAction::triggered, this, &PreviewPanel::ask_for_scene_file);
  connect(lamps_, &QAction::triggered, this, &PreviewPanel::lampsWanted);
  connect(handles_, &QAction::toggled, view_, &PreviewView::set_handles_shown);
  connect(method_, &PreviewMethodBar::methodChanged, this, &PreviewPanel::tell_chosen);
  connect(method_, &PreviewMethodBar::visibilityChanged, this, &PreviewPanel::tell_chosen);
  connect(method_, &PreviewMethodBar::environmentSwitched, this, &PreviewPanel::tell_chosen);
  tell_chosen();
  connect(reset_, &QAction::triggered, view_, &PreviewView::reset_view);
  connect(save_, &QAction::triggered, this, &PreviewPanel::ask_for_file);
  connect(saver_, &PictureSaver::noticed, this, &PreviewPanel::noticed);
  connect(saver_, &PictureSaver::busyChanged, this, &PreviewPanel::allow_saving);
  connect(saver_, &PictureSaver::sceneSaved, this,
          [this](const QString& file) { scenes_->set_scenes({file.toStdString()}); });
  connect(view_, &PreviewView::pointed, this, [this](const QString& value) {
    value_ = value;
    show_notes();
  });
}

void PreviewPanel::make_tools() {
  tools_ = new QWidget(this);
  auto* row = new QHBoxLayout(tools_);
  row->setContentsMargins(0, 0, 0, 0);
  scene_button_ = new QToolButton(tools_);
  scene_button_->setText("Scene");
  scene_button_->setMenu(scenes_);
  scene_button_->setPopupMode(QToolButton::InstantPopup);
  scene_button_->setFocusPolicy(Qt::TabFocus);
  scene_button_->setToolTip("The scene that the luminaire lights");
  scene_button_->setAccessibleName("Scene");
  QToolButton* lamps = button_of(lamps_, tools_);
  auto* colours = new QCheckBox("False colour", tools_);
  colours->setToolTip(look_->false_colour_action()->toolTip());
  connect(colours, &QCheckBox::toggled, look_->false_colour_action(), &QAction::setChecked);
  connect(look_->false_colour_action(), &QAction::toggled, colours, &QCheckBox::setChecked);
  row->addWidget(scene_button_);
  row->addWidget(lamps);
  row->addStretch(1);
  row->addWidget(colours);
  row->addWidget(button_of(reset_, tools_));
  row->addWidget(button_of(save_, tools_));
}

/// As the eye goes: the tools from the left, then how the picture looks, then the picture.
void PreviewPanel::set_tab_order() {
  QWidget* last = scene_button_;
  for (QWidget* row : {tools_, static_cast<QWidget*>(look_), static_cast<QWidget*>(method_)})
    for (QWidget* control : row->findChildren<QWidget*>()) {
      if (control->focusPolicy() == Qt::NoFocus || control == last || control->focusProxy()) continue;
      setTabOrder(last, control);
      last = control;
    }
  setTabOrder(last, view_);
}

void PreviewPanel::connect_to(PreviewInbox& inbox, LivePreview& live) {
  connect(&inbox, &PreviewInbox::frame, this, [this, &live](const std::shared_ptr<const PreviewFrame>& frame) {
    if (frame->luminaire == live.luminaire()) show_frame(frame);
  });
  connect(&inbox, &PreviewInbox::ready, this, &PreviewPanel::show_ready);
  connect(&inbox, &PreviewInbox::failed, this, &PreviewPanel::show_failure);
  connect(&inbox, &PreviewInbox::progress, view_, &PreviewView::show_progress);
  // The inbox's end ends what is told to the render thread too.
  connect(view_, &PreviewView::cameraChanged, &inbox,
          [&live](const SceneCamera& camera, bool moving) { live.set_camera(camera, moving); });
  connect(&view_->lamps(), &LampArrangement::placed, &inbox,
          [&live](const std::vector<ScenePlacement>& lamps, bool moving) { live.set_placements(lamps, moving); });
  connect(view_, &PreviewView::sizeWanted, &inbox, [&live](int width, int height) { live.set_size(width, height); });
  connect(look_, &PreviewLookBar::lookChanged, &inbox, [&live](const PreviewLook& look) { live.set_look(look); });
  connect(method_, &PreviewMethodBar::methodChanged, &inbox,
          [&live](const MethodSettings& method) { live.set_method(method); });
  live.set_look(look_->look());
  connect(method_, &PreviewMethodBar::visibilityChanged, &inbox,
          [&live](Visibility visibility) { live.set_visibility(visibility); });
  connect(method_, &PreviewMethodBar::environmentSwitched, &inbox, [&live](bool on) { live.set_environment(on); });
  connect(method_, &PreviewMethodBar::shadowsToBeRefreshed, &inbox, [&live] { live.refresh_shadows(); });
  live.set_method(method_->method());
  live.set_visibility(method_->visibility());
  live.set_environment(method_->environment());
  if (const QSize& size = view_->wanted_size(); !size.isEmpty()) live.set_size(size.width(), size.height());
}

void PreviewPanel::set_scenes(const std::vector<std::filesystem::path>& files) { scenes_->set_scenes(files); }

void PreviewPanel::set_scene(const Scene& scene, const std::filesystem::path& file) {
  awaits_scene_ = true;
  scenes_->set_current(file);
  scene_button_->setText("Scene: " + QString::fromStdString(scene.name.empty() ? file.stem().string() : scene.name));
  scene_button_->setToolTip("The scene that the luminaire lights: " + QString::fromStdString(file.string()));
  info_ = {};
  show_notes();
  scene_ = scene;
  scene_file_ = file;
  view_->set_scene(scene.camera, scene.luminaires);
  allow_saving();
}

void PreviewPanel::set_luminaire(const LuminaireGeometry& geometry) {
  look_->set_quantity(geometry.quantity);
  view_->set_luminaire(geometry);
  allow_saving();
}

void PreviewPanel::show_frame(const std::shared_ptr<const PreviewFrame>& frame) {
  if (awaits_scene_) return;
  view_->show_frame(frame);
  if (const std::string& note = frame->radiance->note; note != info_.left_out) {
    info_.left_out = note;
    show_notes();
  }
  look_->set_frame(*frame);
  allow_saving();
}

void PreviewPanel::allow_saving() {
  save_->setEnabled(!saver_->busy() && view_->frame());
  scenes_->save_action()->setEnabled(!saver_->busy() && scene_);
}

LampArrangement& PreviewPanel::lamps() { return view_->lamps(); }

void PreviewPanel::show_ready(const RendererInfo& info) {
  awaits_scene_ = false;
  info_ = info;
  method_->offer_environment(info.has_environment);
  tell_chosen();
  show_notes();
}

void PreviewPanel::show_failure(const Error& error) { view_->show_failure(error); }

void PreviewPanel::set_cells(PreviewCells cells) { view_->set_cells(cells); }

/// What the picture is to be by, at once: the render thread may be at a piece of work.
void PreviewPanel::tell_chosen() {
  view_->set_chosen({method_->method(), method_->visibility(), info_.has_environment && method_->environment()});
}

void PreviewPanel::show_notes() {
  QStringList notes;
  for (const std::string& note : info_.notes) notes << QString::fromStdString(note);
  if (!info_.left_out.empty()) notes << tr("left out: %1").arg(QString::fromStdString(info_.left_out));
  status_->set_text(value_.isEmpty() ? notes.join("; ") : value_);
  if (!value_.isEmpty() || info_.opengl.empty()) return;
  notes << "OpenGL: " + QString::fromStdString(info_.opengl) << "OpenCL: " + QString::fromStdString(info_.opencl);
  status_->setToolTip(notes.join("\n"));
}

void PreviewPanel::ask_for_file() {
  auto* dialog = new QFileDialog(this, "Save picture", "preview.png",
                                 "PNG, as it is shown (*.png);;OpenEXR, linear values (*.exr)");
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setAcceptMode(QFileDialog::AcceptSave);
  dialog->setDefaultSuffix("png");
  connect(dialog, &QFileDialog::filterSelected, dialog,
          [dialog](const QString& filter) { dialog->setDefaultSuffix(filter.contains("*.exr") ? "exr" : "png"); });
  connect(dialog, &QFileDialog::fileSelected, this, [this](const QString& file) { save_picture(file.toStdString()); });
  dialog->open();
}

void PreviewPanel::save_picture(const std::filesystem::path& file) {
  if (view_->frame()) return saver_->save(view_->frame(), file);
  const Error error{"there is no picture yet", file.string(), "save again when one is shown", {}};
  emit noticed({OperatorNotice::Level::fault, QString::fromStdString(error.message())});
}

void PreviewPanel::ask_for_scene_file() {
  // Where its mesh is found.
  auto* dialog = new QFileDialog(this, tr("Save scene"), QString::fromStdString(scene_file_.parent_path().string()),
                                 tr("Scenes (*.json)"));
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setAcceptMode(QFileDialog::AcceptSave);
  dialog->setDefaultSuffix("json");
  connect(dialog, &QFileDialog::fileSelected, this, [this](const QString& file) { save_scene(file.toStdString()); });
  dialog->open();
}

void PreviewPanel::save_scene(const std::filesystem::path& file) {
  if (!scene_) return;
  Scene scene = *scene_;
  if (file.lexically_normal() != scene_file_.lexically_normal()) scene.name = file.stem().string();
  scene.camera = view_->orbit().camera();
  scene.luminaires = lamps().lamps();
  saver_->save(scene, file);
}

QList<QAction*> PreviewPanel::panel_actions() const {
  return {scenes_->open_action(),
          scenes_->save_action(),
          lamps_,
          handles_,
          reset_,
          look_->brighter_action(),
          look_->darker_action(),
          look_->hold_average_action(),
          look_->false_colour_action(),
          save_};
}

}  // namespace lumifield
