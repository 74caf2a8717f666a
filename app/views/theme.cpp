#include "app/views/theme.h"

#include <QApplication>
#include <QPainter>
#include <QProxyStyle>
#include <QStyleOption>

namespace lumifield {

namespace {

struct Tones {
  QColor window, base, alternate, text, dim, button, highlight, highlighted, link;
};

QPalette palette_of(const Tones& t) {
  QPalette p;
  for (const auto group : {QPalette::Active, QPalette::Inactive, QPalette::Disabled}) {
    const QColor text = group == QPalette::Disabled ? t.dim : t.text;
    p.setColor(group, QPalette::Window, t.window);
    p.setColor(group, QPalette::WindowText, text);
    p.setColor(group, QPalette::Base, t.base);
    p.setColor(group, QPalette::AlternateBase, t.alternate);
    p.setColor(group, QPalette::Text, text);
    p.setColor(group, QPalette::PlaceholderText, t.dim);
    p.setColor(group, QPalette::Button, t.button);
    p.setColor(group, QPalette::ButtonText, text);
    p.setColor(group, QPalette::BrightText, t.highlighted);
    p.setColor(group, QPalette::ToolTipBase, t.alternate);
    p.setColor(group, QPalette::ToolTipText, t.text);
    p.setColor(group, QPalette::Highlight, group == QPalette::Disabled ? t.dim : t.highlight);
    p.setColor(group, QPalette::HighlightedText, t.highlighted);
    p.setColor(group, QPalette::Link, t.link);
    p.setColor(group, QPalette::Light, t.button.lighter(130));
    p.setColor(group, QPalette::Midlight, t.button.lighter(110));
    p.setColor(group, QPalette::Mid, t.button.darker(125));
    p.setColor(group, QPalette::Dark, t.button.darker(150));
    p.setColor(group, QPalette::Shadow, Qt::black);
  }
  return p;
}

/// Fusion darkens the window's colour for an outline.
class OutlinedBoxes : public QProxyStyle {
 public:
  OutlinedBoxes() : QProxyStyle("Fusion") {}
  void drawPrimitive(PrimitiveElement element, const QStyleOption* option, QPainter* painter,
                     const QWidget* widget) const override {
    QProxyStyle::drawPrimitive(element, option, painter, widget);
    if (element != PE_IndicatorCheckBox || option->palette.color(QPalette::Window).lightness() > 127) return;
    QColor outline = option->palette.color(QPalette::WindowText);
    outline.setAlpha(150);
    painter->save();
    painter->setPen(outline);
    painter->setBrush(Qt::NoBrush);
    painter->drawRect(option->rect.adjusted(0, 0, -1, -1));
    painter->restore();
  }
};

}  // namespace

void set_style() { QApplication::setStyle(new OutlinedBoxes); }

Theme theme_of(const QString& word) {
  return word == "light" ? Theme::light : word == "dark" ? Theme::dark : Theme::system;
}

QString word_of(Theme theme) { return theme == Theme::light ? "light" : theme == Theme::dark ? "dark" : "system"; }

QPalette palette_of(Theme theme) {
  switch (theme) {
    case Theme::light:
      return palette_of(
          {"#f2f2f0", "#ffffff", "#f7f7f5", "#1b1b1b", "#8a8a88", "#e6e6e3", "#2f6db5", "#ffffff", "#1f5fae"});
    case Theme::dark:
      return palette_of(
          {"#2a2b2d", "#3b3d41", "#33353a", "#e6e6e4", "#85868a", "#3a3b3e", "#4d8ad0", "#ffffff", "#7fb2ec"});
    case Theme::system:
      break;
  }
  return {};
}

void apply(Theme theme) { QApplication::setPalette(palette_of(theme)); }

}  // namespace lumifield
