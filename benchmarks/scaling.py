"""What the models of more ranks than there are share: tables by pattern, the machine's own figures, an assumed cluster."""

import csv

from drawing import rows_of

CLUSTER = {"latency": 1.5e-6, "bandwidth": 10e9}  # an assumption: of a usual interconnect, a message and a rank


def tables(folder, bench, pattern):
    """The rows of all tables BENCH-PATTERN.csv of a folder, one after another."""
    return [row for path in sorted(folder.glob(f"{bench}-{pattern}.csv")) for row in rows_of(path)]


def link_here(machine):
    """Latency [s] and bandwidth [bytes/s] between two ranks of this machine, and what a reduction takes, of the table "machine"."""
    messages = {int(r["bytes"]): r["median"] for r in machine if r["what"] == "message"}
    here = {"latency": min(messages.values()), "bandwidth": 2**18 / messages[2**18]}
    reduction = next(r["median"] for r in machine if r["what"] == "reduction")
    print(f"  here: latency {1e6 * here['latency']:.2f} µs, bandwidth {here['bandwidth'] / 1e9:.1f} GB/s, reduction {1e6 * reduction:.2f} µs")
    return here


def written(path, columns, rows):
    """Writes what was predicted as a table. @return its rows by column"""
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(columns)
        writer.writerows([[f"{v:.6g}" if isinstance(v, float) else v for v in row] for row in rows])
    print(f"  written: {path}")
    return [dict(zip(columns, row)) for row in rows]
