#pragma once

#include <QString>

namespace lumifield {

/// A thing the operator should know: what happened, where, and what to do.
struct OperatorNotice {
  enum class Level { information, warning, fault };
  Level level = Level::information;
  QString text;
};

}  // namespace lumifield
