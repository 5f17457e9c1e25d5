// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_GapProfile.hpp"

#include "Harmos_Errors.hpp"
#include "Harmos_Exchange.hpp"

#include <algorithm>
#include <limits>

namespace Harmos::sensitivity {
namespace {

bool isOf(const RowGeometry& geometry, const std::set<int>& surfaces, std::size_t row) {
  return geometry.surfaces[row] >= 0 && surfaces.count(geometry.surfaces[row]) > 0;
}

std::vector<double> boundsOf(const std::vector<ConstraintRow>& rows) {
  std::vector<double> bounds;
  for (const ConstraintRow& row : rows)
    bounds.push_back(row.bound);
  return bounds;
}

const Teuchos::Comm<int>& commOf(const feti::FetiSolver& solver) {
  return *solver.system().comm();
}

} // namespace

GapProfile::GapProfile(feti::FetiSolver& solver, std::vector<ConstraintRow> rows, RowGeometry geometry,
                       std::set<int> surfaces)
    : solver_(solver),
      rows_(std::move(rows)),
      geometry_(std::move(geometry)),
      isByNodes_(true),
      gaps_(boundsOf(rows_)),
      functions_(rows_.size()) {
  std::vector<long long> mine;
  for (std::size_t r = 0; r < rows_.size(); ++r)
    if (isOf(geometry_, surfaces, r))
      mine.push_back(rows_[r].number);
  std::vector<long long> all = gatherAll(commOf(solver_), mine);
  std::sort(all.begin(), all.end());
  weights_.assign(all.size(), 0.0);
  for (std::size_t r = 0; r < rows_.size(); ++r)
    if (isOf(geometry_, surfaces, r))
      functions_[r].emplace_back(
          static_cast<std::size_t>(std::lower_bound(all.begin(), all.end(), rows_[r].number) - all.begin()),
          1.0);
  finish();
}

GapProfile::GapProfile(feti::FetiSolver& solver, std::vector<ConstraintRow> rows, RowGeometry geometry,
                       std::set<int> surfaces, const TensorSplineBasis& basis)
    : solver_(solver),
      rows_(std::move(rows)),
      geometry_(std::move(geometry)),
      gaps_(boundsOf(rows_)),
      weights_(static_cast<std::size_t>(basis.size()), 0.0),
      functions_(rows_.size()) {
  for (std::size_t r = 0; r < rows_.size(); ++r) {
    if (!isOf(geometry_, surfaces, r))
      continue;
    const TensorSplineBasis::Values at = basis.at(geometry_.positions[r]);
    for (std::size_t k = 0; k < at.count; ++k)
      if (at.values[k] != 0.0)
        functions_[r].emplace_back(static_cast<std::size_t>(at.functions[k]), at.values[k]);
  }
  finish();
}

void GapProfile::finish() {
  if (weights_.empty())
    throw InputError("the surfaces whose gaps are designed have no contact points; name contacts or "
                     "obstacles with surfaces that meet");
  weights_ = transposed(geometry_.areas);
  for (std::size_t k = 0; k < weights_.size(); ++k)
    if (!(weights_[k] > 0.0))
      throw InputError("number " + std::to_string(k) +
                       " of the design moves no contact point; use fewer pieces or a narrower range");
}

std::vector<double> GapProfile::profile(const std::vector<double>& design) const {
  std::vector<double> values;
  for (const auto& functions : functions_) {
    double& sum = values.emplace_back(0.0);
    for (const auto& [number, value] : functions)
      sum += design[number] * value;
  }
  return values;
}

std::vector<double> GapProfile::transposed(const std::vector<double>& values) const {
  std::vector<double> sums(weights_.size(), 0.0);
  for (std::size_t r = 0; r < functions_.size(); ++r)
    for (const auto& [number, value] : functions_[r])
      sums[number] += values[r] * value;
  globalSum(commOf(solver_), sums);
  return sums;
}

void GapProfile::apply(const std::vector<double>& design) {
  HARMOS_REQUIRE(design.size() == size(), "a design has a number for each function");
  const std::vector<double> added = profile(design);
  for (std::size_t r = 0; r < rows_.size(); ++r)
    rows_[r].bound = gaps_[r] + added[r];
  solver_.setBounds(rows_);
}

std::vector<double> GapProfile::gradient(const Functional&, const Response&,
                                         const Functional::Adjoint& adjoint) {
  return transposed(adjoint.forces);
}

std::optional<std::vector<double>> GapProfile::reclosed(const std::vector<double>& design,
                                                        const Response& response,
                                                        const DesignSpace& space) const {
  using Status = ConstraintRow::Status;
  if (!isByNodes_)
    return std::nullopt;
  const Teuchos::Comm<int>& comm = commOf(solver_);
  const std::vector<double> residuals =
      solver_.constraints()->givenResiduals(solver_.displacement(), *solver_.solution().multiplier);
  std::vector<ConstraintRow> rows = rows_;
  std::vector<char> isOpen(rows.size(), 0);
  std::vector<double> sums(3, 0.0); // open points, force, area
  for (std::size_t r = 0; r < rows.size(); ++r) {
    rows[r].bound = rows[r].rounding = 0.0;
    if (rows[r].kind != ConstraintRow::Kind::Inequality)
      continue;
    const bool isClosed = response.forces[r] > 0.0, isDesigned = !functions_[r].empty();
    isOpen[r] = !isClosed && isDesigned ? 1 : 0;
    rows[r].status = isClosed || isDesigned ? Status::Closed : Status::Open;
    rows[r].bound = isOpen[r] != 0 ? -1.0 : 0.0;
    sums[0] += isOpen[r];
    sums[1] += isDesigned ? response.forces[r] : 0.0;
    sums[2] += isDesigned ? geometry_.areas[r] : 0.0;
  }
  globalSum(comm, sums);
  if (sums[0] == 0.0)
    return std::nullopt;
  std::vector<std::shared_ptr<const std::vector<double>>> loads;
  for (int i = 0; i < solver_.system().size(); ++i)
    loads.push_back(std::make_shared<const std::vector<double>>(solver_.system().rhs(i).size(), 0.0));
  const feti::FetiSolver::Increment closing =
      solver_.solveIncrement(std::move(loads), rows, solver_.tolerance(), false);
  double most = 0.0; // pressure for each unit of closing
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (isOpen[r] != 0)
      most = std::max(most, closing.rowForces[r] / geometry_.areas[r]);
  most = globalMax(comm, most);
  const double beyond = most > 0.0 ? 0.5 * (sums[1] / sums[2]) / most : 0.0;
  std::vector<double> changes(rows.size(), 0.0);
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (isOpen[r] != 0)
      changes[r] = std::min(0.0, residuals[r]) - beyond;
  std::vector<double> result = transposed(changes);
  for (std::size_t k = 0; k < result.size(); ++k)
    result[k] = std::clamp(design[k] + result[k], space.lower[k], space.upper[k]);
  return result;
}

double GapProfile::volume(const std::vector<double>& design) {
  double sum = 0.0;
  for (std::size_t k = 0; k < design.size(); ++k)
    sum += weights_[k] * design[k];
  return sum;
}

std::pair<fem::Point, fem::Point> extentOfPoints(const Teuchos::Comm<int>& comm, const RowGeometry& geometry,
                                                 const std::set<int>& surfaces) {
  std::vector<double> most(6, -std::numeric_limits<double>::infinity()); // of x and −x
  for (std::size_t r = 0; r < geometry.surfaces.size(); ++r)
    if (isOf(geometry, surfaces, r))
      for (std::size_t d = 0; d < 3; ++d) {
        most[d] = std::max(most[d], geometry.positions[r][d]);
        most[3 + d] = std::max(most[3 + d], -geometry.positions[r][d]);
      }
  globalMax(comm, most);
  return {{-most[3], -most[4], -most[5]}, {most[0], most[1], most[2]}};
}

} // namespace Harmos::sensitivity
