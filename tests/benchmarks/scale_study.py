#!/usr/bin/env python3
"""Predicts the run time of sweeps on many ranks: measures the integration of a design and the work of rank 0 on this
machine, simulates the sweep with these numbers, and prints tables.

    tests/benchmarks/scale_study.py [GB_PER_SECOND ...]   rates of file systems, default 1 10 100; needs a build, h5py, mpirun

Model: time = integration, in which each rank claims the next tiles when it is free, + the bytes of the journals divided
by the rate of the file system + the end: rank 0 enters every tile in the archive's index, and all bytes are written
again. The network and other users of the file system are not modelled.
"""

import heapq
import os
import subprocess
import sys
import tempfile
import time

import h5py

REPOSITORY = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PROGRAM = os.path.join(REPOSITORY, "build", "release", "trebsweep")
JOB = os.path.join(REPOSITORY, "jobs", "millimetre.cfg")
RANKS = (2, 16, 64, 256, 1000, 4000, 10000)
# Without integration, only the remaining work is measured.
IDLE = ("--solver.max-time", "1e-9", "--output.fields", "status", "--lattice.r1", "0.6")
PART_SECONDS = 0.25  # of the tiles that a rank claims at once, as in src/sweep/work_queue.cpp


def sweep(directory, ranks, *options):
    """Runs the job; returns its root attributes, with its bytes and tiles, and the seconds that it took."""
    archive = os.path.join(directory, "map.h5")
    start = time.monotonic()
    if subprocess.run(["mpirun", "-n", str(ranks), PROGRAM, "sweep", JOB, *options, "--output.file", archive,
                       "--progress", "none"], stdout=subprocess.DEVNULL, check=False).returncode:
        sys.exit("the sweep failed")
    seconds = time.monotonic() - start
    with h5py.File(archive) as file:
        attributes = {**file.attrs, "bytes": os.path.getsize(archive), "tiles": len(file["tile_block"])}
    os.remove(archive)
    return attributes, seconds


def measure(directory):
    """Seconds per design on one core, seconds per tile at the end, and bytes per design."""
    cores = os.cpu_count()
    work, _ = sweep(directory, cores, "--lattice.increment", "0.004")
    per_design = work["integration_seconds"] * cores / work["designs"]
    # Many small tiles, then one: the difference is due to the tiles.
    many, slow = sweep(directory, 2, *IDLE, "--lattice.r3", "0.3:0.7:0.0001", "--lattice.r2", "0.3:0.7:0.0001")
    _, fast = sweep(directory, 2, *IDLE, "--lattice.r3", "0.3", "--lattice.r2", "0.3")
    return per_design, (slow - fast) / many["tiles"], work["bytes"] / work["designs"]


def tile_sizes(per_metre):
    """The designs in each tile within the paper's bounds, in tile order, and the extent of a tile."""
    r1 = per_metre - 1                       # 0.5 < r1 < 1.5
    rows = [int(1.2 * per_metre) - 1 - i for i in range(int(1.2 * per_metre))]  # r2 < 1.5 - r3
    extents = (r1, len(rows), rows[0])
    edge = [min(n, max(16, min((n + 4) // 5, 64 if n > 2500 else 48))) for n in extents]  # as in src/sweep/schedule.cpp
    edge[1:] = [next((d for d in range(e, (2 * e - 1) // 3, -1) if n % d == 0), e) for e, n in zip(edge[1:], extents[1:])]
    plane = []
    for first in range(0, extents[1], edge[1]):
        for low in range(0, extents[2], edge[2]):
            size = sum(min(max(row - low, 0), edge[2]) for row in rows[first:first + edge[1]])
            if size:
                plane.append(size)
    return [size * min(edge[0], r1 - first) for first in range(0, r1, edge[0]) for size in plane], edge


def integration_seconds(sizes, ranks, per_design):
    """Seconds until the last rank ends, of which each claims the next tiles when it is free."""
    free = [0.0] * ranks
    part = max(1, int(PART_SECONDS / (per_design * sum(sizes) / len(sizes))))
    first = 0
    while first < len(sizes):
        count = max(1, min(part, (len(sizes) - first) // (4 * ranks)))
        heapq.heapreplace(free, free[0] + sum(sizes[first:first + count]) * per_design)
        first += count
    return max(free)


def main():
    """Measures, simulates and prints."""
    rates = [float(word) for word in sys.argv[1:]] or [1.0, 10.0, 100.0]
    with tempfile.TemporaryDirectory() as directory:
        per_design, per_tile, per_design_bytes = measure(directory)
    print(f"measured here: {1e9 * per_design:.0f} ns of a core per design, {1e6 * per_tile:.0f} us per tile at the end, "
          f" {per_design_bytes:.2f} bytes per design\n")
    for name, per_metre in (("1 mm", 1000), ("0.2 mm", 5000)):
        sizes, _ = tile_sizes(per_metre)
        designs = sum(sizes)
        size = designs * per_design_bytes
        ends = [per_tile * len(sizes) + size / (rate * 1e9) for rate in rates]
        print(f"{name}: {designs} designs in {len(sizes)} tiles, {size / 1e9:.0f} GB in the archive and as much in the "
              f"journals, one per rank; {designs * per_design:.0f} s of a core; the end takes "
              + ", ".join(f"{end:.1f} s at {rate:g} GB/s" for rate, end in zip(rates, ends)) + "\n")
        print("| ranks | tiles per rank | integration, s | balance | "
              + " | ".join(f"total at {r:g} GB/s, s | efficiency" for r in rates) + " |")
        print("|---" * (4 + 2 * len(rates)) + "|")
        for ranks in RANKS:
            seconds = integration_seconds(sizes, ranks, per_design)
            ideal = designs * per_design / ranks
            cells = []
            for rate, end in zip(rates, ends):
                whole = seconds + size / (rate * 1e9) + end
                cells += [f"{whole:.1f}", f"{100 * ideal / whole:.0f} %"]
            print(f"| {ranks} | {len(sizes) / ranks:.1f} | {seconds:.2f} | {100 * ideal / seconds:.0f} % | "
                  + " | ".join(cells) + " |")
        print()


if __name__ == "__main__":
    main()
