// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_StructuredBlock.hpp"

#include "Harmos_Errors.hpp"

#include <cmath>
#include <numeric>

namespace Harmos::fem {
namespace {

using Index = std::array<int, 3>;

const std::array<const char*, 6>& faceNames(int dimension) {
  static const std::array<const char*, 6> plane = {"left", "right", "bottom", "top", "", ""};
  static const std::array<const char*, 6> space = {"left", "right", "front", "back", "bottom", "top"};
  return dimension == 2 ? plane : space;
}

// Corners of the cells that one quadrilateral or hexahedron is cut into, as offsets of 0 or 1.
std::vector<std::vector<Index>> pieces(const CellShape& shape) {
  if (shape.isWedge)
    return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}},
            {{0, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {0, 1, 1}}};
  if (!shape.isSimplex) {
    std::vector<Index> corners;
    for (int k = 0; k < shape.corners; ++k) {
      Index corner{};
      for (std::size_t d = 0; d < static_cast<std::size_t>(shape.dimension); ++d)
        corner[d] = shape.nodeCoordinates[static_cast<std::size_t>(k)][d] > 0.0 ? 1 : 0;
      corners.push_back(corner);
    }
    return {corners};
  }
  if (shape.dimension == 2)
    return {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}, {{0, 0, 0}, {1, 1, 0}, {0, 1, 0}}};
  std::vector<std::vector<Index>> result;
  std::array<std::size_t, 3> path = {0, 1, 2};
  do { // along the edges from (0,0,0) to (1,1,1), in each order of the directions
    std::vector<Index> corners = {{0, 0, 0}};
    for (std::size_t direction : path) {
      Index next = corners.back();
      next[direction] = 1;
      corners.push_back(next);
    }
    const bool odd = (path[0] > path[1]) != ((path[0] > path[2]) != (path[1] > path[2]));
    if (odd)
      std::swap(corners[1], corners[2]);
    result.push_back(corners);
  } while (std::next_permutation(path.begin(), path.end()));
  return result;
}

// Place of each node of a piece on the lattice of nodes, relative to the first corner of the quadrilateral or
// hexahedron.
std::vector<Index> nodeOffsets(const CellShape& shape, const std::vector<Index>& corners) {
  std::vector<Index> offsets;
  for (const Point& r : shape.nodeCoordinates) {
    Index offset{};
    for (std::size_t d = 0; d < static_cast<std::size_t>(shape.dimension); ++d) {
      double place = 0.0;
      const bool isOfSimplex = shape.isSimplex || (shape.isWedge && d < 2);
      const std::size_t barycentric = shape.isWedge ? 2 : static_cast<std::size_t>(shape.dimension);
      if (isOfSimplex) {
        place = corners[0][d];
        for (std::size_t k = 0; k < barycentric; ++k)
          place += (corners[k + 1][d] - corners[0][d]) * r[k];
      } else {
        place = 0.5 * (1.0 + r[d]);
      }
      offset[d] = static_cast<int>(std::lround(place * shape.order));
    }
    offsets.push_back(offset);
  }
  return offsets;
}

// Whether an element has a node there: serendipity elements have none inside of faces and cells.
bool isNode(const CellShape& shape, const Index& at) {
  const int odd = at[0] % 2 + at[1] % 2 + at[2] % 2;
  const bool isOnDiagonal = shape.isWedge && at[2] % 2 == 0;
  return !shape.isSerendipity || odd <= (isOnDiagonal ? 2 : 1);
}

} // namespace

StructuredBlock::StructuredBlock(Options options)
    : options_(std::move(options)), dimension_(shapeOf(options_.cellType).dimension) {
  const CellShape& shape = shapeOf(options_.cellType);
  HARMOS_REQUIRE(dimension_ > 1, "a structured block has cells of two or three dimensions");
  const auto dimension = static_cast<std::size_t>(dimension_);
  for (std::size_t d = 0; d < dimension; ++d)
    if (!(options_.size[d] > 0.0) || options_.subdomains[d] < 1 || options_.elements[d] < 1)
      throw InputError(
          "a structured block needs positive sizes and at least one subdomain and one element per side");
  for (std::size_t d = dimension; d < 3; ++d)
    options_.subdomains[d] = options_.elements[d] = 1;
  for (std::size_t d = 0; d < 3; ++d)
    lattice_[d] = d < dimension ? shape.order * options_.elements[d] + 1 : 1;

  auto mesh = std::make_shared<Mesh>();
  mesh->cellType = options_.cellType;
  std::vector<int> nodeAt; // of each place on the lattice
  for (int place = 0; place < lattice_[0] * lattice_[1] * lattice_[2]; ++place) {
    const auto node = static_cast<int>(places_.size());
    const Index at = {place % lattice_[0], place / lattice_[0] % lattice_[1],
                      place / lattice_[0] / lattice_[1]};
    nodeAt.push_back(node);
    if (!isNode(shape, at))
      continue;
    places_.push_back(at);
    bool onBoundary = false;
    for (std::size_t d = 0; d < dimension; ++d) {
      // From numbers of this block alone, so that all its subdomains get the same.
      const double spacing =
          options_.size[d] / (static_cast<double>(options_.subdomains[d]) * (lattice_[d] - 1));
      mesh->coordinates.push_back(at[d] * spacing);
      for (int end : {0, 1})
        if (at[d] == end * (lattice_[d] - 1)) {
          onBoundary = true;
          faceNodes_[2 * d + static_cast<std::size_t>(end)].push_back(node);
        }
    }
    if (onBoundary)
      mesh->boundary.push_back(node);
  }
  std::vector<std::vector<Index>> cells;
  for (const std::vector<Index>& corners : pieces(shape))
    cells.push_back(nodeOffsets(shape, corners));
  for (int k = 0; k < options_.elements[2]; ++k)
    for (int j = 0; j < options_.elements[1]; ++j)
      for (int i = 0; i < options_.elements[0]; ++i)
        for (const std::vector<Index>& cell : cells)
          for (const Index& offset : cell)
            mesh->cells.push_back(nodeAt[static_cast<std::size_t>(
                shape.order * i + offset[0] +
                lattice_[0] * (shape.order * j + offset[1] + lattice_[1] * (shape.order * k + offset[2])))]);
  mesh_ = mesh;
  findFaces();
}

