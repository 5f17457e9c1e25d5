// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_PartsFile.hpp"

#include "Harmos_OuterSides.hpp"
#include "Harmos_VtkCell.hpp"
#include "Harmos_VtkHdf.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace Harmos::run {
namespace {

using Owned = std::vector<scene::OwnedSubdomain>;

// Names of the arrays, each once.
std::vector<std::string> arrayNames(const std::vector<scene::PartSummary>& parts) {
  std::vector<std::string> names;
  for (const scene::PartSummary& part : parts) {
    std::string name = part.body + ": " + part.part;
    std::replace(name.begin(), name.end(), '/', '|'); // HDF5 parts groups by slashes
    std::string once = name;
    for (int k = 2; std::find(names.begin(), names.end(), once) != names.end(); ++k)
      once = name + " (" + std::to_string(k) + ")";
    names.push_back(once);
  }
  return names;
}

// The arrays of the file, of this rank's subdomains.
class PartsGrid {
 public:
  io::VtkParts shape;
  std::vector<double> points;
  std::vector<long long> links, offsets;
  std::vector<unsigned char> types;
  std::vector<int> bodies, firstPart;
  std::vector<std::vector<int>> numbers; // by part

  PartsGrid(const scene::Scene& scene, const std::vector<scene::PartSummary>& parts)
      : numbers(parts.size()), scene_(scene), parts_(parts) {}

  void add(const scene::OwnedSubdomain& item, const std::vector<fem::Side>& outer) {
    const fem::Mesh& mesh = *item.mesh.mesh;
    const std::string& body = scene_.bodies[static_cast<std::size_t>(item.body)].name;
    std::map<int, long long> pointOf; // of a node
    std::vector<long long> cellEnds = {0};
    std::vector<std::set<std::pair<int, int>>> sidesOn(parts_.size());
    const auto put = [&](const std::vector<int>& nodes, unsigned char type, const auto& onPart) {
      for (int node : nodes) {
        const auto [place, isNew] = pointOf.emplace(node, static_cast<long long>(pointOf.size()));
        links.push_back(place->second);
        if (isNew)
          for (double coordinate : item.mesh.position(node))
            points.push_back(coordinate);
      }
      cellEnds.push_back(cellEnds.back() + static_cast<long long>(nodes.size()));
      types.push_back(type);
      bodies.push_back(item.body);
      firstPart.push_back(0);
      for (std::size_t p = parts_.size(); p-- > 0;) {
        const int number = onPart(p) ? static_cast<int>(p) + 1 : 0;
        numbers[p].push_back(number);
        if (number > 0)
          firstPart.back() = number;
      }
    };
    for (std::size_t p = 0; p < parts_.size(); ++p)
      if (const auto sides = item.mesh.sides.find(parts_[p].part);
          parts_[p].body == body && sides != item.mesh.sides.end())
        for (const fem::Side& side : sides->second)
          sidesOn[p].emplace(side.cell, side.side);
    for (const fem::Side& side : outer) {
      const VtkCell vtk = vtkCell(mesh.typeOf(side));
      const std::vector<int> nodes = mesh.nodesOf(side);
      std::vector<int> ordered;
      for (int place : vtk.nodes)
        ordered.push_back(nodes[static_cast<std::size_t>(place)]);
      put(ordered, vtk.type, [&](std::size_t p) { return sidesOn[p].count({side.cell, side.side}) > 0; });
    }
    for (std::size_t p = 0; p < parts_.size(); ++p)
      if (const auto set = item.mesh.sets.find(parts_[p].part);
          parts_[p].body == body && parts_[p].geometry.sides == 0 && set != item.mesh.sets.end())
        for (int node : set->second)
          put({node}, vtkVertex, [&](std::size_t other) { return other == p; });
    shape.points.push_back(static_cast<long long>(pointOf.size()));
    shape.cells.push_back(static_cast<long long>(cellEnds.size()) - 1);
    shape.links.push_back(cellEnds.back());
    offsets.insert(offsets.end(), cellEnds.begin(), cellEnds.end());
  }

 private:
  const scene::Scene& scene_;
  const std::vector<scene::PartSummary>& parts_;
};

} // namespace

void writeParts(const Teuchos::Comm<int>& comm, const std::string& path, const scene::Scene& scene,
                const Owned& owned, const std::vector<scene::PartSummary>& parts) {
  const std::vector<std::vector<fem::Side>> outer = scene::outerSides(comm, owned);
  PartsGrid grid(scene, parts);
  for (std::size_t i = 0; i < owned.size(); ++i)
    grid.add(owned[i], outer[i]);
  io::VtkHdfWriter file(comm, path, grid.shape,
                        static_cast<long long>((parts.size() + 2) * sizeof(int) * grid.types.size()));
  file.points(grid.points);
  file.cells(grid.links, grid.offsets, grid.types);
  file.cellData("body", grid.bodies);
  file.cellData("part", grid.firstPart);
  const std::vector<std::string> names = arrayNames(parts);
  for (std::size_t p = 0; p < parts.size(); ++p)
    file.cellData(names[p], grid.numbers[p]);
  file.commit();
}

std::string partsText(const scene::Scene& scene, const std::vector<scene::PartSummary>& parts) {
  const std::string size = scene.physics == scene::Physics::Solid ? "area " : "length ";
  std::string text = parts.empty() ? "No boundary part has a name" : "Boundary parts:";
  // Of a geometry without groups every point and curve has a name.
  constexpr int most = 6;
  int alone = 0;
  for (const scene::PartSummary& part : parts) {
    alone += part.geometry.sides == 0 ? 1 : 0;
    if (part.geometry.sides == 0 && alone > most)
      continue;
    text += "\n  " + part.body + "/" + part.part + ": " +
            (part.geometry.sides == 0
                 ? "nodes alone"
                 : std::to_string(part.geometry.sides) + " sides, " + size + fem::textOf(part.geometry));
  }
  if (alone > most)
    text += "\n  and " + std::to_string(alone - most) + " others of nodes alone";
  return text;
}

} // namespace Harmos::run
