// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Composite.hpp"

#include "Harmos_Adhesion.hpp"
#include "Harmos_Contact.hpp"
#include "Harmos_Errors.hpp"
#include "Harmos_Friction.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_Partition.hpp"
#include "Harmos_PrescribedDisplacement.hpp"
#include "Harmos_Tie.hpp"
#include "Harmos_TornBody.hpp"

#include <cmath>
#include <memory>
#include <random>

namespace Harmos::composite {
namespace {

using fem::BodyMesh;
using fem::PlacedMesh;
using fem::Point;

// One kind of body, fibre or matrix, of all cells: cut in the same way in each, since the grids differ in
// their coordinates alone. Cells without scatter share their meshes.
class Pieces {
 public:
  using Make = BodyMesh (*)(const Cell&);

  Pieces(const Cell& regular, Make make, int wanted)
      : make_(make),
        partition_(fem::partitionCells(make(regular), wanted, {fem::PartitionMethod::Metis})),
        regular_(fem::tear(make(regular), partition_.part, partition_.parts, 0)) {}

  int count() const { return partition_.parts; }

  // A piece of a cell, relative to the cell's centre; numbers are those of the cell's own nodes.
  PlacedMesh piece(const Cell& cell, bool isRegular, int part) const {
    const auto k = static_cast<std::size_t>(part);
    return isRegular ? regular_[k] : fem::tear(make_(cell), partition_.part, partition_.parts, 0)[k];
  }

 private:
  Make make_;
  fem::Partition partition_;
  std::vector<PlacedMesh> regular_;
};

// All that the closures of a scene share.
struct Layout {
  Sample sample;
  std::vector<Cell> cells; // row by row
  bool isRegular;
  std::unique_ptr<const Pieces> fibres, matrix;

  Point centre(int cell) const {
    return {(cell % sample.columns + 0.5) * sample.cell.size,
            (cell / sample.columns + 0.5) * sample.cell.size, 0.0};
  }
  int perSide() const { return sample.cell.nodesAround() / 4; }
  long long latticeWidth() const { return static_cast<long long>(sample.columns) * perSide() + 1; }
  long long latticeNodes() const {
    return latticeWidth() * (static_cast<long long>(sample.rows) * perSide() + 1);
  }
  // Nodes of a cell of matrix that no other cell has: all but those on the square.
  long long innerNodes() const {
    return static_cast<long long>(sample.cell.nodesAround()) * sample.cell.matrixLayers *
           fem::shapeOf(sample.cell.cellType).order;
  }
  long long fibreNodes() const { // an upper bound; numbers may have gaps
    const long long n = perSide(), p = fem::shapeOf(sample.cell.cellType).order;
    return (n + 1) * (n + 1) + 4 * n * sample.cell.fibreLayers * p;
  }
  int cellCount() const { return sample.columns * sample.rows; }

