// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_Agreement.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_LocalInverses.hpp"
#include "Harmos_ReplicatedCoarse.hpp"
#include "Harmos_TestModel.hpp"
#include "Harmos_TestQp.hpp"
#include "Harmos_TestScene.hpp"

#include <Teuchos_LAPACK.hpp>
#include <Tpetra_Vector.hpp>

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

namespace Harmos {

/// A block on a grid of subdomains. @param held components that are held at its left side.
struct GridOptions {
  scene::Physics physics = scene::Physics::PlaneStrain;
  std::array<int, 3> subdomains = {4, 2, 1};
  std::array<int, 3> elements = {2, 2, 2};
  std::vector<int> held = {};
};

inline TestModel gridModel(const GridOptions& grid) {
  scene::Scene scene;
  scene.physics = grid.physics;
  fem::StructuredBlock::Options options;
  const bool isSolid = grid.physics == scene::Physics::Solid;
  options.cellType = isSolid ? fem::CellType::Hexahedron8 : fem::CellType::Quadrilateral4;
  for (std::size_t d = 0; d < 3; ++d)
    options.size[d] = grid.subdomains[d];
  options.subdomains = grid.subdomains;
  options.elements = grid.elements;
  scene.bodies.push_back(blockBody("block", options, fem::Material::isotropic(1.0, 0.3)));
  for (int component : grid.held)
    prescribe(scene, {0, "left"}, component);
  const auto comm = testComm();
  const auto owned = scene::decompose(*comm, scene);
  return {scene::assemble(scene, owned), scene::setUpContact(*comm, scene, owned).rows};
}

/// Membranes, a plane and a solid block, each floating.
inline std::vector<GridOptions> gridsOfAllPhysics() {
  using scene::Physics;
  return {{Physics::Membrane, {4, 2, 1}, {3, 3, 1}, {}},
          {Physics::PlaneStrain, {4, 2, 1}, {3, 3, 1}, {}},
          {Physics::Solid, {2, 2, 2}, {2, 2, 2}, {}}};
}

inline feti::ClusterOptions
clusterOptions(int size = 0, feti::ClusterOptions::Joins joins = feti::ClusterOptions::Joins::Faces) {
  feti::ClusterOptions options;
  options.kind = size == 0 ? feti::ClusterOptions::Kind::Rank : feti::ClusterOptions::Kind::Size;
  options.size = size;
  options.joins = joins;
  return options;
}

/// A torn problem with its clusters and their inverse.
struct ClusteredProblem {
  ClusteredProblem(const TestModel& model, const feti::ClusterOptions& clusters,
                   feti::DirichletForm form = feti::DirichletForm::Primal,
                   feti::LocalInverseOptions options = {}, feti::RowWeights weights = feti::RowWeights::None)
      : system(testComm(), model.subdomains, form), constraints(system, model.rows, weights) {
    options.clusters = feti::makeClusters(system, constraints, clusters);
    inverses.emplace(feti::makeLocalInverses(system, constraints, options));
  }

  const feti::Clusters& clusters() const { return inverses->joined()->clusters(); }
  int kernelOf(std::size_t cluster) const {
    const std::vector<std::size_t>& places = clusters().motions().places();
    return static_cast<int>(places[cluster + 1] - places[cluster]);
  }

  feti::SubdomainSystem system;
  feti::Constraints constraints;
  std::optional<feti::LocalInverses> inverses;
};

/// RTα of motions of this rank.
inline feti::TornVector rigid(const feti::RigidMotions& motions, const std::vector<double>& alpha) {
  const std::vector<double> amplitudes = motions.amplitudes(alpha);
  feti::TornVector u = motions.system().zeroVector();
  std::size_t place = 0;
  for (std::size_t i = 0; i < u.size(); ++i)
    for (int k = 0; k < motions.kernel(static_cast<int>(i)).columns; ++k, ++place)
      for (std::size_t j = 0; j < u[i].size(); ++j)
        u[i][j] += amplitudes[place] * motions.kernel(static_cast<int>(i)).column(k)[j];
  return u;
}

/// Numbers without structure, the same on any number of ranks for the same subdomain.
inline feti::TornVector unstructured(const feti::SubdomainSystem& system) {
  feti::TornVector v = system.zeroVector();
  for (std::size_t i = 0; i < v.size(); ++i)
    for (std::size_t j = 0; j < v[i].size(); ++j)
      v[i][j] = std::sin(1.0 + 1.7 * static_cast<double>(j) +
                         0.9 * static_cast<double>(system.subdomain(static_cast<int>(i)).number));
  return v;
}

/// Bu of the averages of a cluster, by weights and rows alone. @note Collective.
inline std::vector<double> averagesOf(const feti::Constraints& constraints,
                                      const feti::Clusters::Cluster& cluster, const MultiVector& bu) {
  HARMOS_REQUIRE(bu.getMap()->isSameAs(*constraints.rowMap()), "a vector of rows");
  const auto view = bu.getLocalViewHost(Tpetra::Access::ReadOnly);
  std::vector<double> result(static_cast<std::size_t>(cluster.averages), 0.0);
  for (const feti::Clusters::Join& join : cluster.joins)
    for (std::size_t q = 0; q < static_cast<std::size_t>(join.count); ++q)
      for (std::size_t k = 0; k < join.rows.size(); ++k)
        result[static_cast<std::size_t>(join.first) + q] +=
            join.weights[q * join.rows.size() + k] * view(static_cast<std::size_t>(join.rows[k]), 0);
  return result;
}

/// The answer of one cluster by the dense matrix of the minimisation that it stands for,
///
///     [K B₀ᵀ N; B₀ 0 0; Nᵀ 0 0] [u; μ; 0] = [f; 0; 0],
///
/// N the motions of the cluster. B₀ is made of the rows of B and U, and of nothing that ClusterInverse has.
/// The matrix is regular only if B₀ has full rank and N is the whole of what K and B₀ leave free.
class DenseCluster {
 public:
  DenseCluster(const ClusteredProblem& problem, std::size_t cluster)
      : members_(problem.clusters().all()[cluster].members) {
    for (int i : members_) {
      places_.push_back(size_);
      size_ += problem.system.matrix(i).rows();
    }
    const feti::Clusters::Cluster& item = problem.clusters().all()[cluster];
    const feti::RigidMotions& motions = problem.clusters().motions();
    const int columns = problem.kernelOf(cluster);
    n_ = size_ + item.averages + columns;
    matrix_ = Dense(n_, n_);
    for (std::size_t m = 0; m < members_.size(); ++m)
      addMember(problem, item, m);
    std::vector<double> alpha(motions.ownColumns().size(), 0.0);
    for (int c = 0; c < columns; ++c) {
      alpha[motions.places()[cluster] + static_cast<std::size_t>(c)] = 1.0;
      const std::vector<double> column = gathered(rigid(motions, alpha));
      kernel_.push_back(column);
      for (int j = 0; j < size_; ++j)
        matrix_(j, size_ + item.averages + c) = matrix_(size_ + item.averages + c, j) =
            column[static_cast<std::size_t>(j)];
      alpha[motions.places()[cluster] + static_cast<std::size_t>(c)] = 0.0;
    }
    factor();
  }

