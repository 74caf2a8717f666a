#pragma once

#include <chrono>
#include <string>

namespace lumifield {

enum class GvcpPresence {
  present,
  refused,  ///< the host is there, but no camera on it
  silent,
};

struct GvcpAnswer {
  GvcpPresence presence = GvcpPresence::silent;
  bool controlled = false;  ///< some program, this one included, controls the camera
};

/// One read of a GigE Vision camera's control privilege from a socket of its own, beside whatever else talks to the
/// camera: a living camera answers within a millisecond, one that is busy within its frame time, and a dead one on a
/// living host is refused at once, where a control library would wait for seconds. Asks five times, 0.5 s in all.
///
/// A camera may take the read for a sign of life of its controller: after reading "controlled", wait out its heartbeat
/// timeout before reading again. Blocks; otherwise reentrant.
/// Source: GigE Vision 2.0, READREG and the Control Channel Privilege and Heartbeat Timeout registers.
GvcpAnswer probe_gvcp(const std::string& ipv4_address);

/// How long the camera stays controlled after its controller fell silent; the usual 3 s when it does not tell, never
/// more than 10 s.
std::chrono::milliseconds gvcp_heartbeat_timeout(const std::string& ipv4_address);

bool is_ipv4_address(const std::string& text);

}  // namespace lumifield
