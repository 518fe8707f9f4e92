"""Job files for explorer_test.py."""

import random

# A mistake of each kind in the fields. Rules between keys are found at the key that is given here last.
MISTAKES = [
    {"scene.counterweight-mass": "-1"}, {"scene.gravity": "0"}, {"scene.projectile-mass": "heavy"},
    {"scene.sling-angle": "4"}, {"scene.start-angle": "3.2"}, {"scene.wind": "2000"}, {"scene.beam-side": "-0.1"},
    {"solver.release-angle": "7"}, {"solver.max-time": "0"}, {"scene.release-height": "6"},
    {"scene.counterweight-hanger": "1.6"}, {"lattice.shortest-sling": "2"}, {"lattice.increment": "3"},
    {"lattice.r1": "1:2"}, {"lattice.r3": "0.3:0.95:0.1"}, {"lattice.r2": "2:1:0.1"},
    {"solver.release": "pin", "solver.pin-angle": ""}, {"solver.release": "window"}, {"scene.beam-mass": "500"},
    {"scene.sling-damping": "5"},
    {"scene.counterweight-hanger": "0.2", "scene.sling-stiffness": "1e5"}, {"scene.sling-stiffness": "60"},
]

# Job files with a mistake each.
WRONG_FILES = [
    # Syntax.
    "gravity = 1", "= 5", "gravity", "; a comment", "[]", "[scene", "[scenes]\ngravity = 1", "toString = 1",
    "__proto__ = 1",
    "[ scene ]\ngravity = 1", "[scene]\ngravity = 9 = 5", '[scene]\ngravity = "9"',
    "[scene]\ngravity = 9 ; a comment", "[scene]\ngravity = 9# a",
    "[scene]\ngravity = 9\n[lattice]\nincrement = 0.5\n[scene]\ngravity = 9",
    "scene.gravity = 9\n[scene.]\ngravity = 9",
    # Values.
    "[scene]\ngravity =", "[scene]\ngravity = 0x10", "[scene]\ngravity = 1e400", "[scene]\nbeam-side = 1e-400",
    "[scene]\ntrough =", "[scene]\nbeam-inertia = Prism", "[lattice]\nr1 =", "[lattice]\nr1 = 1:2",
    "[lattice]\nr1 = 1:2:3", "[lattice]\nr1 = 1:2:-1", "[scene]\nsling-stiffness = 1e-12", "[solver]\nstepper = rk5", "[solver]\ntolerance = 1", "[solver]\ntime-step = -1",
    "[solver]\nmax-steps = 1e3", "[solver]\ncheck = maybe",
    "[solver]\nstepper = rk4\nrelease = window\nrelease-window = 2", "[output]\nfile =", '[output]\nfile = "a"',
    "[output]\nfields = speed, height", "[output]\nfields = , speed", "[output]\nfields = speed speed",
    "[output]\nmaps = some", "[output]\nstorage = float16", "[output]\ncompression = 10",
    "[output]\noptimum = best", "[optimum]\nobjective = status", "[optimum]\nsubject-to = range > 5", "[optimum]\nsubject-to = mass >= 5",
    "[optimum]\nsubject-to = range >= 5 m",
    "[optimum]\nsubject-to = range >= 5,", "[optimum]\ndeviation = -1", "[optimum]\nrobust = maybe",
    '[assess]\nscenes = "a"', "[assess]\nsteppers = rk5", "[assess]\ntolerances =", "[assess]\ntime-steps = 0.1, 0",
    "[assess]\ndesigns = 0", "[assess]\nlattice-seconds = -1",
    # Rules.
    "[scene]\nstart-angle = 0.5\nrelease-height = 2", "[scene]\nwind = 3", "[scene]\nbeam-mass = 500",
    "[scene]\nbeam-mass = 500\nbeam-centre = 2\nbeam-moment = 1e-7", "[solver]\ntime-step = 0.001",
    "[solver]\nstepper = rk4\ntolerance = 1e-6", "[solver]\ntolerance = 1e-6\ntarget-error = 1e-3",
    "[solver]\nrelease = window", "[solver]\nrelease = pin", "[solver]\nrelease-window = 0.1",
    "[output]\nfields = peak-hanger-tension", "[optimum]\nobjective = lift-off-time",
    "[scene]\nbeam-side = 0\n[optimum]\nsubject-to = peak-beam-stress <= 1e7",
    "[optimum]\nsubject-to = range >= 5, range >= 6", "[optimum]\nsubject-to = range >= 6, range <= 5",
    "[optimum]\nrobust = worst", "[lattice]\nincrement = 1e-5", "[lattice]\nincrement = 1e-12",
    "[lattice]\nr1 = 0.1:1e6:0.1\nr2 = 0.1:1e6:0.1",
    # Studies.
    "[scene]\ngravity = 5,,6", "[scene]\ngravity = 5, 5.0", "[scene]\ngravity = 5, -1", "[scene]\ngravity = 1:5",
    "[scene]\ngravity = 1: :1", "[scene]\ngravity = 1:2:1, 3", "[scene]\ngravity = 2:1:1",
    "[scene]\ngravity = 1:5:1.5", "[scene]\ngravity = 1:2e7:1",
    "[scene]\ngravity = 1:1001:1\nprojectile-mass = 1:1001:1", "[scene]\ntrough = yes, no",
    "[scene]\ngravity = 9, 10\n[solver]\ntarget-error = 1e-3", "[scene]\nwind = 3, 4",
    "[scene]\nsling-angle = 0, 0.1\n[output]\nfields = sling-angle", "[scene]\nsling-damping = 0, 3",
    "[scene]\ncounterweight-hanger = 0, 1\nprojectile-mass = 5, 1",
]
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
