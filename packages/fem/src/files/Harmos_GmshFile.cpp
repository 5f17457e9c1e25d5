// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_GmshFile.hpp"

#include "Harmos_Errors.hpp"

#ifdef HARMOS_HAVE_GMSH

#include "Harmos_BodyBlocks.hpp"
#include "Harmos_FileCells.hpp"
#include "Harmos_GmshLibrary.hpp"
#include "Harmos_GmshModel.hpp"
#include "Harmos_Index.hpp"
#include "Harmos_ParameterSpec.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_ReferenceElement.hpp"

#include <cmath>
#include <limits>
#include <sstream>

namespace Harmos::fem {
namespace {

using namespace Details;

std::string quoted(const std::string& text) {
  return "\"" + text + "\"";
}

std::string listed(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names)
    text += (text.empty() ? "" : ", ") + quoted(name);
  return text;
}

std::string placeText(const Point& x) {
  std::ostringstream text;
  text << "(" << x[0] << ", " << x[1] << ", " << x[2] << ")";
  return text.str();
}

// Bodies of fewer cells keep the order of the file: they are read and cut in no time.
constexpr std::size_t fewestAlongCurve = 30000;

/// A file's mesh, as far as bodies are made from it.
class Reader {
 public:
  Reader(std::string path, int dimension, const GmshMeshing& meshing)
      : path_(std::move(path)), dimension_(dimension) {
    dimension_ = openModel(path_, dimension_, meshing);
    groups_ = groupsOfModel();
    readNodes();
  }

  std::vector<GmshBody> eachGroup() const {
    std::vector<GmshBody> bodies;
    for (const std::string& name : names(dimension_))
      if (hasCells(name))
        bodies.push_back({name, {name}});
    return bodies;
  }

  // Its blocks, each of the cells of one type.
  std::vector<BodyMesh> body(const GmshBody& wanted) {
    if (wanted.groups.empty())
      throw InputError("body " + quoted(wanted.name) + " has no group of \"" + path_ +
                       "\"; name at least one of: " + listed(names(dimension_)));
    std::vector<Cells> ofTypes = cellsOf(wanted, typesOf(wanted));
    bool isAlongCurve = false;
    for (Cells& cells : ofTypes) {
      const CellShape& shape = shapeOf(cells.type);
      cells.isAlongCurve = cells.nodes.size() >= fewestAlongCurve * at(shape.nodes);
      if (cells.isAlongCurve)
        putAlongCurve(shape, coordinates_, cells.nodes, cells.regions);
      isAlongCurve = isAlongCurve || cells.isAlongCurve;
    }
    const std::vector<int> numbers = numberNodes(ofTypes, isAlongCurve);
    std::vector<BodyMesh> blocks;
    for (Cells& cells : ofTypes) {
      BodyMesh& block = blocks.emplace_back();
      block.name = wanted.name;
      block.regions = wanted.groups;
      if (ofTypes.size() > 1) {
        const std::vector<int> own = numbersIn(cells, numbers, block.numbers);
        fill(block, cells, own);
      } else {
        fill(block, cells, numbers);
      }
    }
    joinBlocks(blocks, "in \"" + path_ + "\", body " + quoted(wanted.name));
    return blocks;
  }

 private:
  // The cells of one type of a body.
  struct Cells {
    CellType type;
    std::vector<int> nodes; // places of the nodes of each
    std::vector<int> regions;
    bool isAlongCurve = false;
  };

