#include "mpm/PointCompression.h"

#include "core/Error.h"
#include "core/Mix.h"
#include "core/Together.h"
#include "mpm/WaveFactor.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <span>
#include <utility>

namespace lamella::mpm
{
namespace
{

constexpr const char* kind = "compression of material points";
constexpr std::int64_t stride = 200;     // steps from one look at the energies to the next
constexpr std::int64_t sortEvery = 2000; // steps
constexpr double fastWave = 8;           // times the square of a slow wave's speed: ν = 0.43 in plane strain
constexpr double mostForce = 0.2;        // on the sides and between the platens, over the stress, from which it is said
constexpr double leastSteps = 20;        // in half a row
constexpr double aim = 0.6;              // of the energy ratio allowed
constexpr double alarm = 0.85;           // of it, from which speed is taken away
constexpr double lazy = 0.7;             // of the aim, up to which speed is added
constexpr double mostGain = 1.1;         // of speed, at a look
constexpr double mostLoss = 0.25;
constexpr double mostLost = 0.3; // of the work, from which it is said; buckling to 48 % takes 15 to 20 %
constexpr double close = 1e-9;   // of half a row
constexpr int rowValues = sizeof(CompressionRow) / sizeof(double);
constexpr int rowValuesBefore = 13; // of checkpoints without plastic work

void require(bool fine, const std::string& message, const char* hint)
{
  if (!fine)
    throw ParameterError(message, hint);
}

std::span<const double> valuesOf(const CompressionRow& row)
{
  return { reinterpret_cast<const double*>(&row), rowValues }; // NOLINT: a row of doubles
}

/// Of the points of all ranks, wherever they are and in any order: a sum over hashes of their numbers and of what `mix`
/// puts to them. Collective.
template <class Mix>
std::string hashOf(std::span<const std::uint32_t> numbers, const Communicator& comm, Mix&& mix)
{
  std::uint64_t sum = 0;
  for (std::size_t p = 0; p < numbers.size(); ++p)
    sum += mix(mixed(numbers[p]), p);
  // in halves, which do not overflow
  const auto low = static_cast<std::uint64_t>(comm.sum(static_cast<std::int64_t>(sum & 0xffffffffU)));
  const auto high = static_cast<std::uint64_t>(comm.sum(static_cast<std::int64_t>(sum >> 32U)));
  return fmt::format("{:016x}", low + (high << 32U));
}

/// Rank 0's text on every rank.
std::string ofFirst(const Communicator& comm, const std::string& text)
{
  std::vector<std::byte> bytes(text.size());
  std::memcpy(bytes.data(), text.data(), text.size());
  comm.broadcast(bytes);
  return { reinterpret_cast<const char*>(bytes.data()), bytes.size() };
}

} // namespace

template <int Dim>
PointCompression<Dim>::PointCompression(
  MaterialPoints<Dim> points, std::shared_ptr<const PointLaw<Dim>> law, CompressionOptions<Dim> options)
  : options_(std::move(options))
{
  using Points = MaterialPoints<Dim>;
  const Communicator& comm = options_.motion.comm;
  together(comm, [this] { check(); });
  checkTouch(points);
  if (!options_.checkpoint.path.empty() || !options_.continueFrom.empty())
    scene_ = scene(points, *law);
  io::checkPlace(options_.checkpoint, comm);
  auto& motion = options_.motion;
  const int axis = options_.axis;
  const auto at = static_cast<std::size_t>(axis);
  height_ = options_.upper[at] - options_.lower[at];
  area_ = 1;
  for (std::size_t a = 0; a < Dim; ++a)
  {
    std::array<Side, 2>& side = motion.sides[a];
    side = { Side{ Edge::Wall, options_.lower[a] }, Side{ Edge::Wall, options_.upper[a] } };
    if (a == at)
    {
      side[0].sticks = side[1].sticks = options_.grip;
      side[0].friction = side[1].friction = options_.platenFriction;
      continue;
    }
    area_ *= options_.upper[a] - options_.lower[a];
    for (Side& s : side)
    {
      s.edge = options_.sides == LateralSides::Open ? Edge::Open
        : options_.sides == LateralSides::Periodic  ? Edge::Periodic
                                                    : Edge::Wall;
      s.straight = options_.sides == LateralSides::Straight || options_.sides == LateralSides::Periodic;
    }
  }
  // what hardly changes its volume has waves that are far faster than all else it does
  std::vector<double> most;
  for (std::size_t phase = 0; phase < law->phases(); ++phase)
    most.push_back(fastWave * leastResistance(*law, phase) / 2);
  double stiffest = 0;
  for (std::size_t p = 0; p < points.count(); ++p)
    stiffest = std::max(stiffest,
      std::min(most.size() == 1 ? most.front() : most[points.phase()[p]],
        law->stiffness(points.phase()[p], points.matrix(Points::deformations, p), points.vector(Points::axes, p),
          points.memory(p).data())) *
        points.column(Points::volumes)[p] / points.column(Points::masses)[p]);
  wave_ = std::sqrt(comm.max(stiffest));
  speed_ = options_.firstSpeed;
  const double closing = speed_ * wave_;
  if (options_.affineStart)
  {
    const double rate = -closing / height_;
    const double middle = (options_.lower[at] + options_.upper[at]) / 2;
    for (std::size_t p = 0; p < points.count(); ++p)
      points.column(Points::velocities + axis)[p] = rate * (points.column(axis)[p] - middle);
    Matrix<Dim> stretching{};
    stretching(axis, axis) = rate;
    points.setAffines(stretching);
  }
  motion.sides[at][0].velocity = closing / 2;
  motion.sides[at][1].velocity = -closing / 2;
  motion.gravity = {};
  motion.acceleration = {};
  motion.progress = [this](std::int64_t, double)
  { return options_.progress && options_.progress(body_ ? std::min(strain() / options_.strain, 1.0) : 0); };
  std::sort(options_.atStrains.begin(), options_.atStrains.end());
  body_ = std::make_unique<PointDynamics<Dim>>(std::move(points), std::move(law), motion);
  if (!options_.continueFrom.empty())
    restore();
}

template <int Dim>
PointCompression<Dim>::~PointCompression() = default;

template <int Dim>
void PointCompression<Dim>::check() const
{
  const auto& o = options_;
  require(o.axis >= 0 && o.axis < Dim, fmt::format("a compression along axis {}", o.axis),
    Dim == 2 ? "0 or 1 in a plane" : "0, 1 or 2");
  require(o.strain > 0 && o.strain < 1, fmt::format("compression to a strain of {}", o.strain),
    "above 0 and below 1, at which nothing of the height is left");
  require(o.energyRatio > 0, fmt::format("a kinetic energy of {} of the elastic one", o.energyRatio), "above 0");
  require(o.calmFrom >= 0, fmt::format("an energy ratio kept from a strain of {} on", o.calmFrom), "0 or above");
  require(o.leastSpeed > 0 && o.leastSpeed <= o.firstSpeed && o.firstSpeed <= o.mostSpeed && o.mostSpeed < 1,
    fmt::format("speeds of {} to {} to {} of the wave's", o.leastSpeed, o.firstSpeed, o.mostSpeed),
    "above 0, in this order, and below 1");
  require(o.damping >= 0, fmt::format("a damping of {}", o.damping), "0 or above");
  require(o.rows >= 1, fmt::format("a table of {} rows", o.rows), "at least 1");
  require(o.strain / o.rows >= 1e-11, fmt::format("a strain of {} in {} rows", o.strain, o.rows),
    "1e-11 a row, of which positions of 16 digits still tell a hundred-thousandth");
  for (const double e : o.atStrains)
    require(e >= 0 && e <= o.strain, fmt::format("a state at a strain of {}", e),
      "between 0 and the strain that the compression ends at");
  for (std::size_t a = 0; a < Dim; ++a)
    require(o.upper[a] > o.lower[a], fmt::format("a box from {} to {} m along axis {}", o.lower[a], o.upper[a], a),
      "its upper end above its lower one");
}

template <int Dim>
void PointCompression<Dim>::checkTouch(const MaterialPoints<Dim>& points) const
{
  const auto& o = options_;
  const Communicator& comm = o.motion.comm;
  const auto x = points.column(o.axis);
  constexpr double none = std::numeric_limits<double>::max();
  double low = none;
  double high = -none;
  double largest = 0;
  for (std::size_t p = 0; p < points.count(); ++p)
  {
    low = std::min(low, x[p]);
    high = std::max(high, x[p]);
    largest = std::max(largest, points.column(MaterialPoints<Dim>::volumes)[p]);
  }
  low = -comm.max(-low);
  high = comm.max(high);
  if (low > high)
    return; // no points: PointDynamics says so
  const double size = std::pow(comm.max(largest), 1.0 / Dim);
  const auto axis = static_cast<std::size_t>(o.axis);
  const std::array<double, 2> gap{ low - o.lower[axis] - size / 2, o.upper[axis] - high - size / 2 };
  for (const std::size_t side : { 0U, 1U })
    if (gap[side] > size / 2)
      throw InputError(fmt::format("the tissue does not touch the {} platen: {:.4g} m lie between them",
                         side == 0 ? "lower" : "upper", gap[side]),
        "crop the empty rows at the ends, or put the platens where the tissue begins and ends");
}

template <int Dim>
std::string PointCompression<Dim>::scene(const MaterialPoints<Dim>& points, const PointLaw<Dim>& law) const
{
  const Communicator& comm = options_.motion.comm;
  std::string text;
  const auto line = [&](const char* name, const auto& value) { text += fmt::format("{}: {}\n", name, value); };
  const auto& o = options_;
  line("dimension", Dim);
  line("points", comm.sum(static_cast<std::int64_t>(points.count())));
  line("what the points are",
    hashOf(
      points.id(), comm,
      [&](std::uint64_t hash, std::size_t p)
      {
        const Matrix<Dim> affine = points.affine(p);
        for (int n = 0; n < points.numbers(); ++n)
        {
          const int c = MaterialPoints<Dim>::columnOf(n);
          hash = mixed(hash ^ std::bit_cast<std::uint64_t>(c < 0 ? affine.m[n - 2 * Dim] : points.column(c)[p]));
        }
        return hash;
      }));
  line("phases of the points",
    hashOf(points.id(), comm, [&](std::uint64_t hash, std::size_t p) { return mixed(hash ^ points.phase()[p]); }));
  line("law", static_cast<int>(law.kind()));
  for (std::size_t phase = 0; phase < law.phases(); ++phase)
    for (int c = 0; c < law.constantsCount(); ++c)
      text += fmt::format("constant {} of phase {}: {}\n", c, phase, law.constants(phase)[c]);
  line("axis", o.axis);
  for (std::size_t a = 0; a < Dim; ++a)
    text += fmt::format("box along axis {}: {} to {}\n", a, o.lower[a], o.upper[a]);
  line("sides", static_cast<int>(o.sides));
  line("platens grip", o.grip ? "yes" : "no");
  if (o.platenFriction != 0)
    line("friction of the platens", o.platenFriction);
  if (o.motion.bodies.count > 1)
    text += fmt::format("bodies of the phases: {}\nfriction between bodies: {}\n",
      fmt::join(o.motion.bodies.ofPhase, " "), fmt::join(o.motion.bodies.friction, " "));
  line("last strain", o.strain);
  line("rows", o.rows);
  line("energy ratio", o.energyRatio);
  line("strain from which it is kept", o.calmFrom);
  line("first speed", o.firstSpeed);
  line("least speed", o.leastSpeed);
  line("greatest speed", o.mostSpeed);
  line("even start", o.affineStart ? "yes" : "no");
  line("damping", o.damping);
  const auto& m = o.motion;
  line("grid spacing", m.spacing);
  line("shape", static_cast<int>(m.shape));
  line("transfer", static_cast<int>(m.transfer));
  line("order of XPIC", m.xpicOrder);
  line("mass", static_cast<int>(m.mass));
  line("terms of the mass", m.massTerms);
  line("stress update", static_cast<int>(m.update));
  line("fused", m.fused ? "yes" : "no");
  if (m.precision == Precision::Single)
    line("precision", "single");
  line("step", m.step ? fmt::format("{}", *m.step) : fmt::format("{} of the stable one", m.share));
  return text;
}

template <int Dim>
double PointCompression<Dim>::strain() const
{
  return 1 - (body_->position(options_.axis, 1) - body_->position(options_.axis, 0)) / height_;
}

template <int Dim>
double PointCompression<Dim>::calmFrom() const
{
  return std::min(options_.calmFrom, options_.strain / 2);
}

template <int Dim>
double PointCompression<Dim>::allowed(double strain) const
{
  const double calm = calmFrom();
  const double early = strain < calm ? calm / std::max(strain, 1e-9) : 1;
  return options_.energyRatio * early * early;
}

template <int Dim>
void PointCompression<Dim>::press(double speed)
{
  const int axis = options_.axis;
  const double lower = body_->position(axis, 0);
  const double upper = body_->position(axis, 1);
  body_->addStretching(axis, -(speed - speed_) * wave_ / (upper - lower), (lower + upper) / 2);
  body_->setVelocity(axis, 0, speed * wave_ / 2);
  body_->setVelocity(axis, 1, -speed * wave_ / 2);
  speed_ = speed;
}

template <int Dim>
void PointCompression<Dim>::control()
{
  const int axis = options_.axis;
  if (options_.damping > 0)
  {
    const double lower = body_->position(axis, 0);
    const double upper = body_->position(axis, 1);
    const double rate = options_.damping * 3.14159265358979323846 * wave_ / height_;
    body_->calm(std::exp(-rate * body_->pace() * stride), axis, -speed_ * wave_ / (upper - lower), (lower + upper) / 2);
  }
  if (options_.leastSpeed == options_.mostSpeed)
    return;
  const PointEnergies e = body_->energies();
  if (e.elastic <= 1e-12 * e.kinetic)
    return; // nothing touches yet
  const double ratio = e.kinetic / e.elastic;
  const double limit = allowed(strain());
  if (ratio > alarm * limit && speed_ > options_.leastSpeed)
  {
    const double factor = std::max({ std::sqrt(aim * limit / ratio), mostLoss, options_.leastSpeed / speed_ });
    body_->scaleVelocities(factor);
    speed_ *= factor;
    ++slowdowns_;
  }
  else if (ratio < lazy * aim * limit && speed_ < options_.mostSpeed)
  {
    // half a row is to take some steps
    const double half = options_.strain / (2 * options_.rows) * height_;
    const double most = std::min(options_.mostSpeed, half / (leastSteps * body_->pace() * wave_));
    if (most > speed_)
      press(std::min(speed_ * std::min(std::sqrt(aim * limit / ratio), mostGain), most));
  }
}

template <int Dim>
void PointCompression<Dim>::openRow()
{
  row_ = {};
  std::size_t i = 0;
  for (int a = 0; a < Dim; ++a)
    for (int side = 0; side < 2; ++side)
      from_[i++] = body_->impulse(a, side);
  from_[i] = body_->time();
}

template <int Dim>
void PointCompression<Dim>::closeRow()
{
  const double passed = body_->time() - from_.back();
  const auto force = [&](int a, int side)
  { return (body_->impulse(a, side) - from_[static_cast<std::size_t>(2 * a + side)]) / passed; };
  const int axis = options_.axis;
  row_.stress = (force(axis, 1) - force(axis, 0)) / 2 / area_;
  row_.imbalance = (force(axis, 1) + force(axis, 0)) / area_;
  double lateral = 0;
  for (int a = 0; a < Dim && options_.sides != LateralSides::Open; ++a)
    if (a != axis)
      lateral += std::fabs(force(a, 1) - force(a, 0)) / 2 * (body_->position(a, 1) - body_->position(a, 0));
  row_.lateral = lateral; // over the present box's volume, below
  double box = 1;
  for (int a = 0; a < Dim; ++a)
    box *= body_->position(a, 1) - body_->position(a, 0);
  row_.lateral /= box * (Dim - 1);
  rows_.push_back(row_);
}

template <int Dim>
void PointCompression<Dim>::measure()
{
  const PointEnergies e = body_->energies();
  row_.strain = strain();
  row_.elastic = e.elastic;
  row_.kinetic = e.kinetic;
  row_.work = e.supplied;
  row_.dissipated = e.dissipated();
  row_.plastic = e.plastic;
  row_.speed = speed_;
  row_.steps = static_cast<double>(body_->steps());
  row_.time = body_->time();
  double box = 1;
  for (int a = 0; a < Dim; ++a)
  {
    const double length = body_->position(a, 1) - body_->position(a, 0);
    box *= length;
    const auto i = static_cast<std::size_t>(a);
    if (a != options_.axis)
      row_.lateralStrain += (length / (options_.upper[i] - options_.lower[i]) - 1) / (Dim - 1);
  }
  row_.porosity = 1 - body_->volumes()[0] / box;
}

template <int Dim>
bool PointCompression<Dim>::stops() const
{
  return options_.motion.comm.any(options_.motion.progress(body_->steps(), body_->time()));
}

template <int Dim>
bool PointCompression<Dim>::advance(double to)
{
  const double half = options_.strain / (2 * options_.rows);
  for (double left = to - strain(); left > close * half; left = to - strain())
  {
    const double duration = left * height_ / (speed_ * wave_);
    if (lookAt_ <= body_->steps() && until_ == 0) // else it was stopped on the way
    {
      if (duration > 1.5 * stride * body_->pace()) // which may grow on the way
        lookAt_ = body_->steps() + stride;
      else
        until_ = body_->time() + duration;
    }
    const std::int64_t before = body_->steps();
    bool goesOn = lookAt_ > before ? body_->advance(lookAt_ - before, true) : body_->advanceTo(until_, true);
    if (goesOn)
    {
      until_ = 0;
      if (body_->steps() == before)
        return true; // what is left is the round-off of positions, which no step takes
      control();
      if (body_->steps() - sortedAt_ >= sortEvery)
      {
        body_->sortAnew();
        sortedAt_ = body_->steps();
      }
      goesOn = !stops();
    }
    if (!goesOn)
    {
      if (!options_.checkpoint.path.empty())
        save();
      return false;
    }
    if (options_.checkpoint.path.empty() ||
      body_->steps() - savedAt_ < (options_.checkpoint.every > 0 ? options_.checkpoint.every : sortEvery))
      continue;
    if (pace_.due(options_.checkpoint, options_.motion.comm))
      save();
    savedAt_ = body_->steps();
  }
  return true;
}

template <int Dim>
bool PointCompression<Dim>::run()
try
{
  const double half = options_.strain / (2 * options_.rows);
  if (stops())
    return false;
  if (halfRows_ == 0 && rows_.empty())
  {
    openRow();
    measure();
    rows_.push_back(row_); // nothing pressed yet
  }
  while (halfRows_ < std::int64_t{ 2 } * options_.rows)
  {
    const double to = static_cast<double>(halfRows_ + 1) * half;
    for (; states_ < options_.atStrains.size() && options_.atStrains[states_] <= to + close * half; ++states_)
    {
      if (!advance(options_.atStrains[states_]))
        return false;
      if (options_.state)
        options_.state(strain());
    }
    if (!advance(to))
      return false;
    ++halfRows_;
    if (halfRows_ % 2 == 0)
      measure();
    if ((halfRows_ % 2 == 1 && halfRows_ > 1) || halfRows_ == std::int64_t{ 2 } * options_.rows)
      closeRow();
    if (halfRows_ % 2 == 1)
      openRow();
  }
  if (!options_.checkpoint.path.empty() && !(options_.checkpoint.seconds > 0))
    save();
  return true;
}
catch (const DivergenceError& e)
{
  throw DivergenceError(fmt::format("at a strain of {:.4g}: {}", strain(), e.what()), e.hint());
}

template <int Dim>
CompressionSummary PointCompression<Dim>::summary() const
{
  CompressionSummary s;
  s.strain = strain();
  s.finished = halfRows_ == std::int64_t{ 2 } * options_.rows;
  s.calmFrom = calmFrom();
  const double begun = close * options_.strain;
  double excess = 0; // of kinetic energy over what is allowed
  const CompressionRow* restless = nullptr;
  for (const CompressionRow& row : rows_)
  {
    if (s.firstTouch == 0 && row.stress > 0)
      s.firstTouch = row.strain;
    const bool calm = row.strain >= s.calmFrom - begun;
    if (row.strain > begun && row.elastic > 0)
    {
      const double ratio = row.kinetic / row.elastic;
      double& worst = calm ? s.worstRatio : s.earlyRatio;
      if (ratio > worst)
      {
        worst = ratio;
        (calm ? s.worstRatioAt : s.earlyRatioAt) = row.strain;
      }
      if (ratio > excess * allowed(row.strain))
      {
        excess = ratio / allowed(row.strain);
        restless = &row;
      }
    }
    if (!calm || row.stress <= 0)
      continue;
    s.worstLateral = std::max(s.worstLateral, row.lateral / row.stress);
    s.worstImbalance = std::max(s.worstImbalance, std::fabs(row.imbalance) / row.stress);
  }
  s.waveSpeed = wave_;
  s.steps = body_->steps();
  s.slowdowns = slowdowns_;
  s.checkpoints = checkpoints_;
  s.lastCheckpoint = writtenAt_;
  s.warnings = warnings_;
  if (excess > 1)
    s.warnings.push_back(
      fmt::format("the kinetic energy was {:.2g} of the elastic one at a strain of {:.3g}, more than "
                  "the {:.2g} allowed there: lower the {} speed, or add damping",
        restless->kinetic / restless->elastic, restless->strain, allowed(restless->strain),
        slowdowns_ > 0 && speed_ < 2 * options_.leastSpeed ? "least" : "first"));
  if (s.worstImbalance > mostForce)
    s.warnings.push_back(fmt::format("the platens' stresses differ by up to {:.0f} % of their mean: this is not a "
                                     "quasi-static state; lower the speeds, or allow less kinetic energy",
      100 * s.worstImbalance));
  if (s.worstLateral > mostForce && options_.sides == LateralSides::Straight)
    s.warnings.push_back(fmt::format("the stress on the straight sides is up to {:.0f} % of that on the platens, where "
                                     "it should be none: lower the speeds, or allow less kinetic energy",
      100 * s.worstLateral));
  if (!rows_.empty())
    if (const CompressionRow& end = rows_.back(); end.work > 0 && end.dissipated - end.plastic > mostLost * end.work)
      s.warnings.push_back(fmt::format("{:.0f} % of the work is gone, {}: walls may have come apart between points; "
                                       "take more of them a cell: 9 in a plane hold where 4 tear",
        100 * (end.dissipated - end.plastic) / end.work,
        end.plastic > 0 ? "without what walls have taken that yield" : "with walls that are elastic"));
  return s;
}

template <int Dim>
void PointCompression<Dim>::save()
{
  io::Checkpoint c;
  c.kind = kind;
  c.scene = scene_;
  c.provenance = options_.checkpoint.provenance;
  body_->keep(c);
  std::vector<double> table;
  for (const CompressionRow& row : rows_)
    table.insert(table.end(), valuesOf(row).begin(), valuesOf(row).end());
  table.insert(table.end(), valuesOf(row_).begin(), valuesOf(row_).end());
  c.arrays["rows"] = { { static_cast<std::int64_t>(rows_.size()) + 1, rowValues }, std::move(table), "SI",
    "of the table, and the one begun: strain, stress, imbalance, lateral stress, lateral strain, porosity, elastic and "
    "kinetic energy, work, dissipation, speed, steps, time, plastic work" };
  c.arrays["row_began"] = { { 2 * Dim + 1 }, std::vector<double>(from_.begin(), from_.end()), "SI",
    "impulses on the ends of the axes and the time where the row began" };
  c.numbers["speed"] = speed_;
  c.numbers["half rows"] = static_cast<double>(halfRows_);
  c.numbers["slowdowns"] = static_cast<double>(slowdowns_);
  c.numbers["next look"] = static_cast<double>(lookAt_);
  c.numbers["until"] = until_;
  c.numbers["last sorting"] = static_cast<double>(sortedAt_);
  io::CheckpointOptions place = options_.checkpoint;
  std::string words; // on rank 0
  place.warn = [&](const std::string& why)
  {
    words = "a checkpoint could not be written: " + why;
    if (options_.checkpoint.warn)
      options_.checkpoint.warn(why);
  };
  pace_.written();
  if (io::write(std::move(c), place, options_.motion.comm))
  {
    ++checkpoints_;
    writtenAt_ = body_->steps();
  }
  else
    warnings_.push_back(ofFirst(options_.motion.comm, words));
}

template <int Dim>
void PointCompression<Dim>::restore()
{
  const io::Checkpoint c = io::readCheckpoint(options_.continueFrom, kind, scene_, options_.motion.comm);
  body_->takeBack(c);
  const std::vector<double>& table = c.reals("rows");
  const std::vector<double>& began = c.reals("row_began");
  const std::vector<std::int64_t>& shape = c.arrays.at("rows").shape;
  const std::int64_t values = shape.size() == 2 ? shape[1] : 0;
  if (table.empty() || (values != rowValues && values != rowValuesBefore) || began.size() != from_.size())
    throw InputError("the checkpoint's table has another shape", "start the run anew");
  for (std::size_t i = 0; i < table.size(); i += static_cast<std::size_t>(values))
  {
    rows_.emplace_back();
    std::copy_n(table.begin() + static_cast<std::ptrdiff_t>(i), values, reinterpret_cast<double*>(&rows_.back()));
  }
  row_ = rows_.back();
  rows_.pop_back();
  std::copy(began.begin(), began.end(), from_.begin());
  speed_ = c.number("speed");
  c.expectFinite("speed");
  halfRows_ = c.count("half rows");
  slowdowns_ = c.count("slowdowns");
  if (c.numbers.contains("until")) // earlier versions had none of these
  {
    c.expectFinite("until");
    lookAt_ = c.count("next look");
    sortedAt_ = c.count("last sorting");
    until_ = c.number("until");
  }
  savedAt_ = body_->steps();
  const auto gone = std::count_if(options_.atStrains.begin(), options_.atStrains.end(),
    [&](double e) { return e < strain() - close * options_.strain; });
  states_ = static_cast<std::size_t>(gone);
  if (gone > 0 && options_.state)
    warnings_.push_back(fmt::format(
      "{} of the states asked for lie before the checkpoint, which stands at a strain of {:.4g}: they are not made",
      gone, strain()));
}

template class PointCompression<2>;
template class PointCompression<3>;

} // namespace lamella::mpm
