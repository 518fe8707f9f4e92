#!/usr/bin/env python3
"""Measures the cost of each effect and each field, and the change of the optimum by each effect, relative to
the accurate sweep of the paper's scene. Prints tables of medians; the cases take turns in each round.

    tests/benchmarks/benchmark_effects.py [ROUNDS]      needs a build, h5py, and mpirun
"""

import os
import statistics
import subprocess
import sys
import tempfile

import h5py

REPOSITORY = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
EFFECTS = {
    "none": {},
    "beam-inertia prism": {"beam-inertia": "prism"},
    "beam-inertia none": {"beam-inertia": "none"},
    "pivot-viscosity 20": {"pivot-viscosity": "20"},
    "pivot-friction 510": {"pivot-friction": "510"},
    "sling-mass 5": {"sling-mass": "5"},
    "sling-stiffness 3e5": {"sling-stiffness": "3e5"},
    "sling-stiffness 3e5, sling-damping 500": {"sling-stiffness": "3e5", "sling-damping": "500"},
}
FIELDS = ["sling-angle", "arm-rate", "sling-rate", "kinetic-energy", "efficiency", "range",
          "energy-drift", "steps", "slack", "least-sling-tension", "peak-sling-tension",
          "peak-axle-load", "peak-beam-stress"]


def sweep(scene, fields, archive):
    """Runs a sweep: ns per design of the integration, bytes of the archive, steps per design, and the optimum."""
    options = [f"--scene.{key}={value}" for key, value in scene.items()]
    subprocess.run(["mpirun", "-n", "2", os.path.join(REPOSITORY, "build", "release", "trebsweep"),
                    "sweep", os.path.join(REPOSITORY, "jobs", "accurate.cfg"), *options,
                    "--output.fields", ", ".join(["speed", "status", *fields]),
                    "--output.file", archive, "--overwrite", "--progress", "none"],
                   check=True, capture_output=True)
    with h5py.File(archive) as file:
        values = dict(file.attrs)
    return (1e9 * values["integration_seconds"] / values["designs"], os.path.getsize(archive),
            values["steps"] / values["designs"], values["best_speed"],
            *(values[name] for name in ("best_r1", "best_r2", "best_r3")))


def main():
    """Measures and prints the tables."""
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    cases = {name: (scene, []) for name, scene in EFFECTS.items()}
    cases |= {f"field {field}": ({}, [field]) for field in FIELDS}
    results = {name: [] for name in cases}
    with tempfile.TemporaryDirectory() as directory:
        for _ in range(rounds):
            for name, case in cases.items():
                results[name].append(sweep(*case, os.path.join(directory, "map.h5")))
    none = statistics.median(result[0] for result in results["none"])
    print("| scene | ns per design, 2 ranks | ratio | steps per design | optimum, m/s | "
          "at r1, r2, r3, m |\n|---|---|---|---|---|---|")
    for name in EFFECTS:
        nanoseconds = statistics.median(result[0] for result in results[name])
        _, _, steps, speed, r1, r2, r3 = results[name][0]
        print(f"| {name} | {nanoseconds:.0f} | {nanoseconds / none:.2f} | {steps:.1f} | "
              f"{speed:.6f} | {r1:g}, {r2:g}, {r3:g} |")
    print("\n| field, in addition to speed and status | ns per design | ratio | bytes of the archive |\n"
          "|---|---|---|---|")
    for name in ["none", *(name for name in cases if name not in EFFECTS)]:
        nanoseconds = statistics.median(result[0] for result in results[name])
        print(f"| {name.removeprefix('field ')} | {nanoseconds:.0f} | {nanoseconds / none:.2f} | "
              f"{results[name][0][1]} |")


if __name__ == "__main__":
    main()
