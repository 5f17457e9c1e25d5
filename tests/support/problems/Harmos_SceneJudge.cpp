// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SceneJudge.hpp"

#include "Harmos_Agreement.hpp"
#include "Harmos_ContactSetup.hpp"
#include "Harmos_Exchange.hpp"
#include "Harmos_TestComm.hpp"

#include <Teuchos_CommHelpers.hpp>
#include <Teuchos_DefaultSerialComm.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

namespace Harmos {
namespace {

double norm(const std::vector<double>& x) {
  double sum = 0.0;
  for (double value : x)
    sum += value * value;
  return std::sqrt(sum);
}

// v ← v − (its part in the span of the orthonormal basis), twice: rounding errors of the first pass go with
// the second.
void project(const std::vector<std::vector<double>>& basis, std::vector<double>& v) {
  for (int pass = 0; pass < 2; ++pass)
    for (const std::vector<double>& e : basis) {
      double product = 0.0;
      for (std::size_t j = 0; j < v.size(); ++j)
        product += e[j] * v[j];
      for (std::size_t j = 0; j < v.size(); ++j)
        v[j] -= product * e[j];
    }
}

// The bodies before they are torn, on this rank alone.
class Whole {
 public:
  explicit Whole(const scene::Scene& scene) : scene_(scene) {
    const Teuchos::SerialComm<int> alone;
    const std::vector<scene::OwnedSubdomain> owned = scene::decompose(alone, scene);
    pieces_ = scene::assemble(scene, owned);
    contact_ = scene::setUpContact(alone, scene, owned);
    rows_ = contact_.rows;
    std::sort(rows_.begin(), rows_.end(),
              [](const ConstraintRow& a, const ConstraintRow& b) { return a.number < b.number; });
    for (const feti::Subdomain& piece : pieces_) {
      std::vector<std::size_t>& dofs = dofs_.emplace_back(piece.load->size(), none);
      for (std::size_t k = 0; k < piece.interface->size(); ++k) {
        const auto [place, isNew] = shared_.try_emplace(piece.numbers[k], size_);
        size_ += isNew ? 1 : 0;
        dofs[static_cast<std::size_t>((*piece.interface)[k])] = place->second;
      }
      for (std::size_t& dof : dofs)
        if (dof == none)
          dof = size_++;
    }
    isFixed_.assign(size_, false);
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      for (const feti::FixedDof& fixed : pieces_[i].fixed)
        isFixed_[dofs_[i][static_cast<std::size_t>(fixed.dof)]] = true;
  }

  Judgement judge(const std::vector<double>& torn, const run::RunReport& report) const {
    const std::vector<run::ContactState>& contact = report.contact;
    // Rounding errors of displacements, rigid parts included: local problems are solved to κε, and stiff
    // bodies that are moved far have forces that are small beside those errors.
    const double unit = 1e2 * std::numeric_limits<double>::epsilon() * std::max(10.0, report.localCondition);
    Judgement result;
    std::vector<double> imbalance(size_, 0.0), load(size_, 0.0), image(size_, 0.0), ku;
    std::vector<double> least(size_, 1e300), most(size_, -1e300), sum(size_, 0.0), copies(size_, 0.0);
    std::size_t offset = 0;
    double strainEnergy = 0.0, work = 0.0, rounding = 0.0;
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const feti::Subdomain& piece = pieces_[i];
      const double* u = torn.data() + offset;
      offset += piece.load->size();
      // Of large rigid motions only rounding errors of the strains would be left; see audit().
      ku.assign(piece.load->size(), 0.0);
      std::vector<double> strained(u, u + piece.load->size());
      feti::removeKernel(feti::heldKernel(*piece.motions, {}), strained);
      piece.stiffness->multiply(strained.data(), ku.data());
      const std::vector<double> diagonal = piece.stiffness->diagonal();
      for (std::size_t j = 0; j < ku.size(); ++j) {
        const std::size_t dof = dofs_[i][j];
        image[dof] += ku[j];
        load[dof] += (*piece.load)[j];
        strainEnergy += 0.5 * strained[j] * ku[j];
        result.energy -= (*piece.load)[j] * u[j];
        work += std::abs((*piece.load)[j] * u[j]);
        rounding += std::pow(unit * diagonal[j] * u[j], 2);
        result.energyRounding += unit * diagonal[j] * u[j] * u[j];
        result.displacement = std::max(result.displacement, std::abs(u[j]));
        least[dof] = std::min(least[dof], u[j]);
        most[dof] = std::max(most[dof], u[j]);
        sum[dof] += u[j];
        copies[dof] += 1.0;
      }
      for (const feti::FixedDof& fixed : piece.fixed)
        result.prescribed = std::max(result.prescribed, std::abs(u[fixed.dof] - fixed.value));
    }
    result.energy += strainEnergy;
    result.energyScale = std::max(strainEnergy, work);
    for (std::size_t dof = 0; dof < size_; ++dof) {
      result.tear = std::max(result.tear, most[dof] - least[dof]);
      sum[dof] /= copies[dof];
      imbalance[dof] = image[dof] - load[dof];
    }
    judgeRows(sum, contact, imbalance, result);
    for (std::size_t dof = 0; dof < size_; ++dof)
      if (isFixed_[dof])
        imbalance[dof] = 0.0;
    const double forces = std::max({norm(image), norm(load), norm(contactForces(contact))});
    project(tieDirections(), imbalance);
    result.imbalance = forces > 0.0 ? std::max(0.0, norm(imbalance) - std::sqrt(rounding)) / forces : 0.0;
    return result;
  }

 private:
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

