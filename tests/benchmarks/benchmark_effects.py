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
PAPER = "jobs/accurate.cfg"
EFFECTS = {
    "none": "",
    "beam-inertia prism": "--scene.beam-inertia=prism",
    "beam-inertia none": "--scene.beam-inertia=none",
    "pivot-viscosity 20": "--scene.pivot-viscosity=20",
    "pivot-friction 510": "--scene.pivot-friction=510",
    "sling-mass 5": "--scene.sling-mass=5",
    "sling-stiffness 3e5": "--scene.sling-stiffness=3e5",
    "sling-stiffness 3e5, sling-damping 500":
        "--scene.sling-stiffness=3e5 --scene.sling-damping=500",
    "release pin 0.6": "--solver.release=pin --solver.pin-angle=0.6",
    "release farthest": "--solver.release=farthest",
    "release fastest": "--solver.release=fastest",
}
# Around a machine with hanger and trough; the first has neither. All have the same lattice.
MACHINE = "jobs/lab.cfg"
FIXED, CROSSING = "--scene.counterweight-hanger=0", "--solver.release=crossing"
MACHINES = {
    "fixed counterweight, no trough": f"{FIXED} --scene.trough=no {CROSSING}",
    "hanger": f"--scene.trough=no {CROSSING}",
    "trough": f"{FIXED} {CROSSING}",
    "hanger, trough": CROSSING,
    "hanger, trough, pivot-friction 2": f"{CROSSING} --scene.pivot-friction=2",
    "hanger, trough, release pin 0.6": "--solver.release=pin --solver.pin-angle=0.6",
    "hanger, trough, release farthest": "--solver.release=farthest",
    "hanger, trough, release farthest, drag":
        "--solver.release=farthest --scene.projectile-diameter=0.075",
}
FIELDS = ["sling-angle", "arm-rate", "sling-rate", "kinetic-energy", "efficiency", "range",
          "energy-drift", "steps", "slack", "least-sling-tension", "peak-sling-tension",
          "peak-axle-load", "peak-beam-stress", "flight-time", "impact-speed", "apex", "arm-angle",
          "pin-angle"]
MACHINE_FIELDS = ["range", "lift-off-time", "peak-hanger-tension"]
DRAG = "--scene.projectile-diameter=0.075"


def sweep(job, options, fields, archive):
    """Runs a sweep: ns per design of the integration, bytes of the archive, steps per design, and the optimum."""
    subprocess.run(["mpirun", "-n", "2", os.path.join(REPOSITORY, "build", "release", "trebsweep"),
                    "sweep", os.path.join(REPOSITORY, job), *options.split(),
                    "--output.fields", ", ".join(["speed", "status", *fields]),
                    "--output.file", archive, "--overwrite", "--progress", "none"],
                   check=True, capture_output=True)
    with h5py.File(archive) as file:
        values = dict(file.attrs)
    return (1e9 * values["integration_seconds"] / values["designs"], os.path.getsize(archive),
            values["steps"] / values["designs"], values["best_speed"],
            *(values[name] for name in ("best_r1", "best_r2", "best_r3")))


def measure(cases, rounds):
    """Results of the cases by name: the medians of the times, and the rest, which is always the same."""
    results = {name: [] for name in cases}
    with tempfile.TemporaryDirectory() as directory:
        for _ in range(rounds):
            for name, case in cases.items():
                results[name].append(sweep(*case, os.path.join(directory, "map.h5")))
    return {name: (statistics.median(result[0] for result in of_name), *of_name[0][1:])
            for name, of_name in results.items()}


def print_effects(results):
    """Prints the cost of each effect, relative to the first one."""
    none = next(iter(results.values()))[0]
    print("\n| scene | ns per design, 2 ranks | ratio | steps per design | optimum, m/s | "
          "at r1, r2, r3, m |\n|---|---|---|---|---|---|")
    for name, (nanoseconds, _, steps, speed, r1, r2, r3) in results.items():
        print(f"| {name} | {nanoseconds:.0f} | {nanoseconds / none:.2f} | {steps:.1f} | "
              f"{speed:.6f} | {r1:g}, {r2:g}, {r3:g} |")


def print_fields(results):
    """Prints the cost of each field, relative to the first one."""
    none = next(iter(results.values()))[0]
    print("\n| field, in addition to speed and status | ns per design | ratio | bytes of the archive |\n"
          "|---|---|---|---|")
    for name, (nanoseconds, size, *_) in results.items():
        print(f"| {name} | {nanoseconds:.0f} | {nanoseconds / none:.2f} | {size} |")


def main():
    """Measures and prints the tables."""
    rounds = int(sys.argv[1]) if len(sys.argv) > 1 else 3
    print_effects(measure({name: (PAPER, options, []) for name, options in EFFECTS.items()}, rounds))
    print_effects(measure({name: (MACHINE, options, []) for name, options in MACHINES.items()},
                          rounds))
    print_fields(measure({"none": (PAPER, "", [])}
                         | {field: (PAPER, "", [field]) for field in FIELDS}
                         | {"range with drag": (PAPER, DRAG, ["range"])}, rounds))
    print_fields(measure({"none": (MACHINE, CROSSING, [])}
                         | {field: (MACHINE, CROSSING, [field]) for field in MACHINE_FIELDS}, rounds))


if __name__ == "__main__":
    main()
