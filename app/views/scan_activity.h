#pragma once

namespace lumifield {

/// What the window may ask of a scan:
///
///     idle → starting → running ⇄ pausing → paused → running; any but idle → stopping → idle; any → idle at its end
///     idle → rehearsing → idle, by stopping where it is stopped
enum class ScanActivity { idle, rehearsing, starting, running, pausing, paused, stopping };

}  // namespace lumifield
