// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_CgOptions.hpp"
#include "Harmos_SolverMonitor.hpp"

#include <BelosMultiVecTraits.hpp>
#include <Teuchos_LAPACK.hpp>
#include <Teuchos_RCP.hpp>
#include <Teuchos_SerialDenseMatrix.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace Harmos::qp {

/// The directions P = (p_1 … p_k) of conjugate gradients and their images Q = AP, against which a
/// new direction is conjugated again: p ← p − P(PᵀQ)⁻¹(Qᵀp), PᵀQ diagonal (full conjugation; Farhat,
/// Lesoinne, Le Tallec, Pierson, Rixen, Int. J. Numer. Meth. Engng. 50, 2001, section 3; Roux, SIAM J. Sci.
/// Stat. Comput. 6, 1985).
///
/// In floating point arithmetic the short recurrence loses conjugacy as soon as a Ritz vector has converged
/// (Paige, J. Inst. Math. Appl. 18, 1976), and then finds the same vector again and again; the number of
/// steps is no longer bounded by the dimension. Conjugacy to √ε is enough for steps as in exact arithmetic
/// (Simon, Math. Comp. 42, 1984): with Reorthogonalisation::Auto, PᵀAp is looked at every few steps, and
/// conjugation begins while it is still a hundredth of √ε. Stored directions that are worse than a few √ε
/// would make a projector of no use, and are dropped: the store begins again, and on all later faces at once.
///
/// When the store is full, the directions in it go on to be used: converged Ritz vectors, along which
/// conjugacy is lost, are spanned by the early ones.
///
/// Cost: two vectors of memory a direction; a step with conjugation reads P and Q once, and has one reduction
/// of k numbers; without, two vectors are copied and every `checkInterval` steps P is read.
/// Guarded by tests/unit/qp/test_projected_cg.cpp.
template<class Scalar, class MV>
class ConjugateDirections {
 public:
  explicit ConjugateDirections(const CgOptions& options)
      : options_(options), isOn_(options.reorthogonalisation == Reorthogonalisation::Full) {}

  /// Forgets all of them: another face, or another beginning.
  void clear() {
    count_ = 0;
    steps_ = 0;
  }

  int size() const { return count_; }
  /// Whether new directions are conjugated.
  bool isOn() const { return isOn_; }

  /// @param image Ap, or what remains of it on the face and in the kernel of the rows. @param energy pᵀAp >
  /// 0. @param length of the step along p.
  /// @note Collective.
  void add(const MV& p, const MV& image, double energy, double length) {
    if (options_.reorthogonalisation == Reorthogonalisation::None)
      return;
    if (++steps_ % checkInterval == 0 && count_ > 0) {
      const double found = loss(image, energy);
      isOn_ = isOn_ || found > noise;
      if (found > useful)
        count_ = 0;
    }
    if (count_ == options_.storedDirections)
      return;
    reserve(p);
    const Teuchos::Range1D column(count_, count_);
    MVT::SetBlock(p, column, *directions_);
    MVT::SetBlock(image, column, *images_);
    energies_.resize(static_cast<std::size_t>(count_));
    energies_.push_back(energy);
    lengths_.resize(static_cast<std::size_t>(count_));
    lengths_.push_back(length);
    ++count_;
  }

  /// All of them. @param like a vector of their shape. @note Collective.
  void exchange(StateArchive<MV>& archive, const MV& like) {
    archive.number("directions stored", count_);
    archive.number("directions since checks", steps_);
    archive.number("directions conjugated", isOn_);
    archive.numbers("directions energies", energies_);
    archive.numbers("directions lengths", lengths_);
    if (count_ == 0)
      return;
    const Teuchos::Range1D stored(0, count_ - 1);
    if (archive.isReading())
      capacity_ = std::max(capacity_, count_);
    for (Teuchos::RCP<MV>* block : {&directions_, &images_}) {
      const Teuchos::RCP<MV> columns = MVT::Clone(like, count_);
      if (!archive.isReading())
        MVT::SetBlock(*view(**block), stored, *columns);
      archive.vector(block == &directions_ ? "directions" : "directions images", *columns);
      if (archive.isReading()) {
        *block = MVT::Clone(like, capacity_);
        MVT::SetBlock(*columns, stored, **block);
      }
    }
  }

