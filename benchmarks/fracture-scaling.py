"""What fracture takes on more ranks than there are here: a model of the benchmark "fracture-scaling", and its picture.

    /usr/bin/python3 benchmarks/fracture-scaling.py [output=FOLDER] [picture=FILE]

FOLDER holds the benchmark's tables (default: results/bench-fracture-scaling); FILE is FOLDER/fracture-scaling.png unless told.
Writes fracture-scaling-predicted.csv and prints how far the model is from what was counted and measured. `./dev bench fracture-scaling`
runs it after the measurements, with the benchmark's keys: others are no concern of it. The formulas are those of
docs/benchmarks/fracture-ranks.md; how lattices are shared out follows slab() in solvers/peridynamics/BondBuilder.cpp, the levels
solvers/peridynamics/multigrid/BondMultigrid.cpp.
"""

import math
import statistics

from drawing import panels_of, places, rows_of, save
from scaling import CLUSTER, link_here, tables, written

BENCH = "fracture-scaling"
LINKS = {"cluster": CLUSTER,
         "QDR": {"latency": 1.5e-6, "bandwidth": 4e9}}  # of the paper: 40 Gbit/s, 8 of 10 of which are data; latency assumed
PREDICTED_FOR = (1, 2, 4, 8, 16, 32, 64, 128, 200, 256, 512, 680, 1000, 1024, 2000, 2048)

# As in the sources.
REACH, COMPONENTS = 3, 2
COARSEST, GATHER = 100, 1024
TWICE_FROM, TWICE_BELOW = 2, 5
GUARD = 100  # steps from one look at the energies, which is two reductions, to the next


