// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_MeshReport.hpp"

#include "Harmos_PointAlgebra.hpp"
#include "Harmos_SideGeometry.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
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

std::vector<PartBoxes> partBoxes(const std::vector<fem::BodyMesh>& bodies, double margin) {
  std::vector<PartBoxes> parts;
  for (std::size_t b = 0; b < bodies.size(); ++b)
    for (const auto& [name, sides] : bodies[b].sides) {
      parts.push_back({bodies[b].name + "/" + name, b, {}, {}});
      for (const fem::Side& side : sides) {
        std::vector<Point> places;
        for (int node : bodies[b].mesh.nodesOf(side))
          places.push_back(bodies[b].mesh.local(node));
        parts.back().boxes.push_back(fem::widened(fem::boxAround(places), margin));
        parts.back().normals.push_back(fem::geometryOf(bodies[b].mesh, {}, side).normal);
      }
    }
  return parts;
}

fem::SidesGeometry geometryOf(const fem::BodyMesh& body, const std::vector<fem::Side>& sides) {
  fem::SidesGeometry all;
  for (const fem::Side& side : sides)
    all.add(fem::geometryOf(body.mesh, {}, side));
  return all;
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

std::vector<TouchingParts> touchingParts(const std::vector<fem::BodyMesh>& bodies) {
  std::vector<Point> all;
  for (const fem::BodyMesh& body : bodies)
    for (int node : body.mesh.boundary)
      all.push_back(body.mesh.local(node));
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

std::string reportOf(const std::vector<fem::BodyMesh>& bodies) {
  std::ostringstream text;
  text << std::setprecision(3);
  for (const fem::BodyMesh& body : bodies) {
    const Quality quality = qualityOf(body.mesh);
    const Point at = body.mesh.local(body.mesh.cell(quality.worst)[0]);
    text << "Body \"" << body.name << "\": " << body.mesh.numberOfNodes() << " nodes, "
         << body.mesh.numberOfCells() << " cells (" << fem::shapeOf(body.mesh.cellType).name << "), quality "
         << quality.mean << " mean, " << quality.least << " minimum at (" << at[0] << ", " << at[1] << ", "
         << at[2] << ")\n";
    if (const int pieces = fem::numberOfPieces(body.mesh); pieces > 1)
      text << "  in " << pieces << " pieces without common nodes: only effects can couple them\n";
    for (const auto& [name, sides] : body.sides)
      text << "  part \"" << name << "\": " << sides.size() << " sides, "
           << (body.mesh.dimension() == 2 ? "length " : "area ") << fem::textOf(geometryOf(body, sides))
           << "\n";
    // Of a geometry without groups every point and curve has a name.
    constexpr std::size_t most = 6;
    std::size_t told = 0;
    for (const auto& [name, nodes] : body.nodes)
      if (++told <= most)
        text << "  nodes \"" << name << "\": " << nodes.size() << "\n";
    if (told > most)
      text << "  and node sets of " << told - most << " other names\n";
  }
  for (const TouchingParts& pair : touchingParts(bodies))
    text << "Facing surfaces: " << pair.first << " and " << pair.second << " (" << pair.facets << " of "
         << pair.of << " sides)\n";
  return text.str();
}

} // namespace Harmos::app
