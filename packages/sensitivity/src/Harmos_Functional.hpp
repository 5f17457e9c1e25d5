// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CellType.hpp"
#include "Harmos_FetiSolver.hpp"

#include <optional>
#include <set>
#include <vector>

namespace Harmos::scene {
struct ContactSetup;
struct Scene;
} // namespace Harmos::scene

namespace Harmos::sensitivity {

/// Of the rows that this rank gave, in their order: what they are beside coefficients and bounds.
struct RowGeometry {
  std::vector<double> areas;       ///< force / area is the contact pressure; 0: no row of contact
  std::vector<fem::Point> normals; ///< −force · normal acts on the first body
  std::vector<fem::Point> positions;
  std::vector<int> surfaces; ///< a number for each contact or obstacle; −1: no row of contact
};

/// Of the rows of a scene; surfaces are places of effects in the scene. Local.
RowGeometry geometryOf(const scene::ContactSetup& setup, const scene::Scene& scene);

/// An answer, as functionals see it.
struct Response {
  const feti::FetiSolver& solver;    ///< that has it
  const std::vector<double>& forces; ///< of the rows that this rank gave
  const RowGeometry& rows;
};

/// A number that depends on an answer, Φ(u, λ). Immutable.
/// Guarded by tests/unit/sensitivity/test_gap_gradients.cpp.
class Functional {
 public:
  virtual ~Functional() = default;

  /// @throws RefusedDesign on all ranks for an answer that has no such number. @note Collective.
  virtual double value(const Response& response) const = 0;

  /// Φ_u as loads of this rank's subdomains, each copy of a dof with its share, and Φ_λ of the rows that this
  /// rank gave; empty: zeros.
  struct Partials {
    feti::TornVector displacement;
    std::vector<double> forces;
  };
  /// @note Collective.
  virtual Partials partials(const Response& response) const = 0;

  /// (v, η), where it is known without a solution: see Sensitivities.
  struct Adjoint {
    feti::TornVector displacement;
    std::vector<double> forces;
  };
  virtual std::optional<Adjoint> knownAdjoint(const Response&) const { return std::nullopt; }
  /// How often ½uᵀKu − fᵀu is a part of Φ by itself.
  virtual double energyShare() const { return 0.0; }
};

/// The least potential energy, J = min ½uᵀKu − fᵀu, with what friction of given bounds dissipates. Least J is
/// the softest body: where nothing is prescribed and there are no gaps, J = −½fᵀu.
///
/// J is stationary in u and λ, so that its adjoint is known: v = 0, η = −λ (Haslinger and Mäkinen:
/// Introduction to Shape Optimization, 2003, chapter 4).
class Energy : public Functional {
 public:
  double value(const Response& response) const override { return response.solver.audit().energy; }
  Partials partials(const Response&) const override { return {}; }
  std::optional<Adjoint> knownAdjoint(const Response& response) const override;
  double energyShare() const override { return 1.0; }
};

/// What functionals of contact pressures p_r = λ_r/a_r are about: some of the surfaces.
class PressureFunctional : public Functional {
 public:
  /// @param surfaces of RowGeometry.
  explicit PressureFunctional(std::set<int> surfaces) : surfaces_(std::move(surfaces)) {}

 protected:
  bool counts(const RowGeometry& rows, std::size_t row) const {
    return rows.areas[row] > 0.0 && surfaces_.count(rows.surfaces[row]) > 0;
  }
  struct Sums {
    double area = 0.0, force = 0.0, peak = 0.0;
    double mean() const { return force / area; }
  };
  /// @throws RefusedDesign where nothing bears a force. @note Collective.
  Sums sums(const Response& response) const;

 private:
  std::set<int> surfaces_;
};

/// (Σ a_r p_r^q / Σ a_r)^(1/q): between the mean of the pressure (q = 1) and its peak (q → ∞).
class PressureNorm : public PressureFunctional {
 public:
  /// @param exponent q, above 1. @throws InputError otherwise.
  PressureNorm(std::set<int> surfaces, double exponent);
  double value(const Response& response) const override;
  Partials partials(const Response& response) const override;

 private:
  double exponent_;
};

/// Σ a_r (p_r − p̄)² / (Σ a_r p̄²), p̄ the mean: the square of the coefficient of variation.
class PressureSpread : public PressureFunctional {
 public:
  using PressureFunctional::PressureFunctional;
  double value(const Response& response) const override;
  Partials partials(const Response& response) const override;
};

/// A component of the resultant that acts on the first bodies: −Σ λ_r n_r·d.
class Resultant : public PressureFunctional {
 public:
  Resultant(std::set<int> surfaces, const fem::Point& direction)
      : PressureFunctional(std::move(surfaces)), direction_(direction) {}
  double value(const Response& response) const override;
  Partials partials(const Response& response) const override;

 private:
  fem::Point direction_;
};

/// lᵀu, as of the mean displacement of a boundary part.
class LinearDisplacement : public Functional {
 public:
  /// @param weights of this rank's subdomains: where a dof has several copies, the sum of theirs counts.
  explicit LinearDisplacement(feti::TornVector weights) : weights_(std::move(weights)) {}
  double value(const Response& response) const override;
  Partials partials(const Response&) const override { return {weights_, {}}; }

 private:
  feti::TornVector weights_;
};

/// The mean and the largest pressure of some surfaces. @note Collective.
struct PressureSummary {
  double mean = 0.0, peak = 0.0, area = 0.0;
};
PressureSummary pressureSummary(const Teuchos::Comm<int>& comm, const std::vector<double>& forces,
                                const RowGeometry& rows, const std::set<int>& surfaces);

} // namespace Harmos::sensitivity
