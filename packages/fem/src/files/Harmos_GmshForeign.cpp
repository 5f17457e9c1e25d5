// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_GmshModel.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_GmshLibrary.hpp"

#include <numeric>
#include <set>

namespace Harmos::fem::Details {
namespace {

/// Entities of a discrete model, one after the other.
class DiscreteModel {
 public:
  explicit DiscreteModel(const std::vector<double>& points) : points_(points) { gmsh::model::add(name); }

  /// @param group its name; empty: none. @param cells by Gmsh's type.
  void add(int dimension, const std::string& group, const std::map<int, std::vector<Tag>>& cells) {
    const int entity = ++entities_[static_cast<std::size_t>(dimension)];
    gmsh::model::addDiscreteEntity(dimension, entity);
    if (tags_.empty()) {
      tags_.resize(points_.size() / 3);
      std::iota(tags_.begin(), tags_.end(), Tag(1));
      gmsh::mesh::addNodes(dimension, entity, tags_, points_);
    }
    for (const auto& [type, nodes] : cells)
      gmsh::mesh::addElementsByType(entity, type, nodes);
    if (!group.empty())
      gmsh::model::addPhysicalGroup(dimension, {entity}, group);
  }

  void addField(const std::string& field, const std::vector<double>& values) const {
    std::vector<std::vector<double>> rows;
    for (double value : values)
      rows.push_back({value});
    gmsh::view::addNodeData(field, name, tags_, rows);
  }