  /// Ritz vectors of M⁻¹A in the span of P: those of the largest Ritz values, of values above `ratio` times
  /// the least one, and of no more than five in six, since the others have not converged; null for none.
  /// @note Collective.
  Teuchos::RCP<MV> ritzVectors(int most, double ratio) const {
    if (count_ < 4)
      return Teuchos::null;
    // z_j = M⁻¹w_j = p_j − (ρ_j/ρ_{j−1})p_{j−1}, ρ_j = w_jᵀz_j = (step length) p_jᵀAp_j; the Lanczos basis is
    // z_j/√ρ_j, where A becomes tridiagonal (Saad, Iterative Methods for Sparse Linear Systems, 2003, 6.7.3).
    const auto n = static_cast<std::size_t>(count_);
    std::vector<double> weight(n), diagonal(n), below(n), vectors(n * n), work(2 * n);
    for (std::size_t j = 0; j < n; ++j)
      weight[j] = lengths_[j] * energies_[j];
    for (std::size_t j = 0; j < n; ++j) {
      const double beta = j > 0 ? weight[j] / weight[j - 1] : 0.0;
      diagonal[j] = 1.0 / lengths_[j] + (j > 0 ? beta / lengths_[j - 1] : 0.0);
      if (j > 0)
        below[j - 1] = -std::sqrt(beta) / lengths_[j - 1];
    }
    int info = 0;
    Teuchos::LAPACK<int, double>().STEQR('I', count_, diagonal.data(), below.data(), vectors.data(), count_,
                                         work.data(), &info);
    if (info != 0)
      return Teuchos::null;
    const int converged = std::min(most, 5 * count_ / 6);
    int chosen = 0;
    while (chosen < converged && diagonal[n - 1 - static_cast<std::size_t>(chosen)] > ratio * diagonal[0])
      ++chosen;
    if (chosen == 0)
      return Teuchos::null;
    Matrix coefficients(count_, chosen);
    for (int k = 0; k < chosen; ++k)
      for (int j = 0; j < count_; ++j) {
        const auto place = static_cast<std::size_t>(j);
        const double s =
            vectors[(n - 1 - static_cast<std::size_t>(k)) * n + place] / std::sqrt(weight[place]);
        coefficients(j, k) += s;
        if (j > 0)
          coefficients(j - 1, k) -= s * weight[place] / weight[place - 1];
      }
    const Teuchos::RCP<MV> result = MVT::Clone(*directions_, chosen);
    MVT::MvTimesMatAddMv(1.0, *view(*directions_), coefficients, 0.0, *result);
    return result;
  }

  /// p ← p − P(PᵀQ)⁻¹(Qᵀp), if conjugation is on. @note Collective.
  void conjugate(MV& p) const {
    if (!isOn_ || count_ == 0)
      return;
    Matrix coefficients(count_, 1);
    MVT::MvTransMv(1.0, *view(*images_), p, coefficients);
    for (int i = 0; i < count_; ++i)
      coefficients(i, 0) /= energies_[static_cast<std::size_t>(i)];
    MVT::MvTimesMatAddMv(-1.0, *view(*directions_), coefficients, 1.0, p);
  }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Matrix = Teuchos::SerialDenseMatrix<int, Scalar>;
  static constexpr int checkInterval = 10;
  // √ε is 1.5e-8; the loss grows until the next check.
  static constexpr double noise = 1e-10, useful = 1e-7;

  // max |p_iᵀAp|/√(p_iᵀAp_i pᵀAp)
  double loss(const MV& image, double energy) const {
    Matrix products(count_, 1);
    MVT::MvTransMv(1.0, *view(*directions_), image, products);
    double largest = 0.0;
    for (int i = 0; i < count_; ++i)
      largest = std::max(largest, std::abs(products(i, 0)) /
                                      std::sqrt(energies_[static_cast<std::size_t>(i)] * energy));
    return largest;
  }

  Teuchos::RCP<const MV> view(const MV& block) const {
    return MVT::CloneView(block, Teuchos::Range1D(0, count_ - 1));
  }

  // One block for each of P and Q, so that a product is one reduction; it doubles when it is full.
  void reserve(const MV& like) {
    if (count_ < capacity_)
      return;
    capacity_ = std::min(options_.storedDirections, std::max(2 * checkInterval, 2 * count_));
    for (Teuchos::RCP<MV>* block : {&directions_, &images_}) {
      const Teuchos::RCP<MV> larger = MVT::Clone(like, capacity_);
      if (count_ > 0)
        MVT::SetBlock(*view(**block), Teuchos::Range1D(0, count_ - 1), *larger);
      *block = larger;
    }
  }

  CgOptions options_;
  Teuchos::RCP<MV> directions_, images_;
  std::vector<double> energies_; // p_iᵀAp_i
  std::vector<double> lengths_;  // of steps
  int count_ = 0, capacity_ = 0, steps_ = 0;
  bool isOn_ = false;
};

} // namespace Harmos::qp
