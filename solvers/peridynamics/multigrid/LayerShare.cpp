#include "peridynamics/multigrid/LayerShare.h"

#include <algorithm>
#include <array>

namespace lamella::peridynamics
{

LayerShare::LayerShare(std::int64_t layers, const Communicator& comm)
  : comm_(comm.parallel() ? &comm : nullptr)
  , begins_{ 0, layers }
{
  if (comm_ == nullptr)
    return;
  const std::int64_t ranks = comm.size();
  begins_.resize(static_cast<std::size_t>(ranks) + 1);
  for (std::int64_t r = 0; r <= ranks; ++r)
    begins_[static_cast<std::size_t>(r)] = layers * r / ranks;
}

std::int64_t LayerShare::fewest() const noexcept
{
  std::int64_t least = begins_.back();
  for (std::size_t r = 1; r < begins_.size(); ++r)
    least = std::min(least, begins_[r] - begins_[r - 1]);
  return least;
}

LayerShare LayerShare::halved(std::int64_t layers) const
{
  LayerShare coarse = *this;
  for (std::int64_t& begin : coarse.begins_)
    begin = (begin + 1) / 2;
  coarse.begins_.back() = layers;
  return coarse;
}

template <class Real>
void LayerShare::exchange(NodeField<Real>& field, std::int64_t depth) const
{
  if (comm_ == nullptr)
    return;
  const NodeLayout& l = field.layout();
  const std::int64_t layer = (l.dimension == 3 ? l.rowsY() : 1) * l.pitch;
  const int bytes = static_cast<int>(depth * layer * static_cast<std::int64_t>(sizeof(Real)));
  const int below = comm_->rank() > 0 ? comm_->rank() - 1 : MPI_PROC_NULL;
  const int above = comm_->rank() + 1 < comm_->size() ? comm_->rank() + 1 : MPI_PROC_NULL;
  std::vector<MPI_Request> requests;
  const auto at = [&](int c, std::int64_t from) { return field.component(c) + l.begin(0) + (from + l.ghost) * layer; };
  for (int c = 0; c < field.components(); ++c)
  {
    MPI_Irecv(at(c, first() - depth), bytes, MPI_BYTE, below, 73, comm_->handle(), &requests.emplace_back());
    MPI_Irecv(at(c, last()), bytes, MPI_BYTE, above, 74, comm_->handle(), &requests.emplace_back());
  }
  for (int c = 0; c < field.components(); ++c)
  {
    MPI_Isend(at(c, last() - depth), bytes, MPI_BYTE, above, 73, comm_->handle(), &requests.emplace_back());
    MPI_Isend(at(c, first()), bytes, MPI_BYTE, below, 74, comm_->handle(), &requests.emplace_back());
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
}

// @param layer bytes of one @param data of layer 0
void LayerShare::gatherBytes(std::byte* data, std::int64_t layer, std::int64_t from, std::int64_t to) const
{
  std::vector<int> counts;
  std::vector<int> begins;
  for (std::size_t r = 0; r + 1 < begins_.size(); ++r)
  {
    const std::int64_t begin = std::clamp(begins_[r], from, to);
    counts.push_back(static_cast<int>(std::clamp(begins_[r + 1], from, to) - begin));
    begins.push_back(static_cast<int>(begin));
  }
  MPI_Datatype type = MPI_DATATYPE_NULL; // counts in layers: longer arrays before an int overflows
  MPI_Type_contiguous(static_cast<int>(layer), MPI_BYTE, &type);
  MPI_Type_commit(&type);
  MPI_Allgatherv(MPI_IN_PLACE, 0, MPI_DATATYPE_NULL, data, counts.data(), begins.data(), type, comm_->handle());
  MPI_Type_free(&type);
}

template <class Real>
void LayerShare::gather(NodeField<Real>& field, std::int64_t from, std::int64_t to) const
{
  if (comm_ == nullptr)
    return;
  const NodeLayout& l = field.layout();
  const std::int64_t layer = (l.dimension == 3 ? l.rowsY() : 1) * l.pitch;
  for (int c = 0; c < field.components(); ++c)
    gatherBytes(reinterpret_cast<std::byte*>(field.component(c) + l.begin(0) + l.ghost * layer),
      layer * static_cast<std::int64_t>(sizeof(Real)), from, to);
}

template <class Real>
void LayerShare::gather(NodeField<Real>& field) const
{
  gather(field, 0, begins_.back());
}

template <class T>
void LayerShare::gather(std::vector<T>& values) const
{
  if (comm_ == nullptr)
    return;
  const auto layers = static_cast<std::size_t>(begins_.back());
  gatherBytes(reinterpret_cast<std::byte*>(values.data()),
    static_cast<std::int64_t>(values.size() / layers * sizeof(T)), 0, begins_.back());
}

template void LayerShare::exchange(NodeField<float>&, std::int64_t) const;
template void LayerShare::exchange(NodeField<double>&, std::int64_t) const;
template void LayerShare::gather(NodeField<float>&) const;
template void LayerShare::gather(NodeField<double>&) const;
template void LayerShare::gather(NodeField<float>&, std::int64_t, std::int64_t) const;
template void LayerShare::gather(NodeField<double>&, std::int64_t, std::int64_t) const;
template void LayerShare::gather(std::vector<double>&) const;
template void LayerShare::gather(std::vector<float>&) const;

} // namespace lamella::peridynamics
