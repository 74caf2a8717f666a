#pragma once

#include <QWidget>

#include "renderer/methods/method.h"
#include "renderer/visibility/visibility.h"

class QCheckBox;
class QComboBox;
class QHBoxLayout;
class QSpinBox;
class QToolButton;

namespace lumifield {

/// How the preview's light is computed, by how many samples where the method draws any, what casts shadows, and whether
/// the scene's environment lights it. The reference is not offered: a picture of it takes minutes. GUI thread.
class PreviewMethodBar : public QWidget {
  Q_OBJECT

 public:
  explicit PreviewMethodBar(QWidget* parent = nullptr);

  const MethodSettings& method() const { return method_; }
  Visibility visibility() const;
  bool environment() const;
  /// A scene without an environment is not asked about it.
  void offer_environment(bool offered);

 signals:
  void methodChanged(const lumifield::MethodSettings& method);
  void visibilityChanged(lumifield::Visibility visibility);
  void environmentSwitched(bool on);
  /// Published shadows are to stand where the cells of now have their light.
  void shadowsToBeRefreshed();

 private:
  void add_methods(QHBoxLayout* row);
  void add_shadows(QHBoxLayout* row);
  void explain_shadows();
  void choose(Method method);
  void tell(const MethodSettings& method);

  MethodSettings method_;
  Method counted_ = Method::position_dependent;  ///< what the samples shown are of
  QComboBox* methods_;
  QSpinBox* samples_;
  QComboBox* shadows_;
  QToolButton* refresh_;
  QCheckBox* environment_;
};

}  // namespace lumifield
