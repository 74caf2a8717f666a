// What probe_opencl() runs: double precision, one result.
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

__kernel void probe(__global double* result, double value) {
  result[get_global_id(0)] = 2 * value + 1;
}
