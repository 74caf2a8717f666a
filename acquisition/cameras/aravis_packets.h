#pragma once

#include <string>

#include "acquisition/cameras/aravis_settings.h"
#include "acquisition/cameras/stream_packets.h"

namespace lumifield {

/// Packets and pauses of a GigE Vision camera, before its stream is made. `camera` names it among those remembered.
///
/// Given sizes are cut to the camera's largest; where the camera can send a test packet and this one does not pass, the
/// largest that does is taken. With `packet_bytes` 0 they are those remembered, else found by test frames of 1 ms (some
/// seconds where large ones do not pass).
/// Errors: too small, a pause that it does not take; to be found, and no frame arrives: what the camera last refused,
/// if it did.
Result<StreamPackets> choose_packets(ArvCamera* camera, const CameraSettings& settings, const AppliedSettings& applied,
                                     const std::string& name);

}  // namespace lumifield