  /// Reciprocal condition number of the matrix.
  double reciprocalCondition() const { return reciprocal_; }
  std::vector<double> gathered(const feti::TornVector& v) const {
    std::vector<double> result;
    for (int i : members_)
      result.insert(result.end(), v[static_cast<std::size_t>(i)].begin(),
                    v[static_cast<std::size_t>(i)].end());
    return result;
  }
  void scatter(const std::vector<double>& from, feti::TornVector& v) const {
    for (std::size_t m = 0; m < members_.size(); ++m) {
      std::vector<double>& mine = v[static_cast<std::size_t>(members_[m])];
      std::copy(from.begin() + places_[m],
                from.begin() + places_[m] + static_cast<std::ptrdiff_t>(mine.size()), mine.begin());
    }
  }
  /// Takes N out.
  void balance(std::vector<double>& v) const {
    for (const std::vector<double>& column : kernel_) {
      double sum = 0.0;
      for (std::size_t j = 0; j < column.size(); ++j)
        sum += column[j] * v[j];
      for (std::size_t j = 0; j < column.size(); ++j)
        v[j] -= sum * column[j];
    }
  }
  /// u, orthogonal to N, of a load in balance.
  std::vector<double> answer(std::vector<double> f) const {
    f.resize(static_cast<std::size_t>(n_), 0.0);
    int info = 0;
    Teuchos::LAPACK<int, double>().GETRS('N', n_, 1, factor_.values.data(), n_, pivots_.data(), f.data(), n_,
                                         &info);
    f.resize(static_cast<std::size_t>(size_));
    return f;
  }

 private:
  void addMember(const ClusteredProblem& problem, const feti::Clusters::Cluster& item, std::size_t m) {
    const int i = members_[m], first = places_[m];
    const LocalMatrix& k = problem.system.matrix(i);
    for (int r = 0; r < k.rows(); ++r)
      for (std::size_t e = k.offsets[static_cast<std::size_t>(r)];
           e < k.offsets[static_cast<std::size_t>(r) + 1]; ++e)
        matrix_(first + r, first + k.columns[e]) += k.values[e];
    const Map& overlap = *problem.constraints.overlapMap();
    const Map& own = *problem.constraints.rowMap();
    for (const feti::Constraints::Entry& entry : problem.constraints.entries(i)) {
      const int row = own.getLocalElement(overlap.getGlobalElement(entry.row));
      for (const feti::Clusters::Join& join : item.joins)
        for (std::size_t place = 0; place < join.rows.size(); ++place)
          for (int q = 0; q < join.count && join.rows[place] == row; ++q) {
            const double value =
                entry.value * join.weights[static_cast<std::size_t>(q) * join.rows.size() + place];
            matrix_(first + entry.dof, size_ + join.first + q) += value;
            matrix_(size_ + join.first + q, first + entry.dof) += value;
          }
    }
  }

  void factor() {
    factor_ = matrix_;
    pivots_.resize(static_cast<std::size_t>(n_));
    std::vector<double> work(4 * static_cast<std::size_t>(n_));
    std::vector<int> integers(static_cast<std::size_t>(n_));
    double norm = 0.0;
    for (int j = 0; j < n_; ++j) {
      double sum = 0.0;
      for (int i = 0; i < n_; ++i)
        sum += std::abs(matrix_(i, j));
      norm = std::max(norm, sum);
    }
    int info = 0;
    Teuchos::LAPACK<int, double> lapack;
    lapack.GETRF(n_, n_, factor_.values.data(), n_, pivots_.data(), &info);
    if (info == 0)
      lapack.GECON('1', n_, factor_.values.data(), n_, norm, &reciprocal_, work.data(), integers.data(),
                   &info);
  }

  std::vector<int> members_, places_;
  int size_ = 0, n_ = 0;
  Dense matrix_{0, 0}, factor_{0, 0};
  std::vector<int> pivots_;
  std::vector<std::vector<double>> kernel_;
  double reciprocal_ = 0.0;
};

} // namespace Harmos
