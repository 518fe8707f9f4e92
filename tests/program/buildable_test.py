"""Random machines: the optimum can be built, and no design of a lattice that can be built is better."""

import json
import math
import os
import unittest
from collections import namedtuple

import h5py
import numpy as np

from commands import read_trace
from support import JOBS, DirectoryTest

AXES = ("r1", "r3", "r2")
FIELDS = ("tip-clearance", "counterweight-clearance", "projectile-clearance", "least-sling-tension", "pin-angle")
POINTS = 21  # of each axis of the lattice
MACHINES = 30
CHECKED = int(os.environ.get("TREBSWEEP_MACHINES", "6"))  # the last of them; all take minutes


# The text of a job; the height of its fulcrum (m), the weight of its projectile (N), and its objective.
Machine = namedtuple("Machine", "text height weight objective")


def random_machine(random, kind):
    """A Machine with an arm of about a metre, axes and release at random; every other one has a hanger and a trough."""
    hinged = kind % 2 == 0
    height = random.uniform(0.7, 1.2)
    projectile = random.uniform(0.2, 2)
    ratio = random.uniform(30, 130)
    axes = {"r1": (0.15, 0.5), "r3": (0.6, 1.5), "r2": (0.7, 1.7)}
    scene = {"gravity": 9.81, "fulcrum-height": height, "projectile-mass": projectile,
             "counterweight-mass": ratio * projectile, "beam-side": random.uniform(0.02, 0.05),
             "beam-density": random.uniform(400, 800), "start-angle": random.uniform(0.5, 1.1)}
    if hinged:
        scene |= {"counterweight-hanger": random.uniform(0.1, 0.5), "trough": "yes"}
    else:
        axes |= {"r3": (0.3, 0.9 * height), "r2": (0.1 * height, 0.7 * height)}
    release = ("farthest", "fastest", "pin")[kind // 2 % 3]
    solver = {"stepper": "vern8", "tolerance": 1e-10, "max-time": 1, "release": release, "check": "no"}
    if release == "pin":
        solver["pin-angle"] = random.uniform(0.2, 0.8)
    lattice = {axis: f"{low!r}:{high!r}:{(high - low) / (POINTS - 1)!r}" for axis, (low, high) in axes.items()}
    output = {"fields": ", ".join(FIELDS + ("speed", "range"))}
    optimum = {"objective": "speed" if release == "fastest" else "range"}
    sections = {"scene": scene, "lattice": lattice, "solver": solver, "output": output, "optimum": optimum}
    text = "\n".join(f"[{name}]\n" + "\n".join(f"{key} = {value}" for key, value in keys.items())
                     for name, keys in sections.items())
    return Machine(text, height, 9.81 * projectile, optimum["objective"])


class RandomMachines(DirectoryTest):
    def setUp(self):
        random = np.random.default_rng(28)
        self.machines = [random_machine(random, kind) for kind in range(MACHINES)][-CHECKED:]
        self.job = self.path("job.cfg")

    def optimum(self):
        """What `optimum` finds; None if no design satisfies the conditions."""
        done = self.run_program("optimum", self.job, "--json", "--progress", "none", ranks=2, code=None)
        if done.returncode == 0:
            return json.loads(done.stdout)
        self.assertEqual(done.returncode, 3)
        self.assertIn("the constraints exclude every design found", done.stderr)
        return None

    def assert_can_be_built(self, machine, design):
        """In the rows of its trace, which are returned, nothing is below the ground, and the sling pulls."""
        lengths = [f"--{axis}={design[axis]!r}" for axis in AXES]
        trace = self.run_program("trace", self.job, *lengths, "--interval", "2e-4").stdout
        comments, rows = read_trace(trace)
        rows = rows[rows["t"] <= float(comments["release-time"]) * (1 + 1e-12)]
        flies = rows["t"] > float(comments.get("lift-off-time", -1))
        ground = -machine.height - 1e-6
        for body, heights in (("tip", rows["yt"]), ("counterweight", rows["y1"]), ("projectile", rows["y3"][flies])):
            self.assertGreaterEqual(heights.min(), ground, body)
        self.assertGreaterEqual(rows["tension"].min(), -1e-5 * machine.weight)
        self.assertLess(abs(rows["phi1"][-1] - rows["phi2"][-1]), math.pi)
        return rows

    def best_of_lattice(self, machine):
        """The largest objective of the lattice's designs that satisfy the same conditions, or -inf without one."""
        self.run_program("sweep", self.job, "--overwrite", "--progress", "none", ranks=2)
        with h5py.File(self.path("job.h5")) as file:
            maps = {name.replace("_", "-"): data[...] for name, data in file.items() if data.ndim == 3}
        clearances = np.minimum.reduce([maps[field] for field in FIELDS[:3]])
        satisfied = (clearances >= 0) & (maps["least-sling-tension"] >= 0) & (np.abs(maps["pin-angle"]) < math.pi)
        return np.max(maps[machine.objective], where=satisfied, initial=-np.inf)

    def test_the_hobby_machine_can_be_built_from_its_beam_and_its_box_hangs(self):
        with open(os.path.join(JOBS, "hobby.cfg"), encoding="utf-8") as file:
            self.write("job.cfg", file.read())
        found = self.optimum()
        rows = self.assert_can_be_built(Machine("", 1.1, 0.5 * 9.8, "range"), found)
        self.assertLessEqual(found["r1"] + found["r2"], 2 + 1e-9)
        self.assertGreaterEqual(rows["hanger_tension"].min(), -1e-5 * 60 * 9.8)
        self.assertAlmostEqual(rows["yt"][0], -1.1, places=9)
        self.assertEqual(found["warnings"], [])

    def test_the_optimum_can_be_built_and_no_such_design_of_a_lattice_is_better(self):
        for number, machine in enumerate(self.machines):
            self.write("job.cfg", machine.text)
            found, best = self.optimum(), self.best_of_lattice(machine)
            with self.subTest(number=number, job=machine.text):
                if found is None:
                    self.assertEqual(best, -np.inf)
                    continue
                self.assert_can_be_built(machine, found)
                reached = max(found["value"], found["unsafe"]["value"] if found.get("unsafe") else -np.inf)
                self.assertLessEqual(best, reached + 1e-6 * abs(reached))


if __name__ == "__main__":
    unittest.main()
