#pragma once

namespace lumifield {

/// From now on this process uses OpenCL itself: a child forked from it would inherit a driver without its threads, so
/// probe_opencl() asks the driver directly.
void note_opencl_in_use();

}  // namespace lumifield
