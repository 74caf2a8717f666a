#pragma once

#include <QPalette>
#include <QString>

namespace lumifield {

/// The window's colours: the desktop's own, or ours. All of them are readable on Qt's Fusion style.
enum class Theme { system, light, dark };

/// Of the settings file; unknown words are `system`.
Theme theme_of(const QString& word);
QString word_of(Theme theme);

/// `system`: the style's own.
QPalette palette_of(Theme theme);

/// Changes the running application's palette.
void apply(Theme theme);

/// Fusion, with outlines of tick boxes that show on dark colours.
void set_style();

}  // namespace lumifield
