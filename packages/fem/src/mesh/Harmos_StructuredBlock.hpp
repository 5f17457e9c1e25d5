// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Mesh.hpp"

#include <functional>

namespace Harmos::fem {

/// A rectangle or a brick cut into equal subdomains with regular grids.
///
/// Any subdomain can be made on any rank without the others: no rank ever holds the whole mesh. Nodes are
/// numbered along x, then y, then z, over the whole block. Boundary parts are named "left" and "right" (x),
/// "bottom" and "top" (the last direction), and in space "front" and "back" (y). Triangles and tetrahedra
/// come from cutting each quadrilateral into two, each hexahedron into six (Kuhn).
///
/// Guarded by tests/unit/fem/test_structured_block.cpp.
class StructuredBlock {
 public:
  struct Options {
    CellType cellType = CellType::Quadrilateral4;
    Point origin{};
    Point size = {1.0, 1.0, 1.0};
    std::array<int, 3> subdomains = {1, 1, 1}; ///< a direction; in the plane the third is not used
    std::array<int, 3> elements = {1, 1, 1};   ///< of one subdomain
    long long firstNode = 0;                   ///< global number of the first node
    /// Bends the block; null leaves it as it is, and its subdomains share one mesh.
    std::function<Point(const Point&)> map;
  };

  /// @throws InputError for sizes or numbers that are not positive.
  explicit StructuredBlock(Options options);

  int numberOfSubdomains() const;
  /// How many numbers its nodes take. Serendipity elements leave out those inside of faces and cells.
  long long numberOfNodes() const;

  /// Subdomain s = column + columns · (row + rows · layer).
  PlacedMesh subdomain(int s) const;

 private:
  using Index = std::array<int, 3>;
  void findFaces();
  const Index& localNode(int node) const { return places_[static_cast<std::size_t>(node)]; }

  Options options_;
  int dimension_;
  Index lattice_{};                        // nodes of a subdomain in each direction
  std::vector<Index> places_;              // of its nodes on the lattice
  std::shared_ptr<const Mesh> mesh_;       // unbent
  std::array<std::vector<Side>, 6> faces_; // of mesh_: least x, most x, least y, ...
  std::array<std::vector<int>, 6> faceNodes_;
};

/// A rectangle of quadrilaterals of four nodes.
StructuredBlock makeRectangle(const Point& origin, const std::array<double, 2>& size,
                              const std::array<int, 2>& subdomains, const std::array<int, 2>& elements,
                              long long firstNode);

} // namespace Harmos::fem