  // @param numbers of the block's nodes, by place; −1: not one of them.
  void fill(BodyMesh& block, Cells& cells, const std::vector<int>& numbers) {
    block.mesh.cellType = cells.type;
    block.mesh.regions = std::move(cells.regions);
    block.isAlongCurve = cells.isAlongCurve;
    block.mesh.cells.reserve(cells.nodes.size());
    for (int node : cells.nodes)
      block.mesh.cells.push_back(numbers[at(node)]);
    const auto dimension = at(dimension_);
    block.mesh.coordinates.resize(dimension * at(*std::max_element(numbers.begin(), numbers.end()) + 1));
    for (std::size_t node = 0; node < numbers.size(); ++node)
      for (std::size_t d = 0; d < dimension && numbers[node] >= 0; ++d)
        block.mesh.coordinates[dimension * at(numbers[node]) + d] = coordinates_[3 * node + d];
    if (dimension_ == 2)
      requirePlane(block.name, numbers);
    auto matched = std::make_shared<const MatchedSides>(matchSides(block.mesh));
    requireUnfolded(block, *matched, cells.nodes);
    nameSides(block, *matched, numbers);
    nameNodes(block, numbers);
    addFields(block, numbers);
    block.matched = std::move(matched);
  }

  // By rising tags: nodes go by their places in this order from here on.
  void readNodes() {
    auto [tags, coordinates] = gmsh::mesh::getNodes();
    tags_ = std::move(tags);
    if (std::is_sorted(tags_.begin(), tags_.end())) {
      coordinates_ = std::move(coordinates);
    } else {
      std::vector<std::pair<Tag, std::size_t>> order;
      for (Tag tag : tags_)
        order.emplace_back(tag, order.size());
      std::sort(order.begin(), order.end());
      for (std::size_t k = 0; k < order.size(); ++k) {
        tags_[k] = order[k].first;
        const auto x = coordinates.begin() + static_cast<std::ptrdiff_t>(3 * order[k].second);
        coordinates_.insert(coordinates_.end(), x, x + 3);
      }
    }
    firstTag_ = tags_.empty() ? 0 : tags_.front();
    for (std::size_t k = 0; k < coordinates_.size(); ++k)
      if (!std::isfinite(coordinates_[k]))
        throw InputError("in \"" + path_ + "\", node " + std::to_string(tags_[k / 3]) +
                         " has a coordinate that is not a finite number; write the mesh again");
  }

  // Place of a node among all.
  int placeOf(Tag tag) const {
    const std::size_t guess = tag - firstTag_; // right where tags have no gaps, as in most files
    if (guess < tags_.size() && tags_[guess] == tag && (guess == 0 || tags_[guess - 1] != tag))
      return static_cast<int>(guess);
    const auto found = std::lower_bound(tags_.begin(), tags_.end(), tag);
    if (found == tags_.end() || *found != tag)
      throw InputError("\"" + path_ + "\" has cells with node " + std::to_string(tag) +
                       ", which it does not have; write the mesh again");
    return static_cast<int>(found - tags_.begin());
  }

  Point place(int node) const {
    const std::size_t k = 3 * at(node);
    return {coordinates_[k], coordinates_[k + 1], coordinates_[k + 2]};
  }

  // By place: the numbers of a body's nodes, −1 for others; by rising tags, or in the order of the cells.
  std::vector<int> numberNodes(const std::vector<Cells>& ofTypes, bool byCells) const {
    std::vector<int> numbers(tags_.size(), -1);
    int next = 0;
    for (const Cells& cells : ofTypes)
      for (int node : cells.nodes)
        if (numbers[at(node)] < 0)
          numbers[at(node)] = next++;
    if (byCells)
      return numbers;
    next = 0;
    for (int& number : numbers)
      number = number >= 0 ? next++ : -1;
    return numbers;
  }

  // By place: the numbers of a block's nodes within it, in the order of those in the body.
  // @param own receives the latter.
  static std::vector<int> numbersIn(const Cells& cells, const std::vector<int>& numbers,
                                    std::vector<int>& own) {
    for (int node : cells.nodes)
      own.push_back(numbers[at(node)]);
    std::sort(own.begin(), own.end());
    own.erase(std::unique(own.begin(), own.end()), own.end());
    std::vector<int> within(numbers.size(), -1);
    for (int node : cells.nodes)
      within[at(node)] =
          static_cast<int>(std::lower_bound(own.begin(), own.end(), numbers[at(node)]) - own.begin());
    return within;
  }

  const ElementType& elementType(int type) {
    const auto found = types_.find(type);
    return found != types_.end() ? found->second : types_.emplace(type, makeElementType(type)).first->second;
  }