def slabs(ny, ranks):
    """Rows at which the slabs begin, and ny; None where there would be fewer rows than a bond reaches."""
    if ranks > 1 and ny // ranks < REACH:
        return None

    def begins(halvings):
        return [((ny >> halvings) * r // ranks) << halvings for r in range(ranks)] + [ny]

    halvings = 7
    while halvings > 0:
        heights = [b - a for a, b in zip(begins(halvings), begins(halvings)[1:])]
        most = math.ceil(ny / ranks) + (1 if halvings == 1 and ny // ranks >= 2 * coarse_reach(REACH) else 0)
        if min(heights) >= REACH and max(heights) <= max(1.04 * ny / ranks, most):
            break
        halvings -= 1
    return begins(halvings)


def visited(rows, begins):
    """Bonds that each rank goes through: those with an end of its own. rows: bonds by row and by the rows that they lead up."""
    total = [0]
    for row in rows:
        total.append(total[-1] + sum(row))
    return [total[e] - total[b] + sum(rows[y][dy] for y in range(max(0, b - REACH), b) for dy in range(b - y, REACH + 1))
            for b, e in zip(begins, begins[1:])]


def pitch(nx, ghost):
    return ((nx + 7) // 8 * 8 + max(2, ghost) + 15) // 16 * 16


def coarse_reach(reach):
    return reach // 2 + 1 if reach % 2 == 0 else (reach + 1) // 2


def agglomerated(rows, reach, ranks):
    """Rows at which thicker slabs of a level begin, and rows, and which of its ranks have them; solvers/peridynamics/multigrid/Agglomeration.cpp."""
    count = min(ranks, max(1, (rows >> 2) // reach))
    halvings = 6
    while halvings > 2 and (rows >> halvings) // count < 4:
        halvings -= 1
    return [((rows >> halvings) * s // count) << halvings for s in range(count)] + [rows], [s * ranks // count for s in range(count)]


class Level:
    """One level: its nodes across, rim, rows at which slabs begin (and how many rows), and the ranks that have them. None of both: whole on `holders`."""

    def __init__(self, size, ghost, begins, holders, whole, halvings=0):
        self.size, self.ghost, self.begins, self.holders, self.whole, self.halvings = size, ghost, begins, holders, whole, halvings
        self.relays = False  # the next level is the same lattice on fewer ranks, or whole

    def nodes(self):
        return self.size[0] * self.size[1]


def levels_of(nx, ny, ranks):
    """The finest first; None: it cannot be halved."""
    levels = [Level((nx, ny), REACH, slabs(ny, ranks), list(range(ranks)), ranks == 1)]
    reach = REACH
    while levels[-1].nodes() > COARSEST:
        last = levels[-1]
        heights = [b - a for a, b in zip(last.begins, last.begins[1:])]
        small = not last.whole and last.nodes() <= GATHER
        if last.whole or (not small and all(b % 2 == 0 for b in last.begins[:-1]) and all(h % 2 == 0 for h in heights[:-1])
                          and all(h // 2 >= coarse_reach(reach) for h in heights)):
            size = (last.size[0] // 2 + 1, last.size[1] // 2 + 1)
            reach = coarse_reach(reach)
            levels.append(Level(size, reach, [b // 2 for b in last.begins[:-1]] + [size[1]], last.holders, last.whole, last.halvings + 1))
            continue
        if len(levels) == 1:
            return None
        last.relays = True
        begins, leaders = agglomerated(last.size[1], coarse_reach(reach), len(last.holders))
        if small or len(leaders) == 1:
            levels.append(Level(last.size, reach, [0, last.size[1]], last.holders, True, last.halvings))
        else:
            levels.append(Level(last.size, reach, begins, [last.holders[r] for r in leaders], False, last.halvings))
    return levels


def cycles_of(levels):
    """Times that each level is visited, and cycles on it, by one application."""
    visits, cycles = [1], [1]
    for index, level in enumerate(levels[1:], 1):
        visits.append(cycles[-1])
        twice = TWICE_FROM <= level.halvings < TWICE_BELOW and index + 1 < len(levels) and not level.relays
        cycles.append(visits[-1] * (2 if twice else 1))
    return visits, cycles


KEYS = ("messages", "bytes", "waits", "reductions", "gatherings", "gathered", "whole", "thick")


def motion_counts(nx, ranks):
    """Of a step: of a rank in the middle, and in the mean."""
    sides = min(2, ranks - 1)
    most = dict.fromkeys(KEYS, 0.0) | {"messages": sides * COMPONENTS, "bytes": sides * COMPONENTS * REACH * 8 * pitch(nx, REACH), "waits": min(1, sides),
                                       "reductions": 1 + 2 / GUARD}
    share = 2 * (ranks - 1) / ranks / max(1, sides)
    return most, most | {"messages": most["messages"] * share, "bytes": most["bytes"] * share}


def iteration_counts(nx, ny, ranks):
    """Of an iteration of conjugate gradients: the most of a rank, and the mean; None without levels. `whole`: nodes of whole levels, times visits;
    `thick`: those of thicker slabs on fewer ranks, beyond an even share of all."""
    levels = levels_of(nx, ny, ranks)
    if levels is None:
        return None
    every = [dict.fromkeys(KEYS, 0.0) | {"reductions": 3} for _ in range(ranks)]

    def result():
        return ({key: max(c[key] for c in every) for key in KEYS}, {key: sum(c[key] for c in every) / ranks for key in KEYS})

    if ranks == 1:
        return result()
    visits, cycles = cycles_of(levels)

    def exchange(level, times, size):
        for place, rank in enumerate(level.holders):
            sides = (place > 0) + (place + 1 < len(level.holders))
            every[rank]["messages"] += times * sides * COMPONENTS
            every[rank]["bytes"] += times * sides * COMPONENTS * level.ghost * size * pitch(level.size[0], level.ghost)
            every[rank]["waits"] += times if sides else 0

    def slabs_of(level):
        return zip(level.holders, level.begins, level.begins[1:])

    exchange(levels[0], 1, 8)  # the direction, in double precision
    for index, level in enumerate(levels):
        before = levels[index - 1] if index > 0 else None
        after_relay = before is not None and before.relays
        if level.whole:
            for rank in level.holders:
                every[rank]["whole"] += level.nodes() * cycles[index]
        else:
            own = 0 if level.relays else 3 * cycles[index] + cycles[index] - visits[index]
            exchange(level, own + (visits[index] if index > 0 and not after_relay else 0), 4)
            if len(level.holders) < ranks and not level.relays:
                for rank, begin, end in slabs_of(level):
                    every[rank]["thick"] += (level.size[0] * (end - begin) - level.nodes() / ranks) * cycles[index]
        if not after_relay:
            continue
        times = visits[index - 1]
        row = 4 * COMPONENTS * pitch(level.size[0], level.ghost)
        if level.whole:
            parts = len(level.holders)
            for rank in level.holders:
                every[rank]["gatherings"] += (1 + COMPONENTS) * times  # how long, and what
            for rank, begin, end in slabs_of(before):
                every[rank]["gathered"] += times * (row * (level.size[1] - end + begin) + 4 * (parts - 1))
            continue
        waits = [[False, False] for _ in range(ranks)]  # there, and back
        for rank, begin, end in slabs_of(before):
            for leader, first, last in slabs_of(level):
                rows = min(end, last) - max(begin, first)
                if rows > 0 and rank != leader:
                    for way, sender in enumerate((rank, leader)):
                        every[sender]["messages"] += times
                        every[sender]["bytes"] += times * rows * row
                        waits[rank][way] = waits[leader][way] = True
        for rank in range(ranks):
            every[rank]["waits"] += times * sum(waits[rank])
    return result()


def seconds(model, what, size, rows, ranks, link):
    """Of a step or an iteration, by its parts: work, whole levels, messages, bytes, collectives; None where there is no such run."""
    nx, ny = size
    begins = slabs(ny, ranks)
    if begins is None:
        return None
    found = motion_counts(nx, ranks) if what == "motion" else iteration_counts(nx, ny, ranks)
    if found is None:
        return None
    c = found[0]
    m = model[what]
    work = m["bond"] * max(visited(rows, begins)) + (m["fixed"] + m["sent"] * c["bytes"] if ranks > 1 else 0)
    if ranks == 1:
        return [work, 0, 0, 0, 0]
    hops = math.log2(ranks) * link["latency"]
    return [work, m["whole"] * (c["whole"] + c["thick"]), c["messages"] * link["latency"], (c["bytes"] + c["gathered"]) / link["bandwidth"],
            (c["reductions"] + c["gatherings"]) * hops]


def per_unit(row, column):
    return row[column] / row["units"]


def calibrate(counts, times):
    """Seconds a bond (one rank, the large sample), a node of whole levels, and of what a rank does beside its share: of motion the
    same at each step, of an iteration in proportion to the bytes sent (rows beyond its own on all levels). From 8 ranks on."""
    model = {}
    for what in ("motion", "equilibrium"):
        mine = [r for r in counts if r["what"] == what]
        one = {r["nx"]: r for r in mine if r["ranks"] == 1}
        bond = {nx: per_unit(r, "work") / r["visited"] for nx, r in one.items()}
        whole, beside = [], []
        for r in (r for r in mine if r["ranks"] >= 8):
            left = per_unit(r, "work") - bond[r["nx"]] * r["visited"]
            if what == "equilibrium":
                c = iteration_counts(int(r["nx"]), int(r["ny"]), int(r["ranks"]))[1]
                whole.append(per_unit(r, "whole") / c["whole"])
                left = (left - per_unit(r, "whole")) / per_unit(r, "bytes")
            beside.append(left)
        measured = {}
        for r in (r for r in times if r["what"] == what):
            measured.setdefault(r["nx"], []).append(r["one_work"] / r["units"] / one[r["nx"]]["visited"])
        rest = max(0.0, statistics.median(beside))
        model[what] = {"bond": statistics.median(measured[max(measured)]), "counted": bond,
                       "whole": statistics.median(whole) if whole else 0.0, "fixed": rest if what == "motion" else 0.0, "sent": rest if what == "equilibrium" else 0.0}
    return model


def check_counts(counts, model, rows):
    """Largest relative difference of the formulas from the counts; and of the work."""
    print("  largest difference of the model from what was counted")
    for what in ("motion", "equilibrium"):
        worst = {}
        for r in (r for r in counts if r["what"] == what and r["ranks"] > 1):
            size, ranks = (int(r["nx"]), int(r["ny"])), int(r["ranks"])
            most, mean = motion_counts(size[0], ranks) if what == "motion" else iteration_counts(*size, ranks)
            c = mean | {"messages": most["messages"], "bytes": most["bytes"]}
            once = {} if what == "motion" else {"messages": 4, "waits": 4, "reductions": 3}  # products beside those of iterations
            for key, column in (("messages", "messages_most"), ("bytes", "bytes_most"), ("waits", "waits"), ("reductions", "reductions"),
                                ("gatherings", "gatherings"), ("gathered", "gathered")):
                told = c[key] * r["units"]
                if key == "messages":
                    told += once.get(key, 0) * min(2, ranks - 1) * COMPONENTS
                elif key == "bytes" and once:
                    told += 4 * motion_counts(size[0], ranks)[0]["bytes"]
                else:
                    told += once.get(key, 0)
                if r[column]:
                    worst[key] = max(worst.get(key, 0), abs(told / r[column] - 1))
            worst["bonds visited"] = max(worst.get("bonds visited", 0), abs(max(visited(rows[size[0]], slabs(size[1], ranks))) / r["visited_most"] - 1))
            m = model[what]
            work = m["counted"][r["nx"]] * r["visited"] + m["fixed"] + m["sent"] * mean["bytes"] + m["whole"] * mean["whole"]
            worst["work"] = max(worst.get("work", 0), abs(work / per_unit(r, "work") - 1))
        print(f"  {what}: " + ", ".join(f"{key} {100 * w:.1f} %" for key, w in worst.items()))


def tell_counts(counts):
    """The tables of the page."""
    for nx in sorted({r["nx"] for r in counts}):
        for what in ("motion", "breaking", "equilibrium", "batched"):
            for r in sorted((r for r in counts if r["what"] == what and r["nx"] == nx), key=lambda r: r["ranks"]):
                u = r["units"]
                print(f"  | {what}, {nx:.0f} | {r['ranks']:.0f} | {r['rows_most']:.0f} | {r['visited'] / 1e3:.4g} | {r['visited_most'] / r['visited']:.3f} "
                      f"| {r['messages'] / u:.1f}, {r['messages_most'] / u:.1f} | {r['bytes'] / u / 1e3:.1f}, {r['bytes_most'] / u / 1e3:.1f} | {r['waits'] / u:.1f} "
                      f"| {r['reductions'] / u:.2f} | {r['gatherings'] / u:.1f} | {r['gathered'] / u / 1e3:.1f} | {1e3 * r['work'] / u:.3g} | {1e3 * r['work_most'] / u:.3g} "
                      f"| {1e3 * r['whole'] / u:.3g} | {u:.0f} units, {r['set_up_units']:.0f} before, {r['events']:.0f} events, {r['broken']:.0f} broken, "
                      f"value {r['value']:.9g}; set-up {r['s_messages']:.0f} messages, {r['s_reductions']:.0f} reductions, work {r['s_work']:.3g} s |")
    for what in ("motion", "breaking", "equilibrium", "batched"):
        for nx in sorted({r["nx"] for r in counts}):
            values = [r["value"] for r in counts if r["what"] == what and r["nx"] == nx]
            if values:
                print(f"  {what}, {nx:.0f}: values agree to {max(values) / min(values) - 1:.0e}")


def tell_times(times, model, rows, here):
    for what in ("motion", "equilibrium"):
        for nx in sorted({r["nx"] for r in times}):
            mine = [r for r in times if r["what"] == what and r["nx"] == nx]
            size, ranks = (int(nx), 2 * int(nx)), int(mine[0]["ranks"])
            one, two = (sum(seconds(model, what, size, rows[nx], p, here)) for p in (1, ranks))
            clock = [r["all"] / r["one"] for r in mine]
            worked = [r["all_work_most"] / r["one_work"] for r in mine]
            print(f"  {what}, {nx:.0f}: one rank {1e3 * statistics.median(r['one'] / r['units'] for r in mine):.3g} ms by the clock "
                  f"(least {1e3 * min(r['one'] / r['units'] for r in mine):.3g}), {1e3 * statistics.median(r['one_work'] / r['units'] for r in mine):.3g} ms of work; "
                  f"{ranks} over one by the clock {statistics.median(clock):.3f} ({min(clock):.3f} to {max(clock):.3f}), work of the busiest "
                  f"{statistics.median(worked):.3f} ({min(worked):.3f} to {max(worked):.3f}), model {two / one:.3f}; apart over one "
                  f"{statistics.median(r['apart'] / r['one'] for r in mine):.3f}; load {min(r['load'] for r in mine):.1f} to {max(r['load'] for r in mine):.1f}; "
                  f"{mine[0]['units']:.0f} units, set-up {statistics.median(r['one_set_up'] for r in mine):.3g} s, {statistics.median(r['all_set_up'] for r in mine):.3g} s")


def predict(path, model, rows):
    columns = ["link", "what", "nx", "ranks", "rows_most", "seconds", "work", "whole", "messages", "bytes", "collectives", "balance", "speed_up", "efficiency"]
    found = []
    for link_name, link in LINKS.items():
        for what in ("motion", "equilibrium"):
            for nx in sorted(rows):
                one = None
                for ranks in PREDICTED_FOR:
                    size = (int(nx), 2 * int(nx))
                    terms = seconds(model, what, size, rows[nx], ranks, link)
                    if terms is None:
                        continue
                    one = one or sum(terms)
                    begins = slabs(size[1], ranks)
                    bonds = visited(rows[nx], begins)
                    found.append([link_name, what, int(nx), ranks, max(b - a for a, b in zip(begins, begins[1:])), sum(terms), *terms,
                                  sum(map(sum, rows[nx])) / ranks / max(bonds), one / sum(terms), one / sum(terms) / ranks])
    return written(path, columns, found)


def tell_predicted(predicted):
    for link in LINKS:
        for key in dict.fromkeys((r["what"], r["nx"]) for r in predicted):
            for r in (r for r in predicted if r["link"] == link and (r["what"], r["nx"]) == key and r["ranks"] in (1, 64, 128, 200, 256, 512, 1024, 2000, 2048)):
                print(f"  {link}: {key[0]}, {key[1]}, {r['ranks']} ranks of {r['rows_most']} rows: {1e3 * r['seconds']:.4g} ms (work {1e3 * r['work']:.3g}, whole {1e3 * r['whole']:.3g}, "
                      f"messages {1e3 * r['messages']:.3g}, bytes {1e3 * r['bytes']:.3g}, collectives {1e3 * r['collectives']:.3g}), balance {r['balance']:.3f}, "
                      f"speed-up {r['speed_up']:.4g}, efficiency {r['efficiency']:.2f}")


def draw(picture, counts, predicted, model, rows):
    figure, axes = panels_of(3, (4.6, 3.9))
    colours = {("motion", 512): "C0", ("motion", 1024): "C2", ("equilibrium", 512): "C1", ("equilibrium", 1024): "C3", ("motion", 4096): "C4", ("equilibrium", 4096): "C5"}
    names = {"motion": "motion", "equilibrium": "equilibrium"}
    for (what, nx), colour in colours.items():
        label = f"{names[what]}, {nx} × {2 * nx}"
        mine = sorted((r for r in counts if r["what"] == what and r["nx"] == nx), key=lambda r: r["ranks"])
        more = [r for r in mine if r["ranks"] > 1]
        if more:
            axes[0].plot([r["ranks"] for r in more], [r["bytes_most"] / r["units"] / 1e3 for r in more], "o", markersize=4, color=colour, label=label)
            told = [p for p in PREDICTED_FOR if p > 1 and slabs(2 * nx, p)]
            told = [(p, motion_counts(nx, p) if what == "motion" else iteration_counts(nx, 2 * nx, p)) for p in told]
            axes[0].plot([p for p, c in told if c], [c[0]["bytes"] / 1e3 for p, c in told if c], "--", linewidth=0.9, color=colour)
            axes[1].plot([r["ranks"] for r in mine], [1e3 * r["work_most"] / r["units"] for r in mine], "o", markersize=4, color=colour, label=label)
        of = [r for r in predicted if r["link"] == "QDR" and r["what"] == what and r["nx"] == nx]
        if more:
            axes[1].plot([r["ranks"] for r in of], [1e3 * r["seconds"] for r in of], "--", linewidth=0.9, color=colour)
        axes[2].plot([r["ranks"] for r in of], [r["speed_up"] for r in of], "--", linewidth=1.1, color=colour, label=label)
    axes[0].set_ylabel("kB sent by a rank")
    axes[0].set_title("a step, an iteration: counted (points), formula (dashed)", fontsize=9)
    axes[1].set_ylabel("milliseconds")
    axes[1].set_title("work of the busiest rank (points), PREDICTED (dashed)", fontsize=9)
    ideal = [1, 2048]
    axes[2].plot(ideal, ideal, ":", color="0.5", linewidth=0.9)
    axes[2].axvline(200, color="0.7", linewidth=0.8)
    axes[2].annotate("200, as the paper", (200, 220), fontsize=7, rotation=90, textcoords="offset points", xytext=(-9, 0))
    axes[2].set_ylabel("speed-up")
    axes[2].set_title("PREDICTED", fontsize=9)
    for a in axes:
        a.set_xscale("log", base=2)
        a.set_yscale("log")
        a.set_xlabel("ranks")
        a.legend(fontsize=7)
    save(figure, picture)


def main():
    folder, picture = places(BENCH)
    counts, times, machine = (tables(folder, BENCH, pattern) for pattern in ("counts-*", "time", "machine"))
    if not (counts and times and machine):
        print(f"  nothing drawn: {folder} has no tables of counts, times and the machine")
        return
    rows = {}
    for nx in sorted({r["nx"] for r in counts}):
        rows[nx] = [[int(r[f"bonds_{dy}"]) for dy in range(REACH + 1)] for r in rows_of(folder / f"{BENCH}-rows-{nx:.0f}.csv")]
    here = link_here(machine)
    model = calibrate(counts, times)
    for what, m in model.items():
        print(f"  {what}: {1e9 * m['bond']:.2f} ns a bond ({', '.join(f'{nx:.0f}: {1e9 * v:.2f}' for nx, v in m['counted'].items())} in the counted runs), "
              f"{1e6 * m['fixed']:.0f} µs a rank, {1e9 * m['sent']:.1f} ns a byte sent, {1e9 * m['whole']:.0f} ns a node of whole levels")
    tell_counts(counts)
    check_counts(counts, model, rows)
    tell_times(times, model, rows, here)
    large = max(rows)
    rows[4 * large] = [[4 * n for n in row] for row in rows[large] for _ in range(4)]  # the same, four times as fine: about as many bonds a node
    predicted = predict(folder / f"{BENCH}-predicted.csv", model, rows)
    tell_predicted(predicted)
    draw(picture, counts, predicted, model, rows)


if __name__ == "__main__":
    main()
