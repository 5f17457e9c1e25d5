// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_PlateMesh.hpp"

#include "Harmos_TestComm.hpp"
#include "Harmos_TornBody.hpp"

#include <algorithm>
#include <set>

namespace Harmos {

fem::BodyMesh wholeBlock(const fem::StructuredBlock::Options& options) {
  const fem::PlacedMesh placed = fem::StructuredBlock(options).subdomain(0);
  fem::BodyMesh body;
  body.name = "block";
  body.mesh = *placed.mesh;
  const auto dimension = static_cast<std::size_t>(body.mesh.dimension());
  for (std::size_t k = 0; k < body.mesh.coordinates.size(); ++k)
    body.mesh.coordinates[k] += placed.anchor[k % dimension];
  body.regions = {"all"};
  body.sides = placed.sides;
  return body;
}

fem::Point centreOf(const fem::Mesh& mesh, int cell) {
  fem::Point centre{};
  const int corners = fem::shapeOf(mesh.cellType).corners;
  for (int i = 0; i < corners; ++i)
    for (std::size_t d = 0; d < 3; ++d)
      centre[d] += mesh.local(mesh.cell(cell)[i])[d] / corners;
  return centre;
}

std::vector<int> cellsBy(const fem::Mesh& mesh, const std::function<int(const fem::Point&)>& number) {
  std::vector<int> result;
  for (int c = 0; c < mesh.numberOfCells(); ++c)
    result.push_back(number(centreOf(mesh, c)));
  return result;
}

fem::BodyMesh extracted(const fem::BodyMesh& body, const std::vector<int>& number, int wanted,
                        const std::string& cut) {
  const auto dimension = static_cast<std::size_t>(body.mesh.dimension());
  fem::BodyMesh result;
  result.name = body.name + " " + cut;
  result.regions = body.regions;
  result.mesh.cellType = body.mesh.cellType;
  std::vector<int> node(static_cast<std::size_t>(body.mesh.numberOfNodes()), -1), cell(number.size(), -1);
  for (int c = 0; c < body.mesh.numberOfCells(); ++c)
    if (number[static_cast<std::size_t>(c)] == wanted)
      for (int i = 0; i < body.mesh.nodesPerCell(); ++i)
        node[static_cast<std::size_t>(body.mesh.cell(c)[i])] = 0;
  int next = 0;
  for (std::size_t k = 0; k < node.size(); ++k)
    if (node[k] == 0) {
      node[k] = next++;
      for (std::size_t d = 0; d < dimension; ++d)
        result.mesh.coordinates.push_back(body.mesh.coordinates[k * dimension + d]);
    }
  for (int c = 0; c < body.mesh.numberOfCells(); ++c)
    if (number[static_cast<std::size_t>(c)] == wanted) {
      cell[static_cast<std::size_t>(c)] = result.mesh.numberOfCells();
      for (int i = 0; i < body.mesh.nodesPerCell(); ++i)
        result.mesh.cells.push_back(node[static_cast<std::size_t>(body.mesh.cell(c)[i])]);
      if (!body.mesh.regions.empty())
        result.mesh.regions.push_back(body.mesh.region(c));
    }
  std::set<std::pair<int, int>> named;
  for (const auto& [name, sides] : body.sides)
    for (const fem::Side& side : sides)
      if (const int c = cell[static_cast<std::size_t>(side.cell)]; c >= 0) {
        result.sides[name].push_back({c, side.side});
        named.emplace(c, side.side);
      }
  const std::vector<fem::Side> boundary = fem::boundarySides(result.mesh);
  for (const fem::Side& side : boundary)
    if (named.count({side.cell, side.side}) == 0)
      result.sides[cut].push_back(side);
  result.mesh.boundary = fem::nodesOf(result.mesh, boundary);
  return result;
}

scene::Body tornBody(const fem::BodyMesh& body, const std::vector<int>& part, long long& firstNode,
                     const std::vector<fem::Material>& materials) {
  scene::Body result;
  result.name = body.name;
  result.subdomains = *std::max_element(part.begin(), part.end()) + 1;
  result.materials = materials;
  result.onRoot = std::make_shared<const std::vector<fem::PlacedMesh>>(
      testComm()->getRank() == 0 ? fem::tear(body, part, result.subdomains, firstNode)
                                 : std::vector<fem::PlacedMesh>());
  firstNode += body.mesh.numberOfNodes();
  return result;
}

} // namespace Harmos
