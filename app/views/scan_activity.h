#pragma once

namespace lumifield {

/// What the window may ask of a scan:
///
///     idle → starting → running ⇄ pausing → paused → running; any but idle → stopping → idle; any → idle at its end
enum class ScanActivity { idle, starting, running, pausing, paused, stopping };

}  // namespace lumifield
