"""Job files for explorer_test.py."""

import json
import os
import random

from support import REPOSITORY

with open(os.path.join(REPOSITORY, "tests", "job", "refused.json"), encoding="utf-8") as table:
    REFUSED = json.load(table)

EVERY_SECTION = """[scene]
projectile-mass = 50
[lattice]
increment = 0.2
[solver]
stepper = rk4
time-step = 0.002
release = window
release-window = 0.1
max-steps = 40000
check = no
[output]
file = kept.h5
fields = speed, status range
optimum = taut
maps = all
storage = float32
compression = 3
[optimum]
objective = range
subject-to = peak-axle-load <= 4e6, speed >= 1
deviation = 0.001
robust = no
refine = no
[assess]
scenes = a.cfg b.cfg
extremes = c.cfg
steppers = rk4, vern8
time-steps = 0.01 0.001
tolerances = 1e-6
designs = 10
repeats = 3
target-error = 1e-4
lattice-seconds = 0
"""


def mistakes(fields):
    """Texts that the program refuses, as {key: text}, for fields {key: its tag}. A mistake between keys is shown at
    the last of them."""
    is_one = lambda key, text: "," not in text and (":" not in text or not key.startswith("scene."))  # noqa: E731
    for keys, texts in REFUSED["values"]:
        one = [text for text in texts if is_one(keys[0], text)]
        yield from ({key: one[0]} for key in keys if fields.get(key) == "INPUT" and one)
    for together in REFUSED["together"]:
        if fields.keys() >= together.keys() and all(is_one(key, text) for key, text in together.items()):
            yield together


def wrong_files(fields):
    """The texts of job files with a mistake each, which cannot be made in the fields."""
    yield from REFUSED["files"]
    typed = list(mistakes(fields))
    single = [{keys[0]: text} for keys, texts in REFUSED["values"] for text in texts[::2] if "#" not in text]
    for job in [*single, *REFUSED["together"]]:
        if job not in typed:
            yield "".join(f"{key} = {text}\n" for key, text in job.items())


def random_jobs(count):
    """Jobs of random scenes and designs, as {key: text} and {axis: m}; each effect is in some of them."""
    pick = random.Random(19)
    number = lambda low, high: f"{pick.uniform(low, high):.4g}"  # noqa: E731
    for n in range(count):
        job = {"scene.counterweight-mass": number(1000, 9000), "scene.projectile-mass": number(20, 200),
               "scene.beam-side": number(0.05, 0.2), "scene.beam-inertia": pick.choice(["slender", "prism"])}
        design = {"r1": number(0.6, 1.0), "r3": number(0.4, 0.9), "r2": number(0.5, 1.2)}
        if n % 2 == 0:
            job["scene.counterweight-hanger"] = number(0.1, 0.4)
            job["scene.start-angle"] = number(0.4, 1.2)
            job["scene.counterweight-inertia"] = number(0, 300)
        if n % 3 == 0:
            job.update({"scene.trough": "yes", "scene.start-angle": number(0.5, 1.0)})
            design["r3"], design["r2"] = number(1.2, 1.6), number(1.3, 2.0)
        elif n % 4 == 1:
            job.update({"scene.sling-stiffness": number(1e5, 5e5), "scene.sling-damping": number(0, 500)})
        if n % 5 < 2:
            job.update({"solver.release": "pin", "solver.pin-angle": number(0.2, 0.8)})
        elif n % 5 == 2:
            job["solver.release"] = "fastest"
        elif n % 5 == 3:
            job["solver.release"] = "farthest"
        if n % 4 < 2:
            job["scene.pivot-friction"] = number(0, 500)
            job["scene.pivot-viscosity"] = number(0, 50)
        if n % 3 < 2:
            job["scene.projectile-diameter"] = number(0.1, 0.4)
            job["scene.wind"] = number(-8, 8)
        yield job, design


def random_lattices(count):
    """Jobs with lattices of random bounds, as {key: text}; some of them have no design."""
    pick = random.Random(49)
    number = lambda low, high: f"{pick.uniform(low, high):.3g}"  # noqa: E731

    def axis():
        first, steps = pick.randint(5, 15), pick.randint(0, 20)
        return f"{first / 10}:{(first + steps) / 10}:0.1" if steps else str(first / 10)

    for n in range(count):
        job = {"scene.fulcrum-height": number(0.6, 3), "lattice.increment": number(0.02, 0.3)}
        if n % 3 == 0:
            job["scene.start-angle"] = number(0.3, 1)
        else:
            job["scene.release-height"] = number(0.5, 5)
        if n % 2 == 0:
            job["scene.counterweight-hanger"] = number(0.1, 1.2)
        if n % 5 == 0:
            job.update({"scene.trough": "yes", "lattice.r3": axis(), "lattice.r2": axis()})
            del job["lattice.r2" if n % 2 else "lattice.r3"]  # has a default axis
        elif n % 5 == 1:
            job[f"lattice.{pick.choice(['r1', 'r3', 'r2'])}"] = axis()
        elif n % 5 == 2:
            job["lattice.shortest-sling"] = number(0.1, 2)
        yield job
