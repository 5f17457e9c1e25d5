// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ShapeModel.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_BoxTree.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_MeshQuality.hpp"
#include "Harmos_Rendezvous.hpp"
#include "Harmos_ShapeGradient.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace Harmos::sensitivity {
namespace {

using scene::OwnedSubdomain;

const Teuchos::Comm<int>& communicatorOf(const feti::FetiSolver& solver) {
  return *solver.system().comm();
}

// "body "upper", subdomain 3".
std::string nameOf(const scene::Scene& scene, const OwnedSubdomain& item) {
  return "body \"" + scene.bodies[static_cast<std::size_t>(item.body)].name + "\", subdomain " +
         std::to_string(item.number);
}

// Σ over nodes of values (dimension numbers a node) times what the design does to each.
void contract(const ShapeMap& map, const fem::PlacedMesh& atRest, const std::vector<double>& values,
              double factor, std::vector<double>& sums) {
  const auto dimension = static_cast<std::size_t>(atRest.mesh->dimension());
  for (int node = 0; node < atRest.mesh->numberOfNodes(); ++node) {
    double along = 0.0;
    for (std::size_t d = 0; d < dimension; ++d)
      along += values[static_cast<std::size_t>(node) * dimension + d] * map.direction()[d];
    if (along != 0.0)
      for (const auto& [k, value] : map.functions(atRest.position(node)))
        sums[k] += factor * along * value;
  }
}

bool isZero(const std::vector<double>& v) {
  return std::all_of(v.begin(), v.end(), [](double entry) { return entry == 0.0; });
}

bool isZero(const feti::TornVector& v) {
  return std::all_of(v.begin(), v.end(), [](const std::vector<double>& part) { return isZero(part); });
}

// What a vector has at the dofs of rows, wherever their subdomains are: row after row, term after term.
std::vector<std::vector<double>> atTerms(const feti::SubdomainSystem& system,
                                         const std::vector<ConstraintRow>& rows, const feti::TornVector& u) {
  std::vector<std::pair<long long, double>> known;
  for (int i = 0; i < system.size(); ++i) {
    const feti::Subdomain& subdomain = system.subdomain(i);
    for (std::size_t k = 0; k < subdomain.numbers.size(); ++k)
      known.emplace_back(subdomain.numbers[k],
                         u[static_cast<std::size_t>(i)][static_cast<std::size_t>((*subdomain.interface)[k])]);
  }
  std::vector<long long> asked;
  for (const ConstraintRow& row : rows)
    for (const ConstraintRow::Term& term : row.terms)
      asked.push_back(term.dof);
  const std::vector<std::optional<double>> answers = lookUp(*system.comm(), known, asked);
  std::vector<std::vector<double>> result;
  std::size_t next = 0;
  for (const ConstraintRow& row : rows) {
    std::vector<double>& values = result.emplace_back();
    for (std::size_t k = 0; k < row.terms.size(); ++k)
      values.push_back(answers[next++].value_or(0.0));
  }
  return result;
}

double product(const ConstraintRow& row, const std::vector<double>& values) {
  double sum = 0.0;
  for (std::size_t k = 0; k < row.terms.size(); ++k)
    sum += row.terms[k].coefficient * values[k];
  return sum;
}

bool sameTerms(const ConstraintRow& a, const ConstraintRow& b) {
  return a.kind == b.kind && a.number == b.number && a.terms.size() == b.terms.size() &&
         std::equal(a.terms.begin(), a.terms.end(), b.terms.begin(),
                    [](const auto& x, const auto& y) { return x.dof == y.dof; });
}

} // namespace

void completeRows(scene::ContactSetup& contact, int components) {
  std::size_t next = 0; // rows of inequalities are those of the points, in their order
  for (ConstraintRow& row : contact.rows) {
    if (row.kind != ConstraintRow::Kind::Inequality)
      continue;
    const contact::ContactPoint& point = contact.points[next++];
    row.terms.clear();
    for (const contact::ContactPoint::Term& term : point.terms)
      for (int c = 0; c < components; ++c)
        row.terms.push_back(
            {term.node * components + c, term.weight * point.normal[static_cast<std::size_t>(c)]});
  }
}

