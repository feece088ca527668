"""Reads a map's columns from Parquet and from CSV and checks that they say the same.

    python -m venv .venv && .venv/bin/pip install -r tests/python/requirements.txt
    .venv/bin/python tests/python/read_parquet.py MAP.parquet MAP.csv

pyarrow reads the file; where Polars is installed, too, it must read the same.
"""

import csv
import math
import sys

import pyarrow.parquet

try:
    import polars
except ImportError:
    polars = None


def check(condition, message):
    if not condition:
        sys.exit(f"FAILED: {message}")


def main(parquet, text):
    with open(text, newline="") as file:
        head, *rows = list(csv.reader(file))
    table = pyarrow.parquet.read_table(parquet)
    check(table.column_names == head, f"columns {table.column_names}")
    check(table.num_rows == len(rows), f"{table.num_rows} rows, {len(rows)} in the CSV")
    empty = 0
    for place, name in enumerate(head):
        words = name == "status"
        kind = str(table.schema.field(name).type)
        check(kind == ("string" if words else "double"), f"{name} is of type {kind}")
        found = table[name].to_pylist()
        cells = [row[place] for row in rows]
        stated = cells if words else [float(cell) if cell else None for cell in cells]
        check(found == stated, f"{name} differs from the CSV")
        check(words or all(value is None or math.isfinite(value) for value in found), f"{name} is not finite")
        empty += sum(value is None for value in found)
        check(table[name].null_count == sum(value is None for value in found), f"{name}: another count of nulls")
        if polars:
            check(polars.read_parquet(parquet)[name].to_list() == stated, f"Polars reads another {name}")
    about = {key.decode(): value.decode() for key, value in (table.schema.metadata or {}).items()}
    for key in ("name", "settings", "description", "freeact_version"):
        check(about.get(key), f"nothing is said about {key}, only about {sorted(about)}")
    print(f"{len(rows)} rows of {len(head)} columns, {empty} empty cells; {about['name']!r} by freeact {about['freeact_version']}")


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
