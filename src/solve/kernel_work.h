#pragma once
// How much work the hot kernels do: each adds what its roofline says, and a benchmark sets it against the time. Costs a
// kernel a few operations a call.

#include <cstddef>

namespace monolith {

struct KernelWork {
  double flops = 0.0;  // a fused multiply-add is two
  double bytes =
      0.0;  // each field that a kernel reads or writes once, as if none stayed in a cache from one to the next
};

// Of all kernels that this thread has started.
inline KernelWork& kernelWork() {
  thread_local KernelWork work;
  return work;
}

// `entries` of a field, with so much for each.
inline void countWork(std::size_t entries, double flops, double bytes) {
  KernelWork& work = kernelWork();
  work.flops += flops * static_cast<double>(entries);
  work.bytes += bytes * static_cast<double>(entries);
}

}  // namespace monolith
