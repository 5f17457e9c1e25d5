// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_SolverMonitor.hpp"
#include "Harmos_VectorOps.hpp"

#include <BelosMultiVecTraits.hpp>
#include <Teuchos_RCP.hpp>
#include <Teuchos_SerialDenseMatrix.hpp>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace Harmos::qp {

/// A direction p on a face where limits follow, and what it does: Ap, what remains of that on the face (w),
/// what of it the rows take away (ν), and C̄p.
template<class MV>
struct ResidualDirection {
  Teuchos::RCP<MV> p, image, onFace;
  Teuchos::RCP<MV> removed, rows; ///< null without rows
};

/// Directions of least residuals for a matrix that is not symmetric: the images (w, sC̄p) are made orthogonal
/// to each other, and each step takes from the residual what its image can (GCR: Eisenstat, Elman, Schultz,
/// SIAM J. Numer. Anal. 20, 1983). Residuals are those of GMRES.
///
/// Cost: three vectors of memory a direction; a step reads the images once more than twice, with two
/// reductions. Guarded by tests/unit/qp/test_following_limits.cpp.
template<class Scalar, class MV>
class ResidualDirections {
 public:
  void clear() { count_ = 0; }
  int size() const { return count_; }
  /// s, fixed while there are directions: C̄x is compared with forces.
  double rowWeight() const { return rowWeight_; }
  void setRowWeight(double weight) { rowWeight_ = weight; }

  /// wᵀw' + s²ρᵀρ'. @param rows, otherRows null without rows. @note Collective.
  double product(const MV& w, const MV* rows, const MV& other, const MV* otherRows) const {
    double sum = dot<Scalar>(w, other);
    if (rows != nullptr)
      sum += rowWeight_ * rowWeight_ * dot<Scalar>(*rows, *otherRows);
    return sum;
  }

  /// Takes what the images before have of its own from the direction; twice is enough. @note Collective.
  void orthogonalise(ResidualDirection<MV>& d) const {
    for (int pass = 0; pass < 2 && count_ > 0; ++pass) {
      Matrix coefficients(count_, 1);
      MVT::MvTransMv(1.0, *view(blocks_[2]), *d.onFace, coefficients);
      for (int i = 0; i < count_; ++i) {
        if (!d.rows.is_null())
          coefficients(i, 0) += rowWeight_ * rowWeight_ * dot<Scalar>(*rowParts_[place(i)].second, *d.rows);
        coefficients(i, 0) /= norms2_[place(i)];
      }
      int block = 0;
      for (MV* part : {d.p.get(), d.image.get(), d.onFace.get()})
        MVT::MvTimesMatAddMv(-1.0, *view(blocks_[block++]), coefficients, 1.0, *part);
      for (int i = 0; i < count_ && !d.rows.is_null(); ++i) {
        MVT::MvAddMv(1.0, *d.removed, -coefficients(i, 0), *rowParts_[place(i)].first, *d.removed);
        MVT::MvAddMv(1.0, *d.rows, -coefficients(i, 0), *rowParts_[place(i)].second, *d.rows);
      }
    }
  }

  /// @param norm2 of its image, above zero.
  void add(const ResidualDirection<MV>& d, double norm2) {
    reserve(*d.p);
    const Teuchos::Range1D column(count_, count_);
    int block = 0;
    for (const MV* part : {d.p.get(), d.image.get(), d.onFace.get()})
      MVT::SetBlock(*part, column, *blocks_[block++]);
    norms2_.resize(place(count_));
    norms2_.push_back(norm2);
    rowParts_.resize(place(count_));
    if (!d.rows.is_null())
      rowParts_.emplace_back(MVT::CloneCopy(*d.removed), MVT::CloneCopy(*d.rows));
    ++count_;
  }

  /// All of them. @param like, likeRows vectors of their shapes. @note Collective.
  void exchange(StateArchive<MV>& archive, const MV& like, const MV* likeRows) {
    archive.number("coupled stored", count_);
    archive.number("coupled weight", rowWeight_);
    archive.numbers("coupled norms", norms2_);
    if (count_ == 0)
      return;
    const char* const names[] = {"coupled directions", "coupled images", "coupled residuals"};
    if (archive.isReading())
      capacity_ = std::max(capacity_, count_);
    for (int block = 0; block < 3; ++block) {
      const Teuchos::Range1D stored(0, count_ - 1);
      const Teuchos::RCP<MV> columns = MVT::Clone(like, count_);
      if (!archive.isReading())
        MVT::SetBlock(*view(blocks_[block]), stored, *columns);
      archive.vector(names[block], *columns);
      if (archive.isReading()) {
        blocks_[block] = MVT::Clone(like, capacity_);
        MVT::SetBlock(*columns, stored, *blocks_[block]);
      }
    }
    if (likeRows == nullptr)
      return;
    if (archive.isReading())
      for (rowParts_.clear(); rowParts_.size() < place(count_);)
        rowParts_.emplace_back(MVT::CloneCopy(*likeRows), MVT::CloneCopy(*likeRows));
    for (int i = 0; i < count_; ++i) {
      archive.rowVector("coupled removed " + std::to_string(i), *rowParts_[place(i)].first);
      archive.rowVector("coupled rows " + std::to_string(i), *rowParts_[place(i)].second);
    }
  }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Matrix = Teuchos::SerialDenseMatrix<int, Scalar>;
  static std::size_t place(int i) { return static_cast<std::size_t>(i); }

  Teuchos::RCP<const MV> view(const Teuchos::RCP<MV>& block) const {
    return MVT::CloneView(*block, Teuchos::Range1D(0, count_ - 1));
  }

  void reserve(const MV& like) {
    if (count_ < capacity_)
      return;
    constexpr int few = 20;
    capacity_ = std::max(few, 2 * count_);
    for (Teuchos::RCP<MV>& block : blocks_) {
      const Teuchos::RCP<MV> larger = MVT::Clone(like, capacity_);
      if (count_ > 0)
        MVT::SetBlock(*view(block), Teuchos::Range1D(0, count_ - 1), *larger);
      block = larger;
    }
  }

  Teuchos::RCP<MV> blocks_[3];                                          // p, Ap, w
  std::vector<std::pair<Teuchos::RCP<MV>, Teuchos::RCP<MV>>> rowParts_; // ν, C̄p
  std::vector<double> norms2_;
  double rowWeight_ = 0.0;
  int count_ = 0, capacity_ = 0;
};

} // namespace Harmos::qp
