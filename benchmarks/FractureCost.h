#pragma once

#include "Keys.h"

/// Error of strength and toughness against CPU time, over method, horizon and lattice.
namespace lamella::benchmark
{

/// Cemented grains of one shape and fracture energy on ever finer lattices: the largest stress, against the accurate
/// strict method on the same lattice and against the finest lattice. Keys: size=quick or full, or one by one horizons=,
/// nodes=, events= and slow= (the largest horizon² times nodes with events, and with the other methods); saturation=,
/// seed=, stop= (share of the peak at which runs end), repeat= (for medians, of runs below ten seconds); output= the
/// folder of the table.
void strengthCost(const Keys& keys);

/// A square plate with a crack: toughness from the largest stress over those of the continuum and of the lattice.
/// Keys as above, and crack= its half length over the side.
void toughnessCost(const Keys& keys);

} // namespace lamella::benchmark
