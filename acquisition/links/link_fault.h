#pragma once

#include <tl/expected.hpp>

namespace lumifield {

/// What can become of a transfer on a link that was opened.
enum class LinkFault {
  timeout,   ///< the far side sent no complete line, or took no bytes, in time
  hang_up,   ///< the far side is gone: unplugged, switched off, emulator ended
  overlong,  ///< far more bytes than a line has, and no line end: another protocol or another speed
};

template <class T>
using LinkResult = tl::expected<T, LinkFault>;

}  // namespace lumifield