  const std::map<std::string, std::vector<int>>& groups(int dimension) const {
    return groups_[static_cast<std::size_t>(dimension)];
  }

  std::vector<std::string> names(int dimension) const {
    std::vector<std::string> result;
    for (const auto& group : groups(dimension))
      result.push_back(group.first);
    return result;
  }

  // Files may name what is not meshed.
  bool hasCells(const std::string& group) const {
    const std::vector<int>& all = groups(dimension_).at(group);
    return std::any_of(all.begin(), all.end(), [this](int entity) {
      const Elements elements = elementsOf(dimension_, entity);
      return std::any_of(elements.tags.begin(), elements.tags.end(),
                         [](const std::vector<Tag>& tags) { return !tags.empty(); });
    });
  }

  const std::vector<int>& entities(const std::string& body, const std::string& group) const {
    const auto found = groups(dimension_).find(group);
    if (found != groups(dimension_).end())
      return found->second;
    const std::string what = "body " + quoted(body) + ": \"" + path_ + "\" has no physical " +
                             entityName(dimension_) + " " + quoted(group);
    for (int other = 0; other < 4; ++other)
      if (groups(other).count(group) != 0)
        throw InputError(what + "; that is a " + entityName(other) + " there. The " + entityName(dimension_) +
                         "s are: " + listed(names(dimension_)));
    const std::string nearest = nearestName(group, names(dimension_));
    throw InputError(what + (nearest.empty() ? "" : "; did you mean " + quoted(nearest) + "?") + " There " +
                     (names(dimension_).empty() ? "are none: add Physical groups to the geometry"
                                                : "are: " + listed(names(dimension_))));
  }

  // Of the cells of a body.
  std::vector<CellType> typesOf(const GmshBody& body) {
    std::map<int, std::size_t> counts;
    for (const std::string& group : body.groups)
      for (int entity : entities(body.name, group)) {
        const Elements& elements = cells_[entity] = elementsOf(dimension_, entity);
        for (std::size_t k = 0; k < elements.types.size(); ++k)
          counts[elements.types[k]] += elements.tags[k].size();
      }
    const std::string place = "body " + quoted(body.name) + " of \"" + path_ + "\"";
    if (counts.empty())
      throw InputError(place + " has no cells: its groups (" + listed(body.groups) +
                       ") are not meshed. Save the mesh with all physical groups");
    std::string kinds;
    for (const auto& [type, count] : counts) {
      const ElementType& element = elementType(type);
      kinds += (kinds.empty() ? "" : ", ") + std::to_string(count) + " × " +
               (element.ours ? shapeOf(*element.ours).name : element.name);
    }
    for (const auto& [type, count] : counts)
      if (!elementType(type).ours)
        throw InputError(place + " has cells of unsupported type (" + kinds +
                         "). Use triangles of 3 or 6 nodes, quadrilaterals of 4, 8 or 9, tetrahedra of 4 or "
                         "10, wedges of 6, 15 or 18, hexahedra of 8, 20 or 27: Mesh.ElementOrder = 1 or 2");
    std::vector<CellType> types;
    for (const auto& [type, count] : counts)
      types.push_back(*elementType(type).ours);
    return types;
  }

