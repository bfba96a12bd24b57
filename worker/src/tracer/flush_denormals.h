#pragma once

#include <immintrin.h>

namespace nocturne {

/// Numbers below 1e-38 count as zero while tracing (Embree wants it so); the caller's setting comes
/// back afterwards.
class FlushDenormals {
 public:
  FlushDenormals() : before_(_mm_getcsr()) { _mm_setcsr(before_ | 0x8040u); }
  ~FlushDenormals() { _mm_setcsr(before_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  unsigned before_;
};

}  // namespace nocturne
