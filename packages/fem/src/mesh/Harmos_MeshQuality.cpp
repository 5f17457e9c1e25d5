// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_MeshQuality.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_PointAlgebra.hpp"
#include "Harmos_ReferenceElement.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::fem {
namespace {

using Frame = std::array<Point, 3>; // columns of a Jacobian; in the plane the third is e_z

double determinant(const Frame& j) {
  return dot(cross(j[0], j[1]), j[2]);
}

// A quality of a cell, and the sample where it is least.
struct Least {
  double quality = std::numeric_limits<double>::infinity();
  std::size_t sample = 0;

  // What is not a number counts as worst.
  void take(double value, std::size_t k) {
    const double finite = std::isfinite(value) ? value : -std::numeric_limits<double>::infinity();
    if (finite < quality) {
      quality = finite;
      sample = k;
    }
  }
};

// 0 for cells that have shrunk to a point.
double ratio(double value, double scale) {
  return scale == 0.0 ? 0.0 : value / scale;
}

// Jacobians at samples of one cell after another.
class Samples {
 public:
  explicit Samples(CellType type)
      : shape_(shapeOf(type)), dimension_(static_cast<std::size_t>(shape_.dimension)) {
    const Quadrature rule = quadratureOn(type, shape_.stiffnessDegree); // the points of stiffness matrices
    points_ = rule.points;
    weights_ = rule.weights;
    // Jacobians of simplices of the first order are constant.
    if (!shape_.isSimplex || shape_.order > 1)
      points_.insert(points_.end(), shape_.nodeCoordinates.begin(), shape_.nodeCoordinates.end());
    gradients_ = basisGradients(type, points_);
    values_ = basisValues(type, points_);
    frames_.resize(points_.size());
  }

  std::size_t dimension() const { return dimension_; }
  std::size_t size() const { return points_.size(); }
  const Frame& frame(std::size_t k) const { return frames_[k]; }

  void turnTo(const Mesh& mesh, int cell) {
    const int* nodes = mesh.cell(cell);
    const Point first = mesh.local(nodes[0]);
    for (Frame& frame : frames_) {
      frame = {};
      if (dimension_ == 2)
        frame[2] = {0.0, 0.0, 1.0};
    }
    for (std::size_t i = 1; i < shape_.nodeCoordinates.size(); ++i) {
      const Point x = difference(mesh.local(nodes[i]), first);
      for (std::size_t k = 0; k < size(); ++k)
        for (std::size_t j = 0; j < dimension_; ++j)
          frames_[k][j] = sum(frames_[k][j], scaled(gradients_[k][i][j], x));
    }
  }

  // Mean of det J: size of the cell over that of the reference cell.
  double mean() const {
    double sum = 0.0, weights = 0.0;
    for (std::size_t q = 0; q < weights_.size(); ++q) {
      sum += weights_[q] * determinant(frames_[q]);
      weights += weights_[q];
    }
    return sum / weights;
  }

  // Product of the lengths of the sides of a sample's frame, for which equilateral cells have det J.
  double lengths(std::size_t k) const {
    const Frame& frame = frames_[k];
    if (shape_.isWedge)
      return lengthsOfSimplex(frame, 2) * norm(frame[2]);
    return shape_.isSimplex ? lengthsOfSimplex(frame, dimension_)
                            : norm(frame[0]) * norm(frame[1]) * norm(frame[2]);
  }

  // Position of a sample relative to the anchor.
  Point position(const Mesh& mesh, int cell, std::size_t k) const {
    Point x{};
    for (std::size_t i = 0; i < values_[k].size(); ++i)
      x = sum(x, scaled(values_[k][i], mesh.local(mesh.cell(cell)[i])));
    return x;
  }

 private:
  static double lengthsOfSimplex(const Frame& frame, std::size_t dimension) {
    std::array<Point, 4> corners{};
    std::copy_n(frame.begin(), dimension, corners.begin() + 1);
    double most = 0.0;
    for (std::size_t c = 0; c <= dimension; ++c) {
      double product = 1.0;
      for (std::size_t other = 0; other <= dimension; ++other)
        if (other != c)
          product *= norm(difference(corners[other], corners[c]));
      most = std::max(most, product);
    }
    // det J of an equilateral triangle and tetrahedron with sides of length 1.
    return most * (dimension == 2 ? std::sqrt(0.75) : std::sqrt(0.5));
  }

