// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_BodyBlocks.hpp"

#include "Harmos_BoxTree.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Index.hpp"
#include "Harmos_PointAlgebra.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <set>
#include <sstream>

namespace Harmos::fem {
namespace {

using Corners = std::array<int, 4>; // numbers in the body, rising; −1 first where there are fewer

// A side of one cell of its block, or of several.
struct BlockSide {
  Corners corners;
  std::size_t block;
  Side side;
  bool isAlone;
  bool operator<(const BlockSide& other) const {
    return std::tie(corners, block) < std::tie(other.corners, other.block);
  }
};

Corners cornersOf(const BodyMesh& block, const Side& side) {
  const std::vector<int> nodes = block.mesh.nodesOf(side);
  const auto count = at(shapeOf(block.mesh.typeOf(side)).corners);
  Corners corners = {-1, -1, -1, -1};
  for (std::size_t k = 0; k < count; ++k)
    corners[k] = block.number(nodes[k]);
  std::sort(corners.begin(), corners.end());
  return corners;
}

// The sides that blocks share, and what is wrong with some.
class Interfaces {
 public:
  Interfaces(const std::vector<BodyMesh>& blocks, const std::string& place)
      : blocks_(blocks), place_(place), inside_(blocks.size()) {
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      const MatchedSides& matched = *blocks[b].matched;
      for (std::size_t group = 0; group + 1 < matched.first.size(); ++group) {
        const Side& side = matched.sides[matched.first[group]];
        sides_.push_back(
            {cornersOf(blocks[b], side), b, side, matched.first[group + 1] == matched.first[group] + 1});
      }
    }
    std::sort(sides_.begin(), sides_.end());
    for (auto begin = sides_.begin(); begin != sides_.end();) {
      const auto end =
          std::find_if(begin, sides_.end(), [&](const BlockSide& s) { return s.corners != begin->corners; });
      if (end - begin > 1)
        join(*begin, *(begin + 1), end - begin == 2 && begin->isAlone && (begin + 1)->isAlone);
      else
        requireNoTriangles(*begin);
      begin = end;
    }
    requireNoHangingNodes();
  }

  bool isInside(std::size_t block, const Side& side) const {
    return inside_[block].count({side.cell, side.side}) > 0;
  }

 private:
  [[noreturn]] void fail(const BlockSide& a, const std::string& reason) const {
    const Mesh& mesh = blocks_[a.block].mesh;
    const Point x = mesh.local(mesh.nodesOf(a.side).front());
    std::ostringstream text;
    text << place_ << ", cells of different types meet at (" << x[0] << ", " << x[1] << ", " << x[2] << ") "
         << reason;
    throw InputError(text.str());
  }

  void join(const BlockSide& a, const BlockSide& b, bool isPair) {
    if (!isPair || goesTheSameWay(a, b))
      fail(a, "on the same side of their common face: the mesh is folded and cells overlap. Repair it in the "
              "mesh generator");
    if (nodesOf(a) != nodesOf(b))
      fail(a, "with sides of different order: use cells of one order in the whole body");
    inside_[a.block].insert({a.side.cell, a.side.side});
    inside_[b.block].insert({b.side.cell, b.side.side});
  }

  // As a hexahedron beside tetrahedra: both would be on the boundary, and could part.
  void requireNoTriangles(const BlockSide& quadrilateral) const {
    if (quadrilateral.corners[0] < 0 || blocks_[quadrilateral.block].mesh.dimension() == 2)
      return;
    for (std::size_t left = 0; left < 4; ++left) {
      Corners triangle = {-1, -1, -1, -1};
      for (std::size_t k = 0, next = 1; k < 4; ++k)
        if (k != left)
          triangle[next++] = quadrilateral.corners[k];
      const auto found = std::lower_bound(sides_.begin(), sides_.end(), BlockSide{triangle, 0, {}, true});
      if (found != sides_.end() && found->corners == triangle)
        fail(quadrilateral,
             "with a quadrilateral on one side and triangles on the other. Put wedges or a tie between them, "
             "or make them bodies of their own; pyramids are not supported");
    }
  }

  // Of a side whose corners another block has, too: nodes of that on it, which are none of its own. It would
  // be on the boundary, and what is finer on the other side as well.
  void requireNoHangingNodes() const {
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      std::vector<Box> boxes;
      std::vector<const BlockSide*> alone;
      for (const BlockSide& side : sides_)
        if (side.isAlone && side.block != b && !isInside(side.block, side.side) && isShared(side, b)) {
          std::vector<Point> corners = cornerPlaces(side);
          boxes.push_back(widened(boxAround(corners), 1e-6 * norm(difference(corners[1], corners[0]))));
          alone.push_back(&side);
        }
      const BoxTree tree(std::move(boxes));
      const BodyMesh& block = blocks_[b];
      for (int node : fem::nodesOf(block.mesh, boundarySides(*block.matched))) {
        const Point x = block.mesh.local(node);
        for (int place : tree.touching({x, x})) {
          const BlockSide& side = *alone[at(place)];
          const std::vector<int> own = nodesOf(side);
          if (!std::binary_search(own.begin(), own.end(), block.number(node)) && isOn(x, cornerPlaces(side)))
            fail(side, "with sides that do not match: a node of one is within a side of the other. Mesh both "
                       "with the same sides, or make them bodies of their own and tie them");
        }
      }
    }
  }

