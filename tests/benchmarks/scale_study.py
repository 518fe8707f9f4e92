#!/usr/bin/env python3
"""Predicts the run time of sweeps on many ranks: measures the integration of a design, the creation of an archive
and the writing on this machine, simulates the sweep's schedule with these numbers, and prints tables.

    tests/benchmarks/scale_study.py [GB_PER_SECOND ...]   rates of file systems, default 1 10 100; needs a build, h5py, mpirun

Model: time = creation (rank 0 alone, per tile) + rounds, each as long as its slowest rank, + all bytes divided by the
rate of the file system. Bytes of numbers count twice, because they are filled with NaN first. No rank computes while
the archive is written. The network and other users of the file system are not modelled.
"""

import heapq
import os
import re
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
IDLE = ("--solver.max-time", "1e-9")
ROUND_SECONDS, ROUND_BYTES = 2.0, 64 << 20  # as in src/sweep/schedule.cpp
MAPS = 3
FILLED = 8 / 9                              # fraction of the bytes filled with NaN first: all but the status
CELL_BYTES = 3 * 8                          # of the three maps in memory


def sweep(directory, ranks, *options):
    """Runs the job; returns its root attributes and the seconds until the partial archive existed."""
    archive = os.path.join(directory, "map.h5")
    partial = archive + ".partial"
    start = time.monotonic()
    process = subprocess.Popen(["mpirun", "-n", str(ranks), PROGRAM, "sweep", JOB, *options,
                                "--output.file", archive, "--progress", "none"],
                               stdout=subprocess.DEVNULL)
    while not os.path.exists(partial) and process.poll() is None:
        time.sleep(0.001)
    ready = time.monotonic() - start
    if process.wait():
        sys.exit("the sweep failed")
    with h5py.File(archive) as file:
        attributes = dict(file.attrs)
    attributes["bytes"] = os.path.getsize(archive)
    attributes["tiles"] = count_tiles(archive)
    os.remove(archive)
    return attributes, ready


def count_tiles(archive):
    """The number of tiles of an archive."""
    with h5py.File(archive) as file:
        return file["tile_done"].size


def measure(directory):
    """Seconds per design on one core, seconds per tile at creation, bytes per design, bytes written per second."""
    cores = os.cpu_count()
    work, _ = sweep(directory, cores, "--lattice.increment", "0.004")
    per_design = work["integration_seconds"] * cores / work["designs"]
    # Many small tiles, then one: the difference is due to the tiles, for one map without fill.
    one_map = (*IDLE, "--output.fields", "status")
    many, slow = sweep(directory, 1, *one_map, "--lattice.r1", "0.6", "--lattice.r3", "0.3:0.7:0.0001",
                       "--lattice.r2", "0.3:0.7:0.0001")
    _, fast = sweep(directory, 1, *one_map, "--lattice.r1", "0.6", "--lattice.r3", "0.3", "--lattice.r2", "0.3")
    idle, ready = sweep(directory, cores, *IDLE, "--lattice.increment", "0.002")
    writing = idle["sweep_seconds"] - idle["integration_seconds"] - ready
    rate = idle["bytes"] / writing
    per_tile = MAPS * (slow - fast) / many["tiles"]
    return per_design, per_tile, idle["bytes"] / idle["designs"], rate


def tile_sizes(per_metre):
    """The designs in each tile within the paper's bounds, in tile order, and the extent of a tile."""
    r1 = per_metre - 1                       # 0.5 < r1 < 1.5
    rows = [int(1.2 * per_metre) - 1 - i for i in range(int(1.2 * per_metre))]  # r2 < 1.5 - r3
    extents = (r1, len(rows), rows[0])
    edge = [min(n, max(16, min((n + 4) // 5, 64 if n > 2500 else 48))) for n in extents]
    plane = []
    for first in range(0, extents[1], edge[1]):
        for low in range(0, extents[2], edge[2]):
            size = sum(min(max(row - low, 0), edge[2]) for row in rows[first:first + edge[1]])
            if size:
                plane.append(size)
    return [size * min(edge[0], r1 - first) for first in range(0, r1, edge[0]) for size in plane], edge


def integration_seconds(sizes, edge, ranks, per_design):
    """Seconds and number of the rounds. As in the sweep, tiles are assigned the largest first, each to the rank with
    the smallest load."""
    most = max(1, ROUND_BYTES // (edge[0] * edge[1] * edge[2] * CELL_BYTES))
    batch, first, total, rounds = 1, 0, 0.0, 0
    while first < len(sizes):
        assigned = sorted(sizes[first:first + batch * ranks], reverse=True)
        first += len(assigned)
        loads = [0] * min(ranks, len(assigned))
        for size in assigned:
            heapq.heapreplace(loads, loads[0] + size)
        seconds = max(loads) * per_design
        total += seconds
        rounds += 1
        pace = min(max(ROUND_SECONDS / seconds, 0.1), 8.0)
        batch = min(max(1, int(batch * pace)), most)
    return total, rounds


def main():
    """Measures, simulates and prints."""
    rates = [float(word) for word in sys.argv[1:]] or [1.0, 10.0, 100.0]
    with tempfile.TemporaryDirectory() as directory:
        per_design, per_tile, per_design_bytes, rate = measure(directory)
    print(f"measured here: {1e9 * per_design:.0f} ns of a core per design, {1e6 * per_tile:.0f} us of rank 0 per "
          f"tile at creation, {per_design_bytes:.2f} bytes per design, written at {rate / 1e9:.2f} GB/s\n")
    for name, per_metre in (("1 mm", 1000), ("0.2 mm", 5000)):
        sizes, edge = tile_sizes(per_metre)
        designs = sum(sizes)
        creation = per_tile * len(sizes)
        print(f"{name}: {designs} designs in {len(sizes)} tiles, {designs * per_design_bytes / 1e9:.0f} GB, "
              f"{designs * per_design:.0f} s of a core; creation {creation:.2f} s\n")
        print("| ranks | tiles per rank | integration, s | balance | "
              + " | ".join(f"total at {r:g} GB/s, s | efficiency" for r in rates) + " |")
        print("|---" * (4 + 2 * len(rates)) + "|")
        for ranks in RANKS:
            seconds, _ = integration_seconds(sizes, edge, ranks, per_design)
            ideal = designs * per_design / ranks
            cells = []
            for each in rates:
                whole = creation + seconds + (1 + FILLED) * designs * per_design_bytes / (each * 1e9)
                cells += [f"{whole:.1f}", f"{100 * ideal / whole:.0f} %"]
            print(f"| {ranks} | {len(sizes) / ranks:.1f} | {seconds:.2f} | {100 * ideal / seconds:.0f} % | "
                  + " | ".join(cells) + " |")
        print()


if __name__ == "__main__":
    main()
