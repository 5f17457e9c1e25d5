// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_Functional.hpp"

#include "Harmos_ContactSetup.hpp"
#include "Harmos_DesignProblem.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_Log.hpp"
#include "Harmos_Scene.hpp"

#include <algorithm>
#include <cmath>

namespace Harmos::sensitivity {
namespace {

const Teuchos::Comm<int>& commOf(const Response& response) {
  return *response.solver.system().comm();
}

double pressureOf(const Response& response, std::size_t row) {
  return std::max(0.0, response.forces[row]) / response.rows.areas[row];
}

double dot(const fem::Point& a, const fem::Point& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

} // namespace

RowGeometry geometryOf(const scene::ContactSetup& setup, const scene::Scene& scene) {
  RowGeometry geometry;
  std::size_t point = 0; // inequality rows are those of the points, in their order
  for (std::size_t r = 0; r < setup.rows.size(); ++r) {
    const bool isContact = setup.rows[r].kind == ConstraintRow::Kind::Inequality;
    geometry.areas.push_back(isContact ? setup.points[point].area : 0.0);
    geometry.normals.push_back(setup.origins[r].direction);
    geometry.positions.push_back(setup.origins[r].position);
    int surface = -1;
    for (std::size_t e = 0; isContact && e < scene.effects.size(); ++e)
      if (scene.effects[e].get() == setup.origins[r].effect)
        surface = static_cast<int>(e);
    geometry.surfaces.push_back(surface);
    point += isContact ? 1 : 0;
  }
  return geometry;
}

std::optional<Functional::Adjoint> Energy::knownAdjoint(const Response& response) const {
  Adjoint adjoint = {response.solver.system().zeroVector(), response.forces};
  for (double& force : adjoint.forces)
    force = -force;
  return adjoint;
}

PressureSummary pressureSummary(const Teuchos::Comm<int>& comm, const std::vector<double>& forces,
                                const RowGeometry& rows, const std::set<int>& surfaces) {
  std::vector<double> sums(2, 0.0);
  double peak = 0.0;
  for (std::size_t r = 0; r < forces.size(); ++r)
    if (rows.areas[r] > 0.0 && surfaces.count(rows.surfaces[r]) > 0) {
      sums[0] += rows.areas[r];
      sums[1] += std::max(0.0, forces[r]);
      peak = std::max(peak, forces[r] / rows.areas[r]);
    }
  globalSum(comm, sums);
  peak = globalMax(comm, peak);
  return {sums[0] > 0.0 ? sums[1] / sums[0] : 0.0, peak, sums[0]};
}

PressureFunctional::Sums PressureFunctional::sums(const Response& response) const {
  const PressureSummary summary =
      pressureSummary(commOf(response), response.forces, response.rows, surfaces_);
  if (!(summary.area > 0.0))
    throw InputError("the surfaces whose pressure is the cost have no contact points; name contacts or "
                     "obstacles with surfaces that meet");
  if (!(summary.peak > 0.0))
    throw RefusedDesign("no contact point carries a force: the body has lifted off, so there is no pressure. "
                        "Use smaller gaps or prescribe a force instead of a displacement");
  return {summary.area, summary.mean * summary.area, summary.peak};
}

PressureNorm::PressureNorm(std::set<int> surfaces, double exponent)
    : PressureFunctional(std::move(surfaces)), exponent_(exponent) {
  if (!(exponent > 1.0) || !std::isfinite(exponent))
    throw InputError("the exponent of a norm of pressures is " + scientific(exponent) +
                     "; give an exponent above 1, such as 8: the norm approaches the peak as it increases");
}

// By shares of the peak, whose powers stay within the range of numbers.
double PressureNorm::value(const Response& response) const {
  const Sums all = sums(response);
  double sum = 0.0;
  for (std::size_t r = 0; r < response.forces.size(); ++r)
    if (counts(response.rows, r))
      sum += response.rows.areas[r] * std::pow(pressureOf(response, r) / all.peak, exponent_);
  return all.peak * std::pow(globalSum(commOf(response), sum) / all.area, 1.0 / exponent_);
}

// ∂Φ/∂λ_r = (p_r/Φ)^(q−1) / Σa.
Functional::Partials PressureNorm::partials(const Response& response) const {
  const double norm = value(response), area = sums(response).area;
  Partials partials;
  for (std::size_t r = 0; r < response.forces.size(); ++r)
    partials.forces.push_back(
        counts(response.rows, r) ? std::pow(pressureOf(response, r) / norm, exponent_ - 1.0) / area : 0.0);
  return partials;
}

double PressureSpread::value(const Response& response) const {
  const Sums all = sums(response);
  double sum = 0.0;
  for (std::size_t r = 0; r < response.forces.size(); ++r)
    if (counts(response.rows, r))
      sum += response.rows.areas[r] * std::pow(pressureOf(response, r) / all.mean() - 1.0, 2);
  return globalSum(commOf(response), sum) / all.area;
}

// With x_r = p_r/p̄: ∂Φ/∂λ_r = 2/(A p̄) (x_r − 1 − Σa(x − 1)x/A) = 2/(A p̄) (x_r − 1 − Φ), for Σa(x − 1) = 0.
Functional::Partials PressureSpread::partials(const Response& response) const {
  const Sums all = sums(response);
  const double spread = value(response);
  Partials partials;
  for (std::size_t r = 0; r < response.forces.size(); ++r)
    partials.forces.push_back(counts(response.rows, r)
                                  ? 2.0 / all.force * (pressureOf(response, r) / all.mean() - 1.0 - spread)
                                  : 0.0);
  return partials;
}

double Resultant::value(const Response& response) const {
  double sum = 0.0;
  for (std::size_t r = 0; r < response.forces.size(); ++r)
    if (counts(response.rows, r))
      sum -= response.forces[r] * dot(response.rows.normals[r], direction_);
  return globalSum(commOf(response), sum);
}

Functional::Partials Resultant::partials(const Response& response) const {
  Partials partials;
  for (std::size_t r = 0; r < response.forces.size(); ++r)
    partials.forces.push_back(counts(response.rows, r) ? -dot(response.rows.normals[r], direction_) : 0.0);
  return partials;
}

double LinearDisplacement::value(const Response& response) const {
  const feti::TornVector& u = response.solver.displacement();
  double sum = 0.0;
  for (std::size_t i = 0; i < weights_.size(); ++i)
    for (std::size_t j = 0; j < weights_[i].size(); ++j)
      sum += weights_[i][j] * u[i][j];
  return globalSum(commOf(response), sum);
}

} // namespace Harmos::sensitivity