  void judgeRows(const std::vector<double>& u, const std::vector<run::ContactState>& contact,
                 std::vector<double>& imbalance, Judgement& result) const {
    double largest = 0.0, leastForce = 0.0, total = 0.0, moment = 0.0;
    std::size_t inequality = 0;
    for (const ConstraintRow& row : rows_) {
      double w = 0.0;
      for (const ConstraintRow::Term& term : row.terms)
        w += term.coefficient * u[shared_.at(term.dof)];
      const double excess = w - row.bound;
      if (row.kind == ConstraintRow::Kind::Equality)
        result.tieJump = std::max(result.tieJump, std::abs(excess));
      if (row.kind != ConstraintRow::Kind::Inequality)
        continue;
      result.penetration = std::max(result.penetration, excess);
      const double force = contact.at(inequality++).force;
      for (const ConstraintRow::Term& term : row.terms)
        imbalance[shared_.at(term.dof)] += force * term.coefficient;
      largest = std::max(largest, std::abs(force));
      leastForce = std::min(leastForce, force);
      total += std::abs(force);
      moment += std::abs(force * excess);
    }
    result.pull = largest > 0.0 ? -leastForce / largest : 0.0;
    result.forceAtDistance = total > 0.0 ? moment / total : 0.0;
    judgeFriction(u, contact, largest, imbalance, result);
  }

  // By the law itself: |λ_t| ≤ g and g|w| = λ_t·w at each point.
  void judgeFriction(const std::vector<double>& u, const std::vector<run::ContactState>& contact,
                     double largest, std::vector<double>& imbalance, Judgement& result) const {
    std::map<long long, const ConstraintRow*> limited;
    for (const ConstraintRow& row : rows_)
      if (row.kind == ConstraintRow::Kind::Limited)
        limited[row.number] = &row;
    double limits = 0.0, against = 0.0;
    for (const contact::SlipPoint& point : contact_.slips) {
      const run::ContactState& state = contact.at(point.point);
      double force2 = 0.0, slip2 = 0.0, product = 0.0;
      for (std::size_t t = 0; t < point.tangents.size(); ++t) {
        const ConstraintRow& row = *limited.at(static_cast<long long>(point.firstRow + t));
        double slip = -row.bound, force = 0.0;
        for (std::size_t d = 0; d < 3; ++d)
          force -= state.tangentialForce[d] * point.tangents[t][d];
        for (const ConstraintRow::Term& term : row.terms) {
          slip += term.coefficient * u[shared_.at(term.dof)];
          imbalance[shared_.at(term.dof)] += force * term.coefficient;
        }
        force2 += force * force;
        slip2 += slip * slip;
        product += force * slip;
      }
      const double limit = point.follows ? point.coefficient * std::max(0.0, state.force) : point.limit;
      result.overLimit = std::max(result.overLimit, std::sqrt(force2) - limit);
      limits += limit;
      against += limit * std::sqrt(slip2) - product;
    }
    // Where contact is open everywhere, slips are free.
    result.overLimit /= std::max({largest, limits, std::numeric_limits<double>::min()});
    result.slipAgainst = limits > 0.0 ? against / limits : 0.0;
  }

  std::vector<double> contactForces(const std::vector<run::ContactState>& contact) const {
    std::vector<double> forces(size_, 0.0);
    std::size_t inequality = 0;
    for (const ConstraintRow& row : rows_)
      if (row.kind == ConstraintRow::Kind::Inequality) {
        for (const ConstraintRow::Term& term : row.terms)
          forces[shared_.at(term.dof)] += contact.at(inequality).force * term.coefficient;
        ++inequality;
      }
    return forces;
  }

  // An orthonormal basis of the forces that ties may exert on dofs that are not prescribed.
  std::vector<std::vector<double>> tieDirections() const {
    std::vector<std::vector<double>> basis;
    for (const ConstraintRow& row : rows_) {
      if (row.kind != ConstraintRow::Kind::Equality)
        continue;
      std::vector<double> v(size_, 0.0);
      for (const ConstraintRow::Term& term : row.terms)
        if (const std::size_t dof = shared_.at(term.dof); !isFixed_[dof])
          v[dof] += term.coefficient;
      const double before = norm(v);
      project(basis, v);
      const double after = norm(v);
      if (!(after > 1e-10 * before)) // depends on the others, or holds prescribed values alone
        continue;
      for (double& value : v)
        value /= after;
      basis.push_back(std::move(v));
    }
    return basis;
  }

  const scene::Scene& scene_;
  std::vector<feti::Subdomain> pieces_;
  scene::ContactSetup contact_;
  std::vector<ConstraintRow> rows_;
  std::map<long long, std::size_t> shared_;    // dofs by their global number
  std::vector<std::vector<std::size_t>> dofs_; // of the whole, of each local dof
  std::size_t size_ = 0;
  std::vector<bool> isFixed_;
};

} // namespace

Judgement judge(const scene::Scene& scene, const TestRun& run) {
  std::vector<double> mine;
  for (const std::vector<double>& values : run.solution.displacement)
    mine.insert(mine.end(), values.begin(), values.end());
  // Ranks own consecutive subdomains.
  const Teuchos::Comm<int>& comm = *testComm();
  const std::vector<double> all = gatherAll(comm, mine);
  Judgement result;
  agree(comm, [&] {
    if (comm.getRank() == 0)
      result = Whole(scene).judge(all, run.report);
  });
  Teuchos::broadcast(comm, 0, static_cast<int>(sizeof(result)), reinterpret_cast<char*>(&result));
  return result;
}

} // namespace Harmos