 private:
  static constexpr const char* name = "mesh";
  const std::vector<double>& points_;
  std::vector<Tag> tags_;
  std::array<int, 4> entities_{};
};

/// A cell type of VTK, and Gmsh's order of its nodes: Gmsh's node i is VTK's order[i].
struct VtkType {
  int vtk, gmsh, dimension;
  std::vector<int> order;
};

std::vector<int> asTheyAre(int nodes) {
  std::vector<int> order(static_cast<std::size_t>(nodes));
  std::iota(order.begin(), order.end(), 0);
  return order;
}

// The figures of both manuals. Those that Harmos does not have are told by name later.
const std::vector<VtkType>& vtkTypes() {
  static const std::vector<VtkType> types = {
      {1, 15, 0, asTheyAre(1)},
      {3, 1, 1, asTheyAre(2)},
      {21, 8, 1, asTheyAre(3)},
      {5, 2, 2, asTheyAre(3)},
      {22, 9, 2, asTheyAre(6)},
      {8, 3, 2, {0, 1, 3, 2}},
      {9, 3, 2, asTheyAre(4)},
      {23, 16, 2, asTheyAre(8)},
      {28, 10, 2, asTheyAre(9)},
      {10, 4, 3, asTheyAre(4)},
      {24, 11, 3, {0, 1, 2, 3, 4, 5, 6, 7, 9, 8}},
      {11, 5, 3, {0, 1, 3, 2, 4, 5, 7, 6}},
      {12, 5, 3, asTheyAre(8)},
      {25, 17, 3, {0, 1, 2, 3, 4, 5, 6, 7, 8, 11, 16, 9, 17, 10, 18, 19, 12, 15, 13, 14}},
      {29, 12, 3, {0,  1,  2,  3,  4,  5,  6,  7,  8,  11, 16, 9,  17, 10,
                   18, 19, 12, 15, 13, 14, 24, 22, 20, 21, 23, 25, 26}},
      {13, 6, 3, asTheyAre(6)},
      {26, 18, 3, {0, 1, 2, 3, 4, 5, 6, 8, 12, 7, 13, 14, 9, 11, 10}},
      {32, 13, 3, {0, 1, 2, 3, 4, 5, 6, 8, 12, 7, 13, 14, 9, 11, 10, 15, 17, 16}},
      {14, 7, 3, asTheyAre(5)}};
  return types;
}

const VtkType& vtkType(const std::string& path, int type) {
  for (const VtkType& known : vtkTypes())
    if (known.vtk == type)
      return known;
  throw InputError("\"" + path + "\" has cells of VTK's type " + std::to_string(type) +
                   ", which is not supported; use triangles, quadrilaterals, tetrahedra, wedges or "
                   "hexahedra of first or second order");
}

// What tells the regions; empty: nothing does.
std::vector<long long> regionsOf(const std::string& path, const VtkGrid& grid) {
  for (const char* name : {"gmsh:physical", "medit:ref", "CellEntityIds", "MaterialIds", "material",
                           "Material", "region", "Region", "cell_tags", "gmsh:geometrical"})
    if (const auto found = grid.data.find(name); found != grid.data.end())
      return found->second;
  if (grid.data.empty())
    return {};
  if (grid.data.size() == 1)
    return grid.data.begin()->second;
  std::string names;
  for (const auto& item : grid.data)
    names += (names.empty() ? "\"" : ", \"") + item.first + "\"";
  throw InputError(
      "\"" + path + "\" has several integer arrays per cell (" + names +
      "), so the region array is ambiguous. Save the file with one of them or name it \"region\"");
}

} // namespace

void loadGrid(const std::string& path, const VtkGrid& grid) {
  const std::vector<long long> regions = regionsOf(path, grid);
  // Of each dimension, region by region, type by type.
  std::map<std::pair<int, long long>, std::map<int, std::vector<Tag>>> cells;
  long long begin = 0;
  for (std::size_t c = 0; c < grid.types.size(); ++c) {
    const VtkType& type = vtkType(path, grid.types[c]);
    if (grid.offsets[c] - begin != static_cast<long long>(type.order.size()))
      throw InputError("\"" + path + "\", cell " + std::to_string(c) + " of VTK's type " +
                       std::to_string(type.vtk) + " has " + std::to_string(grid.offsets[c] - begin) +
                       " nodes instead of " + std::to_string(type.order.size()));
    std::vector<Tag>& nodes = cells[{type.dimension, regions.empty() ? 0 : regions[c]}][type.gmsh];
    for (int k : type.order)
      nodes.push_back(static_cast<Tag>(grid.nodes[static_cast<std::size_t>(begin + k)] + 1));
    begin = grid.offsets[c];
  }
  DiscreteModel model(grid.points);
  for (auto place = cells.rbegin(); place != cells.rend(); ++place) {
    const auto& [dimension, region] = place->first;
    model.add(dimension, regions.empty() ? "" : std::to_string(region), place->second);
  }
}

namespace {

int gmshType(CellType type) {
  static const std::map<CellType, int> types = {
      {CellType::Line2, 1},           {CellType::Line3, 8},          {CellType::Triangle3, 2},
      {CellType::Triangle6, 9},       {CellType::Quadrilateral4, 3}, {CellType::Quadrilateral8, 16},
      {CellType::Quadrilateral9, 10}, {CellType::Tetrahedron4, 4},   {CellType::Tetrahedron10, 11},
      {CellType::Wedge6, 6},          {CellType::Wedge15, 18},       {CellType::Wedge18, 13},
      {CellType::Hexahedron8, 5},     {CellType::Hexahedron20, 17},  {CellType::Hexahedron27, 12}};
  return types.at(type);
}

std::vector<Tag> inOrderOfGmsh(const ExodusMesh::Block& block) {
  const std::vector<std::size_t> order = makeElementType(gmshType(block.type)).order;
  std::vector<Tag> nodes(block.nodes.size());
  for (std::size_t first = 0; first < nodes.size(); first += order.size())
    for (std::size_t i = 0; i < order.size(); ++i)
      nodes[first + order[i]] = static_cast<Tag>(block.nodes[first + i]);
  return nodes;
}

// Of a side set, its sides by their types.
std::map<int, std::vector<Tag>> sidesOf(const std::string& path, const ExodusMesh& mesh,
                                        const ExodusMesh::SideSet& set) {
  std::map<int, std::vector<Tag>> cells;
  for (std::size_t k = 0; k < set.elements.size(); ++k) {
    long long row = set.elements[k] - 1;
    std::size_t b = 0;
    const auto countOf = [&](std::size_t block) {
      return static_cast<long long>(mesh.blocks[block].nodes.size()) / shapeOf(mesh.blocks[block].type).nodes;
    };
    for (; row >= countOf(b); ++b)
      row -= countOf(b);
    const CellShape& shape = shapeOf(mesh.blocks[b].type);
    if (set.sides[k] < 1 || set.sides[k] > static_cast<long long>(shape.sides.size()))
      throw InputError("\"" + path + "\" cannot be read: the side set \"" + set.name + "\" has the side " +
                       std::to_string(set.sides[k]) + " of element " + std::to_string(set.elements[k]) +
                       ", a " + shape.name + "; the file is damaged");
    const auto side = static_cast<std::size_t>(set.sides[k] - 1);
    std::vector<Tag>& nodes = cells[gmshType(shape.sideTypes[side])];
    for (int node : shape.sides[side])
      nodes.push_back(
          static_cast<Tag>(mesh.blocks[b].nodes[static_cast<std::size_t>(row * shape.nodes + node)]));
  }
  return cells;
}

} // namespace

void loadExodus(const std::string& path, const ExodusMesh& mesh) {
  DiscreteModel model(mesh.points);
  for (const ExodusMesh::Block& block : mesh.blocks)
    model.add(mesh.dimension, block.name, {{gmshType(block.type), inOrderOfGmsh(block)}});
  for (const ExodusMesh::SideSet& set : mesh.sideSets)
    model.add(mesh.dimension - 1, set.name, sidesOf(path, mesh, set));
  constexpr int point = 15; // of Gmsh
  for (const ExodusMesh::NodeSet& set : mesh.nodeSets)
    model.add(0, set.name, {{point, {set.nodes.begin(), set.nodes.end()}}});
  for (const auto& [name, values] : mesh.fields)
    model.addField(name, values);
}

namespace {

struct NumberedElement {
  int type, dimension;
  std::vector<Tag> nodes;
};

// All elements of the model by their numbers.
std::map<Tag, NumberedElement> elementsByNumber() {
  std::map<Tag, NumberedElement> result;
  for (int dimension = 1; dimension < 4; ++dimension) {
    const auto [types, tags, nodes] = gmsh::mesh::getElements(dimension);
    for (std::size_t k = 0; k < types.size(); ++k) {
      const std::size_t each = tags[k].empty() ? 0 : nodes[k].size() / tags[k].size();
      for (std::size_t e = 0; e < tags[k].size(); ++e) {
        const auto first = nodes[k].begin() + static_cast<std::ptrdiff_t>(e * each);
        result[tags[k][e]] = {types[k], dimension, {first, first + static_cast<std::ptrdiff_t>(each)}};
      }
    }
  }
  return result;
}

// A new entity with these elements, and its group.
void addGroup(int dimension, const std::string& name, const std::map<int, std::vector<Tag>>& cells) {
  const int entity = gmsh::model::addDiscreteEntity(dimension);
  for (const auto& [type, nodes] : cells)
    gmsh::mesh::addElementsByType(entity, type, nodes);
  gmsh::model::addPhysicalGroup(dimension, {entity}, name);
}

} // namespace

void addGroups(const std::string& path, const std::vector<UniversalGroup>& groups) {
  const std::map<Tag, NumberedElement> elements = elementsByNumber();
  const std::vector<Tag> nodes = gmsh::mesh::getNodes().tags;
  const std::set<Tag> known(nodes.begin(), nodes.end());
  const auto fail = [&](const UniversalGroup& group, const std::string& what, long long number) {
    throw InputError("\"" + path + "\": the group \"" + group.name + "\" names the " + what + " " +
                     std::to_string(number) + ", which the file does not have; write it again");
  };
  std::map<std::pair<int, std::string>, std::map<int, std::vector<Tag>>> cells; // by dimension and name
  constexpr int point = 15;                                                     // of Gmsh
  for (const UniversalGroup& group : groups) {
    for (long long number : group.nodes) {
      if (number < 0 || known.count(static_cast<Tag>(number)) == 0)
        fail(group, "node", number);
      cells[{0, group.name}][point].push_back(static_cast<Tag>(number));
    }
    for (long long number : group.elements) {
      const auto found = elements.find(static_cast<Tag>(number));
      if (found == elements.end())
        fail(group, "element", number);
      const NumberedElement& element = found->second;
      std::vector<Tag>& all = cells[{element.dimension, group.name}][element.type];
      all.insert(all.end(), element.nodes.begin(), element.nodes.end());
    }
  }
  std::set<int> dimensions;
  for (const auto& entry : cells)
    dimensions.insert(entry.first.first);
  // Of files of this format Gmsh removes all groups or none.
  const Groups byProperty = groupsOfModel();
  gmsh::model::removePhysicalGroups();
  for (int dimension = 0; dimension < 4; ++dimension)
    for (const auto& [name, entities] : byProperty[static_cast<std::size_t>(dimension)])
      if (dimensions.count(dimension) == 0)
        gmsh::model::addPhysicalGroup(dimension, entities, name);
  for (const auto& [place, ofTypes] : cells)
    addGroup(place.first, place.second, ofTypes);
}

} // namespace Harmos::fem::Details
