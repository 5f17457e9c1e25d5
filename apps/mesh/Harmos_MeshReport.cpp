// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_MeshReport.hpp"

#include "Harmos_BodyBlocks.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_SideGeometry.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <map>
#include <set>
#include <sstream>

namespace Harmos::app {
namespace {

using fem::Point;

double square(const Point& a) {
  return dot(a, a);
}

double determinant(const Point& a, const Point& b, const Point& c) {
  return dot(a, cross(b, c));
}

double simplexQuality(const std::vector<Point>& x, int dimension) {
  double squares = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      squares += square(difference(x[i], x[j]));
  if (squares <= 0.0)
    return 0.0;
  if (dimension == 2)
    return 2.0 * std::sqrt(3.0) * determinant(difference(x[1], x[0]), difference(x[2], x[0]), {0, 0, 1}) /
           squares;
  // 6√2 V = l³ for edges of length l.
  return std::sqrt(2.0) *
         determinant(difference(x[1], x[0]), difference(x[2], x[0]), difference(x[3], x[0])) /
         std::pow(squares / 6.0, 1.5);
}

// Corners in the order of Shards: `around` of the bottom, and of the top in space. @param best of a regular
// cell.
double prismQuality(const std::vector<Point>& x, std::size_t around, double best) {
  double least = 1.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::size_t ring = i / around * around, k = i % around;
    const Point a = difference(x[ring + (k + 1) % around], x[i]),
                b = difference(x[ring + (k + around - 1) % around], x[i]);
    Point c = {0, 0, 1};
    if (x.size() > around)
      c = ring == 0 ? difference(x[i + around], x[i]) : difference(x[i], x[i - around]);
    const double lengths = std::sqrt(square(a) * square(b) * square(c));
    least = std::min(least, lengths > 0.0 ? determinant(a, b, c) / lengths / best : 0.0);
  }
  return least;
}

double qualityOf(const fem::CellShape& shape, const std::vector<Point>& corners) {
  if (shape.isSimplex)
    return simplexQuality(corners, shape.dimension);
  return shape.isWedge ? prismQuality(corners, 3, std::sqrt(0.75)) : prismQuality(corners, 4, 1.0);
}

struct PartBoxes {
  std::string name;
  std::size_t body;
  std::vector<fem::Box> boxes;
  std::vector<Point> normals;
};

// Faces that look into each other, up to 60 degrees: others touch at edges, or go through each other.
bool isFacing(const PartBoxes& part, std::size_t side, const PartBoxes& other, const fem::BoxTree& tree) {
  const std::vector<int> near = tree.touching(part.boxes[side]);
  constexpr double leastOpposed = 0.5;
  return std::any_of(near.begin(), near.end(), [&](int k) {
    return dot(part.normals[side], other.normals[static_cast<std::size_t>(k)]) < -leastOpposed;
  });
}

using Bodies = std::vector<std::vector<fem::BodyMesh>>; // the blocks of each

// The names of a body's boundary parts, rising.
std::set<std::string> partsOf(const std::vector<fem::BodyMesh>& blocks) {
  std::set<std::string> names;
  for (const fem::BodyMesh& block : blocks)
    for (const auto& part : block.sides)
      names.insert(part.first);
  return names;
}

// take(block, side) of all sides of a part.
template<class Take>
void visitPart(const std::vector<fem::BodyMesh>& blocks, const std::string& name, const Take& take) {
  for (const fem::BodyMesh& block : blocks)
    if (const auto part = block.sides.find(name); part != block.sides.end())
      for (const fem::Side& side : part->second)
        take(block, side);
}

std::vector<PartBoxes> partBoxes(const Bodies& bodies, double margin) {
  std::vector<PartBoxes> parts;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (const std::string& name : partsOf(bodies[b])) {
      parts.push_back({bodies[b].front().name + "/" + name, b, {}, {}});
      visitPart(bodies[b], name, [&](const fem::BodyMesh& block, const fem::Side& side) {
        std::vector<Point> places;
        for (int node : block.mesh.nodesOf(side))
          places.push_back(block.mesh.local(node));
        parts.back().boxes.push_back(fem::widened(fem::boxAround(places), margin));
        parts.back().normals.push_back(fem::geometryOf(block.mesh, {}, side).normal);
      });
    }
  return parts;
}

// "4 cells (hexahedron of 8 nodes), quality 0.9 mean, 0.8 minimum at (0, 0, 0)"
void tellCells(const fem::Mesh& mesh, std::ostream& text) {
  const Quality quality = app::qualityOf(mesh);
  const Point at = mesh.local(mesh.cell(quality.worst)[0]);
  text << mesh.numberOfCells() << " cells (" << fem::shapeOf(mesh.cellType).name << "), quality "
       << quality.mean << " mean, " << quality.least << " minimum at (" << at[0] << ", " << at[1] << ", "
       << at[2] << ")\n";
}

void tellParts(const std::vector<fem::BodyMesh>& blocks, std::ostream& text) {
  for (const std::string& name : partsOf(blocks)) {
    fem::SidesGeometry all;
    std::size_t count = 0;
    visitPart(blocks, name, [&](const fem::BodyMesh& block, const fem::Side& side) {
      all.add(fem::geometryOf(block.mesh, {}, side));
      ++count;
    });
    text << "  part \"" << name << "\": " << count << " sides, "
         << (blocks.front().mesh.dimension() == 2 ? "length " : "area ") << fem::textOf(all) << "\n";
  }
  std::map<std::string, std::set<int>> named;
  for (const fem::BodyMesh& block : blocks)
    for (const auto& [name, nodes] : block.nodes)
      for (int node : nodes)
        named[name].insert(block.number(node));
  // Of a geometry without groups every point and curve has a name.
  constexpr std::size_t most = 6;
  std::size_t told = 0;
  for (const auto& [name, nodes] : named)
    if (++told <= most)
      text << "  nodes \"" << name << "\": " << nodes.size() << "\n";
  if (told > most)
    text << "  and node sets of " << told - most << " other names\n";
}

} // namespace

