#pragma once

#include <QWidget>

#include "renderer/methods/method.h"

class QComboBox;
class QSpinBox;

namespace lumifield {

/// How the preview's light is computed, and by how many samples where the method draws any. The reference is not
/// offered: a picture of it takes minutes. GUI thread.
class PreviewMethodBar : public QWidget {
  Q_OBJECT

 public:
  explicit PreviewMethodBar(QWidget* parent = nullptr);

  const MethodSettings& method() const { return method_; }

 signals:
  void methodChanged(const lumifield::MethodSettings& method);

 private:
  void choose(Method method);
  void tell(const MethodSettings& method);

  MethodSettings method_;
  Method counted_ = Method::position_dependent;  ///< what the samples shown are of
  QComboBox* methods_;
  QSpinBox* samples_;
};

}  // namespace lumifield