  // Global number of a node of a cell's matrix: first the lattice on the lines between the cells, row by row,
  // then the inner nodes cell by cell.
  long long matrixNumber(int cell, long long local) const {
    if (local < innerNodes())
      return latticeNodes() + cell * innerNodes() + local;
    const int n = perSide(), place = static_cast<int>(local - innerNodes());
    const int k = place % n;
    const std::array<std::array<int, 2>, 4> onSides = {{{k, 0}, {n, k}, {n - k, n}, {0, n - k}}};
    const auto& at = onSides[static_cast<std::size_t>(place / n)];
    const long long x = static_cast<long long>(cell % sample.columns) * n + at[0],
                    y = static_cast<long long>(cell / sample.columns) * n + at[1];
    return y * latticeWidth() + x;
  }
};

std::string holeName(int cell) {
  return "hole " + std::to_string(cell);
}

PlacedMesh moved(PlacedMesh mesh, const Point& centre) {
  for (std::size_t d = 0; d < 3; ++d)
    mesh.anchor[d] += centre[d];
  return mesh;
}

PlacedMesh matrixPiece(const Layout& layout, int subdomain) {
  const int cell = subdomain / layout.matrix->count(), part = subdomain % layout.matrix->count();
  const Sample& sample = layout.sample;
  PlacedMesh mesh =
      moved(layout.matrix->piece(layout.cells[static_cast<std::size_t>(cell)], layout.isRegular, part),
            layout.centre(cell));
  for (long long& number : mesh.boundaryNumbers)
    number = layout.matrixNumber(cell, number);
  const int column = cell % sample.columns, row = cell / sample.columns;
  const auto keepIf = [&](const char* name, bool outer) {
    if (!outer) {
      mesh.sets.erase(name);
      mesh.sides.erase(name);
    }
  };
  keepIf("left", column == 0);
  keepIf("right", column == sample.columns - 1);
  keepIf("bottom", row == 0);
  keepIf("top", row == sample.rows - 1);
  if (auto set = mesh.sets.extract("hole")) {
    set.key() = holeName(cell);
    mesh.sets.insert(std::move(set));
  }
  if (auto sides = mesh.sides.extract("hole")) {
    sides.key() = holeName(cell);
    mesh.sides.insert(std::move(sides));
  }
  return mesh;
}

std::vector<Cell> scatteredCells(const Sample& sample) {
  std::mt19937 generator(static_cast<unsigned>(sample.seed));
  // Written out: std::uniform_real_distribution may differ from library to library.
  const auto random = [&] { return 2.0 * (static_cast<double>(generator()) / 4294967296.0) - 1.0; };
  std::vector<Cell> cells;
  for (int k = 0; k < sample.columns * sample.rows; ++k) {
    Cell cell = sample.cell;
    cell.radius *= 1.0 + sample.radiusScatter * random();
    cell.centre[0] += sample.offsetScatter * cell.size * random();
    cell.centre[1] += sample.offsetScatter * cell.size * random();
    const double reach = std::max(std::abs(cell.centre[0]), std::abs(cell.centre[1])) + cell.radius;
    if (reach > 0.48 * cell.size)
      throw InputError("the fibre of cell " + std::to_string(k) + " (radius " + scientific(cell.radius, 4) +
                           ") is closer to the side of its cell than 1/50 of its length; reduce \"Volume "
                           "fraction\", \"Radius scatter\" or \"Offset scatter\"",
                       {{"cell", std::to_string(k)}});
    cells.push_back(cell);
  }
  return cells;
}

fem::Dilatation dilatationOf(const Sample& sample, const fem::Material& material) {
  const bool project = sample.dilatation == "projected" ||
                       (sample.dilatation == "auto" && fem::nearlyIncompressible(material));
  return project ? fem::Dilatation::Projected : fem::Dilatation::Full;
}

// A fibre in each cell, as bodies 1, 2, …, and what holds it.
void addFibres(const std::shared_ptr<Layout>& layout, scene::Scene& scene) {
  const Sample& sample = layout->sample;
  const int count = layout->cellCount();
  layout->fibres = std::make_unique<Pieces>(sample.cell, fibreMesh, sample.fibreSubdomains);
  const long long firstFibreNode = layout->latticeNodes() + count * layout->innerNodes();
  for (int k = 0; k < count; ++k) {
    scene::Body fibre;
    fibre.name = "fibre " + std::to_string(k);
    fibre.subdomains = layout->fibres->count();
    fibre.subdomain = [layout, k, firstFibreNode](int part) {
      PlacedMesh mesh =
          moved(layout->fibres->piece(layout->cells[static_cast<std::size_t>(k)], layout->isRegular, part),
                layout->centre(k));
      for (long long& number : mesh.boundaryNumbers)
        number += firstFibreNode + k * layout->fibreNodes();
      return mesh;
    };
    fibre.materials = {sample.interface == Sample::Interface::Homogeneous ? sample.matrix : sample.fibre};
    fibre.dilatation = dilatationOf(sample, fibre.materials[0]);
    scene.bodies.push_back(std::move(fibre));

    effects::SurfacePair circle;
    circle.first = {k + 1, "surface"};
    circle.second = {0, holeName(k)};
    circle.coupling = effects::Coupling::Nodes;
    // The circle's own normals: with those of its facets a fibre would rotate almost, but not quite, freely.
    Point centre = layout->centre(k);
    for (std::size_t d = 0; d < 2; ++d)
      centre[d] += layout->cells[static_cast<std::size_t>(k)].centre[d];
    circle.normal = [centre](const Point& x) {
      const double dx = x[0] - centre[0], dy = x[1] - centre[1], r = std::hypot(dx, dy);
      return Point{dx / r, dy / r, 0.0};
    };
    if (sample.interface == Sample::Interface::Contact || sample.interface == Sample::Interface::Adhesive) {
      const auto contact =
          std::make_shared<effects::Contact>(std::move(circle), 0.0, scene.bodies.back().name);
      scene.effects.push_back(contact);
      if (sample.interface == Sample::Interface::Adhesive)
        scene.effects.push_back(
            std::make_shared<effects::Adhesion>(contact, sample.adhesion.value(), scene.bodies.back().name));
      if (sample.slipBound > 0.0)
        scene.effects.push_back(
            std::make_shared<effects::Friction>(contact, sample.slipBound, scene.bodies.back().name));
      if (sample.frictionCoefficient > 0.0)
        scene.effects.push_back(std::make_shared<effects::Friction>(
            contact, effects::Coulomb(sample.frictionCoefficient), scene.bodies.back().name));
    } else {
      scene.effects.push_back(std::make_shared<effects::Tie>(std::move(circle), scene.bodies.back().name));
    }
  }
}

} // namespace

scene::Scene makeScene(const Sample& sample) {
  const auto layout = std::make_shared<Layout>();
  layout->sample = sample;
  layout->isRegular = sample.radiusScatter == 0.0 && sample.offsetScatter == 0.0;
  layout->cells = scatteredCells(sample);
  layout->matrix = std::make_unique<Pieces>(sample.cell, matrixMesh, sample.matrixSubdomains);
  const int count = layout->cellCount();
  const double width = sample.columns * sample.cell.size, height = sample.rows * sample.cell.size;

  scene::Scene scene;
  scene.name = "fibre composite";
  scene.physics = sample.physics;
  scene::Body matrix;
  matrix.name = "matrix";
  matrix.subdomains = count * layout->matrix->count();
  matrix.subdomain = [layout](int k) { return matrixPiece(*layout, k); };
  matrix.materials = {sample.matrix};
  matrix.dilatation = dilatationOf(sample, sample.matrix);
  const double stretch = sample.load == Sample::Load::Compression ? -sample.strain : sample.strain;
  scene.bodies.push_back(std::move(matrix));
  if (sample.interface != Sample::Interface::Holes)
    addFibres(layout, scene);
  const auto move = [&](const char* side, int component, double displacement) {
    scene.effects.push_back(effects::hold({0, side}, component, displacement));
    if (!sample.history.empty())
      scene.timeline.follow(*scene.effects.back(), sample.history);
  };
  scene.effects.push_back(effects::hold({0, "left"}, 0));
  move("right", 0, stretch * width);
  scene.measures = {{"strain", scene.effects.back(), {}, stretch},
                    {"stress", scene.effects.back(), 0, 1.0 / height}};
  scene.effects.push_back(effects::hold({0, "bottom"}, 1));
  if (sample.load == Sample::Load::Biaxial) {
    move("top", 1, stretch * height);
    scene.measures.push_back({"stress_y", scene.effects.back(), 1, 1.0 / width});
  }
  return scene;
}

} // namespace Harmos::composite