  const CellShape& shape_;
  std::size_t dimension_;
  std::vector<Point> points_; // of the rule first
  std::vector<double> weights_;
  std::vector<std::vector<Point>> gradients_;
  std::vector<std::vector<double>> values_;
  std::vector<Frame> frames_;
};

// ‖F‖² of the motion that takes one frame to the other: Σ (a_j·a_k)(b^j·b^k), with b^j dual to the frame
// before.
double squaredNorm(const Frame& before, double size, const Frame& after, std::size_t dimension) {
  Frame dual;
  for (std::size_t j = 0; j < 3; ++j)
    dual[j] = scaled(1.0 / size, cross(before[(j + 1) % 3], before[(j + 2) % 3]));
  double sum = 0.0;
  for (std::size_t j = 0; j < dimension; ++j)
    for (std::size_t k = 0; k < dimension; ++k)
      sum += dot(after[j], after[k]) * dot(dual[j], dual[k]);
  return sum;
}

// Visits each cell of a mesh with its quality.
template<class Visit>
void visitQualities(const Mesh& mesh, Visit&& visit) {
  Samples samples(mesh.cellType);
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    samples.turnTo(mesh, c);
    const double mean = samples.mean();
    Least least;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const double det = determinant(samples.frame(k));
      least.take(ratio(det, std::max(mean, samples.lengths(k))), k);
    }
    visit(c, least, samples);
  }
}

template<class Visit>
void visitQualities(const Mesh& before, const Mesh& after, Visit&& visit) {
  HARMOS_REQUIRE(before.cellType == after.cellType && before.cells == after.cells,
                 "a motion is judged between meshes of the same cells");
  Samples old(before.cellType), samples(after.cellType);
  const std::size_t d = samples.dimension();
  for (int c = 0; c < after.numberOfCells(); ++c) {
    old.turnTo(before, c);
    samples.turnTo(after, c);
    const double size = old.mean();
    HARMOS_REQUIRE(size > 0.0, "cell " + std::to_string(c) + " is tangled before it is moved");
    const double growth = samples.mean() / size;
    Least least;
    for (std::size_t k = 0; k < samples.size(); ++k) {
      const double det = determinant(old.frame(k));
      if (!(det > 0.0))
        continue;
      const double norm2 = squaredNorm(old.frame(k), det, samples.frame(k), d);
      const double bound = std::pow(norm2 / static_cast<double>(d), 0.5 * static_cast<double>(d));
      least.take(ratio(determinant(samples.frame(k)) / det, std::max(growth, bound)), k);
    }
    visit(c, least, samples);
  }
}

// Keeps the worst of the cells that it is shown.
struct WorstOf {
  const PlacedMesh& mesh;
  CellQuality worst;

  void operator()(int c, const Least& least, const Samples& samples) {
    if (least.quality < worst.quality)
      worst = {c, sum(mesh.anchor, samples.position(*mesh.mesh, c, least.sample)), least.quality};
  }
};

} // namespace

std::vector<double> cellQualities(const Mesh& mesh) {
  std::vector<double> result;
  visitQualities(mesh, [&](int, const Least& least, const Samples&) { result.push_back(least.quality); });
  return result;
}

std::vector<double> cellQualities(const Mesh& before, const Mesh& after) {
  std::vector<double> result;
  visitQualities(before, after,
                 [&](int, const Least& least, const Samples&) { result.push_back(least.quality); });
  return result;
}

CellQuality worstCell(const PlacedMesh& mesh) {
  WorstOf worst{mesh, {}};
  visitQualities(*mesh.mesh, worst);
  return worst.worst;
}

CellQuality worstCell(const PlacedMesh& before, const PlacedMesh& after) {
  WorstOf worst{after, {}};
  visitQualities(*before.mesh, *after.mesh, worst);
  return worst.worst;
}

std::string textOf(const PlacedMesh& mesh, const CellQuality& quality) {
  return "cell " + std::to_string(quality.cell) + " (" + shapeOf(mesh.mesh->cellType).name + ") at " +
         placeText(quality.place) + ": quality " + scientific(quality.quality);
}

} // namespace Harmos::fem
