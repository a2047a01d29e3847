#include <algorithm>
#include <cmath>

#include "core/map/soft_ground.h"

namespace cairn {
namespace portable_soft {
namespace {
#include "core/map/soft_row.inc"
}  // namespace
}  // namespace portable_soft

const SoftKernels& portable_soft_kernels() {
  static constexpr SoftKernels kKernels{"portable", portable_soft::work_on_row};
  return kKernels;
}

#if defined(__x86_64__)

#pragma GCC push_options
#pragma GCC target("avx2")
namespace avx2_soft {
namespace {
#include "core/map/soft_row.inc"
}  // namespace
}  // namespace avx2_soft
#pragma GCC pop_options

#pragma GCC push_options
#pragma GCC target("avx512f,avx512bw,avx512dq,avx512vl,prefer-vector-width=512")
namespace avx512_soft {
namespace {
#include "core/map/soft_row.inc"
}  // namespace
}  // namespace avx512_soft
#pragma GCC pop_options

const SoftKernels* avx2_soft_kernels() {
  static constexpr SoftKernels kKernels{"AVX2", avx2_soft::work_on_row};
  return __builtin_cpu_supports("avx2") ? &kKernels : nullptr;
}

const SoftKernels* avx512_soft_kernels() {
  static constexpr SoftKernels kKernels{"AVX-512", avx512_soft::work_on_row};
  const bool all = __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512dq") &&
                   __builtin_cpu_supports("avx512vl");
  return all ? &kKernels : nullptr;
}

#else

const SoftKernels* avx2_soft_kernels() { return nullptr; }
const SoftKernels* avx512_soft_kernels() { return nullptr; }

#endif

const std::vector<const SoftKernels*>& usable_soft_kernels() {
  static const std::vector<const SoftKernels*> all = [] {
    std::vector<const SoftKernels*> usable{avx512_soft_kernels(), avx2_soft_kernels(),
                                           &portable_soft_kernels()};
    std::erase(usable, nullptr);
    return usable;
  }();
  return all;
}

}  // namespace cairn