  // Whether a block has all corners of a side.
  bool isShared(const BlockSide& side, std::size_t block) const {
    const std::vector<int>& numbers = blocks_[block].numbers;
    return std::all_of(side.corners.begin(), side.corners.end(), [&](int corner) {
      return corner < 0 || std::binary_search(numbers.begin(), numbers.end(), corner);
    });
  }

  std::vector<Point> cornerPlaces(const BlockSide& side) const {
    const Mesh& mesh = blocks_[side.block].mesh;
    std::vector<int> nodes = mesh.nodesOf(side.side);
    nodes.resize(at(shapeOf(mesh.typeOf(side.side)).corners));
    std::vector<Point> places;
    for (int node : nodes)
      places.push_back(mesh.local(node));
    return places;
  }

  // Within a line or a facet of straight edges, up to rounding, and not at its ends.
  static bool isOn(const Point& x, const std::vector<Point>& corners) {
    constexpr double rounding = 1e-6;
    if (corners.size() == 4)
      return isOn(x, {corners[0], corners[1], corners[2]}) || isOn(x, {corners[0], corners[2], corners[3]});
    const Point a = difference(corners[1], corners[0]), r = difference(x, corners[0]);
    const double aa = dot(a, a), ra = dot(r, a);
    if (corners.size() == 2) {
      const double t = ra / aa;
      return t > rounding && t < 1.0 - rounding &&
             norm(difference(r, scaled(t, a))) <= rounding * std::sqrt(aa);
    }
    const Point b = difference(corners[2], corners[0]);
    const double ab = dot(a, b), bb = dot(b, b), rb = dot(r, b), det = aa * bb - ab * ab;
    const double s = (ra * bb - rb * ab) / det, t = (rb * aa - ra * ab) / det;
    const Point away = difference(r, sum(scaled(s, a), scaled(t, b)));
    const bool isCorner = std::max({s, t, 1.0 - s - t}) > 1.0 - rounding;
    return !isCorner && std::min({s, t, 1.0 - s - t}) > -rounding && norm(away) <= rounding * std::sqrt(aa);
  }

  std::vector<int> nodesOf(const BlockSide& side) const {
    std::vector<int> nodes = blocks_[side.block].mesh.nodesOf(side.side);
    for (int& node : nodes)
      node = blocks_[side.block].number(node);
    std::sort(nodes.begin(), nodes.end());
    return nodes;
  }

  // Corners of sides go around outwards: from the two sides of one, they go around in opposite ways.
  bool goesTheSameWay(const BlockSide& a, const BlockSide& b) const {
    const auto around = [&](const BlockSide& side) {
      std::vector<int> nodes = blocks_[side.block].mesh.nodesOf(side.side);
      nodes.resize(at(shapeOf(blocks_[side.block].mesh.typeOf(side.side)).corners));
      for (int& node : nodes)
        node = blocks_[side.block].number(node);
      std::rotate(nodes.begin(), std::min_element(nodes.begin(), nodes.end()), nodes.end());
      return nodes;
    };
    const std::vector<int> first = around(a), second = around(b);
    if (first.size() > 2)
      return first[1] == second[1];
    return blocks_[a.block].number(blocks_[a.block].mesh.nodesOf(a.side)[0]) ==
           blocks_[b.block].number(blocks_[b.block].mesh.nodesOf(b.side)[0]);
  }

  const std::vector<BodyMesh>& blocks_;
  const std::string& place_;
  std::vector<BlockSide> sides_;
  std::vector<std::set<std::pair<int, int>>> inside_; // cells and sides, by block
};