  // In our order of nodes.
  std::vector<Cells> cellsOf(const GmshBody& body, const std::vector<CellType>& types) {
    std::vector<Cells> ofTypes;
    for (CellType type : types)
      ofTypes.push_back({type, {}, {}});
    for (std::size_t region = 0; region < body.groups.size(); ++region)
      for (int entity : entities(body.name, body.groups[region])) {
        const std::string owner = "group " + quoted(body.groups[region]) + " of body " + quoted(body.name);
        const auto [previous, isNew] = owners_.emplace(entity, owner);
        if (!isNew)
          throw InputError("in \"" + path_ + "\", " + entityName(dimension_) + " " + std::to_string(entity) +
                           " belongs to " + previous->second + " and to " + owner +
                           ". A cell belongs to one region of one body: make the groups disjoint");
        const Elements elements = std::move(cells_[entity]);
        for (std::size_t k = 0; k < elements.types.size(); ++k) {
          const ElementType& element = elementType(elements.types[k]);
          std::vector<int> ours;
          ours.reserve(elements.nodes[k].size());
          for (std::size_t first = 0; first < elements.nodes[k].size(); first += element.nodes)
            for (std::size_t i : element.order)
              ours.push_back(placeOf(elements.nodes[k][first + i]));
          dropCopies(shapeOf(*element.ours), ours); // files of format 2 hold cells once for each group
          orient(*element.ours, entity, ours);
          Cells& cells = *std::find_if(ofTypes.begin(), ofTypes.end(),
                                       [&](const Cells& c) { return c.type == *element.ours; });
          cells.nodes.insert(cells.nodes.end(), ours.begin(), ours.end());
          if (body.groups.size() > 1)
            cells.regions.insert(cells.regions.end(), ours.size() / element.nodes, static_cast<int>(region));
        }
      }
    return ofTypes;
  }

  // For messages: what a cell is called in the file.
  std::string cellText(const CellShape& shape, const int* cell) const {
    std::string nodes;
    for (int i = 0; i < shape.corners; ++i)
      nodes += (i == 0 ? "" : ", ") + std::to_string(tags_[at(cell[i])]);
    return "the cell at " + placeText(place(cell[0])) + " with the corner nodes " + nodes;
  }

  // Renumbers mirrored cells: writers of .vtk and others do not care how they go around.
  void orient(CellType type, int entity, std::vector<int>& cells) const {
    const CellShape& shape = shapeOf(type);
    const auto nodes = static_cast<std::size_t>(shape.nodes);
    std::vector<Point> swapped = shape.nodeCoordinates;
    for (Point& x : swapped)
      std::swap(x[0], x[1]);
    const std::vector<std::size_t> order = matched(swapped, shape.nodeCoordinates);
    const CellType linear = linearOf(type);
    const auto gradients = basisGradients(linear, shapeOf(linear).nodeCoordinates);
    std::vector<int> cell(nodes);
    for (std::size_t first = 0; first < cells.size(); first += nodes) {
      const int sign = orientation(shape, gradients, &cells[first]);
      if (sign == 0 && shape.isSimplex)
        throw InputError(
            "in \"" + path_ + "\", " + entityName(dimension_) + " " + std::to_string(entity) + ", " +
            cellText(shape, &cells[first]) + " has no " +
            (dimension_ == 2 ? "area: its corners lie on a line" : "volume: its corners lie in a plane") +
            ". Repair it in Gmsh (Mesh.Optimize) or remove the cell");
      if (sign >= 0)
        continue;
      for (std::size_t i = 0; i < nodes; ++i)
        cell[i] = cells[first + order[i]];
      std::copy(cell.begin(), cell.end(), cells.begin() + static_cast<std::ptrdiff_t>(first));
    }
  }

  // Neighbours that cover each other, which no sign of a Jacobian tells.
  void requireUnfolded(const BodyMesh& body, const MatchedSides& matched,
                       const std::vector<int>& cells) const {
    const std::optional<std::pair<Side, Side>> folded = foldedSides(body.mesh, matched);
    if (!folded)
      return;
    const CellShape& shape = shapeOf(body.mesh.cellType);
    const auto cellOf = [&](const Side& side) {
      return cellText(shape,
                      &cells[static_cast<std::size_t>(side.cell) * static_cast<std::size_t>(shape.nodes)]);
    };
    throw InputError("in \"" + path_ + "\", body " + quoted(body.name) + ", " + cellOf(folded->first) +
                     " and " + cellOf(folded->second) +
                     " lie on the same side of their common face: the mesh is folded and cells overlap. "
                     "Repair it in Gmsh (a finer mesh, Mesh.Optimize)");
  }

