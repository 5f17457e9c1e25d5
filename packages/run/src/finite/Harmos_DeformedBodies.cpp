// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_DeformedBodies.hpp"

#include "Harmos_CopiesOfNodes.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FiniteElasticity.hpp"
#include "Harmos_Kernel.hpp"
#include "Harmos_MovedSubdomains.hpp"
#include "Harmos_Rendezvous.hpp"
#include "Harmos_RigidTurns.hpp"
#include "Harmos_Tensors.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::run {
namespace {

// What effects add to the matrix of a subdomain.
std::shared_ptr<const LocalMatrix> springsOf(const scene::Scene& scene, const scene::OwnedSubdomain& item) {
  std::vector<MatrixEntry> entries;
  for (const auto& effect : scene.effects) {
    const std::vector<int> bodies = effect->bodies();
    if (std::find(bodies.begin(), bodies.end(), item.body) != bodies.end() &&
        effect->stiffnessKey(scene, item))
      effect->addStiffness(scene, item, entries);
  }
  return entries.empty() ? nullptr
                         : std::make_shared<LocalMatrix>(makeLocalMatrix(
                               item.mesh.mesh->numberOfNodes() * scene.components(), std::move(entries)));
}

// @param displacement null: at rest.
feti::Kernel kernelOf(const fem::Mesh& mesh, const std::vector<double>* displacement) {
  const int components = mesh.dimension();
  if (mesh.isAxisymmetric)
    return feti::translationKernel(mesh.numberOfNodes() * components, components, 1);
  std::vector<double> positions = mesh.coordinates;
  for (std::size_t k = 0; k < positions.size() && displacement != nullptr; ++k)
    positions[k] += (*displacement)[k];
  return feti::rigidBodyKernel(positions, components);
}

} // namespace

DeformedBodies::DeformedBodies(const Teuchos::Comm<int>& comm, const scene::Scene& scene,
                               const std::vector<scene::OwnedSubdomain>& atRest)
    : comm_(comm), scene_(scene), atRest_(atRest) {
  agree(comm, [&] {
    for (std::size_t i = 0; i < atRest.size(); ++i) {
      springs_.push_back(springsOf(scene, atRest[i]));
      states_.push_back(fem::initialStates(*atRest[i].mesh.mesh, elasticityAt(i)));
    }
  });
}

fem::Elasticity DeformedBodies::elasticityAt(std::size_t subdomain) const {
  return elasticityOf(scene_, scene_.bodies[static_cast<std::size_t>(atRest_[subdomain].body)]);
}

fem::TemperatureRise DeformedBodies::riseAt(std::size_t subdomain, double time) const {
  const scene::OwnedSubdomain& item = atRest_[subdomain];
  return {scene_.temperatureRises(time)[static_cast<std::size_t>(item.body)], scene_.nodalRises(item, time)};
}

// Of each subdomain.
std::vector<fem::TemperatureRise> DeformedBodies::risesAt(double time) const {
  std::vector<fem::TemperatureRise> result;
  for (std::size_t i = 0; i < atRest_.size(); ++i)
    result.push_back(riseAt(i, time));
  return result;
}

DeformedBodies::Forces DeformedBodies::forces(const feti::TornVector& displacement, double time) const {
  Forces result;
  std::vector<double> sums(3, 0.0); // stored, dissipated, points that yield
  long long unsound = 0;
  agree(comm_, [&] {
    const std::vector<fem::TemperatureRise> rises = risesAt(time);
    for (std::size_t i = 0; i < atRest_.size() && unsound == 0; ++i) {
      const scene::OwnedSubdomain& item = atRest_[i];
      const std::vector<double>& u = displacement[i];
      fem::FiniteForces forces =
          fem::finiteForces(*item.mesh.mesh, elasticityAt(i), u, rises[i], &states_[i]);
      unsound += forces.leastJacobian > 0.0 && std::isfinite(forces.energy) ? 0 : 1;
      sums[0] += forces.energy;
      sums[1] += forces.dissipated;
      sums[2] += forces.yielding;
      result.yields.push_back(forces.yielding > 0 ? 1 : 0);
      if (springs_[i]) {
        std::vector<double> pulls(u.size());
        springs_[i]->multiply(u.data(), pulls.data());
        for (std::size_t k = 0; k < u.size(); ++k) {
          forces.internal[k] += pulls[k];
          sums[0] += 0.5 * pulls[k] * u[k];
        }
      }
      result.internal.push_back(std::move(forces.internal));
    }
  });
  result.isSound = globalSum(comm_, unsound) == 0;
  globalSum(comm_, sums);
  result.energy = sums[0];
  result.dissipated = sums[1];
  result.yielding = sums[2];
  return result;
}

