#include "pdfs/directions.h"

#include "support/chi_square.h"

namespace nocturne {
namespace {

TEST(UniformHemisphere, SamplesMatchPdf) {
  test::expect_samples_match_pdf(
      [](const Uniform4& u) { return UniformHemisphere::sample(u[0], u[1]); },
      UniformHemisphere::pdf);
}

TEST(CosineHemisphere, SamplesMatchPdf) {
  test::expect_samples_match_pdf(
      [](const Uniform4& u) { return CosineHemisphere::sample(u[0], u[1]); },
      CosineHemisphere::pdf);
}

}  // namespace
}  // namespace nocturne