Quality qualityOf(const fem::Mesh& mesh) {
  const fem::CellShape& shape = fem::shapeOf(mesh.cellType);
  Quality quality;
  quality.least = 2.0;
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    std::vector<Point> corners;
    for (int k = 0; k < shape.corners; ++k)
      corners.push_back(mesh.local(mesh.cell(c)[k]));
    const double value = qualityOf(shape, corners);
    quality.mean += value / mesh.numberOfCells();
    if (value < quality.least) {
      quality.least = value;
      quality.worst = c;
    }
  }
  return quality;
}

std::vector<TouchingParts> touchingParts(const Bodies& bodies) {
  std::vector<Point> all;
  for (const std::vector<fem::BodyMesh>& blocks : bodies)
    for (const fem::BodyMesh& block : blocks)
      for (int node : block.mesh.boundary)
        all.push_back(block.mesh.local(node));
  if (all.empty())
    return {};
  const fem::Box whole = fem::boxAround(all);
  const std::vector<PartBoxes> parts =
      partBoxes(bodies, 5e-4 * std::sqrt(square(difference(whole.high, whole.low))));
  std::vector<TouchingParts> result;
  for (std::size_t second = 1; second < parts.size(); ++second) {
    const fem::BoxTree tree(parts[second].boxes);
    for (std::size_t first = 0; first < second; ++first) {
      if (parts[first].body == parts[second].body)
        continue;
      int facing = 0;
      for (std::size_t side = 0; side < parts[first].boxes.size(); ++side)
        facing += isFacing(parts[first], side, parts[second], tree) ? 1 : 0;
      if (facing > 0)
        result.push_back(
            {parts[first].name, parts[second].name, facing, static_cast<int>(parts[first].boxes.size())});
    }
  }
  return result;
}

std::string reportOf(const Bodies& bodies) {
  std::ostringstream text;
  text << std::setprecision(3);
  for (const std::vector<fem::BodyMesh>& blocks : bodies) {
    text << "Body \"" << blocks.front().name << "\": " << fem::numberOfNodes(blocks) << " nodes, ";
    if (blocks.size() > 1)
      text << "cells of " << blocks.size() << " types\n";
    for (const fem::BodyMesh& block : blocks) {
      text << (blocks.size() > 1 ? "  " : "");
      tellCells(block.mesh, text);
    }
    if (const int pieces = fem::numberOfPieces(blocks); pieces > 1)
      text << "  in " << pieces << " pieces without common nodes: only effects can couple them\n";
    tellParts(blocks, text);
  }
  for (const TouchingParts& pair : touchingParts(bodies))
    text << "Facing surfaces: " << pair.first << " and " << pair.second << " (" << pair.facets << " of "
         << pair.of << " sides)\n";
  return text.str();
}

} // namespace Harmos::app
