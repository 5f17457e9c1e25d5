// SPDX-License-Identifier: BSD-3-Clause
#include "Harmos_SubdomainSum.hpp"

#include "Harmos_Agreement.hpp"

#include <Tpetra_Import.hpp>
#include <Tpetra_MultiVector.hpp>

#include <algorithm>
#include <limits>

namespace Harmos::feti {

namespace {

// t ← C_iᵀx of all members, one vector after the other.
void gather(const SubdomainSum::Group& group, const double* in, std::size_t stride, std::size_t count,
            std::vector<double>& t) {
  const std::size_t size =
      static_cast<std::size_t>(group.op->size()) * static_cast<std::size_t>(group.members);
  t.assign(size * count, 0.0);
  for (std::size_t c = 0; c < count; ++c)
    for (const SubdomainSum::Entry& entry : group.entries)
      t[c * size + static_cast<std::size_t>(entry.place)] +=
          entry.value * in[c * stride + static_cast<std::size_t>(entry.row)];
}

// y ← y + C_iu.
void scatter(const SubdomainSum::Group& group, const std::vector<double>& u, double* out, std::size_t stride,
             std::size_t count) {
  const std::size_t size =
      static_cast<std::size_t>(group.op->size()) * static_cast<std::size_t>(group.members);
  for (std::size_t c = 0; c < count; ++c)
    for (const SubdomainSum::Entry& entry : group.entries)
      out[c * stride + static_cast<std::size_t>(entry.row)] +=
          entry.value * u[c * size + static_cast<std::size_t>(entry.place)];
}

} // namespace

SubdomainSum::SubdomainSum(Teuchos::RCP<const Import> importer, std::vector<Group> groups,
                           std::shared_ptr<const ClusterInverse> joined)
    : importer_(std::move(importer)), groups_(std::move(groups)), joined_(std::move(joined)) {}

Teuchos::RCP<const Map> SubdomainSum::getDomainMap() const {
  return importer_->getSourceMap();
}

void SubdomainSum::applyLocally(const double* in, double* out, std::size_t stride, int columns) const {
  const auto count = static_cast<std::size_t>(columns);
  for (const Group& group : groups_) {
    gather(group, in, stride, count, t_);
    u_.resize(t_.size());
    group.op->apply(t_.data(), u_.data(), group.members * columns);
    scatter(group, u_, out, stride, count);
  }
}

// What joins subdomains needs all of them before any has its answer.
void SubdomainSum::applyJoined(const double* in, double* out, std::size_t stride, int columns) const {
  const auto count = static_cast<std::size_t>(columns);
  us_.resize(groups_.size());
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    gather(groups_[g], in, stride, count, t_);
    us_[g].resize(t_.size());
    groups_[g].op->apply(t_.data(), us_[g].data(), groups_[g].members * columns);
    joined_->gather(g, t_.data(), columns);
  }
  joined_->solve(columns);
  for (std::size_t g = 0; g < groups_.size(); ++g) {
    joined_->add(g, us_[g].data(), columns);
    scatter(groups_[g], us_[g], out, stride, count);
  }
}

void SubdomainSum::apply(const MultiVector& X, MultiVector& Y, Teuchos::ETransp, Scalar alpha,
                         Scalar beta) const {
  const std::size_t columns = X.getNumVectors();
  if (in_.is_null() || in_->getNumVectors() != columns) {
    in_ = Teuchos::rcp(new MultiVector(importer_->getTargetMap(), columns));
    out_ = Teuchos::rcp(new MultiVector(importer_->getTargetMap(), columns));
    image_ = Teuchos::rcp(new MultiVector(getDomainMap(), columns));
  }
  in_->doImport(X, *importer_, Tpetra::INSERT);
  {
    const auto in = in_->getLocalViewHost(Tpetra::Access::ReadOnly);
    const auto out = out_->getLocalViewHost(Tpetra::Access::OverwriteAll);
    const std::size_t rows = out.extent(0);
    constexpr std::size_t atOnce = 32;
    for (std::size_t c = 0; c < columns && rows > 0; c += atOnce) {
      const std::size_t count = std::min(atOnce, columns - c);
      const auto fill = [&](double value) {
        for (std::size_t k = c; k < c + count; ++k)
          std::fill(&out(0, k), &out(0, k) + rows, value);
      };
      fill(0.0);
      try {
        if (joined_ == nullptr)
          applyLocally(&in(0, c), &out(0, c), out.stride(1), static_cast<int>(count));
        else
          applyJoined(&in(0, c), &out(0, c), out.stride(1), static_cast<int>(count));
      } catch (...) {
        failure_ = std::current_exception();
        fill(std::numeric_limits<double>::quiet_NaN());
      }
    }
  }
  image_->putScalar(0.0); // versions of Tpetra differ in whether ADD overwrites what is the rank's own
  image_->doExport(*out_, *importer_, Tpetra::ADD);
  if (beta == 0.0)
    Y.scale(alpha, *image_); // Y may be uninitialised: 0·NaN is to be avoided
  else
    Y.update(alpha, *image_, beta);
}

void SubdomainSum::rethrowFailure() const {
  agreeOnFailure(*getDomainMap()->getComm(), failure_);
}

} // namespace Harmos::feti
