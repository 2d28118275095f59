"""What steady diffusion takes on more ranks than there are here: a model of the benchmark "diffusion-scaling", and its picture.

    /usr/bin/python3 benchmarks/diffusion-scaling.py [output=FOLDER] [picture=FILE]

FOLDER holds the benchmark's tables (default: results/bench-diffusion-scaling); FILE is FOLDER/diffusion-scaling.png unless told.
Writes diffusion-scaling-predicted.csv and prints how far the model is from what was counted and measured. `./dev bench
diffusion-scaling` runs it after the measurements, with the benchmark's keys: others are no concern of it. The formulas are those of
docs/benchmarks/diffusion-ranks.md; how lattices are shared out follows solvers/lattice/Decomposition.cpp,
solvers/lbm/multigrid/Multigrid.cpp and solvers/lbm/lean/Pieces.cpp.
"""

import math
import statistics

from drawing import panels_of, places, save
from scaling import CLUSTER, link_here, tables, written

KINDS = {"lean": "lean", "pieces": "pieces", "walls": "pieces, walls insulate", "voids": "pieces, voids"}
COUNTED = ("messages_most", "bytes_most", "waits", "reductions", "gatherings", "gathered")

# As in the sources.
UNEVENNESS = 0.03
COARSEST_NODES, GATHER_NODES = 600, 4096
SHARED_PIECES = 3000
ONCE = {"lean": 4, "pieces": 6, "walls": 9, "voids": 7}  # reductions of a solve beside one a cycle and those of its visits
PIECE_SET_UP = {"pieces": 6, "walls": 6, "voids": 10}  # reductions of the set-up, five for each level that is shared, some more
DEEPEST_FIRST = {"pieces": 2, "walls": 2, "voids": 1}  # halvings from the nodes to the first level of pieces, where parts allow it
FINEST_EXCHANGES = {1: 13, 2: 33}  # of the finest level, by those halvings: two a sweep, and after the correction
LEAN_EXCHANGES, PIECE_EXCHANGES = FINEST_EXCHANGES[1], 12  # of a visit of a coarse level


def run_of(row):
    return tuple(int(row[a]) for a in ("nx", "ny", "nz")), int(row["ranks"])


