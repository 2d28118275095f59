"""Tables of what a study of the program found."""

import csv


def write_table(keys, rows):
    """Writes rows, dictionaries of the same words, as CSV where the key `table` names a file."""
    if "table" in keys and rows:
        with open(keys["table"], "w", encoding="utf-8", newline="") as file:
            table = csv.DictWriter(file, rows[0])
            table.writeheader()
            table.writerows(rows)
