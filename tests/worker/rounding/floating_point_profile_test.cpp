#include "rounding/floating_point_profile.h"

#include <gtest/gtest.h>
#include <immintrin.h>

#include <algorithm>

namespace nocturne {
namespace {

/// The class of a process that computes with these bits set in the processor's control register.
std::string class_with(unsigned control) {
  const unsigned before = _mm_getcsr();
  _mm_setcsr(before | control);
  const std::string found = floating_point_profile();
  _mm_setcsr(before);
  return found;
}

TEST(FloatingPointProfile, IsSixteenDigitsAndTheSameEachTime) {
  const std::string found = floating_point_profile();
  EXPECT_EQ(found.size(), 16U);
  EXPECT_TRUE(std::ranges::all_of(
      found, [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); }));
  EXPECT_EQ(found, floating_point_profile());
}

TEST(FloatingPointProfile, FlagsOfEarlierArithmeticDoNotMatter) {
  EXPECT_EQ(class_with(_MM_EXCEPT_INEXACT | _MM_EXCEPT_DIV_ZERO), floating_point_profile());
}

TEST(FloatingPointProfile, DiffersByRoundingAndByWhatBecomesOfTinyNumbers) {
  const std::string usual = floating_point_profile();
  for (const unsigned control :
       std::initializer_list<unsigned>{_MM_ROUND_UP, _MM_ROUND_DOWN, _MM_ROUND_TOWARD_ZERO,
                                       _MM_FLUSH_ZERO_ON, 0x40 /* denormals are zero */}) {
    EXPECT_NE(class_with(control), usual) << control;
  }
}

}  // namespace
}  // namespace nocturne