  // 1 or −1 if the Jacobian has this sign at every corner of the cell with straight edges; 0 otherwise, which
  // is left for the integration to judge.
  // @param gradients of the basis of first order at the corners
  int orientation(const CellShape& shape, const std::vector<std::vector<Point>>& gradients,
                  const int* cell) const {
    std::size_t positive = 0, negative = 0;
    for (const std::vector<Point>& atCorner : gradients) {
      std::array<Point, 3> frame{};
      if (dimension_ == 2)
        frame[2] = {0, 0, 1};
      double most = 1.0; // the square of the largest Jacobian that columns of these lengths can have
      for (std::size_t d = 0; d < at(dimension_); ++d) {
        for (std::size_t k = 0; k < gradients.size(); ++k)
          if (atCorner[k][d] != 0.0)
            frame[d] = sum(frame[d], scaled(atCorner[k][d], place(cell[k])));
        most *= dot(frame[d], frame[d]);
      }
      const double jacobian = dot(frame[0], cross(frame[1], frame[2]));
      constexpr double rounding = 1e-14;
      if (shape.isSimplex)
        return jacobian * jacobian <= rounding * rounding * most ? 0 : jacobian > 0.0 ? 1 : -1;
      positive += jacobian > 0.0 ? 1 : 0;
      negative += jacobian < 0.0 ? 1 : 0;
    }
    return positive == gradients.size() ? 1 : negative == gradients.size() ? -1 : 0;
  }

  // @param numbers of the body's nodes, by place; −1: not one of them.
  void requirePlane(const std::string& body, const std::vector<int>& numbers) const {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    Point least = {infinite, infinite, infinite}, most = {-infinite, -infinite, -infinite};
    for (std::size_t node = 0; node < numbers.size(); ++node)
      for (std::size_t d = 0; d < 3 && numbers[node] >= 0; ++d) {
        least[d] = std::min(least[d], coordinates_[3 * node + d]);
        most[d] = std::max(most[d], coordinates_[3 * node + d]);
      }
    constexpr double tolerance = 1e-9; // relative: files hold coordinates with some 16 digits
    const double size = std::max(most[0] - least[0], most[1] - least[1]);
    if (most[2] - least[2] > tolerance * size) {
      std::ostringstream heights;
      heights << least[2] << " to " << most[2];
      throw InputError("body " + quoted(body) + " of \"" + path_ + "\" reaches from z = " + heights.str() +
                       ", but a body of dimension 2 must lie in a plane z = constant. Rotate it into the x-y "
                       "plane; if it is the surface of a solid (.stl), mesh the volume first");
    }
  }

  void nameSides(BodyMesh& body, const MatchedSides& matched, const std::vector<int>& numbers) {
    const std::vector<Side> boundary = boundarySides(matched);
    body.mesh.boundary = nodesOf(body.mesh, boundary);
    std::map<std::vector<int>, Side> byCorners;
    for (const Side& side : boundary) {
      std::vector<int> nodes = body.mesh.nodesOf(side);
      nodes.resize(at(shapeOf(body.mesh.typeOf(side)).corners));
      std::sort(nodes.begin(), nodes.end());
      byCorners.emplace(nodes, side);
    }
    for (const auto& [name, entities] : groups(dimension_ - 1)) {
      std::vector<Side> sides;
      std::vector<int>& inside = body.nodes[name]; // of sides that are not on the boundary
      for (int entity : entities) {
        const Elements elements = elementsOf(dimension_ - 1, entity);
        for (std::size_t k = 0; k < elements.types.size(); ++k) {
          const ElementType& element = elementType(elements.types[k]);
          for (std::size_t first = 0; first < elements.nodes[k].size(); first += element.nodes) {
            std::vector<int> nodes;
            for (std::size_t i = 0; i < element.corners; ++i) {
              const int number = numbers[at(placeOf(elements.nodes[k][first + i]))];
              if (number >= 0)
                nodes.push_back(number);
            }
            std::sort(nodes.begin(), nodes.end());
            const auto side = byCorners.find(nodes);
            if (side != byCorners.end())
              sides.push_back(side->second);
            else if (nodes.size() == element.corners)
              for (std::size_t i = 0; i < element.nodes; ++i)
                inside.push_back(numbers[at(placeOf(elements.nodes[k][first + i]))]);
          }
        }
      }
      const auto rank = [](const Side& s) { return std::make_pair(s.cell, s.side); };
      std::sort(sides.begin(), sides.end(), [&](const Side& a, const Side& b) { return rank(a) < rank(b); });
      sides.erase(std::unique(sides.begin(), sides.end(),
                              [&](const Side& a, const Side& b) { return rank(a) == rank(b); }),
                  sides.end());
      if (!sides.empty())
        body.sides[name] = sides;
      std::sort(inside.begin(), inside.end());
      inside.erase(std::unique(inside.begin(), inside.end()), inside.end());
      if (inside.empty())
        body.nodes.erase(name);
    }
  }

