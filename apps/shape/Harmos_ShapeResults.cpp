// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_ShapeResults.hpp"

#include "Harmos_Exchange.hpp"
#include "Harmos_ResultFile.hpp"
#include "Harmos_StressRecovery.hpp"

#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace Harmos::shape {
namespace {

// What travels to rank 0.
struct Line {
  long long number, node;
  int surface;
  PointState before, after;
};

void put(std::ostream& text, double value) {
  if (std::isfinite(value))
    text << value;
}

} // namespace

std::string historyText(const std::vector<HistoryRow>& rows) {
  std::ostringstream text;
  text << "iteration,evaluations,cost,gradient_norm,constraint,step,refused,seconds\n"
       << std::setprecision(17);
  for (const HistoryRow& row : rows) {
    text << row.iteration << "," << row.evaluations << ",";
    for (double value : {row.cost, row.gradientNorm, row.violation, row.step}) {
      put(text, value);
      text << ",";
    }
    text << row.refused << ",";
    put(text, row.seconds);
    text << "\n";
  }
  return text.str();
}

SurfaceState surfaceState(const scene::ContactSetup& contact, const std::vector<ConstraintRow>& rows,
                          const sensitivity::RowGeometry& geometry, const std::vector<double>& forces) {
  SurfaceState state;
  std::size_t point = 0; // rows of inequalities are those of the points
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (rows[r].kind != ConstraintRow::Kind::Inequality)
      continue;
    state.numbers.push_back(rows[r].number);
    state.nodes.push_back(contact.points[point++].node);
    state.surfaces.push_back(geometry.surfaces[r]);
    const double area = geometry.areas[r];
    state.points.push_back({geometry.positions[r], rows[r].bound, area > 0.0 ? forces[r] / area : 0.0, area});
  }
  return state;
}

std::string shapeText(const Teuchos::Comm<int>& comm, const scene::Scene& scene, const SurfaceState& before,
                      const SurfaceState& after) {
  std::vector<std::vector<Line>> sends(static_cast<std::size_t>(comm.getSize()));
  for (std::size_t k = 0; k < after.numbers.size(); ++k)
    sends[0].push_back(
        {after.numbers[k], after.nodes[k], after.surfaces[k], before.points[k], after.points[k]});
  std::vector<Line> lines;
  for (const std::vector<Line>& part : exchangeItems(comm, sends))
    lines.insert(lines.end(), part.begin(), part.end());
  if (comm.getRank() != 0)
    return "";
  std::sort(lines.begin(), lines.end(), [](const Line& a, const Line& b) { return a.number < b.number; });
  const std::vector<std::string> paths = scene.effectPaths();
  std::ostringstream text;
  text << "surface,node,x_before,y_before,z_before,x_after,y_after,z_after,gap_before,gap_after,"
          "pressure_before,pressure_after,area\n"
       << std::setprecision(17);
  for (const Line& line : lines) {
    text << paths[static_cast<std::size_t>(line.surface)] << "," << line.node;
    for (const PointState* state : {&line.before, &line.after})
      for (double x : state->position)
        text << "," << x;
    text << "," << line.before.gap << "," << line.after.gap << "," << line.before.pressure << ","
         << line.after.pressure << "," << line.after.area << "\n";
  }
  return text.str();
}

std::string designText(const sensitivity::DesignSpace& space, const std::vector<double>& best,
                       const std::vector<fem::Point>& places) {
  std::ostringstream text;
  text << "number,x,y,z,lower,upper,start,best\n" << std::setprecision(17);
  for (std::size_t k = 0; k < space.size(); ++k) {
    text << k << ",";
    for (std::size_t d = 0; d < 3; ++d) {
      if (k < places.size())
        text << places[k][d];
      text << ",";
    }
    for (double value : {space.lower[k], space.upper[k], space.start[k]}) {
      put(text, value);
      text << ",";
    }
    text << best[k] << "\n";
  }
  return text.str();
}

void writeFields(const Answer& answer, const std::string& path, bool withStresses) {
  const feti::TornVector& u = answer.solver.displacement();
  run::ResultFields fields;
  fields.displacement = &u;
  fields.components = answer.scene.components();
  std::vector<std::vector<fem::Voigt>> stress;
  if (withStresses && answer.scene.physics != scene::Physics::Membrane) {
    stress =
        run::recoverStress(answer.comm, answer.scene, answer.owned, u, answer.scene.timeline.end()).stress;
    fields.stress = &stress;
  }
  const std::vector<run::ContactState> states =
      run::contactStates(answer.comm, answer.contact.points, answer.solver.contact());
  const run::ContactFields atNodes =
      run::contactFields(answer.comm, answer.owned, answer.contact.points, states);
  fields.contact = &atNodes;
  run::writeResult(answer.comm, path, answer.owned, fields);
}

void tell(const Answer& answer, const feti::SolveReport& solve, run::RunReport& report) {
  const feti::FetiSolver& solver = answer.solver;
  static_cast<feti::SolveReport&>(report) = solve;
  report.primalDimension = solver.system().primalDimension();
  report.kernelDimension = solver.system().kernelDimension();
  report.subdomains = solver.system().globalSubdomains();
  report.dualDimension = solver.constraints()->dualDimension();
  report.inequalities = solver.constraints()->inequalities();
  report.limited = solver.constraints()->limited();
  report.coarseDimension = solver.pipeline().coarse()->dimension();
  report.isCoarseDistributed = solver.pipeline().coarse()->isDistributed();
  report.clusters = solver.pipeline().decided().clusters();
  report.dualOperator = solver.pipeline().decided().describe();
  report.distinctFactorizations =
      globalSum(answer.comm, static_cast<long long>(solver.pipeline().inverses()->distinctFactorizations()));
  report.roundedFactorizations =
      globalSum(answer.comm, static_cast<long long>(solver.pipeline().inverses()->roundedFactorizations()));
  report.localCondition = globalMax(answer.comm, solver.pipeline().inverses()->condition());
  report.localDefect = globalMax(answer.comm, solver.pipeline().inverses()->defect());
  report.factorisations =
      globalSum(answer.comm, static_cast<long long>(solver.factorizations().factorizations));
  constexpr double mebi = 1048576.0;
  report.dualOperatorMiB = globalSum(answer.comm, solver.pipeline().inverses()->bytes() / mebi);
  report.reachedTolerance = report.tolerance;
  report.audited = true;
  report.audit = solver.audit();
  for (const ConstraintRow& row : answer.contact.rows)
    report.gapRounding = std::max(report.gapRounding, row.rounding);
  report.gapRounding = globalMax(answer.comm, report.gapRounding);
  report.contactPoints = answer.contact.points;
  report.contact = run::contactStates(answer.comm, answer.contact.points, solver.contact());
  report.contactCounts = run::countContact(answer.comm, report.contact);
  report.forces = run::forcesOf(answer.comm, answer.scene, answer.owned, solver.system(), answer.contact,
                                solver.displacement(), solver.reactions(), solver.rowForces());
}

} // namespace Harmos::shape
