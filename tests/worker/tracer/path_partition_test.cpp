// Which photons bring a path of light, for every path of up to four interactions.
#include "tracer/both_directions/path_partition.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <utility>
#include <vector>

namespace nocturne {
namespace {

// From the camera to the luminaire: S specular-like, D diffuse-like, d mirrored by a kernel that
// is diffuse-like as a whole (a smooth coat) or by a pane, | straight through a pane, N
// diffuse-like near the camera, L diffuse-like near the luminaire, if it is next to it.
Interaction interaction(char c) {
  return {.specular_like = c == 'S',
          .delta = c == 'S' || c == 'd' || c == '|',
          .straight = c == '|',
          .near_camera = c == 'N',
          .near_luminaire = c == 'L'};
}

Transport by_adjoint_walk(const std::string& path) {
  PathEnds ends;
  bool first = true;
  std::uint32_t interactions = 0;
  bool near = false;
  for (const char c : path) {
    ends = after_adjoint(ends, interaction(c), std::exchange(first, false));
    if (c == '|') continue;
    ++interactions;
    near = c == 'L';
  }
  return owner_of(at_luminaire(ends, interactions, near));
}

// As the forward photon knows it when it is connected to the camera from the path's first letter.
Transport by_forward_walk(const std::string& path) {
  PathEnds ends;
  for (std::size_t i = path.size(); i-- > 1;) {
    ends = after_forward(ends, interaction(path[i]));
    if (!forward_goes_on(ends, interaction(path[i]))) return Transport::kAdjoint;
  }
  if (path.empty()) return Transport::kAdjoint;
  ends.diffuse_like_at_camera = path[0] == 'D' || path[0] == 'L';
  return owner_of(ends);
}

TEST(PathPartition, TruthTable) {
  struct Row {
    const char* path;
    Transport by;
  };
  constexpr Transport kA = Transport::kAdjoint, kF = Transport::kForward;
  const std::array<Row, 31> rows{
      {{"", kA},     {"D", kA},   {"S", kA},   {"DD", kA},  {"DS", kF},  {"SD", kA},  {"SS", kA},
       {"NS", kA},   {"dS", kA},  {"|S", kA},  {"DDS", kF}, {"DSD", kA}, {"DSS", kF}, {"SDS", kA},
       {"D|S", kF},  {"DS|", kF}, {"D||", kA}, {"DSd", kF}, {"DdS", kF}, {"NDS", kA}, {"Dd", kF},
       {"dd", kA},   {"Dd|", kF}, {"L", kA},   {"DL", kF},  {"DLD", kA}, {"DSL", kF}, {"SL", kA},
       {"D|L|", kF}, {"|L", kA},  {"LL", kF}}};
  for (const Row& row : rows) EXPECT_EQ(by_adjoint_walk(row.path), row.by) << row.path;
}

// Together the photons of both directions bring every path once.
TEST(PathPartition, BothWalksAgree) {
  const std::string letters = "SDd|NL";
  std::vector<std::string> paths{""};
  for (std::size_t i = 0; i < paths.size() && paths[i].size() < 4; ++i) {
    for (const char c : letters) paths.push_back(paths[i] + c);
  }
  EXPECT_EQ(paths.size(), 1555u);
  for (const std::string& path : paths) {
    EXPECT_EQ(by_adjoint_walk(path), by_forward_walk(path)) << path;
  }
}

}  // namespace
}  // namespace nocturne