def starts_of(rows, count, unit):
    units = -(-rows // unit)
    return [min(rows, units * i // count * unit) for i in range(count)] + [rows]


def parts_of(rows, count, unit):
    starts = starts_of(rows, count, unit)
    return [b - a for a, b in zip(starts, starts[1:])]


def decomposition(size, ranks, unevenness=UNEVENNESS):
    """Parts along y and z, rows of the largest along each, halvings with parts at even rows; None where there are too few rows."""
    _, ny, nz = size
    splits = [(z, ranks // z) for z in range(1, ranks + 1) if ranks % z == 0 and z <= nz and ranks // z <= ny]
    if not splits:
        return None
    pz, py = min(reversed(splits), key=lambda s: (s[0] - 1) * ny + (s[1] - 1) * nz)
    for levels in (7, 6, 5, 4, 3, 2, 1, 0):
        unit, good = 1 << levels, True
        for rows, count in ((ny, py), (nz, pz)):
            if count > 1:
                parts, even = parts_of(rows, count, unit), rows / count
                good &= min(parts) > 0 and ((levels == 1 and even >= 8) or max(parts) <= (1 + unevenness) * even)
        if good or levels == 0:
            break
    largest = [max(parts_of(rows, count, unit if count > 1 else 1)) for rows, count in ((ny, py), (nz, pz))]
    return (py, pz), largest, levels


def halved(values, times=1):
    return tuple(-(-v // 2**times) for v in values)


def uneven(depth):
    """By how much more than its even share a part of a level may hold that is shared out anew."""
    return min(1.0, 0.05 * 8.0**depth)


def sides(parts):
    """Neighbours along y and z of the rank that has the most."""
    return [min(2, p - 1) for p in parts]


def row_bytes(nx):
    return 4 * 2 * (((nx + 1) // 2 + 2 + 7) // 8 * 8)


def halo_of_rows(nx, rows, parts):
    y, z = sides(parts)
    return row_bytes(nx) * (z * (rows[0] + 2) + y * (rows[1] + 2))


def empty():
    return dict.fromkeys((*COUNTED, "whole", "whole_bytes"), 0.0)


def moved_share(size, ranks, before, halvings, after):
    """Of the rows of a level's part: how many another part has once the level is shared out anew; the most along either axis."""
    (parts, _, old), (_, _, new) = before, after
    staying = 1.0
    for axis, count in zip((1, 2), parts):
        if count == 1:
            continue
        was = [s >> halvings for s in starts_of(size[axis] << halvings, count, 1 << old)]
        now = starts_of(size[axis], count, 1 << new)
        kept = [max(0, min(b, d) - max(a, c)) / max(1, b - a) for a, b, c, d in zip(was, was[1:], now, now[1:])]
        staying *= min(kept)
    return 1 - staying


def lean_counts(size, ranks):
    """Of a cycle, of the rank that has the most of them; nodes that every rank works on by itself (whole)."""
    c = empty()
    shared = parts, rows, levels = decomposition(size, ranks)

    def exchange(nx, rows, parts, times):
        c["messages_most"] += times * sum(sides(parts))
        c["bytes_most"] += times * halo_of_rows(nx, rows, parts)
        c["waits"] += times * sum(p > 1 for p in parts)

    exchange(size[0], rows, parts, LEAN_EXCHANGES)
    c["reductions"] = 1
    size, rows, left, depth, halvings = halved(size), halved(rows), levels - 1, 1, 1
    while math.prod(size) > COARSEST_NODES and math.prod(size) > GATHER_NODES:
        if left == 0:
            moved = decomposition(size, ranks, uneven(depth))
            if moved is None or moved[2] == 0:
                break
            exchange(size[0], rows, parts, 1)
            c["messages_most"] += sum(sides(moved[0]))
            c["waits"] += 2
            c["bytes_most"] += 2 * row_bytes(size[0]) * math.prod(rows) * moved_share(size, ranks, shared, halvings, moved)
            shared, halvings = moved, 0
            parts, rows, left = moved
        exchange(size[0], rows, parts, LEAN_EXCHANGES)
        size, rows, left, depth, halvings = halved(size), halved(rows), left - 1, depth + 1, halvings + 1
    c["gatherings"] = 1
    c["gathered"] = row_bytes(size[0]) * size[1] * size[2] * (1 - 1 / ranks)
    c["whole"] = math.prod(size)
    c["whole_bytes"] = 5 * 8 / 7 * row_bytes(size[0]) * (size[1] + 2) * (size[2] + 2)
    return c


def first_depth(law, size, ranks):
    """Halvings from the nodes to the blocks of the first level of pieces."""
    return min(law["deepest_first"], decomposition(size, ranks)[2])


def shared_levels(size, ranks, law):
    """Of every level of pieces that the ranks share: blocks along x, those of the largest part along y and z, parts, and of its
    blocks the share that came from elsewhere where it was shared out anew (else None); blocks of the one that is gathered; and
    halvings from the nodes to the first one."""
    shared = parts, rows, levels = decomposition(size, ranks)
    first = first_depth(law, size, ranks)
    blocks, mine, left, halvings, came, found = halved(size, first), halved(rows, first), levels - first, first, None, []
    while pieces_of(law["pieces_gathered"], first + len(found)) * math.prod(blocks) >= SHARED_PIECES:
        if left == 0:
            anew = decomposition(blocks, ranks, uneven(first + len(found)))
            if anew is None or anew[2] == 0:
                break
            came = moved_share(blocks, ranks, shared, halvings, anew)
            shared, halvings = anew, 0
            parts, mine, left = anew
        found.append((blocks[0], mine, parts, came))
        blocks, mine, left, halvings, came = halved(blocks), halved(mine), left - 1, halvings + 1, None
    return found, blocks, first


def pieces_of(known, depth):
    """Pieces a block, from those known by halvings from the nodes; beyond them as of the nearest ones."""
    return known[min(known, key=lambda d: (abs(d - depth), d))]


def piece_counts(size, ranks, law):
    """The same of piece multigrid. law: pieces a block (of halos, by the first level's depth; of levels, by theirs), visits of the
    first level and by how much they grow from level to level."""
    c = empty()
    parts, rows, _ = decomposition(size, ranks)
    levels, gathered, first = shared_levels(size, ranks, law)
    neighbours, times = sides(parts), FINEST_EXCHANGES[first]
    c["messages_most"] = times * sum(neighbours)
    c["bytes_most"] = times * halo_of_rows(size[0], rows, parts)
    c["waits"] = times * sum(p > 1 for p in parts)
    c["reductions"] = c["gatherings"] = 1
    for index, (nx, mine, parts, came) in enumerate(levels):
        visits = law["visits"] * law["growth"] ** index
        neighbours = sides(parts)
        side = nx * (neighbours[1] * mine[0] + neighbours[0] * mine[1])
        exchanges = visits * (PIECE_EXCHANGES if came is None else PIECE_EXCHANGES + 1)
        c["messages_most"] += exchanges * sum(neighbours)
        c["bytes_most"] += exchanges * 4 * pieces_of(law["pieces_sent"], first) * side
        c["waits"] += exchanges
        if came is not None:
            c["messages_most"] += visits * sum(neighbours)
            c["bytes_most"] += visits * 2 * 4 * pieces_of(law["pieces_gathered"], first + index) * nx * math.prod(mine) * came
            c["waits"] += visits * 2
        c["reductions"] += visits
        c["gatherings"] = visits
    unknowns = pieces_of(law["pieces_gathered"], first + len(levels)) * math.prod(gathered)
    c["gathered"] = c["gatherings"] * 4 * unknowns * (1 - 1 / ranks)
    c["whole"] = c["gatherings"] * unknowns
    c["whole_bytes"] = 8 / 7 * 100 * unknowns
    return c


def visits_of(r, law):
    """Visits a cycle of the first level of pieces and their growth from level to level, of a run: from its waits and gatherings."""
    size, ranks = run_of(r)
    levels, _, first = shared_levels(size, ranks, law)
    last = r["gatherings"] / r["cycles"]
    waits = [PIECE_EXCHANGES + (0 if came is None else 3) for _, _, _, came in levels]
    total = r["waits"] / r["cycles"] - FINEST_EXCHANGES[first] * sum(p > 1 for p in decomposition(size, ranks)[0])
    low, high = 0.25, 4.0
    for _ in range(60 if len(levels) > 1 else 0):  # Σ of the series that ends in the last one's
        middle = 0.5 * (low + high)
        low, high = (middle, high) if sum(w * last / middle**k for k, w in enumerate(reversed(waits))) > total else (low, middle)
    growth = low if len(levels) > 1 else 1.0
    return {"visits": last / growth ** max(0, len(levels) - 1), "growth": growth}


def law_of(rows):
    """Of one kind, from all its counts; visits from the strong run on the most ranks."""
    rows = sorted((r for r in rows if r["ranks"] > 1), key=lambda r: r["ranks"])
    law = {"pieces_gathered": {}, "deepest_first": DEEPEST_FIRST[rows[0]["kind"]]}
    for r in rows:
        size, ranks = run_of(r)
        unknowns = r["gathered"] / r["gatherings"] / 4 / (1 - 1 / ranks)
        depth = first_depth(law, size, ranks) + int(r["s_reductions"] - PIECE_SET_UP[r["kind"]]) // 5
        law["pieces_gathered"].setdefault(depth, []).append(unknowns / math.prod(halved(size, depth)))
    law["pieces_gathered"] = {d: statistics.median(v) for d, v in law["pieces_gathered"].items()}
    halos = {}
    for r in rows:
        size, ranks = run_of(r)
        none, one = (piece_counts(size, ranks, {**law, "pieces_sent": {0: v}, **visits_of(r, law)})["bytes_most"] for v in (0, 1))
        if one > none:
            halos.setdefault(first_depth(law, size, ranks), []).append((r["bytes_most"] / r["cycles"] - none) / (one - none))
    law["pieces_sent"] = {d: statistics.median(v) for d, v in halos.items()}
    return {**law, **visits_of([r for r in rows if r["scaling"] == "strong"][-1], law)}


def counts_of(kind, size, ranks, laws):
    return lean_counts(size, ranks) if kind == "lean" else piece_counts(size, ranks, laws[kind])


def share(size, ranks):
    (py, pz), rows, _ = decomposition(size, ranks)
    return rows[0] * rows[1] / (size[1] * size[2])


def of_two(what, kind, size, ranks, model, laws):
    """By how much more (work, bytes) blocks of 2³ nodes take, where parts cannot be halved for blocks of 4³; else 1."""
    return model[kind][f"two_{what}"] if kind in laws and first_depth(laws[kind], size, ranks) < DEEPEST_FIRST[kind] else 1.0


def seconds(kind, size, ranks, model, laws, link):
    """Of a cycle, by its parts: work, rows packed, gathered levels, messages, bytes, collectives."""
    work = model[kind]["voxel"] * math.prod(size) * share(size, ranks) * of_two("work", kind, size, ranks, model, laws)
    if ranks == 1:
        return [work, 0, 0, 0, 0, 0]
    c = counts_of(kind, size, ranks, laws)
    hops = math.log2(ranks) * link["latency"]
    return [work, model[kind]["packed"] * c["bytes_most"], model[kind]["whole"] * c["whole"],
            c["messages_most"] * link["latency"], (c["bytes_most"] + c["gathered"]) / link["bandwidth"],
            (c["reductions"] + c["gatherings"]) * hops]


def memory(kind, size, ranks, model, laws):
    """Bytes of a rank: picture, field and levels; halos of the finest level; what every rank has whole."""
    held = model[kind]["bytes"] * math.prod(size) * share(size, ranks) * of_two("bytes", kind, size, ranks, model, laws)
    if ranks == 1:
        return held
    (py, pz), rows, _ = decomposition(size, ranks)
    return held + 2 * halo_of_rows(size[0], rows, (py, pz)) + counts_of(kind, size, ranks, laws)["whole_bytes"]


def calibrate(counts, alone, laws):
    """What the model takes from the tables: seconds a voxel, a byte packed, a gathered node (pieces: unknown), bytes a voxel."""
    model = {}
    for kind in KINDS:
        strong = [r for r in counts if r["kind"] == kind and r["scaling"] == "strong"]
        one = next(r for r in strong if r["ranks"] == 1)
        size, _ = run_of(one)
        nodes = math.prod(size)
        here = {"voxel_counted": one["work"] / one["cycles"] / nodes, "two_work": 1.0, "two_bytes": 1.0}
        whole, packed = [], []
        for r in (r for r in strong if r["ranks"] >= 8):
            c = counts_of(kind, size, int(r["ranks"]), laws)
            whole.append(r["whole"] / r["cycles"] / c["whole"])
            own = here["voxel_counted"] * nodes * share(size, int(r["ranks"]))
            packed.append(((r["work"] - r["whole"]) / r["cycles"] - own) / c["bytes_most"])
        here["whole"], here["packed"] = statistics.median(whole), max(0.0, statistics.median(packed))
        for r in (r for r in strong if r["ranks"] == 3):  # whose parts can be halved but once
            c, voxels = counts_of(kind, size, 3, laws), nodes * share(size, 3)
            here["two_work"] = ((r["work"] - r["whole"]) / r["cycles"] - here["packed"] * c["bytes_most"]) / voxels / here["voxel_counted"]
            here["two_bytes"] = (r["solver_bytes"] / 3 - c["whole_bytes"]) / voxels / (one["solver_bytes"] / nodes)
        large = next((r for r in alone if r["kind"] == kind and r["ranks"] == 1), one)
        large_nodes = large["nx"] * large["ny"] * large["nz"]
        here["voxel"] = large["work"] / large["cycles"] / large_nodes
        here["bytes"] = large["solver_bytes"] / large_nodes
        model[kind] = here
    return model


def check_counts(counts, laws, model):
    """Largest relative difference of the formulas from the counts, by kind and scaling; and of the work and the memory."""
    print("  kind, scaling: largest difference of the model from what was counted (work: processor time a rank)")
    for kind in KINDS:
        for scaling in ("strong", "weak"):
            worst = dict.fromkeys((*COUNTED, "work", "memory"), 0.0)
            for r in (r for r in counts if r["kind"] == kind and r["scaling"] == scaling and r["ranks"] > 1):
                size, ranks = run_of(r)
                own = {kind: {**laws[kind], **visits_of(r, laws[kind])}} if kind in laws else laws  # with its visits
                c = counts_of(kind, size, ranks, own)
                c["reductions"] += ONCE[kind] / r["cycles"]
                for what in COUNTED:
                    worst[what] = max(worst[what], abs(c[what] / (r[what] / r["cycles"]) - 1))
                base = next(o for o in counts if o["kind"] == kind and o["scaling"] == scaling and o["ranks"] == 1)
                voxel = base["work"] / base["cycles"] / (base["nx"] * base["ny"] * base["nz"])
                work = sum(seconds(kind, size, ranks, {kind: {**model[kind], "voxel": voxel}}, own, CLUSTER)[:3])
                worst["work"] = max(worst["work"], abs(work / (r["work"] / r["cycles"]) - 1))
                bytes_a_voxel = base["solver_bytes"] / (base["nx"] * base["ny"] * base["nz"])
                held = memory(kind, size, ranks, {kind: {**model[kind], "bytes": bytes_a_voxel}}, own)
                worst["memory"] = max(worst["memory"], abs(held * ranks / r["solver_bytes"] - 1))
            print(f"  {kind}, {scaling}: " + ", ".join(f"{what} {100 * w:.0f} %" for what, w in worst.items()))


def check_times(times, model, laws, here):
    """Two ranks over one: the model beside the medians of the pairs."""
    for kind in KINDS:
        rows = [r for r in times if r["kind"] == kind]
        if not rows:
            continue
        edge = round(rows[0]["nodes"] ** (1 / 3))
        ranks = int(rows[0]["ranks"])
        strong, weak = (edge,) * 3, (edge, edge, edge * ranks)
        one = sum(seconds(kind, strong, 1, model, laws, here))
        for name, size, column in (("strong", strong, "all"), ("weak", weak, "weak")):
            ratios, worked = ([(r[f"{column}_{what}"] / r[f"{column}_cycles"]) / (r[f"one_{what}"] / r["one_cycles"]) for r in rows]
                              for what in ("solve", "work"))
            told, measured = sum(seconds(kind, size, ranks, model, laws, here)) / one, statistics.median(ratios)
            print(f"  {kind}, {name}: a cycle on {ranks} ranks over one, model {told:.3f}, median of {len(rows)} pairs {measured:.3f}"
                  f" ({min(ratios):.3f} to {max(ratios):.3f}), {100 * (told / measured - 1):+.0f} %; of the processor time outside MPI"
                  f" {statistics.median(worked):.3f}; one rank {statistics.median(r['one_solve'] for r in rows):.2f} s")


def weak_size(edge, ranks):
    across = max(i for i in range(1, math.isqrt(ranks) + 1) if ranks % i == 0)
    return edge, edge * across, edge * (ranks // across)


def predict(path, model, laws, links):
    ranks_of = [2**k for k in range(11)] + [1000]
    columns = ["link", "kind", "scaling", "edge", "ranks", "seconds_a_cycle", "work", "packing", "whole", "messages", "bytes",
               "collectives", "efficiency", "bytes_a_rank"]
    rows = []
    for link_name, link in links.items():
        for kind in KINDS:
            for scaling, edge in (*(("strong", e) for e in (256, 512, 1000, 2000)), ("weak", 200)):
                first = None
                for ranks in sorted(ranks_of):
                    size = (edge,) * 3 if scaling == "strong" else weak_size(edge, ranks)
                    if decomposition(size, ranks) is None or (ranks > 1 and decomposition(size, ranks)[2] == 0):
                        continue
                    terms = seconds(kind, size, ranks, model, laws, link)
                    first = first or sum(terms)
                    like = first * of_two("work", kind, size, ranks, model, laws)  # of one rank, with the same blocks
                    efficiency = like / sum(terms) / (ranks if scaling == "strong" else 1)
                    rows.append([link_name, kind, scaling, edge, ranks, sum(terms), *terms, efficiency,
                                 memory(kind, size, ranks, model, laws)])
    return written(path, columns, rows)


def tell(rows):
    """The table of the page: efficiency, and the most ranks of which each still does half of what one alone would."""
    for link in dict.fromkeys(r["link"] for r in rows):
        print(f"  predicted, {link}: efficiency (MB a rank), and the most ranks with one of at least 0.5")
        for key in dict.fromkeys((r["kind"], r["scaling"], r["edge"]) for r in rows):
            mine = {r["ranks"]: r for r in rows if r["link"] == link and (r["kind"], r["scaling"], r["edge"]) == key}
            cells = [f"{mine[p]['efficiency']:.2f} ({mine[p]['bytes_a_rank'] / 1e6:.3g})" if p in mine else "" for p in (1, 8, 64, 512, 1000, 1024)]
            powers = sorted(p for p in mine if p != 1000)
            limit = powers[0]
            for p in powers:
                if mine[p]["efficiency"] < 0.5:
                    break
                limit = p
            print(f"  | {key[0]} | {key[1]} {key[2]} | {mine[1]['seconds_a_cycle']:.3g} | " + " | ".join(cells) + f" | {limit} |")


def draw(picture, counts, times, predicted, laws):
    figure, axes = panels_of(3, (4.6, 3.9))
    colours = {"lean": "C0", "pieces": "C2", "walls": "C3", "voids": "C1"}
    for kind, label in KINDS.items():
        rows = sorted((r for r in counts if r["kind"] == kind and r["scaling"] == "strong" and r["ranks"] > 1), key=lambda r: r["ranks"])
        axes[0].plot([r["ranks"] for r in rows], [r["bytes_most"] / r["cycles"] / 1e6 for r in rows], "o", markersize=4,
                     color=colours[kind], label=label)
        size, _ = run_of(rows[0])
        ranks = [2**k for k in range(1, 11)]
        axes[0].plot(ranks, [counts_of(kind, size, p, laws)["bytes_most"] / 1e6 for p in ranks], "--", linewidth=0.9, color=colours[kind])
    axes[0].set_ylabel("MB sent by a rank in a cycle")
    axes[0].set_title(f"{size[0]}³: counted (points), formula (dashed)", fontsize=10)
    axes[0].set_yscale("log")
    for kind in ("lean", "walls"):
        strong = sorted((r for r in counts if r["kind"] == kind and r["scaling"] == "strong"), key=lambda r: r["ranks"])
        size, _ = run_of(strong[0])
        axes[1].plot([r["ranks"] for r in strong], [r["work_most"] / r["cycles"] for r in strong], "o", markersize=4, color=colours[kind],
                     label=f"{KINDS[kind]}, {size[0]}³, work of a rank")
        rows = [r for r in times if r["kind"] == kind]
        if rows:
            medians = [statistics.median(r[f"{c}_work"] / r[f"{c}_cycles"] for r in rows) for c in ("one", "all")]
            axes[1].plot([1, rows[0]["ranks"]], medians, "D", markersize=5, markerfacecolor="none", color=colours[kind],
                         label=f"{KINDS[kind]}, {round(rows[0]['nodes'] ** (1 / 3))}³, the same")
        for edge in (256, 512, 1000, 2000):
            rows = [r for r in predicted if r["link"] == "cluster" and r["kind"] == kind and r["scaling"] == "strong" and r["edge"] == edge and r["ranks"] != 1000]
            axes[1].plot([r["ranks"] for r in rows], [r["seconds_a_cycle"] for r in rows], "--", linewidth=0.9, color=colours[kind])
            if kind == "lean":
                axes[1].annotate(f"{edge}³", (rows[0]["ranks"], rows[0]["seconds_a_cycle"]), fontsize=7, textcoords="offset points", xytext=(2, -10))
    axes[1].set_ylabel("seconds a cycle")
    axes[1].set_ylim(3e-4, 3e3)
    axes[1].set_title("one size: work (points), PREDICTED (dashed)", fontsize=10)
    axes[1].set_yscale("log")
    for kind, label in KINDS.items():
        rows = [r for r in predicted if r["link"] == "cluster" and r["kind"] == kind and r["scaling"] == "weak" and r["ranks"] != 1000]
        axes[2].plot([r["ranks"] for r in rows], [r["efficiency"] for r in rows], "--", linewidth=0.9, color=colours[kind], label=label)
        rows = [r for r in times if r["kind"] == kind]
        if rows:
            ratio = statistics.median((r["one_work"] / r["one_cycles"]) / (r["weak_work"] / r["weak_cycles"]) for r in rows)
            axes[2].plot([rows[0]["ranks"]], [ratio], "D", markersize=5, markerfacecolor="none", color=colours[kind])
    axes[2].set_ylabel("efficiency")
    axes[2].set_ylim(0, 1.1)
    axes[2].set_title("200³ a rank: work (points), PREDICTED (dashed)", fontsize=10)
    for a in axes:
        a.set_xscale("log", base=2)
        a.set_xlabel("ranks")
        a.legend(fontsize=7)
    save(figure, picture)


def main():
    folder, picture = places("diffusion-scaling")
    counts, alone, times, machine = (
        tables(folder, "diffusion-scaling", pattern) for pattern in ("counts-*", "memory-*-200-*", "time", "machine"))
    if not (counts and machine):
        print(f"  nothing drawn: {folder} has no tables of counts and of the machine")
        return
    laws = {kind: law_of([r for r in counts if r["kind"] == kind]) for kind in KINDS if kind != "lean"}
    model = calibrate(counts, alone, laws)
    here = link_here(machine)
    for kind in KINDS:
        m, law = model[kind], laws.get(kind, {})
        print(f"  {kind}: {1e9 * m['voxel']:.1f} ns a voxel and cycle ({1e9 * m['voxel_counted']:.1f} in the counted runs), "
              f"{1e9 * m['packed']:.2f} ns a byte sent, {1e9 * m['whole']:.0f} ns a gathered node, {m['bytes']:.1f} bytes a voxel; "
              + (f"blocks of 2³ {m['two_work']:.2f} of the work, {m['two_bytes']:.2f} of the bytes; " if law.get("deepest_first", 1) > 1 else "")
              + ", ".join(f"{k} {law[k]:.2f}" for k in ("visits", "growth") if k in law)
              + "".join(f", {v:.2f} {k.replace('_', ' ')} a block of {2**d}³ nodes" for k in ("pieces_sent", "pieces_gathered")
                        for d, v in sorted(law.get(k, {}).items())))
    for told, some in (("all numbers of ranks", counts), ("all but three", [r for r in counts if r["ranks"] != 3])):
        values = {}
        for r in some:
            values.setdefault((r["kind"], r["nx"], r["ny"], r["nz"]), []).append(r["value"])
        print(f"  values on {told} agree to {max(max(v) / min(v) - 1 for v in values.values()):.0e}")
    check_counts(counts, laws, model)
    check_times(times, model, laws, here)
    predicted = predict(folder / "diffusion-scaling-predicted.csv", model, laws, {"here": here, "cluster": CLUSTER})
    tell(predicted)
    draw(picture, counts, times, predicted, laws)


if __name__ == "__main__":
    main()