ShapeModel::ShapeModel(feti::FetiSolver& solver, const scene::Scene& scene,
                       const std::vector<OwnedSubdomain>& owned, const scene::ContactSetup& contact,
                       ShapeMap map, std::set<int> bodies, double leastQuality)
    : solver_(solver),
      scene_(scene),
      atRest_(owned),
      map_(std::move(map)),
      bodies_(std::move(bodies)),
      leastQuality_(leastQuality),
      design_(map_.size(), 0.0),
      owned_(owned),
      reference_(contact),
      contact_(contact),
      geometry_(geometryOf(contact, scene)) {
  const Teuchos::Comm<int>& comm = communicatorOf(solver_);
  if (scene_.physics == scene::Physics::Membrane)
    throw InputError("the node positions of membranes cannot be designed; design their gaps");
  if (scene_.physics == scene::Physics::Axisymmetric)
    throw InputError("the node positions of axisymmetric bodies cannot be designed; design their gaps");
  completeRows(reference_, scene_.components());
  contact_ = reference_;
  std::vector<double> moved(map_.size(), 0.0);
  std::vector<fem::Point> places;
  agree(comm, [&] {
    for (std::size_t i = 0; i < owned.size(); ++i) {
      if (bodies_.count(owned[i].body) == 0)
        continue;
      bool moves = false;
      for (int node = 0; node < owned[i].mesh.mesh->numberOfNodes(); ++node) {
        const fem::Point x = owned[i].mesh.position(node);
        places.push_back(x);
        for (const auto& [k, value] : map_.functions(x)) {
          moved[k] += value;
          moves = moves || value != 0.0;
        }
      }
      if (moves)
        places_.push_back(i);
    }
    requireSupported();
  });
  globalSum(comm, moved);
  for (std::size_t k = 0; k < moved.size(); ++k) {
    if (!(moved[k] > 0.0))
      throw InputError("number " + std::to_string(k) +
                       " of the design moves no node; use fewer pieces, a narrower range or a greater depth");
    weights_.push_back(map_.basis().integral(static_cast<int>(k)));
  }
  movingSubdomains_ = globalSum(comm, static_cast<long long>(places_.size()));
  constexpr double far = std::numeric_limits<double>::infinity();
  const fem::Box box =
      places.empty() ? fem::Box{{far, far, far}, {-far, -far, -far}} : fem::boxAround(places);
  for (std::size_t d = 0; d < 3; ++d)
    extent_ = std::max(extent_, globalMax(comm, box.high[d]) - globalMin(comm, box.low[d]));
  std::vector<feti::Subdomain> subdomains;
  agree(comm, [&] { subdomains = scene::assemble(scene_, moving(design_)); });
  hasLoads_ = globalMax(comm, std::all_of(subdomains.begin(), subdomains.end(),
                                          [](const feti::Subdomain& item) { return isZero(*item.load); })
                                  ? 0LL
                                  : 1LL) > 0;
  volumeAtRest_ = volume(design_);
}

// Local.
void ShapeModel::requireSupported() const {
  for (std::size_t place : places_)
    for (const auto& effect : scene_.effects)
      if (effect->stiffnessKey(scene_, atRest_[place]))
        throw InputError(effect->label() + " acts on " + nameOf(scene_, atRest_[place]) +
                         ", whose nodes the design moves, but the derivative of its stiffness is not "
                         "implemented; remove it or use a smaller depth");
  for (const ConstraintRow& row :
       reference_.rows) // nodes that match have one term a component on either side
    for (const ConstraintRow::Term& term : row.terms)
      if (row.kind == ConstraintRow::Kind::Inequality &&
          row.terms.size() > 2 * static_cast<std::size_t>(scene_.components()))
        throw InputError("a contact of surfaces with non-matching nodes (at dof " + std::to_string(term.dof) +
                         ") has rows without implemented derivatives with respect to nodes; design its gaps "
                         "or use matching nodes");
}

std::vector<OwnedSubdomain> ShapeModel::moving(const std::vector<double>& design) const {
  std::vector<OwnedSubdomain> result;
  for (std::size_t place : places_)
    result.push_back({atRest_[place].number, atRest_[place].body, map_.moved(atRest_[place].mesh, design)});
  return result;
}

std::vector<OwnedSubdomain> ShapeModel::all(std::vector<OwnedSubdomain> moving) const {
  std::vector<OwnedSubdomain> result = atRest_;
  for (std::size_t m = 0; m < places_.size(); ++m)
    result[places_[m]] = std::move(moving[m]);
  return result;
}

scene::ContactSetup ShapeModel::contactOf(const std::vector<OwnedSubdomain>& owned) const {
  scene::ContactSetup contact = scene::setUpContact(communicatorOf(solver_), scene_, owned);
  completeRows(contact, scene_.components());
  requireSameRows(contact);
  return contact;
}

