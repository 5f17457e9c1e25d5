// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_PlateMesh.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace Harmos {

/// A bent block of two regions with n cells (simplices: pairs or sixes) a direction as one body, with the
/// block's boundary parts and one named node in its middle, "centre".
inline fem::BodyMesh testBody(fem::CellType type, int n) {
  fem::StructuredBlock::Options options;
  options.cellType = type;
  options.origin = {3.0, 1.0, -2.0};
  options.elements = {n, n, n};
  options.map = [](const fem::Point& x) {
    return fem::Point{x[0] + 0.1 * x[1] * x[1], x[1] + 0.05 * x[0], x[2] - 0.03 * x[0] * x[1]};
  };
  fem::BodyMesh body = wholeBlock(options);
  body.regions = {"first", "second"};
  for (int c = 0; c < body.mesh.numberOfCells(); ++c)
    body.mesh.regions.push_back(2 * c < body.mesh.numberOfCells() ? 0 : 1);
  body.nodes["centre"] = {body.mesh.numberOfNodes() / 2};
  for (int node = 0; node < body.mesh.numberOfNodes(); ++node)
    body.fields["heat"].push_back(body.mesh.local(node)[0] + 10.0 * body.mesh.local(node)[1]);
  return body;
}

/// Whether all fields of two subdomains are the same, to the bit.
inline void expectSame(const fem::PlacedMesh& a, const fem::PlacedMesh& b) {
  EXPECT_EQ(a.mesh->cellType, b.mesh->cellType);
  EXPECT_EQ(a.mesh->coordinates, b.mesh->coordinates);
  EXPECT_EQ(a.mesh->cells, b.mesh->cells);
  EXPECT_EQ(a.mesh->boundary, b.mesh->boundary);
  EXPECT_EQ(a.mesh->regions, b.mesh->regions);
  EXPECT_EQ(a.anchor, b.anchor);
  EXPECT_EQ(a.boundaryNumbers, b.boundaryNumbers);
  EXPECT_EQ(a.sets, b.sets);
  EXPECT_EQ(a.fields, b.fields);
  ASSERT_EQ(a.sides.size(), b.sides.size());
  for (const auto& [name, sides] : a.sides) {
    ASSERT_EQ(b.sides.count(name), 1u) << name;
    const std::vector<fem::Side>& others = b.sides.at(name);
    ASSERT_EQ(sides.size(), others.size()) << name;
    for (std::size_t k = 0; k < sides.size(); ++k) {
      EXPECT_EQ(sides[k].cell, others[k].cell);
      EXPECT_EQ(sides[k].side, others[k].side);
    }
  }
}

} // namespace Harmos