  void nameNodes(BodyMesh& body, const std::vector<int>& numbers) const {
    for (int dimension = 0; dimension < dimension_ - 1; ++dimension)
      for (const auto& [name, entities] : groups(dimension)) {
        std::vector<int> nodes;
        for (int entity : entities)
          for (const std::vector<Tag>& ofType : elementsOf(dimension, entity).nodes)
            for (Tag node : ofType)
              if (const int number = numbers[at(placeOf(node))]; number >= 0)
                nodes.push_back(number);
        if (nodes.empty())
          continue;
        std::vector<int>& all = body.nodes[name]; // a point and a curve may have one name
        all.insert(all.end(), nodes.begin(), nodes.end());
        std::sort(all.begin(), all.end());
        all.erase(std::unique(all.begin(), all.end()), all.end());
      }
  }

  // Scalar values at nodes, as far as the file has them for all nodes of the body.
  void addFields(BodyMesh& body, const std::vector<int>& numbers) const {
    for (int view : gmsh::view::getTags()) {
      const auto [kind, tags, data, components] = gmsh::view::getModelData(view);
      if (kind != "NodeData" || components != 1)
        continue;
      std::vector<double> values(at(body.mesh.numberOfNodes()), std::numeric_limits<double>::quiet_NaN());
      for (std::size_t k = 0; k < tags.size(); ++k)
        if (const int number = numbers[at(placeOf(tags[k]))]; number >= 0 && !data[k].empty())
          values[at(number)] = data[k].front();
      if (std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); }))
        body.fields[gmsh::view::getName(view)] = std::move(values);
    }
  }

  std::string path_;
  int dimension_;
  Groups groups_;
  std::vector<Tag> tags_; // of all nodes, rising
  Tag firstTag_ = 0;
  std::vector<double> coordinates_; // of all nodes
  std::map<int, ElementType> types_;
  std::map<int, Elements> cells_;     // of entities, from typeOf() to cellsOf()
  std::map<int, std::string> owners_; // of entities
};

} // namespace

bool canReadGmsh() {
  return true;
}

std::vector<BodyMesh> readGmsh(const std::string& path, const std::vector<GmshBody>& bodies, int dimension,
                               const GmshMeshing& meshing) {
  HARMOS_REQUIRE(dimension == 0 || dimension == 2 || dimension == 3, "bodies have two or three dimensions");
  try {
    const GmshSession session(path);
    Reader reader(path, dimension, meshing);
    std::vector<BodyMesh> result;
    for (const GmshBody& body : bodies.empty() ? reader.eachGroup() : bodies)
      for (BodyMesh& block : reader.body(body))
        result.push_back(std::move(block));
    return result;
  } catch (const gmsh::GmshFailure& failure) {
    throwGmshError(path, failure.what());
  }
}

} // namespace Harmos::fem

#else

namespace Harmos::fem {

bool canReadGmsh() {
  return false;
}

std::vector<BodyMesh> readGmsh(const std::string& path, const std::vector<GmshBody>&, int,
                               const GmshMeshing&) {
  throw InputError("\"" + path +
                   "\" cannot be read: Harmos was built without Gmsh. Install libgmsh-dev and configure with "
                   "-DHARMOS_ENABLE_GMSH=ON");
}

} // namespace Harmos::fem

#endif
