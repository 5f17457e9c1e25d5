// SPDX-License-Identifier: BSD-3-Clause

/// Subdomains whose matrices are given in frames of their own, against the same ones without.

#include "Harmos_DualPipeline.hpp"
#include "Harmos_DualSolution.hpp"
#include "Harmos_Elasticity.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_FetiSolver.hpp"
#include "Harmos_Recovery.hpp"
#include "Harmos_StructuredBlock.hpp"
#include "Harmos_TestComm.hpp"
#include "Harmos_TestErrors.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace test_frames {

using namespace Harmos;
using feti::Frame;
using feti::Subdomain;

namespace {

constexpr int pieces = 4;

// A strip of four pieces, held at its left end, loaded, with nodes of its lower side over a floor.
struct Strip {
  std::vector<Subdomain> subdomains; // of this rank
  std::vector<ConstraintRow> rows;   // likewise
};

Strip makeStrip() {
  fem::StructuredBlock::Options options;
  options.cellType = fem::CellType::Quadrilateral4;
  options.subdomains = {pieces, 1, 1};
  options.elements = {3, 3, 1};
  options.size = {4.0, 1.0, 1.0};
  const fem::StructuredBlock block(options);
  fem::Elasticity elasticity;
  elasticity.materials = {fem::Material::isotropic(1.0, 0.3)};
  Strip strip;
  const int rank = testComm()->getRank(), ranks = testComm()->getSize();
  for (int s = 0; s < pieces; ++s) {
    if (s % ranks != rank)
      continue;
    const fem::PlacedMesh placed = block.subdomain(s);
    const fem::Mesh& mesh = *placed.mesh;
    Subdomain subdomain;
    subdomain.number = s;
    subdomain.stiffness = std::make_shared<LocalMatrix>(fem::assembleElasticity(mesh, elasticity));
    subdomain.motions = std::make_shared<feti::Kernel>(feti::rigidBodyKernel(mesh.coordinates, 2));
    auto load = std::make_shared<std::vector<double>>();
    for (int node = 0; node < mesh.numberOfNodes(); ++node)
      load->insert(load->end(), {1e-3 * s, -2e-3});
    subdomain.load = load;
    auto interface = std::make_shared<std::vector<int>>();
    for (int node : mesh.boundary)
      for (int c = 0; c < 2; ++c) {
        interface->push_back(2 * node + c);
        subdomain.numbers.push_back(2 * placed.number(node) + c);
        if (s == 0 && placed.position(node)[0] == 0.0)
          subdomain.fixed.push_back({2 * node + c, 0.0});
      }
    subdomain.interface = interface;
    if (s == 2) // the middle of its lower side
      for (int node : mesh.boundary)
        if (const fem::Point x = placed.position(node); x[1] == 0.0 && x[0] > 2.1 && x[0] < 2.9) {
          ConstraintRow row;
          row.kind = ConstraintRow::Kind::Inequality;
          row.number = static_cast<long long>(strip.rows.size());
          row.terms = {{2 * placed.number(node) + 1, -1.0}};
          row.bound = 0.01;
          strip.rows.push_back(row);
        }
    strip.subdomains.push_back(std::move(subdomain));
  }
  return strip;
}

Frame frameOf(long long number) {
  const double angle = 0.7 * static_cast<double>(number) - 0.4, c = std::cos(angle), s = std::sin(angle);
  return {{{{c, -s, 0.0}, {s, c, 0.0}, {0.0, 0.0, 1.0}}}, 2};
}

// Tᵀ K T, of a matrix whose graph has whole blocks.
std::shared_ptr<const LocalMatrix> entered(const LocalMatrix& k, const Frame& frame) {
  auto result = std::make_shared<LocalMatrix>(k);
  for (std::size_t node = 0; node + 2 < k.offsets.size(); node += 2)
    for (std::size_t p = 0; k.offsets[node] + p < k.offsets[node + 1]; p += 2)
      for (std::size_t a = 0; a < 2; ++a)
        for (std::size_t b = 0; b < 2; ++b) {
          double sum = 0.0;
          for (std::size_t i = 0; i < 2; ++i)
            for (std::size_t j = 0; j < 2; ++j)
              sum += frame(i, a) * k.values[k.offsets[node + i] + p + j] * frame(j, b);
          result->values[k.offsets[node + a] + p + b] = sum;
        }
  return result;
}

std::shared_ptr<const feti::Kernel> entered(const feti::Kernel& kernel, const Frame& frame) {
  auto result = std::make_shared<feti::Kernel>(kernel);
  for (int k = 0; k < kernel.columns; ++k) {
    std::vector<double> column(kernel.column(k), kernel.column(k) + kernel.rows);
    frame.enter(column);
    std::copy(column.begin(), column.end(),
              result->values.begin() + static_cast<std::ptrdiff_t>(k) * kernel.rows);
  }
  return result;
}

feti::TornVector solve(feti::DualPipeline& pipeline) {
  const feti::DualStages stages = pipeline.stages();
  Teuchos::ParameterList given;
  given.sublist("Solver").set("Tolerance", 1e-12);
  const Teuchos::ParameterList list = feti::FetiSolver::parameters().validated(given, "the test");
  const feti::SolverOptions options = feti::SolverOptions::fromList(list.sublist("Solver"));
  feti::SolveReport report;
  const feti::DualSolution solution = feti::solveDualProblem(stages, options, nullptr, {}, Log(), report);
  EXPECT_TRUE(report.converged) << report.reason;
  feti::TornVector u = feti::recover(*stages.system, *stages.constraints, *stages.inverses, *stages.coarse,
                                     *stages.problem, *solution.lambda, solution.mu)
                           .displacement;
  pipeline.system().leaveFrames(u);
  return u;
}

feti::DualPipeline pipelineOf(const Strip& strip, feti::DualForm form, feti::DirichletForm dirichlet) {
  feti::DualOptions options;
  options.form = form;
  options.preconditioner = feti::PreconditionerKind::Dirichlet;
  options.mayRound = false;
  return {feti::SubdomainSystem(testComm(), strip.subdomains, dirichlet), strip.rows, options, {}, Log()};
}

} // namespace