feti::TornVector DeformedBodies::followingLoads(const feti::TornVector& displacement, double time) const {
  feti::TornVector result;
  std::vector<const scene::Effect*> effects;
  for (const auto& effect : scene_.effects)
    if (effect->finite() != nullptr && effect->finite()->hasFollowingLoads())
      effects.push_back(effect.get());
  if (effects.empty() || !scene_.isFinite())
    return result;
  std::vector<scene::OwnedSubdomain> moved = scene::moved(atRest_, displacement);
  scene::measureParts(comm_, scene_, moved);
  agree(comm_, [&] {
    for (const scene::OwnedSubdomain& item : moved) {
      std::vector<double>& sum = result.emplace_back(displacement[result.size()].size(), 0.0);
      for (const scene::Effect* effect : effects) {
        const std::vector<int> bodies = effect->bodies();
        if (std::find(bodies.begin(), bodies.end(), item.body) == bodies.end())
          continue;
        std::vector<double> load(sum.size(), 0.0);
        effect->finite()->addFollowingLoad(scene_, {atRest_[result.size() - 1], item}, load);
        const double factor = scene_.timeline.factor(*effect, time);
        for (std::size_t k = 0; k < sum.size(); ++k)
          sum[k] += factor * load[k];
      }
    }
  });
  return result;
}

void DeformedBodies::makeTangent(const feti::TornVector& displacement, const std::vector<double>& times,
                                 const std::vector<char>& which, Tangent& tangent) const {
  agree(comm_, [&] {
    tangent.matrices.resize(atRest_.size());
    tangent.kernels.resize(atRest_.size());
    for (std::size_t i = 0; i < atRest_.size(); ++i) {
      if (which[i] == 0)
        continue;
      const scene::OwnedSubdomain& item = atRest_[i];
      LocalMatrix matrix = fem::assembleStrainTangent(*item.mesh.mesh, elasticityAt(i), displacement[i],
                                                      riseAt(i, times[i]), &states_[i]);
      feti::Kernel kernel = kernelOf(*item.mesh.mesh, scene_.isFinite() ? &displacement[i] : nullptr);
      if (springs_[i]) {
        kernel = feti::keptKernel(kernel, *springs_[i]);
        matrix = sum(matrix, *springs_[i]);
      }
      tangent.matrices[i] = std::make_shared<LocalMatrix>(std::move(matrix));
      tangent.kernels[i] = std::make_shared<feti::Kernel>(std::move(kernel));
    }
  });
}

DeformedBodies::States DeformedBodies::statesAfter(const feti::TornVector& displacement, double time) const {
  States result = states_;
  agree(comm_, [&] {
    const std::vector<fem::TemperatureRise> rises = risesAt(time);
    for (std::size_t i = 0; i < atRest_.size(); ++i)
      if (states_[i].size > 0)
        fem::finiteForces(*atRest_[i].mesh.mesh, elasticityAt(i), displacement[i], rises[i], &states_[i],
                          &result[i]);
  });
  return result;
}

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

// Σ(y − ȳ)(x − x̄)ᵀ of nodes that went from x to y, with a one for the axis that the plane lacks.
Matrix covariance(const fem::Mesh& mesh, const std::vector<double>& from, const std::vector<double>& to) {
  const auto m = static_cast<std::size_t>(mesh.dimension()),
             n = static_cast<std::size_t>(mesh.numberOfNodes());
  std::array<double, 3> before{}, after{};
  for (std::size_t k = 0; k < n * m; ++k) {
    before[k % m] += (mesh.coordinates[k] + from[k]) / static_cast<double>(n);
    after[k % m] += (mesh.coordinates[k] + to[k]) / static_cast<double>(n);
  }
  Matrix result{};
  double size = 0.0;
  for (std::size_t k = 0; k < n * m; k += m)
    for (std::size_t a = 0; a < m; ++a)
      for (std::size_t b = 0; b < m; ++b) {
        const double x = mesh.coordinates[k + b] + from[k + b] - before[b];
        result[a][b] += (mesh.coordinates[k + a] + to[k + a] - after[a]) * x;
        size += a == b ? x * x : 0.0;
      }
  if (m == 2)
    result[2][2] = size;
  return result;
}

// The orthogonal factor Q of A = QP by Newton's iteration Q ← ½(Q + Q⁻ᵀ) (Higham: Computing the polar
// decomposition, SIAM J. Sci. Stat. Comput. 7, 1986); none of a matrix that is singular or mirrors.
std::optional<Matrix> rotationOf(Matrix q) {
  constexpr int most = 60;
  double scale = 0.0;
  for (const auto& row : q)
    for (const double entry : row)
      scale = std::max(scale, std::abs(entry));
  for (auto& row : q)
    for (double& entry : row)
      entry /= scale > 0.0 ? scale : 1.0;
  constexpr double singular = 1e-9, converged = 1e-15;
  for (int k = 0; k < most; ++k) {
    const double det = fem::determinant(q);
    if (!(det > singular))
      return std::nullopt;
    const Matrix inverse = fem::inverseTransposed(q, det);
    double change = 0.0;
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) {
        const double next = 0.5 * (q[a][b] + inverse[a][b]);
        change = std::max(change, std::abs(next - q[a][b]));
        q[a][b] = next;
      }
    if (change <= converged)
      break;
  }
  return q;
}

} // namespace

