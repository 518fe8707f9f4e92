#!/usr/bin/env python3
"""Compares whole sweeps with the paper's algorithm on one core. Prints a table of medians; the cases take turns
in each round.

    tests/benchmarks/benchmark_sweeps.py [ROUNDS]      needs a build with the tests, h5py, and mpirun
"""

import os
import re
import statistics
import subprocess
import sys
import tempfile

import h5py

REPOSITORY = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.path.join(REPOSITORY, "build", "release")
SWEEPS = [("jobs/paper.cfg", ()), ("jobs/accurate.cfg", ()),
          ("jobs/accurate.cfg", ("--solver.stepper", "dopri5"))]


def serial_seconds():
    """Seconds of a plain implementation of the paper's algorithm on one core."""
    text = subprocess.run([os.path.join(BUILD, "tests", "paper_serial")], check=True, text=True,
                          capture_output=True).stdout
    return float(re.search(r"seconds +(\S+)", text).group(1))


def sweep_seconds(job, options, ranks, archive):
    """Runs a sweep: seconds of the integration and in total, and the fraction of lane steps in use."""
    subprocess.run(["mpirun", "-n", str(ranks), os.path.join(BUILD, "trebsweep"), "sweep",
                    os.path.join(REPOSITORY, job), *options, "--output.file", archive,
                    "--overwrite", "--progress", "none"], check=True, capture_output=True)
    with h5py.File(archive) as file:
        attributes = {name: float(value) for name, value in file.attrs.items()
                      if name in ("integration_seconds", "sweep_seconds", "steps", "lane_steps")}
        return (attributes["integration_seconds"], attributes["sweep_seconds"],
                attributes["steps"] / attributes["lane_steps"])


def main():
    """Measures and prints the table."""
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 5
    serial, times = [], {}
    with tempfile.TemporaryDirectory() as directory:
        for _ in range(rounds):
            serial.append(serial_seconds())
            for job, options in SWEEPS:
                for ranks in (1, 2):
                    times.setdefault((job, options, ranks), []).append(
                        sweep_seconds(job, options, ranks, os.path.join(directory, "map.h5")))
    plain = statistics.median(serial)
    print(f"The paper's algorithm on one core: {plain:.2f} s (median of {rounds})\n")
    print("| sweep | ranks | integration, s | x the paper's | with writing, s | x the paper's | "
          "writing | lane utilisation | efficiency |\n|---|---|---|---|---|---|---|---|---|")
    for (job, options, ranks), values in times.items():
        integration, whole, lanes = (statistics.median(column) for column in zip(*values))
        alone = statistics.median(value[0] for value in times[job, options, 1])
        print(f"| {job} {options[1] if options else ''} | {ranks} | {integration:.3f} | "
              f"{plain / integration:.1f} | {whole:.3f} | {plain / whole:.1f} | "
              f"{100 * (1 - integration / whole):.0f} % | {100 * lanes:.1f} % | "
              f"{100 * alone / (ranks * integration):.0f} % |")


if __name__ == "__main__":
    main()