void makeSet(std::vector<int>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

// Sides inside the body leave its parts, and its boundary.
void keepOuterSides(BodyMesh& block, const std::function<bool(const Side&)>& isInside) {
  std::vector<Side> outer;
  for (const Side& side : boundarySides(*block.matched))
    if (!isInside(side))
      outer.push_back(side);
  block.mesh.boundary = nodesOf(block.mesh, outer);
  for (auto part = block.sides.begin(); part != block.sides.end();) {
    std::vector<Side>& sides = part->second;
    const auto end =
        std::stable_partition(sides.begin(), sides.end(), [&](const Side& side) { return !isInside(side); });
    const std::vector<int> nodes = nodesOf(block.mesh, std::vector<Side>(end, sides.end()));
    if (!nodes.empty()) {
      std::vector<int>& named = block.nodes[part->first];
      named.insert(named.end(), nodes.begin(), nodes.end());
      makeSet(named);
    }
    sides.erase(end, sides.end());
    part = sides.empty() ? block.sides.erase(part) : std::next(part);
  }
}

// By name: numbers in the body, rising.
std::map<std::string, std::vector<int>> namedNodes(const std::vector<BodyMesh>& blocks) {
  std::map<std::string, std::vector<int>> named;
  for (const BodyMesh& block : blocks) {
    for (const auto& [name, nodes] : block.nodes)
      for (int node : nodes)
        named[name].push_back(block.number(node));
    for (const auto& [name, sides] : block.sides)
      for (int node : nodesOf(block.mesh, sides))
        named[name].push_back(block.number(node));
  }
  for (auto& [name, numbers] : named)
    makeSet(numbers);
  return named;
}

void nameCopies(BodyMesh& block, const std::map<std::string, std::vector<int>>& named) {
  for (const auto& [name, numbers] : named) {
    std::vector<int> own;
    if (const auto sides = block.sides.find(name); sides != block.sides.end())
      own = nodesOf(block.mesh, sides->second);
    std::vector<int> more;
    for (int number : numbers) {
      const auto found = std::lower_bound(block.numbers.begin(), block.numbers.end(), number);
      const auto node = static_cast<int>(found - block.numbers.begin());
      if (found != block.numbers.end() && *found == number &&
          !std::binary_search(own.begin(), own.end(), node))
        more.push_back(node);
    }
    if (more.empty())
      continue;
    std::vector<int>& nodes = block.nodes[name];
    nodes.insert(nodes.end(), more.begin(), more.end());
    makeSet(nodes);
  }
}

} // namespace

std::vector<std::vector<BodyMesh>> groupedByBody(std::vector<BodyMesh> blocks) {
  std::vector<std::vector<BodyMesh>> bodies;
  for (BodyMesh& block : blocks) {
    if (bodies.empty() || bodies.back().front().name != block.name)
      bodies.emplace_back();
    bodies.back().push_back(std::move(block));
  }
  return bodies;
}

void joinBlocks(std::vector<BodyMesh>& blocks, const std::string& place) {
  if (blocks.size() < 2)
    return;
  const Interfaces interfaces(blocks, place);
  for (std::size_t b = 0; b < blocks.size(); ++b)
    keepOuterSides(blocks[b], [&](const Side& side) { return interfaces.isInside(b, side); });
  const std::map<std::string, std::vector<int>> named = namedNodes(blocks);
  for (BodyMesh& block : blocks) {
    nameCopies(block, named);
    for (auto field = block.fields.begin(); field != block.fields.end();) {
      const bool isEverywhere = std::all_of(blocks.begin(), blocks.end(), [&](const BodyMesh& other) {
        return other.fields.count(field->first) > 0;
      });
      field = isEverywhere ? std::next(field) : block.fields.erase(field);
    }
  }
}

std::vector<int> partsOfBlocks(const std::vector<BodyMesh>& blocks, int wanted) {
  double cells = 0.0;
  for (const BodyMesh& block : blocks)
    cells += block.mesh.numberOfCells();
  if (blocks.size() > 1 && wanted > cells)
    throw InputError("body \"" + blocks.front().name + "\" cannot be partitioned into " +
                     std::to_string(wanted) + " parts: it has " +
                     std::to_string(static_cast<long long>(cells)) +
                     " cells. Choose between 1 and that many parts");
  // Where the share of cells that is dealt out passes a half, another part begins: sums to what is wanted.
  std::vector<int> parts;
  double dealt = 0.0;
  long long before = 0;
  for (const BodyMesh& block : blocks) {
    dealt += wanted * (block.mesh.numberOfCells() / cells);
    const long long now = std::max(before + 1, std::llround(dealt));
    parts.push_back(static_cast<int>(now - before));
    before = now;
  }
  return parts;
}

int numberOfPieces(const std::vector<BodyMesh>& blocks) {
  std::vector<int> parent(at(numberOfNodes(blocks)));
  std::iota(parent.begin(), parent.end(), 0);
  const auto rootOf = [&](int node) {
    while (parent[at(node)] != node)
      node = parent[at(node)] = parent[at(parent[at(node)])];
    return node;
  };
  auto pieces = static_cast<int>(parent.size());
  for (const BodyMesh& block : blocks)
    for (int c = 0; c < block.mesh.numberOfCells(); ++c)
      for (int k = 1; k < block.mesh.nodesPerCell(); ++k) {
        const int a = rootOf(block.number(block.mesh.cell(c)[0])),
                  b = rootOf(block.number(block.mesh.cell(c)[k]));
        if (a == b)
          continue;
        parent[at(b)] = a;
        --pieces;
      }
  return pieces;
}

int numberOfNodes(const std::vector<BodyMesh>& blocks) {
  int end = 0;
  for (const BodyMesh& block : blocks)
    end = std::max(end, block.numbers.empty() ? block.mesh.numberOfNodes() : block.numbers.back() + 1);
  return end;
}

} // namespace Harmos::fem