void ShapeModel::requireSameRows(const scene::ContactSetup& contact) const {
  const bool isSame =
      contact.rows.size() == reference_.rows.size() &&
      std::equal(contact.rows.begin(), contact.rows.end(), reference_.rows.begin(), sameTerms);
  if (globalMin(communicatorOf(solver_), isSame ? 1LL : 0LL) == 0)
    throw InputError("the nodes that the design moves change the counterparts of contacts; let the design "
                     "move both bodies of a contact with matching nodes or design gaps");
}

void ShapeModel::requireQuality(const std::vector<OwnedSubdomain>& moving) const {
  const Teuchos::Comm<int>& comm = communicatorOf(solver_);
  double least = std::numeric_limits<double>::infinity();
  std::string text;
  agree(comm, [&] {
    for (std::size_t m = 0; m < moving.size(); ++m) {
      const fem::CellQuality worst = fem::worstCell(atRest_[places_[m]].mesh, moving[m].mesh);
      if (worst.quality >= least)
        continue;
      least = worst.quality;
      text = nameOf(scene_, moving[m]) + ", " + fem::textOf(moving[m].mesh, worst);
    }
  });
  const double worst = globalMin(comm, least);
  if (worst >= leastQuality_)
    return;
  const bool isMine = least == worst;
  const std::vector<char> told =
      gatherAll(comm, isMine ? std::vector<char>(text.begin(), text.end()) : std::vector<char>());
  throw RefusedDesign("the design tangles the mesh: " + std::string(told.begin(), told.end()) +
                      "; at least " + scientific(leastQuality_) +
                      " is required. Tighten the bounds of the design or increase its depth");
}

void ShapeModel::apply(const std::vector<double>& design) {
  HARMOS_REQUIRE(design.size() == size(), "a design has a number for each function");
  const Teuchos::Comm<int>& comm = communicatorOf(solver_);
  std::vector<OwnedSubdomain> moved = moving(design);
  requireQuality(moved);
  std::vector<feti::Subdomain> subdomains;
  agree(comm, [&] {
    subdomains = scene::assemble(scene_, moved);
    for (std::size_t m = 0; m < moved.size(); ++m) {
      const std::vector<feti::FixedDof>& before =
          solver_.system().subdomain(static_cast<int>(places_[m])).fixed;
      const bool isSame =
          std::equal(before.begin(), before.end(), subdomains[m].fixed.begin(), subdomains[m].fixed.end(),
                     [](const auto& a, const auto& b) { return a.dof == b.dof && a.value == b.value; });
      if (!isSame)
        throw InputError(
            nameOf(scene_, moved[m]) +
            ": prescribed values depend on nodes that the design moves; prescribe constant values there");
    }
  });
  std::vector<OwnedSubdomain> owned = all(std::move(moved));
  scene::ContactSetup contact = contactOf(owned);
  std::vector<std::shared_ptr<const LocalMatrix>> matrices;
  std::vector<std::shared_ptr<const feti::Kernel>> motions;
  std::vector<std::shared_ptr<const std::vector<double>>> loads;
  for (int i = 0; i < solver_.system().size(); ++i) {
    const feti::Subdomain& subdomain = solver_.system().subdomain(i);
    matrices.push_back(subdomain.stiffness);
    motions.push_back(subdomain.motions);
    loads.push_back(subdomain.load);
  }
  for (std::size_t m = 0; m < places_.size(); ++m) {
    matrices[places_[m]] = subdomains[m].stiffness;
    motions[places_[m]] = subdomains[m].motions;
    loads[places_[m]] = subdomains[m].load;
  }
  solver_.setShape(matrices, motions, std::move(loads), contact.rows);
  owned_ = std::move(owned);
  contact_ = std::move(contact);
  geometry_ = geometryOf(contact_, scene_);
  design_ = design;
}

// (½κ s(u, u) − s(v, u))·V.
void ShapeModel::addMatrices(const Functional& functional, const Response& response,
                             const Functional::Adjoint& adjoint, std::vector<double>& gradient) const {
  const double share = functional.energyShare();
  for (std::size_t place : places_) {
    const scene::Body& body = scene_.bodies[static_cast<std::size_t>(atRest_[place].body)];
    const fem::Elasticity elasticity = scene::elasticityOf(scene_, body);
    const fem::Mesh& mesh = *owned_[place].mesh.mesh;
    const std::vector<double>&u = response.solver.displacement()[place], &v = adjoint.displacement[place];
    if (share != 0.0)
      contract(map_, atRest_[place].mesh, fem::shapeGradient(mesh, elasticity, u, u), 0.5 * share, gradient);
    if (!isZero(v))
      contract(map_, atRest_[place].mesh, fem::shapeGradient(mesh, elasticity, v, u), -1.0, gradient);
  }
}

