// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ShapeGradient.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_StrainOperator.hpp"

#include <algorithm>

// With a projected dilatation a cell's part of vᵀ K u is Σ_q w σ̄(u) : ε̄(v), ε̄ = ε + (d̄ − d)/3 I, where d =
// div and d̄ = Σ_b ψ_b m_b with G m = Σ_q w ψ d, G = Σ_q w ψ ψᵀ. With p = tr σ̄/3 and its own projection p̄ =
// Σ_b ψ_b c_b the derivative along δ is
//
//   Σ_q δw σ̄(u):ε̄(v) + w [(σ̄(u) − p I) : δε(v) + p δd̄(v)] + w [the same with u and v exchanged],
//
//   Σ_q w p δd̄ = Σ_q δw p̄ (d − d̄) + w [p̄ δd + (p − p̄) δψ·m + (d − d̄) δψ·c],
//
// the latter by δm = G⁻¹(δ(Σ w ψ d) − δG m). Projections onto 1, x, y, z do not depend on the centre and the
// length by which these are made free of units, so that both may be held: δψ_k = φ_a / length.

namespace Harmos::fem {
namespace {

// Places of the entries of a tensor in a Voigt list.
constexpr std::size_t voigt[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

// A displacement field at a quadrature point.
struct FieldAt {
  double gradient[3][3]; // [component][direction]
  Voigt strain, stress;  // ε̄ and σ̄
  double dilatation = 0.0, pressure = 0.0;
  double dilatationExcess = 0.0, pressureExcess = 0.0; // d − d̄, p − p̄
};

// One of the two fields on a cell.
struct CellField {
  std::vector<double> values; // node by node
  std::vector<FieldAt> at;
  std::array<double, 4> dilatations{}, pressures{}; // m and c
};

// Derivative of vᵀ K u on one cell after another.
class CellShapeGradient {
 public:
  CellShapeGradient(const Mesh& mesh, const CellIntegrator& cell, const Elasticity& elasticity)
      : mesh_(mesh),
        cell_(cell),
        dimension_(static_cast<std::size_t>(mesh.dimension())),
        nodes_(static_cast<std::size_t>(cell.basisSize())),
        points_(static_cast<std::size_t>(cell.points())),
        stiffness_(stiffnesses(elasticity)),
        projected_(isProjected(mesh, elasticity)),
        space_(mesh, cell) {
    for (CellField& field : fields_) {
      field.values.resize(nodes_ * dimension_);
      field.at.resize(points_);
    }
  }

  // Of the cell that the integrator has turned to: adds to the gradient of the mesh.
  void add(int c, const std::vector<double>& v, const std::vector<double>& u, std::vector<double>& gradient) {
    const int* members = mesh_.cell(c);
    gather(members, v, fields_[0]);
    gather(members, u, fields_[1]);
    setStrains(fields_[0]);
    setStrains(fields_[1]);
    if (projected_) {
      setGram();
      project(&FieldAt::dilatation, &CellField::dilatations, &FieldAt::dilatationExcess);
      addProjection(fields_[0]);
      addProjection(fields_[1]);
    }
    setStresses(stiffnessOf(stiffness_, mesh_.region(c)), fields_[0]);
    setStresses(stiffnessOf(stiffness_, mesh_.region(c)), fields_[1]);
    if (projected_)
      project(&FieldAt::pressure, &CellField::pressures, &FieldAt::pressureExcess);
    for (std::size_t q = 0; q < points_; ++q)
      addPoint(q, members, gradient);
  }

 private:
  void gather(const int* members, const std::vector<double>& all, CellField& field) const {
    for (std::size_t i = 0; i < nodes_; ++i)
      for (std::size_t m = 0; m < dimension_; ++m)
        field.values[i * dimension_ + m] = all[static_cast<std::size_t>(members[i]) * dimension_ + m];
  }

  void setStrains(CellField& field) const {
    for (std::size_t q = 0; q < points_; ++q) {
      FieldAt& f = field.at[q];
      f = {};
      for (std::size_t i = 0; i < nodes_; ++i) {
        const Point& g = cell_.gradient(static_cast<int>(i), static_cast<int>(q));
        for (std::size_t m = 0; m < dimension_; ++m)
          for (std::size_t n = 0; n < dimension_; ++n)
            f.gradient[m][n] += field.values[i * dimension_ + m] * g[n];
      }
      for (std::size_t m = 0; m < dimension_; ++m) {
        f.dilatation += f.gradient[m][m];
        for (std::size_t n = 0; n < dimension_; ++n)
          f.strain[voigt[m][n]] += f.gradient[m][n];
      }
    }
  }

  void setGram() {
    space_.update();
    const std::size_t n = space_.size();
    gram_.assign(n * n, 0.0);
    for (std::size_t q = 0; q < points_; ++q) {
      const double* psi = space_.at(q);
      for (std::size_t a = 0; a < n; ++a)
        for (std::size_t b = 0; b < n; ++b)
          gram_[a * n + b] += cell_.measure(static_cast<int>(q)) * psi[a] * psi[b];
    }
  }

  // Coefficients of the projection of a number at the points, and what it leaves, of both fields.
  void project(double FieldAt::*number, std::array<double, 4> CellField::*coefficients,
               double FieldAt::*excess) {
    const std::size_t n = space_.size();
    factor_ = gram_;
    moments_.assign(2 * n, 0.0);
    for (std::size_t k = 0; k < 2; ++k)
      for (std::size_t q = 0; q < points_; ++q)
        for (std::size_t a = 0; a < n; ++a)
          moments_[k * n + a] +=
              cell_.measure(static_cast<int>(q)) * space_.at(q)[a] * fields_[k].at[q].*number;
    solveSmall(static_cast<int>(n), factor_, 2, moments_.data());
    for (std::size_t k = 0; k < 2; ++k) {
      std::copy_n(moments_.begin() + static_cast<std::ptrdiff_t>(k * n), n,
                  (fields_[k].*coefficients).begin());
      for (FieldAt& f : fields_[k].at) {
        const double* psi = space_.at(static_cast<std::size_t>(&f - fields_[k].at.data()));
        f.*excess = f.*number;
        for (std::size_t a = 0; a < n; ++a)
          f.*excess -= psi[a] * moments_[k * n + a];
      }
    }
  }

  static void addProjection(CellField& field) {
    for (FieldAt& f : field.at)
      for (std::size_t r = 0; r < 3; ++r)
        f.strain[r] -= f.dilatationExcess / 3.0;
  }

  static void setStresses(const VoigtMatrix& material, CellField& field) {
    for (FieldAt& f : field.at) {
      for (std::size_t r = 0; r < 6; ++r)
        for (std::size_t k = 0; k < 6; ++k)
          f.stress[r] += material[r][k] * f.strain[k];
      f.pressure = (f.stress[0] + f.stress[1] + f.stress[2]) / 3.0;
    }
  }

  // Without projection all excesses are zero, and what follows is the formula of the header.
  void addPoint(std::size_t q, const int* members, std::vector<double>& gradient) const {
    const int iq = static_cast<int>(q);
    const double weight = cell_.measure(iq);
    double density = 0.0;      // goes with ∂_k φ_a
    double shift[3] = {};      // [k], goes with φ_a
    double turning[3][3] = {}; // [k][n], goes with ∂_n φ_a
    for (std::size_t r = 0; r < 6; ++r)
      density += weight * fields_[1].at[q].stress[r] * fields_[0].at[q].strain[r];
    for (std::size_t field = 0; field < 2; ++field) {
      const FieldAt &f = fields_[field].at[q], &other = fields_[1 - field].at[q];
      for (std::size_t m = 0; m < dimension_; ++m)
        for (std::size_t n = 0; n < dimension_; ++n) {
          const double stress = weight * (f.stress[voigt[m][n]] - (m == n ? f.pressureExcess : 0.0));
          for (std::size_t k = 0; k < dimension_; ++k)
            turning[k][n] += stress * other.gradient[m][k];
        }
      density += weight * (f.pressure - f.pressureExcess) * other.dilatationExcess;
      for (std::size_t k = 0; k + 1 < space_.size(); ++k)
        shift[k] += weight / space_.length() *
                    (f.pressureExcess * fields_[1 - field].dilatations[k + 1] +
                     other.dilatationExcess * fields_[field].pressures[k + 1]);
    }
    for (std::size_t i = 0; i < nodes_; ++i) {
      const Point& g = cell_.gradient(static_cast<int>(i), iq);
      const double value = cell_.value(static_cast<int>(i), iq);
      double* target = gradient.data() + static_cast<std::size_t>(members[i]) * dimension_;
      for (std::size_t k = 0; k < dimension_; ++k) {
        double sum = density * g[k] + shift[k] * value;
        for (std::size_t n = 0; n < dimension_; ++n)
          sum -= turning[k][n] * g[n];
        target[k] += sum;
      }
    }
  }

  const Mesh& mesh_;
  const CellIntegrator& cell_;
  std::size_t dimension_, nodes_, points_;
  std::vector<VoigtMatrix> stiffness_;
  bool projected_;
  DilatationSpace space_;
  std::array<CellField, 2> fields_; // v and u
  std::vector<double> gram_, factor_, moments_;
};

} // namespace

std::vector<double> shapeGradient(const Mesh& mesh, const Elasticity& elasticity,
                                  const std::vector<double>& v, const std::vector<double>& u) {
  HARMOS_REQUIRE(v.size() == mesh.coordinates.size() && u.size() == mesh.coordinates.size(),
                 "a shape gradient needs as many nodal values as the mesh has coordinates");
  const ReferenceElement element(mesh.cellType, stiffnessDegree(mesh.cellType, elasticity.integration));
  CellIntegrator cell(mesh, element);
  CellShapeGradient derivative(mesh, cell, elasticity);
  std::vector<double> gradient(mesh.coordinates.size(), 0.0);
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    derivative.add(c, v, u, gradient);
  }
  return gradient;
}

// The rule of stiffness matrices integrates Jacobians exactly: these are of degree d − 1 or 2d − 1 in each
// direction on cells of products, and of total degree d on curved simplices.
double measureOf(const Mesh& mesh) {
  const ReferenceElement element(mesh.cellType, stiffnessDegree(mesh.cellType));
  CellIntegrator cell(mesh, element);
  double sum = 0.0;
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    sum += cell.size();
  }
  return sum;
}

std::vector<double> shapeGradientOfMeasure(const Mesh& mesh) {
  const ReferenceElement element(mesh.cellType, stiffnessDegree(mesh.cellType));
  CellIntegrator cell(mesh, element);
  const auto dimension = static_cast<std::size_t>(mesh.dimension());
  std::vector<double> gradient(mesh.coordinates.size(), 0.0);
  for (int c = 0; c < mesh.numberOfCells(); ++c) {
    cell.turnTo(c);
    for (int i = 0; i < cell.basisSize(); ++i) {
      double* target = gradient.data() + static_cast<std::size_t>(mesh.cell(c)[i]) * dimension;
      for (int q = 0; q < cell.points(); ++q)
        for (std::size_t k = 0; k < dimension; ++k)
          target[k] += cell.measure(q) * cell.gradient(i, q)[k];
    }
  }
  return gradient;
}

} // namespace Harmos::fem