// Both forms; of Dirichlet conditions in the matrix that piece stays as it is. Answers agree to the solver's
// tolerance times the condition of F, below a thousand.
TEST(Frames, solutions_do_not_depend_on_them) {
  for (const feti::DualForm form : {feti::DualForm::Condensed, feti::DualForm::Implicit})
    for (const feti::DirichletForm dirichlet : {feti::DirichletForm::Primal, feti::DirichletForm::Dual}) {
      const Strip strip = makeStrip();
      feti::DualPipeline pipeline = pipelineOf(strip, form, dirichlet);
      const feti::TornVector plain = solve(pipeline);
      std::vector<std::shared_ptr<const LocalMatrix>> matrices;
      std::vector<std::shared_ptr<const feti::Kernel>> kernels;
      std::vector<std::shared_ptr<const std::vector<double>>> loads;
      std::vector<std::optional<Frame>> frames;
      for (const Subdomain& s : strip.subdomains) {
        const bool stays = dirichlet == feti::DirichletForm::Primal && !s.fixed.empty();
        frames.push_back(stays ? std::nullopt : std::optional<Frame>(frameOf(s.number)));
        matrices.push_back(stays ? s.stiffness : entered(*s.stiffness, *frames.back()));
        kernels.push_back(stays ? s.motions : entered(*s.motions, *frames.back()));
        loads.push_back(s.load);
      }
      pipeline.setShape(matrices, kernels, loads, strip.rows, frames);
      const feti::TornVector framed = solve(pipeline);
      double worst = 0.0, largest = 0.0;
      for (std::size_t i = 0; i < plain.size(); ++i)
        for (std::size_t k = 0; k < plain[i].size(); ++k) {
          worst = std::max(worst, std::abs(plain[i][k] - framed[i][k]));
          largest = std::max(largest, std::abs(plain[i][k]));
        }
      EXPECT_LE(globalMax(*testComm(), worst), 1e-9 * globalMax(*testComm(), largest));
    }
}

// Another frame costs no factorisation, and pieces that are alike share theirs in any frames.
TEST(Frames, factors_stay) {
  Strip strip = makeStrip();
  for (Subdomain& s : strip.subdomains) // where frames let rows act
    s.reserved = s.interface;
  feti::DualPipeline pipeline = pipelineOf(strip, feti::DualForm::Condensed, feti::DirichletForm::Dual);
  const auto count = [&] {
    return globalSum(*testComm(), static_cast<long long>(pipeline.factorizations().factorizations));
  };
  const long long before = count();
  std::vector<std::shared_ptr<const LocalMatrix>> matrices;
  std::vector<std::shared_ptr<const feti::Kernel>> kernels;
  std::vector<std::shared_ptr<const std::vector<double>>> loads;
  std::vector<std::optional<Frame>> frames;
  for (const Subdomain& s : strip.subdomains) {
    matrices.push_back(s.stiffness);
    kernels.push_back(s.motions);
    loads.push_back(s.load);
    frames.emplace_back(frameOf(s.number));
  }
  pipeline.setShape(matrices, kernels, loads, strip.rows, frames);
  EXPECT_EQ(count(), before);
  EXPECT_LE(pipeline.inverses()->distinctFactorizations(), 1);
}

TEST(Frames, of_prescribed_values_in_the_matrix) {
  const Strip strip = makeStrip();
  feti::SubdomainSystem system(testComm(), strip.subdomains, feti::DirichletForm::Primal);
  std::vector<std::optional<Frame>> frames;
  for (const Subdomain& s : strip.subdomains)
    frames.emplace_back(frameOf(s.number));
  EXPECT_NE(inputErrorOf([&] { system.setFrames(frames); }).find("a frame needs"), std::string::npos);
}

} // namespace test_frames