std::vector<std::optional<feti::Frame>> DeformedBodies::frames(const feti::TornVector& from,
                                                               const feti::TornVector& to) const {
  std::vector<std::optional<feti::Frame>> result;
  for (std::size_t i = 0; i < atRest_.size(); ++i) {
    std::optional<feti::Frame>& frame = result.emplace_back();
    // Around an axis nothing turns.
    if (from[i] == to[i] || atRest_[i].mesh.mesh->isAxisymmetric || !scene_.isFinite())
      continue;
    if (const auto q = rotationOf(covariance(*atRest_[i].mesh.mesh, from[i], to[i])))
      frame.emplace(*q, scene_.components());
  }
  return result;
}

feti::TornVector DeformedBodies::turned(const feti::TornVector& displacement,
                                        const feti::TornVector& change) const {
  const auto components = static_cast<std::size_t>(scene_.components());
  feti::TornVector result = displacement;
  RigidTurns turns(scene_.bodies.size(), components);
  for (std::size_t i = 0; i < atRest_.size(); ++i)
    turns.add(atRest_[i].body, atRest_[i].mesh, displacement[i], change[i]);
  turns.sumUp(comm_);
  for (std::size_t i = 0; i < atRest_.size(); ++i) {
    const scene::OwnedSubdomain& item = atRest_[i];
    const std::optional<fem::Tensor> excess =
        item.mesh.mesh->isAxisymmetric ? std::nullopt : turns.excessOf(item.body);
    const fem::Point centre = turns.centreOf(item.body);
    for (std::size_t k = 0; k < result[i].size(); k += components) {
      const fem::Point place = item.mesh.position(static_cast<int>(k / components));
      for (std::size_t a = 0; a < components; ++a) {
        result[i][k + a] += change[i][k + a];
        for (std::size_t b = 0; b < components && excess; ++b)
          result[i][k + a] += (*excess)[a][b] * (place[b] + displacement[i][k + b] - centre[b]);
      }
    }
  }
  joinCopies(result);
  return result;
}

double DeformedBodies::joinCopies(feti::TornVector& displacement) const {
  return scene::joinCopies(comm_, scene_.components(), atRest_, displacement);
}

fem::Point DeformedBodies::placeOfLargest(const feti::TornVector& motion) const {
  struct Place {
    double square;
    fem::Point position;
  };
  const auto components = static_cast<std::size_t>(scene_.components());
  Place largest = {-1.0, {}};
  for (std::size_t i = 0; i < atRest_.size(); ++i)
    for (std::size_t node = 0; node * components < motion[i].size(); ++node) {
      double square = 0.0;
      for (std::size_t d = 0; d < components; ++d)
        square += std::pow(motion[i][node * components + d], 2);
      if (square > largest.square)
        largest = {square, atRest_[i].mesh.position(static_cast<int>(node))};
    }
  const std::vector<Place> all = gatherAll(comm_, std::vector<Place>{largest});
  largest = all.front(); // the same on all ranks
  for (const Place& place : all)
    if (place.square > largest.square)
      largest = place;
  return largest.position;
}

std::vector<double> DeformedBodies::products(const std::vector<ConstraintRow>& rows,
                                             const feti::TornVector& displacement) const {
  const auto components = static_cast<std::size_t>(scene_.components());
  const auto isAsked = [this](const ConstraintRow& row) {
    return row.kind != ConstraintRow::Kind::Inequality || !scene_.isFinite();
  };
  std::vector<double> result(rows.size(), 0.0);
  std::vector<long long> asked;
  for (const ConstraintRow& row : rows)
    for (const ConstraintRow::Term& term : row.terms)
      if (isAsked(row))
        asked.push_back(term.dof);
  if (globalMax(comm_, static_cast<long long>(asked.size())) == 0)
    return result;
  std::vector<std::pair<long long, double>> known;
  for (std::size_t i = 0; i < atRest_.size(); ++i) {
    const fem::PlacedMesh& placed = atRest_[i].mesh;
    for (std::size_t b = 0; b < placed.boundaryNumbers.size(); ++b)
      for (std::size_t c = 0; c < components; ++c)
        known.emplace_back(
            placed.boundaryNumbers[b] * static_cast<long long>(components) + static_cast<long long>(c),
            displacement[i][static_cast<std::size_t>(placed.mesh->boundary[b]) * components + c]);
  }
  const std::vector<std::optional<double>> values = lookUp(comm_, known, asked);
  std::size_t next = 0;
  for (std::size_t k = 0; k < rows.size(); ++k)
    for (const ConstraintRow::Term& term : rows[k].terms)
      if (isAsked(rows[k]))
        result[k] += term.coefficient * values[next++].value_or(0.0);
  return result;
}

} // namespace Harmos::run
