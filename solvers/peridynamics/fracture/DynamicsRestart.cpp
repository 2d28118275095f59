// What bonds in motion keep on disk, and how they go on from it.
#include "core/Error.h"
#include "peridynamics/fracture/Dynamics.h"

#include <fmt/format.h>

namespace lamella::peridynamics
{
namespace
{

constexpr const char* motionKind = "bonds in motion";

} // namespace

std::string BondDynamics::scene() const
{
  const NodeLayout& l = u_.layout();
  std::string text = sceneOf(bonds_);
  const auto line = [&](const char* name, const auto& value) { text += fmt::format("{}: {}\n", name, value); };
  if (masses_)
    line("masses",
      hashOfRows(bonds_,
        [&](std::int64_t y, std::int64_t z)
        {
          const double* row = masses_->component(0) + l.index(0, y, z);
          return std::string(reinterpret_cast<const char*>(row), static_cast<std::size_t>(l.size[0]) * sizeof(double));
        })
        .substr(0, 16));
  else
    line("density", options_.density);
  line("step", dt_);
  line("viscosity", nu_);
  line("bonds break", options_.breaking ? "yes" : "no");
  line("relaxation of the loading rate", rate_ ? rate_->relaxation() : 0);
  line("reference energy of the loading rate", rate_ ? rate_->reference() : 0);
  line("which components are fixed",
    hashOfRows(bonds_,
      [&](std::int64_t y, std::int64_t z)
      {
        const std::uint8_t* row = fixed_.data() + l.index(0, y, z);
        return std::string(row, row + l.size[0]);
      })
      .substr(0, 16));
  return text;
}

void BondDynamics::save()
{
  const Communicator& comm = bonds_.communicator();
  io::Checkpoint c;
  c.kind = motionKind;
  c.scene = scene_;
  c.provenance = options_.checkpoint.provenance;
  c.arrays["displacement"] = gathered(bonds_, u_, "m", "displacement");
  c.arrays["velocity"] = gathered(bonds_, v_, "m/s", "velocity");
  const char* newton = bonds_.dimension() == 3 ? "N" : "N/m";
  c.arrays["force"] = gathered(bonds_, f_, newton, "force of the bonds on the nodes");
  if (load_)
    c.arrays["load"] = gathered(bonds_, *load_, newton, "force on the nodes from outside");
  if (imposed_)
    c.arrays["imposed_velocity"] = gathered(bonds_, *imposed_, "m/s", "velocity of fixed components at a rate of 1");
  const char* joule = bonds_.dimension() == 3 ? "J" : "J/m";
  c.arrays["sums"] = { { comm.size(), 2 }, comm.gather(std::array{ sums_.supplied, sums_.damped }), joule,
    "energy supplied and damped, by rank" };
  std::vector<Bond> list;
  std::vector<std::int64_t> step;
  std::vector<double> time;
  std::vector<double> energy;
  for (const DynamicBreak& b : broken_)
  {
    list.push_back(b.bond);
    step.push_back(b.step);
    time.push_back(b.time);
    energy.push_back(b.energy);
  }
  const auto count = static_cast<std::int64_t>(list.size());
  c.arrays["broken"] = arrayOf(list);
  c.arrays["broken_step"] = { { count }, std::move(step), "", "at which the bond broke" };
  c.arrays["broken_time"] = { { count }, std::move(time), "s", "when the bond broke" };
  c.arrays["broken_energy"] = { { count }, std::move(energy), joule, "that the bond held" };
  c.numbers = { { "steps", static_cast<double>(step_) }, { "time", time_ }, { "broken energy", brokenEnergy_ },
    { "initial energy", initial_ }, { "rate", rate() }, { "damage", rate_ ? rate_->damage() : 0 } };
  if (options_.keepWith)
    options_.keepWith(c);
  pace_.written();
  if (write(std::move(c), options_.checkpoint, comm))
  {
    ++checkpoints_;
    checkpointAt_ = step_;
  }
}

void BondDynamics::restore()
{
  const Communicator& comm = bonds_.communicator();
  const io::Checkpoint c = io::readCheckpoint(options_.continueFrom, motionKind, scene_, comm);
  u_ = scattered(bonds_, c, "displacement");
  v_ = scattered(bonds_, c, "velocity");
  f_ = scattered(bonds_, c, "force");
  bonds_.exchange(u_);
  if (c.arrays.contains("load"))
    load_ = scattered(bonds_, c, "load");
  if (c.arrays.contains("imposed_velocity"))
    imposed_ = scattered(bonds_, c, "imposed_velocity");
  const std::vector<double>& sums = c.reals("sums");
  const auto rank = static_cast<std::size_t>(comm.rank());
  if (sums.size() == 2 * static_cast<std::size_t>(comm.size()))
    sums_ = { sums[2 * rank], sums[2 * rank + 1] };
  else if (rank == 0)
    for (std::size_t k = 0; k + 1 < sums.size(); k += 2)
      sums_ = { sums_.supplied + sums[k], sums_.damped + sums[k + 1] };
  const std::vector<Bond> list = bondsIn(c, "broken", bonds_);
  const auto& step = c.integers("broken_step");
  const auto& time = c.reals("broken_time");
  const auto& energy = c.reals("broken_energy");
  if (step.size() != list.size() || time.size() != list.size() || energy.size() != list.size() || sums.size() % 2 != 0)
    throw InputError("the checkpoint's broken bonds are not as many everywhere", "start the run anew");
  for (const char* const name : { "displacement", "velocity", "force", "sums", "broken_time", "broken_energy", "time",
         "broken energy", "initial energy" })
    c.expectFinite(name);
  for (std::size_t k = 0; k < list.size(); ++k)
    broken_.push_back({ list[k], step.at(k), time.at(k), energy.at(k) });
  bonds_.breakBonds(comm.rank() == 0 ? std::span<const Bond>(list) : std::span<const Bond>());
  step_ = c.count("steps");
  time_ = c.number("time");
  brokenEnergy_ = c.number("broken energy");
  initial_ = c.number("initial energy");
  if (rate_)
    rate_->set(c.number("rate"), c.number("damage"));
  if (options_.takeBack)
    options_.takeBack(c);
}

} // namespace lamella::peridynamics
