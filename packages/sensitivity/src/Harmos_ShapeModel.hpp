// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_ContactSetup.hpp"
#include "Harmos_Decomposition.hpp"
#include "Harmos_DesignModel.hpp"
#include "Harmos_Scene.hpp"
#include "Harmos_ShapeMap.hpp"

#include <set>
#include <vector>

namespace Harmos::sensitivity {

/// Gives rows of contact a term for each component of the displacement, of zero where the normal has none: as
/// normals turn, rows keep their dofs, and what is factored its boundary. For solvers whose bodies are to
/// change. Local.
void completeRows(scene::ContactSetup& contact, int components);

/// Bodies whose nodes follow a design, on obstacles and on each other where their nodes match.
///
/// Subdomains that have nodes which may move are assembled and factored anew for each design, others never.
/// With s(v, u) = ∂(vᵀKu)/∂x of nodes (fem::shapeGradient()), κ = Functional::energyShare(), V_k = ∂x/∂α_k
///
///     dΦ/dα_k = (½κ s(u, u) − s(v, u))·V_k + (v − κu)ᵀf′ − λᵀB′v − ηᵀ(B′u − c′) + ∂Φ/∂a a′,
///
/// where loads f, rows B, c and areas a are made for shapes that differ by ±V_k times 10⁻⁵ of the size of the
/// bodies, and differences taken, with errors of 10⁻¹⁰: two searches for contact for each number of the
/// design, no solution.
///
/// Guarded by tests/unit/sensitivity/test_shape_gradients.cpp.
class ShapeModel : public DesignModel {
 public:
  /// @param solver of the scene's subdomains and rows, after completeRows(), to outlive this; so are scene
  /// and owned. @param owned, contact at rest.
  /// @param bodies that move. @param leastQuality of cells, as fem::worstCell() judges them by what they
  /// were: below, a mesh counts as tangled.
  /// @throws InputError on all ranks for bodies on foundations, prescribed values that depend on the place of
  /// nodes that move, mortar coupling of surfaces that move, and where nothing moves. @note Collective.
  ShapeModel(feti::FetiSolver& solver, const scene::Scene& scene,
             const std::vector<scene::OwnedSubdomain>& owned, const scene::ContactSetup& contact,
             ShapeMap map, std::set<int> bodies, double leastQuality = 0.2);

  std::size_t size() const override { return map_.size(); }
  const std::vector<double>& weights() const override { return weights_; }
  void apply(const std::vector<double>& design) override;
  const std::vector<ConstraintRow>& rows() const override { return contact_.rows; }
  const RowGeometry& geometry() const override { return geometry_; }
  std::vector<double> gradient(const Functional& functional, const Response& response,
                               const Functional::Adjoint& adjoint) override;
  double volume(const std::vector<double>& design) override;
  std::vector<double> volumeGradient(const std::vector<double>& design) override;
  /// All nodes move along one direction d, by a: the Jacobian matrix X_ξ + d a_ξᵀ changes by one of rank one,
  /// its determinant, det X_ξ (1 + a_ξᵀ X_ξ⁻¹ d), linearly.
  bool hasLinearVolume() const override { return true; }

  /// Subdomains as the last design has them, and their contacts.
  const std::vector<scene::OwnedSubdomain>& owned() const { return owned_; }
  const scene::ContactSetup& contact() const { return contact_; }
  /// Subdomains that are factored anew for each design, on all ranks.
  long long movingSubdomains() const { return movingSubdomains_; }

 private:
  // Of this rank's subdomains that may move, at a design.
  std::vector<scene::OwnedSubdomain> moving(const std::vector<double>& design) const;
  std::vector<scene::OwnedSubdomain> all(std::vector<scene::OwnedSubdomain> moving) const;
  scene::ContactSetup contactOf(const std::vector<scene::OwnedSubdomain>& owned) const;
  void requireQuality(const std::vector<scene::OwnedSubdomain>& moving) const;
  void requireSupported() const;
  void requireSameRows(const scene::ContactSetup& contact) const;
  void addMatrices(const Functional& functional, const Response& response, const Functional::Adjoint& adjoint,
                   std::vector<double>& gradient) const;
  void addDifferences(const Functional& functional, const Response& response,
                      const Functional::Adjoint& adjoint, std::vector<double>& gradient) const;

  feti::FetiSolver& solver_;
  const scene::Scene& scene_;
  const std::vector<scene::OwnedSubdomain>& atRest_;
  ShapeMap map_;
  std::set<int> bodies_;
  double leastQuality_;
  std::vector<std::size_t> places_; // of subdomains that may move
  long long movingSubdomains_ = 0;
  std::vector<double> weights_, design_;
  std::vector<scene::OwnedSubdomain> owned_;
  scene::ContactSetup reference_, contact_;
  RowGeometry geometry_;
  double extent_ = 0.0, volumeAtRest_ = 0.0;
  bool hasLoads_ = false;
};

} // namespace Harmos::sensitivity