// What loads, rows and areas contribute. Sums of this rank; the functional's own change on rank 0.
void ShapeModel::addDifferences(const Functional& functional, const Response& response,
                                const Functional::Adjoint& adjoint, std::vector<double>& gradient) const {
  const Teuchos::Comm<int>& comm = communicatorOf(solver_);
  const feti::SubdomainSystem& system = solver_.system();
  const feti::TornVector& u = response.solver.displacement();
  const double share = functional.energyShare(), step = 1e-5 * extent_;
  const std::vector<std::vector<double>> uAtTerms = atTerms(system, contact_.rows, u);
  const bool hasAdjoint = globalMax(comm, isZero(adjoint.displacement) ? 0LL : 1LL) > 0;
  const std::vector<std::vector<double>> vAtTerms =
      hasAdjoint ? atTerms(system, contact_.rows, adjoint.displacement) : std::vector<std::vector<double>>();
  // Of the data at a design, with the answer as it is.
  const auto valueAt = [&](const std::vector<double>& design, double& ofAreas) {
    std::vector<OwnedSubdomain> moved = moving(design);
    double value = 0.0;
    if (hasLoads_)
      agree(comm, [&] {
        scene::EffectCosts costs(scene_);
        scene::SubdomainEffects effects(scene_, costs);
        for (std::size_t m = 0; m < moved.size(); ++m) {
          const std::vector<double>& load = *effects.load(moved[m]);
          for (std::size_t j = 0; j < load.size(); ++j)
            if (load[j] != 0.0)
              value += (adjoint.displacement[places_[m]][j] - share * u[places_[m]][j]) * load[j];
        }
      });
    const scene::ContactSetup contact = contactOf(all(std::move(moved)));
    for (std::size_t r = 0; r < contact.rows.size(); ++r) {
      const ConstraintRow& row = contact.rows[r];
      if (hasAdjoint)
        value -= response.forces[r] * product(row, vAtTerms[r]);
      value -= adjoint.forces[r] * (product(row, uAtTerms[r]) - row.bound);
    }
    if (share == 0.0) {
      const RowGeometry geometry = geometryOf(contact, scene_);
      ofAreas = functional.value({response.solver, response.forces, geometry});
    }
    return value;
  };
  for (std::size_t k = 0; k < size(); ++k) {
    std::vector<double> design = design_;
    double areasAbove = 0.0, areasBelow = 0.0;
    design[k] = design_[k] + step;
    const double above = valueAt(design, areasAbove);
    design[k] = design_[k] - step;
    const double below = valueAt(design, areasBelow);
    gradient[k] += (above - below) / (2.0 * step);
    if (comm.getRank() == 0)
      gradient[k] += (areasAbove - areasBelow) / (2.0 * step);
  }
}

std::vector<double> ShapeModel::gradient(const Functional& functional, const Response& response,
                                         const Functional::Adjoint& adjoint) {
  std::vector<double> gradient(size(), 0.0);
  agree(communicatorOf(solver_), [&] { addMatrices(functional, response, adjoint, gradient); });
  addDifferences(functional, response, adjoint, gradient);
  globalSum(communicatorOf(solver_), gradient);
  return gradient;
}

double ShapeModel::volume(const std::vector<double>& design) {
  double sum = 0.0;
  const std::vector<OwnedSubdomain> moved = moving(design);
  try { // outside of agree(), which knows no more than the kind of an error
    agree(communicatorOf(solver_), [&] {
      for (const OwnedSubdomain& item : moved)
        sum += fem::measureOf(*item.mesh.mesh);
    });
  } catch (const NumericalError& error) {
    throw RefusedDesign("the design tangles the mesh: " + std::string(error.what()));
  }
  return globalSum(communicatorOf(solver_), sum) - volumeAtRest_;
}

std::vector<double> ShapeModel::volumeGradient(const std::vector<double>& design) {
  std::vector<double> gradient(size(), 0.0);
  const std::vector<OwnedSubdomain> moved = moving(design);
  agree(communicatorOf(solver_), [&] {
    for (std::size_t m = 0; m < moved.size(); ++m)
      contract(map_, atRest_[places_[m]].mesh, fem::shapeGradientOfMeasure(*moved[m].mesh.mesh), 1.0,
               gradient);
  });
  globalSum(communicatorOf(solver_), gradient);
  return gradient;
}

} // namespace Harmos::sensitivity
