#pragma once

#include <QObject>
#include <QTimer>
#include <vector>

#include "app/views/lamp_handle.h"

namespace lumifield {

/// The luminaires of the scene as they are arranged in the window, and which one is chosen: view and panel change the
/// same one, and the render thread is told. There is at least one while there is a scene. GUI thread.
class LampArrangement : public QObject {
  Q_OBJECT

 public:
  /// Lamps rest this long after the last change that moves them.
  static constexpr int rest_ms = 150;
  static constexpr double largest_scale = 1e6;

  explicit LampArrangement(QObject* parent = nullptr);

  /// Another scene's own, which the render thread has from the scene. `up` is the scene's.
  void set_scene(std::vector<ScenePlacement> own, const Vec3& up);
  void set_shape(const LampShape& shape);

  const std::vector<ScenePlacement>& lamps() const { return lamps_; }
  const ScenePlacement& lamp(int number) const { return lamps_.at(static_cast<std::size_t>(number)); }
  int count() const { return static_cast<int>(lamps_.size()); }
  /// −1: none.
  int chosen() const { return chosen_; }
  const LampShape& shape() const { return shape_; }
  const Vec3& up() const { return up_; }
  bool can_add() const { return !lamps_.empty() && lamps_.size() < most_luminaires; }
  bool can_remove() const { return chosen_ >= 0 && lamps_.size() > 1; }

  /// `moving` until settle() or the time of rest. Of a number that there is.
  void place(int number, const ScenePlacement& lamp, bool moving);
  /// What moved rests.
  void settle();
  /// −1 for none; a number that is none chooses none.
  void choose(int number);
  void choose_next(int step);

 public slots:
  /// A copy beside the chosen one, or the last, which is then chosen.
  void add_copy();
  void remove_chosen();
  void back_to_scene();

 signals:
  /// For the render thread.
  void placed(const std::vector<lumifield::ScenePlacement>& lamps, bool moving);
  /// Anything, the choice too: for those that show it.
  void changed();
  /// Another scene or another luminaire: what is held is let go.
  void replaced();

 private:
  void tell(bool moving);

  std::vector<ScenePlacement> lamps_, own_;
  LampShape shape_;
  Vec3 up_{0, 0, 1};
  int chosen_ = -1;
  QTimer rest_;
};

}  // namespace lumifield
