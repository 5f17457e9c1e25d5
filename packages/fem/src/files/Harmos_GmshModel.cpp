// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_GmshModel.hpp"

#include "Harmos_Errors.hpp"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <gmsh.h>
#include <numeric>
#include <unistd.h>

namespace Harmos::fem::Details {
namespace {

void flushOutput() {
  std::fflush(stdout);
} // C++ streams pass it on at once

} // namespace

Silence::Silence() : output_(dup(STDOUT_FILENO)) {
  flushOutput();
  const int nowhere = open("/dev/null", O_WRONLY);
  if (output_ >= 0 && nowhere >= 0)
    dup2(nowhere, STDOUT_FILENO);
  if (nowhere >= 0)
    close(nowhere);
}

Silence::~Silence() {
  flushOutput();
  if (output_ >= 0) {
    dup2(output_, STDOUT_FILENO);
    close(output_);
  }
}

namespace {

volatile std::sig_atomic_t inGmsh = 0;

// Made beforehand: a handler of signals may do next to nothing.
std::string sentence;

[[noreturn]] void endWithSentence() {
  const auto written = write(STDERR_FILENO, sentence.data(), sentence.size());
  constexpr int badInput = 2;
  _exit(written < 0 ? badInput + 1 : badInput);
}

void onSignal(int) {
  endWithSentence();
}

void onExit() {
  if (inGmsh != 0)
    endWithSentence();
}

} // namespace

EndGuard::EndGuard(const std::string& path)
    : aborted_(std::signal(SIGABRT, onSignal)), faulted_(std::signal(SIGSEGV, onSignal)) {
  sentence = isExodus(path)
                 ? "error: the library of Exodus ended the program that reads \"" + path +
                       "\": the file is damaged\n"
                 : "error: Gmsh ended the program that reads \"" + path +
                       "\": the file is damaged, contains Exit or uses an unsupported feature. Open it in "
                       "Gmsh to locate the failure\n";
  static const bool registered = std::atexit(onExit) == 0;
  inGmsh = registered ? 1 : 0;
}

EndGuard::~EndGuard() {
  inGmsh = 0;
  std::signal(SIGABRT, aborted_);
  std::signal(SIGSEGV, faulted_);
}

GmshSession::GmshSession(const std::string& path) : guard_(path) {
  gmsh::initialize(0, nullptr, false);
  gmsh::option::setNumber("General.Terminal", 0);
  gmsh::option::setNumber("General.AbortOnError", 2); // throw
  gmsh::option::setNumber("General.NumThreads", 1);   // the same mesh at every run
}

GmshSession::~GmshSession() {
  try {
    gmsh::finalize();
  } catch (...) { // nothing is left to be done about it
  }
}

namespace {

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
  gmsh::model::add("grid");
  std::array<int, 4> entities{};
  bool hasNodes = false;
  for (auto place = cells.rbegin(); place != cells.rend(); ++place) {
    const auto& [dimension, region] = place->first;
    const int entity = ++entities[static_cast<std::size_t>(dimension)];
    gmsh::model::addDiscreteEntity(dimension, entity);
    if (!hasNodes) {
      std::vector<Tag> tags(grid.points.size() / 3);
      std::iota(tags.begin(), tags.end(), Tag(1));
      gmsh::model::mesh::addNodes(dimension, entity, tags, grid.points);
      hasNodes = true;
    }
    for (const auto& [type, nodes] : place->second)
      gmsh::model::mesh::addElementsByType(entity, type, {}, nodes);
    if (!regions.empty()) {
      const int group = gmsh::model::addPhysicalGroup(dimension, {entity});
      gmsh::model::setPhysicalName(dimension, group, std::to_string(region));
    }
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

/// Entities of a discrete model, one after the other, each with a group of a name.
class DiscreteModel {
 public:
  explicit DiscreteModel(const std::vector<double>& points) : points_(points) { gmsh::model::add(name); }

  void add(int dimension, const std::string& group, const std::map<int, std::vector<Tag>>& cells) {
    const int entity = ++entities_[static_cast<std::size_t>(dimension)];
    gmsh::model::addDiscreteEntity(dimension, entity);
    if (tags_.empty()) {
      tags_.resize(points_.size() / 3);
      std::iota(tags_.begin(), tags_.end(), Tag(1));
      gmsh::model::mesh::addNodes(dimension, entity, tags_, points_);
    }
    for (const auto& [type, nodes] : cells)
      gmsh::model::mesh::addElementsByType(entity, type, {}, nodes);
    gmsh::model::setPhysicalName(dimension, gmsh::model::addPhysicalGroup(dimension, {entity}), group);
  }

  void addField(const std::string& field, const std::vector<double>& values) const {
    std::vector<std::vector<double>> rows;
    for (double value : values)
      rows.push_back({value});
    gmsh::view::addModelData(gmsh::view::add(field), 0, name, "NodeData", tags_, rows);
  }

 private:
  static constexpr const char* name = "mesh";
  const std::vector<double>& points_;
  std::vector<Tag> tags_;
  std::array<int, 4> entities_{};
};

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

const char* entityName(int dimension) {
  static const std::array<const char*, 4> names = {"point", "curve", "surface", "volume"};
  return names[static_cast<std::size_t>(dimension)];
}

Groups groupsOfModel() {
  Groups groups;
  gmsh::vectorpair all;
  gmsh::model::getPhysicalGroups(all);
  for (const auto& [dimension, tag] : all) {
    std::string name;
    gmsh::model::getPhysicalName(dimension, tag, name);
    std::vector<int> entities;
    gmsh::model::getEntitiesForPhysicalGroup(dimension, tag, entities);
    std::vector<int>& group =
        groups[static_cast<std::size_t>(dimension)][name.empty() ? std::to_string(tag) : name];
    group.insert(group.end(), entities.begin(), entities.end());
  }
  if (all.empty()) {
    gmsh::model::getEntities(all);
    for (const auto& [dimension, tag] : all)
      groups[static_cast<std::size_t>(dimension)][entityName(dimension) + (" " + std::to_string(tag))] = {
          tag};
  }
  for (auto& ofDimension : groups)
    for (auto& [name, entities] : ofDimension) {
      std::sort(entities.begin(), entities.end());
      entities.erase(std::unique(entities.begin(), entities.end()), entities.end());
    }
  return groups;
}

bool isSamePlace(const Point& a, const Point& b) {
  constexpr double tolerance = 1e-8; // on a reference cell of size 1
  return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]) < tolerance;
}

std::vector<std::size_t> matched(const std::vector<Point>& places, const std::vector<Point>& others) {
  std::vector<std::size_t> result;
  for (const Point& place : places)
    for (std::size_t k = 0; k < others.size(); ++k)
      if (isSamePlace(place, others[k])) {
        result.push_back(k);
        break;
      }
  return places.size() == others.size() && result.size() == places.size() ? result
                                                                          : std::vector<std::size_t>{};
}

ElementType makeElementType(int type) {
  ElementType result;
  int order = 0, nodes = 0, corners = 0;
  std::vector<double> coordinates;
  gmsh::model::mesh::getElementProperties(type, result.name, result.dimension, order, nodes, coordinates,
                                          corners);
  result.nodes = static_cast<std::size_t>(nodes);
  result.corners = static_cast<std::size_t>(corners);
  const auto dimension = static_cast<std::size_t>(result.dimension);
  if (result.dimension < 2)
    return result; // sides of plane cells and points: only their corners are used
  std::vector<Point> places(result.nodes);
  for (std::size_t i = 0; i < result.nodes; ++i)
    for (std::size_t d = 0; d < dimension; ++d)
      places[i][d] = coordinates[i * dimension + d];
  for (CellType candidate : bodyCells) {
    const CellShape& shape = shapeOf(candidate);
    if (shape.dimension != result.dimension || shape.corners != corners)
      continue;
    result.order = matched(shape.nodeCoordinates, places);
    if (!result.order.empty()) {
      result.ours = candidate;
      break;
    }
  }
  return result;
}

Elements elementsOf(int dimension, int entity) {
  Elements elements;
  gmsh::model::mesh::getElements(elements.types, elements.tags, elements.nodes, dimension, entity);
  return elements;
}

} // namespace Harmos::fem::Details
