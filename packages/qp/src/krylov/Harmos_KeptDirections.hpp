// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "Harmos_BlockOps.hpp"
#include "Harmos_EqualityRows.hpp"
#include "Harmos_FaceOps.hpp"
#include "Harmos_SolverMonitor.hpp"
#include "Harmos_VectorOps.hpp"

#include <BelosMultiVecTraits.hpp>
#include <BelosOperatorTraits.hpp>
#include <Teuchos_RCP.hpp>
#include <Teuchos_SerialDenseMatrix.hpp>

#include <cmath>

namespace Harmos::qp {

/// Directions U with UᵀAU = I that are valid on every face: without entries at bounds, soft or not, and in
/// the kernel of the rows. Conjugate gradients that begin at the minimum along them, with directions
/// conjugate to them, do not see the eigenvalues that they stand for (deflation; Nicolaides, SIAM J. Numer.
/// Anal. 24, 1987; Saad, Yeung, Erhel, Guyomarc'h, SIAM J. Sci. Comput. 21, 2000).
///
/// In the dual problem a few subdomains of bad shape make a few eigenvalues of M⁻¹A that are thousands of
/// times the others. Conjugate gradients find them anew on each face, since each begins a new sequence;
/// their Ritz vectors from one face, at a product each, spare that on all the others.
///
/// Guarded by tests/unit/qp/newton/test_kept_directions.cpp.
template<class Scalar, class MV, class OP>
class KeptDirections {
 public:
  KeptDirections(const Problem<Scalar, MV, OP>& problem, const EqualityRows<Scalar, MV, OP>& rows)
      : problem_(problem), rows_(rows) {}

  int size() const { return static_cast<int>(count_); }

  /// Adds what of given columns is valid on every face and independent of those that are here.
  /// @note Collective; a product with A a column.
  void add(const MV& columns, Counters& counters) {
    const int given = static_cast<int>(MVT::GetNumberVecs(columns));
    const ActiveFace bounded = allBounds();
    const Teuchos::RCP<MV> u = MVT::Clone(columns, 1), image = MVT::Clone(columns, 1);
    reserve(columns, count_ + given);
    const Teuchos::RCP<const FaceGram<MV>> gram = rows_.isPresent() ? rows_.faceGram(bounded) : Teuchos::null;
    for (int k = 0; k < given; ++k) {
      MVT::Assign(*MVT::CloneView(columns, Teuchos::Range1D(k, k)), *u);
      const double before = norm<Scalar>(*u);
      Faces::mask(*u, bounded);
      if (!moveToKernel(gram, bounded, *u))
        continue;
      orthogonalise(*u, nullptr);
      if (!(norm<Scalar>(*u) > least * before))
        continue;
      ++counters.hessianApplications;
      Belos::OperatorTraits<Scalar, MV, OP>::Apply(*problem_.hessian(), *u, *image);
      orthogonalise(*u, image.get());
      const double energy = dot<Scalar>(*u, *image);
      if (!(energy > 0.0))
        continue;
      MVT::MvScale(*u, 1.0 / std::sqrt(energy));
      MVT::MvScale(*image, 1.0 / std::sqrt(energy));
      MVT::SetBlock(*u, Teuchos::Range1D(count_, count_), *directions_);
      MVT::SetBlock(*image, Teuchos::Range1D(count_, count_), *images_);
      ++count_;
    }
  }

  /// p ← p − U(AU)ᵀp. @note Collective, if there are any.
  void conjugate(MV& p) const {
    if (count_ == 0)
      return;
    Matrix coefficients(count_, 1);
    MVT::MvTransMv(1.0, *view(*images_), p, coefficients);
    MVT::MvTimesMatAddMv(-1.0, *view(*directions_), coefficients, 1.0, p);
  }

  /// x ← the minimum of the cost on x + span U, g ← its gradient. @note Collective, if there are any.
  void minimise(MV& x, MV& gradient) const {
    if (count_ == 0)
      return;
    Matrix coefficients(count_, 1);
    MVT::MvTransMv(1.0, *view(*directions_), gradient, coefficients);
    MVT::MvTimesMatAddMv(-1.0, *view(*directions_), coefficients, 1.0, x);
    MVT::MvTimesMatAddMv(-1.0, *view(*images_), coefficients, 1.0, gradient);
  }

  void exchange(StateArchive<MV>& archive, const MV& like) {
    archive.number("kept directions", count_);
    if (count_ == 0)
      return;
    for (Teuchos::RCP<MV>* block : {&directions_, &images_}) {
      const Teuchos::RCP<MV> columns =
          archive.isReading() ? MVT::Clone(like, count_) : MVT::CloneCopy(*view(**block));
      archive.vector(block == &directions_ ? "kept" : "kept images", *columns);
      if (archive.isReading())
        *block = columns;
    }
  }

 private:
  using MVT = Belos::MultiVecTraits<Scalar, MV>;
  using Faces = FaceOps<Scalar, MV>;
  using Matrix = Teuchos::SerialDenseMatrix<int, Scalar>;
  // Of a vector that must be left without its entries at bounds and what is here already.
  static constexpr double least = 1e-2;

  Teuchos::RCP<const MV> view(const MV& block) const {
    return MVT::CloneView(block, Teuchos::Range1D(0, count_ - 1));
  }

  void reserve(const MV& like, int columns) {
    for (Teuchos::RCP<MV>* block : {&directions_, &images_}) {
      const Teuchos::RCP<MV> larger = MVT::Clone(like, columns);
      if (count_ > 0)
        MVT::SetBlock(*view(**block), Teuchos::Range1D(0, count_ - 1), *larger);
      *block = larger;
    }
  }

  // Entries that can be held on any face, or have curvatures that are none of A.
  ActiveFace allBounds() const {
    const std::size_t length = BoundTraits<Scalar, MV>::length(*problem_.solution());
    const std::vector<char> marked = BlockOps<Scalar, MV>::marked(problem_.blocks(), length);
    return ActiveFace(marked.begin(), marked.end());
  }

  // Where bodies are held by what is bounded alone, there is none for some vectors.
  bool moveToKernel(const Teuchos::RCP<const FaceGram<MV>>& gram, const ActiveFace& bounded, MV& u) const {
    if (gram.is_null())
      return true;
    const Teuchos::RCP<MV> w = rows_.makeVector();
    for (int pass = 0; pass < 2; ++pass) {
      rows_.apply(u, *w);
      gram->solve(*w);
      rows_.addTransposed(-1.0, *w, u);
      Faces::mask(u, bounded);
    }
    rows_.apply(u, *w);
    constexpr double rounding = 1e-10;
    return norm<Scalar>(*w) <= rounding * norm<Scalar>(u);
  }

  void orthogonalise(MV& u, MV* image) const {
    if (count_ == 0)
      return;
    Matrix coefficients(count_, 1);
    MVT::MvTransMv(1.0, *view(*images_), u, coefficients);
    MVT::MvTimesMatAddMv(-1.0, *view(*directions_), coefficients, 1.0, u);
    if (image != nullptr)
      MVT::MvTimesMatAddMv(-1.0, *view(*images_), coefficients, 1.0, *image);
  }

  const Problem<Scalar, MV, OP>& problem_;
  const EqualityRows<Scalar, MV, OP>& rows_;
  Teuchos::RCP<MV> directions_, images_;
  int count_ = 0;
};

} // namespace Harmos::qp