void StructuredBlock::findFaces() {
  const auto dimension = static_cast<std::size_t>(dimension_);
  for (const Side& side : boundarySides(*mesh_)) {
    const std::vector<int> sideNodes = mesh_->nodesOf(side);
    for (std::size_t face = 0; face < 2 * dimension; ++face) {
      const int end = face % 2 == 0 ? 0 : lattice_[face / 2] - 1;
      if (std::all_of(sideNodes.begin(), sideNodes.end(),
                      [&](int node) { return localNode(node)[face / 2] == end; }))
        faces_[face].push_back(side);
    }
  }
}

int StructuredBlock::numberOfSubdomains() const {
  return options_.subdomains[0] * options_.subdomains[1] * options_.subdomains[2];
}

long long StructuredBlock::numberOfNodes() const {
  long long count = 1;
  for (std::size_t d = 0; d < 3; ++d)
    count *= static_cast<long long>(options_.subdomains[d]) * (lattice_[d] - 1) + 1;
  return count;
}

PlacedMesh StructuredBlock::subdomain(int s) const {
  HARMOS_REQUIRE(s >= 0 && s < numberOfSubdomains(), "there is no such subdomain");
  const Index& count = options_.subdomains;
  const Index place = {s % count[0], s / count[0] % count[1], s / count[0] / count[1]};
  const auto dimension = static_cast<std::size_t>(dimension_);
  PlacedMesh placed;
  placed.anchor = options_.origin;
  for (std::size_t d = 0; d < dimension; ++d)
    placed.anchor[d] += options_.size[d] * place[d] / count[d];
  if (options_.map) {
    const Point corner = options_.map(placed.anchor);
    auto bent = std::make_shared<Mesh>(*mesh_);
    for (int node = 0; node < bent->numberOfNodes(); ++node) {
      Point x = options_.origin;
      const Index& at = localNode(node);
      // From the number in the whole block, so that copies of a node agree to the bit.
      for (std::size_t d = 0; d < dimension; ++d) {
        const int intervals = lattice_[d] - 1;
        x[d] += options_.size[d] * (static_cast<double>(place[d]) * intervals + at[d]) /
                (static_cast<double>(count[d]) * intervals);
      }
      const Point y = options_.map(x);
      for (std::size_t d = 0; d < dimension; ++d)
        bent->coordinates[static_cast<std::size_t>(node) * dimension + d] = y[d] - corner[d];
    }
    placed.anchor = corner;
    placed.mesh = bent;
  } else {
    placed.mesh = mesh_;
  }
  long long stride[3] = {1, 1, 1};
  for (std::size_t d = 1; d < 3; ++d)
    stride[d] = stride[d - 1] * (static_cast<long long>(count[d - 1]) * (lattice_[d - 1] - 1) + 1);
  for (int local : mesh_->boundary) {
    const Index& at = localNode(local);
    long long number = options_.firstNode;
    for (std::size_t d = 0; d < 3; ++d)
      number += stride[d] * (static_cast<long long>(place[d]) * (lattice_[d] - 1) + at[d]);
    placed.boundaryNumbers.push_back(number);
  }
  for (std::size_t face = 0; face < 2 * dimension; ++face) {
    const bool outer = place[face / 2] == (face % 2 == 0 ? 0 : count[face / 2] - 1);
    if (!outer)
      continue;
    const std::string name = faceNames(dimension_)[face];
    placed.sets[name] = faceNodes_[face];
    placed.sides[name] = faces_[face];
  }
  return placed;
}

StructuredBlock makeRectangle(const Point& origin, const std::array<double, 2>& size,
                              const std::array<int, 2>& subdomains, const std::array<int, 2>& elements,
                              long long firstNode) {
  StructuredBlock::Options options;
  options.origin = origin;
  options.size = {size[0], size[1], 1.0};
  options.subdomains = {subdomains[0], subdomains[1], 1};
  options.elements = {elements[0], elements[1], 1};
  options.firstNode = firstNode;
  return StructuredBlock(options);
}

} // namespace Harmos::fem
