"""The commands as users meet them: exit codes, messages, files, and archives in common tools.

Needs TREBSWEEP (the program) and MPIEXEC in the environment.
"""

import itertools
import json
import os
import re
import signal
import subprocess
import time
import unittest

import h5py
import numpy as np

from support import JOBS, MPIEXEC, PROGRAM, DirectoryTest, mpirun

KERNELS = os.path.join(os.path.dirname(PROGRAM), "lib", "glibc-hwcaps")
COARSE = ("--lattice.increment", "0.1")


def wide_kernels():
    """Whether there are kernels for AVX2 and AVX-512, and the machine can run both."""
    with open("/proc/cpuinfo", encoding="utf-8") as file:
        return "avx512dq" in file.read() and all(os.path.isdir(os.path.join(KERNELS, level))
                                                 for level in ("x86-64-v3", "x86-64-v4"))


class CommandTest(DirectoryTest):
    """Tests that start with a job file alone in their directory."""

    def setUp(self):
        self.empty_directory()
        self.job = self.write("job.cfg", "[solver]\nstepper = dopri5\nrelease = crossing\n")

    def assert_refused(self, arguments, *words):
        """Exit code 2, one line on stderr that holds the words, and no change of the directory."""
        before = self.snapshot()
        done = self.run_program(*arguments, code=2)
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr.count("\n"), 1, done.stderr)
        for word in ("trebsweep: ", *words):
            self.assertIn(word, done.stderr)
        self.assertEqual(self.snapshot(), before)

    def redirected(self, redirection, *command, code=0):
        """Runs a command with a redirection of bash."""
        return self.run_command("bash", "-c", f'exec "$@" {redirection}', "bash", *command, code=code)

    def snapshot(self):
        """{name: bytes} of the regular files in the directory."""
        return {name: self.read(name) for name in os.listdir(self.directory) if os.path.isfile(self.path(name))}


class Help(CommandTest):
    def test_help_and_version_go_to_stdout(self):
        for command in ([], ["sweep"], ["trace"], ["assess"], ["info"]):
            self.assertIn("trebsweep", self.run_program(*command, "--help").stdout)
        self.assertRegex(self.run_program("--version").stdout,
                         r"^trebsweep \d+\.\d+\.\d+ \(.+\)\nkernel: .+ \(\d lanes\)\n$")

    def test_serial_commands_do_not_start_mpi(self):
        # Open MPI's MPI_Init fails if its message layer does not exist.
        broken = {"OMPI_MCA_pml": "missing"}
        if "Open MPI" not in subprocess.run([MPIEXEC, "--version"], capture_output=True, text=True,
                                            check=True).stdout:
            self.skipTest("can make only Open MPI's MPI_Init fail")
        self.assertNotEqual(self.run_program("sweep", self.job, *COARSE, code=None, environment=broken).returncode, 0)
        for arguments in (["--help"], ["--version"], ["sweep", "--help"], ["assess", "-h"],
                          ["trace", self.job, *Trace.DESIGN], ["trace", "--help"]):
            self.assertTrue(self.run_program(*arguments, environment=broken).stdout)

    def test_every_process_of_a_launcher_runs_the_serial_commands(self):
        self.run_program("sweep", self.job, *COARSE)
        for arguments in (["--version"], ["--help"], ["info", "job.h5"], ["trace", self.job, *Trace.DESIGN]):
            alone = self.run_program(*arguments).stdout
            for variable in ("OMPI_COMM_WORLD_RANK", "PMI_RANK", "PMIX_RANK", "SLURM_PROCID"):
                with self.subTest(arguments=arguments, variable=variable):
                    self.assertEqual(self.run_program(*arguments, environment={variable: "3"}).stdout, alone)


class Precedence(CommandTest):
    """A scene key can be given in four sources, listed from the highest precedence to the lowest."""

    SOURCES = ("option", "option's file", "job", "job's file")

    def projectile_mass(self, sources):
        """The value that a sweep uses when each of some sources gives its own."""
        arguments, job = [], "[scene]\n"
        for source in sources:
            mass = f"projectile-mass = {50 + self.SOURCES.index(source)}\n"
            if source == "option":
                arguments += ["--scene.projectile-mass", mass.split()[-1]]
            elif source == "job":
                job += mass
            else:
                path = self.write(f"scene{self.SOURCES.index(source)}.cfg", f"[scene]\n{mass}")
                if source == "job's file":
                    job += f"file = {os.path.basename(path)}\n"
                else:
                    arguments += ["--scene.file", path]
        path = self.write("job.cfg", job + "[lattice]\nincrement = 0.3\n")
        done = self.run_program("sweep", path, *arguments, "--overwrite")
        with h5py.File(self.path("job.h5")) as file:
            line = next(x for x in file.attrs["job"].splitlines() if x.startswith("projectile-mass"))
        self.assertIn(line, done.stdout)  # in the summary
        return int(line.split()[-1])

    def test_the_source_of_higher_precedence_wins(self):
        for high, low in itertools.combinations(self.SOURCES, 2):
            with self.subTest(high=high, low=low):
                self.assertEqual(self.projectile_mass([high, low]), 50 + self.SOURCES.index(high))
        for source in self.SOURCES:
            with self.subTest(source=source):
                self.assertEqual(self.projectile_mass([source]), 50 + self.SOURCES.index(source))

    def test_a_scene_file_given_as_an_option_changes_the_papers_sweep(self):
        wood = os.path.join(JOBS, "scenes", "wood.cfg")
        done = self.run_program("sweep", os.path.join(JOBS, "paper.cfg"), "--scene.file", wood, *COARSE)
        self.assertIn(f"scene     {wood}: beam-density = 700, beam-side = 0.2, beam-inertia = prism",
                      done.stdout)
        self.assertIn("solver    euler, time step 0.01 s", done.stdout)
        info = self.run_program("info", "paper.h5").stdout
        for line in done.stdout.splitlines():
            if line.startswith(("scene ", "solver ")):
                self.assertIn(line, info)


class Warnings(CommandTest):
    """Each reason to doubt a result is reported once, on stderr."""

    def warnings(self, *arguments, job=None):
        done = self.run_program("sweep", job or self.job, *arguments, "--overwrite", "--progress", "none", ranks=2)
        return [line for line in done.stderr.splitlines() if line.startswith("warning: ")]

    def test_an_optimum_on_the_edge_of_the_lattice_is_reported_with_its_bound(self):
        [warning] = self.warnings(*COARSE)
        self.assertIn("on the edge of the lattice: r1 = 0.6 m, the smallest allowed by h - h0 < r1 (47); "
                      "r2 = 0.9 m, the largest allowed by r2 < h0 - r3 (49)", warning)
        [warning] = self.warnings("--lattice.r1", "0.6:0.8:0.1", "--lattice.r3", "0.58", "--lattice.r2", "0.8:1:0.1")
        self.assertIn("the smallest allowed by lattice.r1", warning)
        self.assertNotIn("r3", warning)

    def test_an_optimum_inside_the_lattice_gives_no_warning(self):
        self.assertEqual(self.warnings("--lattice.r1", "0.505:0.52:0.001", "--lattice.r3", "0.582",
                                       "--lattice.r2", "0.916"), [])

    def test_steps_that_change_a_status_or_create_energy_are_reported(self):
        euler = self.write("euler.cfg", "[solver]\nstepper = euler\nrelease = window\ntime-step = 0.1\n")
        warnings = self.warnings("--lattice.increment", "0.05", job=euler)
        self.assertEqual(sum("a different status when integrated accurately" in line for line in warnings), 1)
        # Of the best designs of this scene, whose efficiency is high: not of single ones with chaotic swings.
        warnings = self.warnings("--lattice.increment", "0.05", "--scene.counterweight-mass", "400",
                                 "--solver.release", "crossing", job=euler)
        self.assertEqual(sum("an energy efficiency above 1" in line for line in warnings), 1)

    def test_slack_slings_among_the_best_designs_are_reported(self):
        warnings = self.warnings("--scene.sling-angle", "1.5", "--lattice.increment", "0.05")
        self.assertEqual(sum("slack" in line for line in warnings), 1)
        warnings = self.warnings("--scene.sling-angle", "1.5", "--lattice.increment", "0.05", "--output.optimum", "taut")
        self.assertEqual(sum("the sling goes slack" in line for line in warnings), 0)

    def test_a_refined_optimum_at_the_end_of_a_given_axis_is_reported(self):
        axes = ("--lattice.r3", "0.5", "--lattice.r2", "0.9", "--optimum.refine", "yes")
        [warning] = self.warnings("--lattice.r1", "0.6:0.9:0.1", *axes)
        self.assertIn("on the edge of the lattice: r1 = 0.6 m, the smallest allowed by lattice.r1", warning)
        self.assertEqual(self.warnings("--lattice.r1", "0.505:0.905:0.1", *axes), [])
        warnings = self.warnings("--lattice.r1", "0.6:0.9:0.1", *axes, "--scene.release-height", "1.7, 1.9, 2")
        self.assertEqual(sum("lies on the edge of the lattice: the smallest r1 in" in line for line in warnings), 1)


class Buildable(CommandTest):
    """In what a best design cannot be built: by how much the rows of its trace say."""

    SCENE = ("[scene]\ncounterweight-mass = 60\nprojectile-mass = 0.5\nfulcrum-height = 1.1\nbeam-side = 0.05\n"
             "beam-density = 700\nstart-angle = 0.5\ncounterweight-hanger = 0.6\ntrough = yes\n"
             "[lattice]\nr1 = 0.7:0.9:0.1\nr3 = 1\nr2 = 2\n[solver]\nrelease = fastest\n")
    BODIES = {"the arm's tip": "yt", "the counterweight": "y1", "the projectile": "y3"}

    def setUp(self):
        super().setUp()
        self.job = self.write("job.cfg", self.SCENE)

    def swept(self, *arguments):
        """The warnings of a sweep, and its optimum as options of trace."""
        done = self.run_program("sweep", self.job, *arguments, "--overwrite", "--progress", "none", ranks=2)
        with h5py.File(self.path("job.h5")) as file:
            design = [f"--{name}={float(file.attrs['best_' + name])!r}" for name in ("r1", "r2", "r3")]
        return [line for line in done.stderr.splitlines() if line.startswith("warning: ")], design

    def assert_described(self, line, design, *scene):
        """The line names the bodies and tensions that the rows of the design's trace have below zero."""
        done = self.run_program("trace", self.job, *scene, *design, "--interval", "1e-4")
        comments = dict(re.findall(r"^# (\S+) = (\S+)$", done.stdout, re.MULTILINE))
        rows = Trace.table(done.stdout)
        rows["y3"][rows["t"] < float(comments["lift-off-time"])] = 0
        heights = {body: rows[column].min() + 1.1 for body, column in self.BODIES.items()}
        below = re.findall(r"(the [a-z' ]+) reaches (\S+) m below the ground", line)
        self.assertEqual([body for body, _ in below], [body for body, height in heights.items() if height < -1e-6])
        for body, depth in below:
            self.assertAlmostEqual(float(depth) / -heights[body], 1, delta=0.05)
        for column, words in (("tension", "push with"), ("hanger_tension", "under a compression of")):
            least = rows[column].min()
            found = re.search(rf"{words} (\S+) N", line)
            self.assertEqual(found is not None, least < 0)
            if found:
                self.assertAlmostEqual(float(found.group(1)) / -least, 1, delta=0.01)
        # A trace says the same, and where and when it is worst.
        problems = line[line.index("the arm's tip reaches"):]
        self.assertIn(f"warning: the design cannot be built: {problems}\n", done.stderr)
        self.assertAlmostEqual(float(comments["ground-clearance"]), min(heights.values()), places=6)
        self.assertEqual(comments["ground-clearance-of"], "tip")
        for column, key in (("yt", "ground-clearance"), ("tension", "least-sling-tension"),
                            ("hanger_tension", "least-hanger-tension")):
            self.assertAlmostEqual(float(comments[key + "-time"]), rows["t"][rows[column].argmin()], delta=1.01e-4)

    def test_the_best_design_of_a_lattice_is_described_as_by_its_trace(self):
        for arguments in ((), ("--solver.check", "no"), ("--solver.release", "crossing")):
            with self.subTest(arguments=arguments):
                warnings, design = self.swept(*arguments)
                self.assertTrue(warnings[0].startswith("warning: the optimum cannot be built: the arm's tip"))
                self.assertEqual(sum("slack" in line for line in warnings), 1)
                self.assert_described(warnings[0], design, *arguments)

    def test_a_refined_optimum_is_described_instead_of_that_of_the_lattice(self):
        options = ("--solver.release", "crossing", "--lattice.r1", "0.3:0.9:0.1")
        _, lattice = self.swept(*options)
        warnings, design = self.swept(*options, "--optimum.refine", "yes")
        self.assertNotEqual(design, lattice)
        self.assert_described(warnings[0], design, "--solver.release", "crossing")

    def test_a_machine_above_the_ground_and_under_tension_has_no_warning(self):
        raised = ("--scene.fulcrum-height", "2.1", "--solver.release", "farthest")
        warnings, design = self.swept(*raised, "--lattice.r1", "0.5", "--lattice.r3", "1.5")
        self.assertEqual(warnings, [])
        self.assertEqual(self.run_program("trace", self.job, *design, *raised).stderr, "")

    def test_a_study_has_one_line_that_counts_its_scenes(self):
        warnings, _ = self.swept("--scene.fulcrum-height", "1.1, 1.2, 2.1", "--lattice.r1", "0.5", "--lattice.r3",
                                 "1.5", "--solver.release", "farthest")
        [line] = [line for line in warnings if "built" in line]
        self.assertRegex(line, "^warning: the optimum of 2 of 3 scenes cannot be built: below the ground in 2")


class MeasuredError(CommandTest):
    NAMES = ("error_median", "error_largest", "error_at_optimum", "error_designs")

    def line(self, text):
        return next(line for line in text.splitlines() if line.startswith("error "))

    def test_summary_info_and_attributes_give_the_same_error(self):
        line = self.line(self.run_program("sweep", self.job, *COARSE).stdout)
        self.assertEqual(line, self.line(self.run_program("info", "job.h5").stdout))
        with h5py.File(self.path("job.h5")) as file:
            median, largest, at_optimum, designs = (file.attrs[name] for name in self.NAMES)
        self.assertEqual(line, f"error     {median:.2g} median, {largest:.2g} largest of {designs} designs; "
                               f"{at_optimum:.2g} at the optimum")
        self.assertTrue(0 < median < largest < 1e-7)

    def test_attributes_are_the_same_on_any_number_of_ranks(self):
        attributes = []
        for ranks in (1, 2, 3):
            self.run_program("sweep", self.job, "--lattice.increment", "0.05", "--overwrite", ranks=ranks)
            with h5py.File(self.path("job.h5")) as file:
                attributes.append([file.attrs[name] for name in self.NAMES])
        self.assertEqual(attributes[0], attributes[1])
        self.assertEqual(attributes[0], attributes[2])

    def test_check_no_leaves_out_the_error_and_the_warnings_that_need_it(self):
        euler = self.write("euler.cfg", "[solver]\nstepper = euler\nrelease = window\ntime-step = 0.1\n")
        done = self.run_program("sweep", euler, *COARSE, "--solver.check", "no")
        self.assertEqual(self.line(done.stdout), "error     not measured")
        self.assertEqual(done.stderr.count("warning: "), done.stderr.count("on the edge of the lattice"))
        with h5py.File(self.path("euler.h5")) as file:
            values = [file.attrs[name] for name in self.NAMES]
        self.assertTrue(np.isnan(values[:3]).all())
        self.assertEqual(values[3], 0)

    def test_check_takes_yes_or_no(self):
        self.assert_refused(["sweep", self.job, "--solver.check", "maybe"],
                            "solver.check = maybe: must be one of no, yes")


class BuiltMachines(CommandTest):
    """The laboratory machine of jobs/lab.cfg: a hanger, a trough and the rules of release of builders."""

    LAB = os.path.join(JOBS, "lab.cfg")
    COARSE = ("--lattice.r1", "0.17:0.29:0.06", "--lattice.r3", "0.67:1.07:0.1", "--lattice.r2", "0.875:1.275:0.1")

    def test_maps_and_error_are_the_same_on_any_number_of_ranks_for_rules_of_builders(self):
        for rule, most in (("farthest", 3), ("fastest", 2), ("pin --solver.pin-angle 0.6", 2)):
            results = []
            for ranks in range(1, most + 1):
                self.run_program("sweep", self.LAB, *self.COARSE, "--solver.release", *rule.split(), "--overwrite",
                                 ranks=ranks)
                with h5py.File(self.path("lab.h5")) as file:
                    maps = {name: item[...].tobytes() for name, item in file.items() if item.shape == (3, 5, 5)}
                    results.append((maps, [file.attrs[name] for name in MeasuredError.NAMES]))
            self.assertEqual(len(maps), 12)
            for other in results[1:]:
                self.assertEqual(results[0], other, rule)
            median, largest, _, designs = results[0][1]
            self.assertEqual(designs, 75)
            self.assertTrue(1e-10 < median < 1e-7 and largest < 1e-6, (rule, median, largest))

    def test_designs_that_do_not_lift_off_or_reach_the_trough_are_counted(self):
        done = self.run_program("sweep", self.LAB, "--solver.max-time", "0.1", "--lattice.r1", "0.25",
                                "--lattice.r3", "0.07:1.07:0.25", "--lattice.r2", "1.075:1.275:0.1")
        info = self.run_program("info", "lab.h5").stdout
        with h5py.File(self.path("lab.h5")) as file:
            row = dict(zip(file["tile_designs"].attrs["columns"].split(), file["tile_designs"][0]))
            meanings = file["status"].attrs["flag_meanings"].split()
            self.assertEqual(meanings[file["status"][0, 0, 0]], "sling_too_short")
            self.assertEqual(meanings[file["status"][0, 4, 0]], "never_lifted")
        self.assertEqual((row["sling_too_short"], row["never_lifted"]), (3, 12))
        for words in ("3 sling_too_short", "12 never_lifted", "optimum   none: nothing was released"):
            self.assertIn(words, done.stdout)
            self.assertIn(words, info)

    def test_the_axes_that_a_trough_has_by_default_are_printed_and_continue_the_archive(self):
        scene = ("--scene.file", os.path.join(JOBS, "scenes", "laboratory.cfg"), "--lattice.increment", "0.1")
        summary = self.run_program("sweep", self.job, *scene, ranks=2).stdout
        self.assertIn("\naxes      r3 = 0.3:1.8:0.1, r2 = 0.3:1.8:0.1 m (default with a trough)\n", summary)
        with h5py.File(self.path("job.h5")) as file:
            for axis in ("r3", "r2"):
                np.testing.assert_array_equal(file[axis], np.arange(3, 19) / 10)
        for given in ((), ("--lattice.r2", "0.3:1.8:0.1")):
            again = self.run_program("sweep", self.job, *scene, *given)
            self.assertIn("holds the complete archive of this job", again.stderr)
        self.assertNotIn("axes ", self.run_program("sweep", self.job, *COARSE, "--overwrite").stdout)

    def test_the_optimum_is_sought_among_the_axes_that_a_trough_has_by_default(self):
        found = self.run_program("optimum", self.job, "--scene.file", os.path.join(JOBS, "scenes", "laboratory.cfg"),
                                 "--lattice.r1", "0.25", "--lattice.increment", "0.1", "--json", ranks=2).stdout
        _, r3, r2 = json.loads(found)["bounds"]
        self.assertEqual((r3, r2), ([0.3, 1.8], [0.3, 1.8]))

    def test_the_best_machine_for_the_backyard_is_within_its_limits(self):
        done = self.run_program("sweep", os.path.join(JOBS, "backyard.cfg"), ranks=2)
        refined = float(re.search(r"\nrefined   range (.+) m at ", done.stdout)[1])
        with h5py.File(self.path("backyard.h5")) as file:
            at = {name: data[...] for name, data in file.items() if data.ndim == 3}
        within = (at["peak_axle_load"] <= 5000) & (at["peak_beam_stress"] <= 2e7)
        for name in ("ground_clearance", "least_sling_tension", "least_hanger_tension"):
            within &= at[name] >= 0
        best = at["range"][within].max()
        self.assertGreater(best, 65)
        self.assertLess(best, refined)
        self.assertLess(refined, np.nanmax(at["range"]))

    def test_fields_of_what_the_scene_lacks_are_refused(self):
        for field, key in (("lift-off-time", "scene.trough"), ("peak-hanger-tension", "scene.counterweight-hanger")):
            self.assert_refused(["sweep", self.job, "--output.fields", field],
                                f"output.fields = {field}: must be left out unless {key}")


class AccurateByDefault(CommandTest):
    TABLETOP = ("[scene]\nfulcrum-height = 0.3\nrelease-height = 0.4\ncounterweight-mass = 2\n"
                "projectile-mass = 0.02\nbeam-side = 0.01\nbeam-density = 700\n"
                "[lattice]\nincrement = 0.02\nshortest-sling = 0.06\n")

    def test_the_default_solver_is_accurate_to_1e_7(self):
        job = self.write("tabletop.cfg", self.TABLETOP)
        self.run_program("sweep", job, "--output.fields", "speed, speed-error, status")
        with h5py.File(self.path("tabletop.h5")) as file:
            self.assertLess(np.nanmax(np.abs(file["speed_error"][...])), 1e-7)

    def test_a_counterweight_that_cannot_lift_the_projectile_gives_no_release(self):
        # The paper's Euler method reports releases at up to thousands of metres per second.
        job = self.write("heavy.cfg", "[scene]\nprojectile-mass = 1e8\n[lattice]\nincrement = 0.1\n")
        self.assertIn("optimum   none: nothing was released", self.run_program("sweep", job).stdout)

    def test_keys_that_the_solver_does_not_use_are_refused(self):
        self.assert_refused(["sweep", self.job, "--solver.time-step", "0.01"],
                            "solver.time-step = 0.01: must be left out", "solver.tolerance")
        self.assert_refused(["sweep", self.job, "--solver.release-window", "0.01"],
                            "solver.release-window = 0.01: must be left out")
        paper = os.path.join(JOBS, "paper.cfg")
        self.assert_refused(["sweep", paper, "--solver.tolerance", "1e-9"],
                            "solver.tolerance = 1e-9: must be left out", "solver.time-step")
        self.assert_refused(["sweep", paper, "--solver.stepper", "dopri5"], "solver.release = window")
        self.assert_refused(["sweep", self.job, "--solver.pin-angle", "0.6"],
                            "solver.pin-angle = 0.6: must be left out unless solver.release is pin")

    def test_keys_that_the_scene_does_not_use_are_refused(self):
        for used, unused, why in [
                (["start-angle=0.9"], "release-height = 2", "with scene.start-angle"),
                (["trough=yes"], "sling-angle = -1", "with scene.trough = yes"),
                (["beam-mass=5", "beam-centre=0.4", "beam-moment=2"], "beam-side = 0.1", "with scene.beam-mass"),
                ([], "wind = 3", "unless scene.projectile-diameter is above 0")]:
            with self.subTest(unused=unused):
                options = [f"--scene.{value}" for value in [*used, unused.replace(" = ", "=")]]
                self.assert_refused(["sweep", self.job, *options], f"scene.{unused}: must be left out {why}")


class Scale(CommandTest):
    def test_an_axis_of_millions_of_values_makes_progress_within_seconds(self):
        command = ["sweep", self.job, "--lattice.r1", "0.6", "--lattice.r3", "0.58", "--lattice.r2", "0.1:0.9999999:1e-7",
                   "--solver.stepper", "fehlberg78"]
        done, limit = 0, 4
        while not os.path.exists(self.path("job.h5")):
            run = self.run_program(*command, "--time-limit", str(limit), ranks=2, code=None)
            self.assertIn(run.returncode, (0, 75), run.stderr)
            if run.returncode == 75:
                before, stopped = done, re.search(r"stopped with (\d+) designs done", run.stderr)
                done = int(stopped.group(1)) if stopped else 0
                if done == before:  # other processes share the machine
                    limit *= 2
                    self.assertLess(limit, 60)


class Streams(CommandTest):
    """Results and exit codes do not depend on whether messages can be read, but on whether results can."""

    BROKEN = {"closed": "2>&-", "full": "2>/dev/full", "without a reader": "2> >(exec true)"}
    DESIGN = ("--r1", "0.51", "--r2", "0.91", "--r3", "0.58")
    UNDERGROUND = ("--r1", "0.51", "--r2", "2", "--r3", "0.58")

    def test_no_exit_code_depends_on_stderr(self):
        # Each of them prints messages. The progress bar does so while the archive is open.
        coarse = (self.job, "--lattice.increment", "0.05", "--progress", "bar")
        commands = {
            ("sweep", *coarse, "--time-limit", "1e-6"): 75,
            ("sweep", *coarse): 0,
            ("sweep", *coarse, "--output.file", "again.h5", "--lattice.r1", "0.6"): 0,
            ("sweep", "missing.cfg"): 2,
            ("info", "job.h5", "--verify", "--progress", "bar"): 0,
            ("info", "missing.h5"): 2,
            ("trace", self.job, *self.DESIGN, "--solver.max-time", "0.3"): 0,
            ("trace", self.job, *self.UNDERGROUND): 0,
            ("optimum", self.job, "--progress", "bar"): 0,
            ("optimum", self.job, "--optimum.subject-to", "speed >= 1e6"): 1,
            ("assess", self.job, *Assess.SMALL, "--output.file", "assess.h5"): 0,
        }
        for name, redirection in self.BROKEN.items():
            self.setUp()
            for command, code in commands.items():
                with self.subTest(stderr=name, command=command):
                    self.redirected(redirection, PROGRAM, *command, code=code)
            self.run_program("info", "job.h5", "--verify")

    def test_ranks_without_stderr_write_an_intact_archive(self):
        for code, options in ((75, ["--time-limit", "1e-6"]), (0, [])):
            self.run_command(*mpirun(2), "bash", "-c", 'exec "$@" 0<&- 2>&-', "bash", PROGRAM, "sweep", self.job,
                             *COARSE, *options, code=code)
        self.run_program("info", "job.h5", "--verify")

    def test_stdout_that_cannot_be_written_is_an_error_of_every_command(self):
        self.run_program("sweep", self.job, *COARSE)
        for redirection, reason in ((">/dev/full", "No space left on device"), (">&-", "Bad file descriptor")):
            for command in (["--help"], ["sweep", "--help"], ["info", "job.h5"], ["trace", self.job, *self.DESIGN],
                            ["optimum", self.job, "--progress", "none"],
                            ["sweep", self.job, *COARSE, "--output.file", "other.h5", "--overwrite"]):
                with self.subTest(redirection=redirection, command=command):
                    done = self.redirected(redirection, PROGRAM, *command, code=1)
                    self.assertIn(f"trebsweep: cannot write to stdout: {reason}\n", done.stderr)

    def test_a_reader_that_leaves_ends_a_trace_silently(self):
        done = self.redirected("> >(exec true)", PROGRAM, "trace", self.job, *self.DESIGN, "--interval", "1e-5",
                               code=-signal.SIGPIPE)
        self.assertEqual(done.stderr, "")


class Stdin(CommandTest):
    """A job called - is read from stdin."""

    def test_a_sweep_of_stdin_is_that_of_the_file(self):
        self.run_program("sweep", self.job, *COARSE, "--output.file", "file.h5")
        expected = self.read("file.h5")
        for ranks in (None, 2):
            with self.subTest(ranks=ranks):
                done = self.run_command("bash", "-c", 'cat job.cfg | "$@"', "bash", *mpirun(ranks), PROGRAM, "sweep",
                                        "-", *COARSE, "--overwrite")
                self.assertIn("archive   job.h5\n", done.stdout)
                with h5py.File(self.path("job.h5")) as piped, h5py.File(self.path("file.h5")) as file:
                    np.testing.assert_array_equal(piped["speed"], file["speed"])
                    self.assertEqual(piped.attrs["job"], file.attrs["job"].replace("file.h5", "job.h5"))
        self.assertEqual(self.read("file.h5"), expected)

    def test_every_command_with_a_job_reads_stdin(self):
        for command, *options in (["trace", *Trace.DESIGN], ["optimum", "--json"]):
            with self.subTest(command=command):
                alone, piped = (self.redirected("<job.cfg", PROGRAM, command, job, *options).stdout
                                for job in (self.job, "-"))
                seconds = r'"seconds": [^,}]*'
                self.assertEqual(re.sub(seconds, "", piped), re.sub(seconds, "", alone))
        done = self.redirected("<job.cfg", PROGRAM, "assess", "-", *Assess.SMALL)
        self.assertIn("scene job", done.stdout)
        self.assertEqual(sorted(os.listdir(self.directory)), ["job-assess.h5", "job.cfg"])

    def test_a_scene_file_is_relative_to_the_working_directory(self):
        self.write("moon.cfg", "[scene]\ngravity = 1.62\n")
        self.write("job.cfg", "[scene]\nfile = moon.cfg\n")
        done = self.redirected("<job.cfg", PROGRAM, "sweep", "-", *COARSE)
        self.assertIn("scene     moon.cfg: gravity = 1.62\n", done.stdout)

    def test_stdin_that_is_no_job_is_refused(self):
        self.write("binary", bytes(range(256)))
        self.write("long", "#" * (1 << 20) + "\n")
        self.write("words", "This is no job.\n")
        for redirection, words in (("<&-", " (stdin): Bad file descriptor"), ("</dev/null", " (stdin): is empty"),
                                   ("<binary", " (stdin): is not a text file"), ("<.", " (stdin): Is a directory"),
                                   ("<long", " (stdin): is longer than 1 MiB"),
                                   ("<words", ": line 1, 'This is no job.'")):
            for ranks in (None, 2):
                with self.subTest(redirection=redirection, ranks=ranks):
                    if ranks and redirection in ("<&-", "<."):
                        continue  # mpirun does not pass these on
                    done = self.redirected(redirection, *mpirun(ranks), PROGRAM, "sweep", "-", code=2)
                    self.assertEqual(done.stderr.count(f"trebsweep: job file -{words}"), 1, done.stderr)

    def test_a_signal_ends_a_sweep_that_waits_for_stdin(self):
        with subprocess.Popen([PROGRAM, "sweep", "-"], cwd=self.directory, stdin=subprocess.PIPE, text=True,
                              stderr=subprocess.PIPE) as sweep:
            time.sleep(0.5)
            for _ in range(50):  # one that arrives while MPI starts does not interrupt the wait
                if sweep.poll() is None:
                    sweep.send_signal(signal.SIGINT)
                    time.sleep(0.2)
            self.assertEqual(sweep.poll(), 2)
            self.assertIn("(stdin): Interrupted", sweep.stderr.read())


class BadInput(CommandTest):
    def test_impossible_physics_is_refused_with_key_value_and_bound(self):
        for key in ("gravity", "counterweight-mass", "projectile-mass", "release-height",
                    "fulcrum-height"):
            for value in ("0", "-1", "nan", "inf"):
                with self.subTest(key=key, value=value):
                    self.assert_refused(["sweep", self.job, f"--scene.{key}", value],
                                        f"scene.{key} = {value}", "above 0")

    def test_empty_and_oversized_lattices_are_refused(self):
        self.assert_refused(["sweep", self.job, "--scene.release-height", "3.5"],
                            "scene.release-height = 3.5", "leaves no design")
        for value in ("0", "-0.01", "nan"):
            self.assert_refused(["sweep", self.job, "--lattice.increment", value],
                                f"lattice.increment = {value}", "above 0")
        self.assert_refused(["sweep", self.job, "--lattice.increment", "1e-8"],
                            "lattice.increment = 1e-08", "would make a lattice of", "1e+12")

    def test_malformed_axes_are_refused(self):
        for value in ("1:0.5:0.1", "a:b:c", "0.5:1:0", "0.5:1:-0.1", "0.5:1", "nan"):
            self.assert_refused(["sweep", self.job, f"--lattice.r1={value}"],
                                f"lattice.r1 = {value}: must be first:last:step with a step above 0 and first <= last")

    def test_errors_list_the_choices(self):
        self.assert_refused(["sweep", self.job, "--solver.stepper", "leapfrog"],
                            "solver.stepper = leapfrog", "euler", "dopri5")
        self.assert_refused(["sweep", self.job, "--output.fields", "speed,mass"],
                            "output.fields = mass", "release-time")
        self.assert_refused(["sweep", self.job, "--output.storage", "float16"],
                            "output.storage = float16", "float64, float32")
        self.assert_refused(["sweep", self.job, "--output.compression", "10"],
                            "output.compression = 10", "0 to 9")

    def test_unknown_keys_in_files_and_options_are_refused(self):
        job = self.write("typo.cfg", "[scene]\ngravitiy = 9.8\n")
        self.assert_refused(["sweep", job], "scene.gravitiy", "counterweight-mass")
        self.assert_refused(["sweep", self.job, "--scene.gravitiy", "9.8"], "scene.gravitiy")
        self.assert_refused(["sweep", self.job, "--overwrit"], "--overwrit")
        self.assert_refused(["swep", self.job], "swep", "sweep, optimum, trace, assess and info")

    def test_files_that_are_not_job_files_are_refused(self):
        self.assert_refused(["sweep", "missing.cfg"], "missing.cfg", "No such file")
        self.assert_refused(["sweep", self.directory], self.directory, "directory")
        self.write("binary.cfg", bytes(range(256)))
        self.assert_refused(["sweep", "binary.cfg"], "binary.cfg", "not a text file")
        text = self.write("words.cfg", "This is no job.\n")
        self.assert_refused(["sweep", text], "words.cfg")

    def test_output_files_that_cannot_be_written_are_refused(self):
        self.assert_refused(["sweep", self.job, "--output.file", "no/such/folder.h5"],
                            "output.file = no/such/folder.h5", "no/such")
        self.assert_refused(["sweep", self.job, "--output.file", self.directory],
                            f"output.file = {self.directory}", "is a directory")
        # Root may write to any directory, but no file system takes a name this long.
        self.assert_refused(["sweep", self.job, "--output.file", "x" * 300],
                            "output.file = xxx", "the path is too long")

    def test_all_ranks_end_together_with_one_message(self):
        done = self.run_program("sweep", self.job, "--scene.gravity", "-1", ranks=3, code=2)
        self.assertEqual(done.stderr.count("scene.gravity = -1"), 1)
        done = self.run_program("sweep", "missing.cfg", ranks=2, code=2)
        self.assertEqual(done.stderr.count("No such file"), 1)


class Sweep(CommandTest):
    def test_a_sweep_prints_a_summary_and_leaves_only_its_archive(self):
        done = self.run_program("sweep", self.job, *COARSE)
        self.assertIn("optimum   ", done.stdout)
        self.assertIn("archive   job.h5", done.stdout)
        self.assertEqual(sorted(os.listdir(self.directory)), ["job.cfg", "job.h5"])

    def test_maps_are_bitwise_the_same_on_any_number_of_ranks(self):
        for ranks in (1, 2, 3, 5, 16):
            self.run_program("sweep", self.job, *COARSE, "--output.file", f"{ranks}.h5", ranks=ranks)
        with h5py.File(self.path("1.h5")) as alone:
            for ranks in (2, 3, 5, 16):
                with h5py.File(self.path(f"{ranks}.h5")) as other:
                    for field in ("speed", "release_time", "status"):
                        self.assertEqual(alone[field][...].tobytes(), other[field][...].tobytes())
                    self.assertEqual(alone.attrs["best_speed"], other.attrs["best_speed"])

    def test_maps_are_bitwise_the_same_with_avx2_and_avx512(self):
        if not wide_kernels():
            self.skipTest("this machine, or this build, lacks AVX-512")
        for stepper in ("euler", "rk4", "cash_karp54", "dopri5", "fehlberg78", "vern7", "vern8"):
            maps = []
            for level, name in (("x86-64-v3", "AVX2"), ("x86-64-v4", "AVX-512")):
                environment = {"LD_LIBRARY_PATH": os.path.join(KERNELS, level)}
                self.assertIn(name, self.run_program("--version", environment=environment).stdout)
                self.run_program("sweep", self.job, *COARSE, "--solver.stepper", stepper,
                                 "--output.file", "map.h5", "--overwrite", environment=environment)
                with h5py.File(self.path("map.h5")) as archive:
                    maps.append([archive[field][...].tobytes()
                                 for field in ("speed", "release_time", "status")])
            self.assertEqual(maps[0], maps[1])

    @unittest.skipUnless(wide_kernels(), "needs kernels with and without FMA")
    def test_ranks_with_different_instruction_sets_are_refused(self):
        rank = [PROGRAM, "sweep", self.job, *COARSE]
        old = ["env", "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX512F,-AVX2", *rank]
        done = self.run_command(MPIEXEC, "-n", "1", *rank, ":", "-n", "1", *old, code=1)
        self.assertIn("trebsweep: some ranks are on machines with", done.stderr)
        self.assertEqual(os.listdir(self.directory), ["job.cfg"])

    def test_effects_and_fields_are_bitwise_the_same_with_avx2_and_avx512_and_on_ranks(self):
        levels = ["x86-64-v3", "x86-64-v4"] if wide_kernels() else [""]
        fields = ["speed", "status", "slack", "range", "energy-drift", "peak-sling-tension",
                  "peak-beam-stress", "efficiency", "steps"]
        for scene in ("friction", "heavy_sling", "elastic_sling"):
            maps = []
            for level in levels:
                for ranks in (1, 2):
                    self.run_program(
                        "sweep", self.job, *COARSE, "--solver.stepper", "fehlberg78",
                        "--scene.file", os.path.join(JOBS, "scenes", f"{scene}.cfg"),
                        "--output.fields", ", ".join(fields), "--output.file", "map.h5",
                        "--overwrite", ranks=ranks,
                        environment={"LD_LIBRARY_PATH": os.path.join(KERNELS, level)})
                    with h5py.File(self.path("map.h5")) as archive:
                        maps.append([archive[field.replace("-", "_")][...].tobytes()
                                     for field in fields])
                        drift = archive["energy_drift"][...]
                        self.assertLess(np.nanmax(abs(drift)), 1e-6)
                        self.assertTrue({0, 1} <= set(np.unique(archive["slack"])) <= {0, 1, 2})
            for other in maps[1:]:
                self.assertEqual(maps[0], other)

    def test_the_optimum_can_be_limited_to_taut_slings(self):
        arguments = (*COARSE, "--scene.sling-angle", "1.5", "--solver.stepper", "fehlberg78")
        self.run_program("sweep", self.job, *arguments, "--output.fields", "speed, slack",
                         "--output.file", "all.h5")
        done = self.run_program("sweep", self.job, *arguments, "--output.optimum", "taut",
                                "--output.file", "taut.h5")
        with h5py.File(self.path("all.h5")) as archive, h5py.File(self.path("taut.h5")) as taut:
            slack, speed = archive["slack"][...], archive["speed"][...]
            self.assertTrue((slack == 2).any())
            if (slack == 1).any():
                self.assertEqual(taut.attrs["best_speed"], speed[slack == 1].max())
            else:
                self.assertIn("no released design has a taut sling", done.stdout)

    def test_the_optimum_has_the_largest_objective_of_the_designs_that_satisfy_the_constraints(self):
        scene = ("--lattice.increment", "0.05", "--solver.stepper", "vern8", "--lattice.shortest-sling", "0.2")
        fields = ("speed", "range", "efficiency", "sling-angle", "pin-angle", "arm-rate", "peak-axle-load",
                  "least-sling-tension", "slack")
        self.run_program("sweep", self.job, *scene, "--output.fields", ", ".join(fields), "--output.file", "all.h5")
        with h5py.File(self.path("all.h5")) as archive:
            maps = {field: archive[field.replace("-", "_")][...] for field in fields}
            axes = [archive[name][...] for name in ("r1", "r3", "r2")]
        angle, load = (float(np.nanmedian(maps[field])) for field in ("sling-angle", "peak-axle-load"))
        for objective, taut, constraints in (
                ("range", False, ()), ("efficiency", False, ()), ("sling-angle", False, ()),
                ("pin-angle", False, (("pin-angle", "<=", -0.1),)),
                ("speed", False, (("peak-axle-load", "<=", load),)),
                ("range", True, (("peak-axle-load", "<=", load), ("least-sling-tension", ">=", 100))),
                ("arm-rate", True, ()), ("efficiency", False, (("sling-angle", ">=", angle), ("speed", "<=", 10)))):
            with self.subTest(objective=objective, taut=taut, constraints=constraints):
                allowed = np.isfinite(maps[objective])
                for field, sign, limit in constraints:
                    allowed &= maps[field] <= limit if sign == "<=" else maps[field] >= limit
                if taut:
                    allowed &= maps["slack"] == 1
                self.assertTrue(allowed.any() and not allowed.all())
                index = np.unravel_index(np.where(allowed, maps[objective], -np.inf).argmax(), allowed.shape)
                expected = [maps[objective][index], maps["speed"][index], *(axis[i] for axis, i in zip(axes, index))]
                for ranks in (1, 3):
                    done = self.run_program(
                        "sweep", self.job, *scene, "--output.file", "best.h5", "--overwrite", "--optimum.objective",
                        objective, "--output.optimum", "taut" if taut else "all", "--optimum.subject-to",
                        ", ".join(f"{field} {sign} {limit!r}" for field, sign, limit in constraints), ranks=ranks)
                    with h5py.File(self.path("best.h5")) as best:
                        self.assertEqual([best.attrs[f"best_{name}"] for name in ("value", "speed", "r1", "r3", "r2")],
                                         expected)
                        self.assertEqual(best.attrs["objective"], objective)
                        self.assertEqual(best["speed"][...].tobytes(), maps["speed"].tobytes())
                        self.assertEqual(sorted(name for name, item in best.items() if item.shape == allowed.shape),
                                         ["release_time", "speed", "status"])
                    line = re.search("optimum .*", done.stdout).group()
                    self.assertIn(line, self.run_program("info", "best.h5").stdout)
                    self.assertEqual("subject to" in line, bool(constraints))

    def test_constraints_that_no_design_satisfies_leave_no_optimum(self):
        done = self.run_program("sweep", self.job, *COARSE, "--optimum.subject-to", "speed >= 100")
        text = "optimum   none: no released design satisfies the constraints"
        self.assertIn(text, done.stdout)
        self.assertIn(text, self.run_program("info", "job.h5").stdout)
        with h5py.File(self.path("job.h5")) as file:
            self.assertTrue(all(np.isnan(value) for name, value in file.attrs.items() if name.startswith("best_")))
            self.assertTrue(np.isnan(file.attrs["error_at_optimum"]) and file.attrs["error_designs"] > 0)

    def test_an_archive_opens_in_xarray(self):
        import xarray as xr  # slow to import, and used by two tests only
        self.run_program("sweep", self.job, *COARSE, ranks=2)
        for engine in ("netcdf4", "h5netcdf"):
            with xr.open_dataset(self.path("job.h5"), engine=engine) as data:
                self.assertEqual(data.speed.dims, ("r1", "r3", "r2"))
                self.assertEqual([data[axis].units for axis in ("r1", "r3", "r2")], ["m"] * 3)
                self.assertEqual(data.speed.units, "m s-1")
                self.assertEqual(data.release_time.units, "s")
                self.assertEqual(data.speed.ancillary_variables, "status")
                self.assertEqual(data.status.dtype, np.uint8)
                flags = dict(zip(data.status.flag_meanings.split(), data.status.flag_values))
                released = data.status == flags["released"]
                self.assertTrue((released == data.speed.notnull()).all())
                self.assertTrue(((data.status == flags["outside_lattice"])
                                 == (data.r2 > 1.5 - data.r3 - 1e-6)).all())
                best = data.speed.sel(r1=data.best_r1, r3=data.best_r3, r2=data.best_r2)
                self.assertEqual(float(best), data.best_speed)
                self.assertEqual(float(data.speed.max()), data.best_speed)
                self.assertTrue(data.tile_designs.any("tile_designs_column").all())

    def test_an_archive_records_its_origin(self):
        self.run_program("sweep", self.job, *COARSE, "--scene.gravity", "9.81")
        with h5py.File(self.path("job.h5")) as file:
            attributes = dict(file.attrs)
        self.assertEqual(attributes["Conventions"], "CF-1.10")
        self.assertEqual(attributes["format_version"], 1)
        self.assertEqual((attributes["objective"], attributes["objective_units"]), ("speed", "m s-1"))
        self.assertRegex(attributes["source"], r"^trebsweep \d")
        self.assertIn("--scene.gravity 9.81", attributes["history"])
        self.assertIn("gravity = 9.81\n", attributes["job"])
        self.assertGreaterEqual(attributes["sweep_seconds"], attributes["integration_seconds"])

    def test_the_stored_job_reproduces_the_maps(self):
        self.run_program("sweep", self.job, *COARSE, "--scene.projectile-mass", "55")
        with h5py.File(self.path("job.h5")) as file:
            again = self.write("again.cfg", file.attrs["job"])
            speed = file["speed"][...]
        self.run_program("sweep", again, "--output.file", "again.h5")
        with h5py.File(self.path("again.h5")) as file:
            self.assertEqual(file["speed"][...].tobytes(), speed.tobytes())

    def test_compression_and_float32_keep_the_values(self):
        self.run_program("sweep", self.job, *COARSE)
        self.run_program("sweep", self.job, *COARSE, "--output.compression", "5",
                         "--output.storage", "float32", "--output.file", "small.h5", ranks=2)
        with h5py.File(self.path("job.h5")) as plain, h5py.File(self.path("small.h5")) as small:
            self.assertEqual(small["speed"].dtype, np.float32)
            self.assertEqual(small["speed"].compression, "gzip")
            self.assertTrue(small["speed"].shuffle)
            np.testing.assert_array_equal(small["speed"][...],
                                          plain["speed"][...].astype(np.float32))
            np.testing.assert_array_equal(small["status"][...], plain["status"][...])

    def test_progress_goes_to_stderr_in_the_chosen_style(self):
        done = self.run_program("sweep", self.job, *COARSE, "--progress", "bar")
        self.assertIn("100 %", done.stderr)
        self.assertNotIn("left", done.stdout)
        done = self.run_program("sweep", self.job, *COARSE, "--progress", "none", "--overwrite")
        self.assertNotIn("%", done.stderr.replace("within 5 %", ""))


class Optimum(CommandTest):
    KEYS = {"objective", "value", "error", "r1", "r3", "r2", "release_time", "active", "gradient", "hessian",
            "one_percent_loss", "one_percent_limit", "constraints", "build_constraints", "sensitivity",
            "sensitivity_of_optimum", "worst", "expected", "maxima", "starts", "starts_at_best", "coarse_increment",
            "designs", "seconds", "converged", "bounds", "job", "unsafe", "values"}

    def optimum(self, *options, job=None, ranks=None):
        """The JSON object that the command prints, without the run time."""
        found = json.loads(self.run_program("optimum", job or self.job, "--json", *options, ranks=ranks).stdout)
        self.assertGreater(found.pop("seconds"), 0)
        return found

    def assert_no_optimum(self, *options, words, ranks=None):
        """Exit code 1, nothing on stdout, and a message of one line with the words."""
        done = self.run_program("optimum", self.job, *options, code=1 if ranks is None else None, ranks=ranks)
        self.assertNotEqual(done.returncode, 0)
        self.assertEqual(done.stdout, "")
        messages = [line for line in done.stderr.splitlines() if line.startswith("trebsweep: ")]
        self.assertEqual(len(messages), 1, done.stderr)
        self.assertIn(words, messages[0])

    def test_tolerances_end_at_bounds_and_constraints_and_say_which(self):
        weak = ("--optimum.subject-to", "peak-beam-stress <= 6e7", "--lattice.r1", "0.52:1:0.01")
        found = self.optimum(*weak)
        (r1_shorter, r1_longer), (r3_shorter, r3_longer), (r2_shorter, r2_longer) = found["one_percent_loss"]
        for forbidden in (r1_shorter, r1_longer, r3_longer, r2_longer):
            self.assertLess(forbidden, 1e-6)
        for allowed in (r3_shorter, r2_shorter):
            self.assertGreater(allowed, 0.009)
        stress = "peak-beam-stress <= 60000000"
        self.assertEqual(found["one_percent_limit"], [["r1 >= 0.52", stress], [None, stress], [None, stress]])
        text = self.run_program("optimum", self.job, *weak).stdout
        self.assertIn(f"r1: 0.0000 m shorter (r1 >= 0.52) or 0.0000 m longer ({stress}); gradient", text)
        text = self.run_program("optimum", self.job).stdout
        self.assertIn(" m shorter or 0.0000 m longer (r2 + r3 <= 1.5); gradient", text)

    def test_json_has_the_documented_keys_and_the_papers_optimum(self):
        found = self.optimum("--optimum.deviation", "0.005")
        self.assertEqual(set(found) | {"seconds"}, self.KEYS)
        self.assertEqual(found["objective"], "speed")
        # The maximum between the designs of the millimetre lattice, where it is 16.94320899 m/s at most.
        self.assertAlmostEqual(found["value"], 16.952925755, places=8)
        for name, length in {"r1": 0.511423, "r3": 0.583397, "r2": 0.916603}.items():
            self.assertAlmostEqual(found[name], length, places=6)
        self.assertLess(found["error"], 1e-9)
        self.assertEqual([limit["constraint"] for limit in found["active"]], ["r2 + r3 <= 1.5"])
        self.assertEqual({key for maximum in found["maxima"] for key in maximum}, {"r1", "r3", "r2", "value"})
        self.assertEqual(np.shape(found["hessian"]), (3, 3))
        self.assertLess(found["worst"], found["expected"])
        self.assertLess(found["expected"], found["value"])
        # By dimensional analysis, the speed is proportional to the square root of gravity.
        self.assertAlmostEqual(found["sensitivity"]["gravity"], found["value"] / (2 * 9.8), places=8)
        self.assertIsNone(self.optimum()["worst"])

    def test_text_and_json_agree(self):
        options = ("--optimum.objective", "range", "--optimum.subject-to", "peak-axle-load <= 1.6e5")
        text = self.run_program("optimum", self.job, *options).stdout
        found = self.optimum(*options)
        self.assertIn(f"range {found['value']:.10g} m", text)
        for name in ("r1", "r2", "r3"):
            self.assertIn(f"{name} = {found[name]:.7f}", text)
        self.assertEqual(len(found["active"]), 2)
        for limit in found["active"]:
            self.assertIn(f"{limit['constraint']}: {limit['multiplier']:+.6g} m", text)
        self.assertIn(f"spacing of {found['coarse_increment']} m", text)
        for key, slope in found["sensitivity"].items():
            if key == "gravity":
                self.assertRegex(text, rf"{key} .*{re.escape(f'{slope * 0.098:+.6g}')}")

    def test_without_an_optimum_the_message_says_why(self):
        excluded = ("--optimum.subject-to", "peak-axle-load <= 1e4, speed >= 16")
        for ranks in (None, 2):
            self.assert_no_optimum("--scene.release-height", "3.5", words="the design space is empty", ranks=ranks)
            self.assert_no_optimum("--solver.max-time", "0.2", words="nothing is released", ranks=ranks)
            self.assert_no_optimum(*excluded, words="the constraints exclude every design", ranks=ranks)

    def test_unknown_and_contradictory_constraints_are_refused(self):
        for constraints in ("sped >= 3", "speed >= 4, speed <= 3", "status >= 1", "speed > 3"):
            self.assert_refused(["optimum", self.job, "--optimum.subject-to", constraints], "optimum.subject-to")
        self.assert_refused(["optimum", self.job, "--optimum.robust", "worst"], "optimum.robust")
        self.assert_refused(["optimum", self.job, "--lattice.increment", "0.0005"], "lattice.increment")

    def test_fixed_axes_are_kept(self):
        free = self.optimum()
        for name in ("r1", "r3", "r2"):
            fixed = self.optimum(f"--lattice.{name}", "0.6")
            self.assertEqual(fixed[name], 0.6)
            self.assertLess(fixed["value"], free["value"])

    def test_the_optimum_is_bitwise_the_same_on_any_number_of_ranks(self):
        # With two maxima, so that the ranks share the searches.
        options = ("--scene.start-angle", "0.3", "--optimum.objective", "range")
        alone = self.optimum(*options)
        self.assertGreater(alone["starts"], 1)
        for ranks in (2, 3, 4):
            self.assertEqual(self.optimum(*options, ranks=ranks), alone)

    def test_a_given_increment_is_that_of_the_coarse_sweep(self):
        own = self.optimum()
        given = self.optimum("--lattice.increment", "0.03")
        self.assertEqual(given["coarse_increment"], 0.03)
        self.assertNotEqual(own["coarse_increment"], 0.03)
        self.assertAlmostEqual(given["value"], own["value"], places=10)
        self.assertIn("0.03 m", self.run_program("optimum", self.job, "--lattice.increment", "0.03").stdout)

    def test_the_optimum_does_not_depend_on_the_jobs_stepper(self):
        paper, accurate = (self.optimum(job=os.path.join(JOBS, f"{name}.cfg")) for name in ("paper", "accurate"))
        self.assertNotEqual(paper.pop("job"), accurate.pop("job"))
        self.assertEqual(paper, accurate)

    def test_no_file_is_written(self):
        before = self.snapshot()
        self.optimum()
        self.assertEqual(self.snapshot(), before)


class LongPaths(CommandTest):
    def test_the_path_of_an_archive_has_at_most_200_characters(self):
        directory = "a" * 100
        os.makedirs(self.path(directory))
        longest = os.path.join(directory, "b" * (200 - len(directory) - 1))
        for ranks in (None, 2):
            self.run_program("sweep", self.job, *COARSE, "--overwrite", "--output.file", longest, ranks=ranks)
        self.assert_refused(["sweep", self.job, *COARSE, "--output.file", longest + "c"],
                            "too long: 201 characters, at most 200 are allowed")


class ExistingFiles(CommandTest):
    def unfinished(self, *options):
        """Leaves an unfinished sweep, job.h5.partial; returns the command that continues it."""
        command = ["sweep", self.job, "--lattice.increment", "0.007", "--solver.stepper", "dopri5"]
        with subprocess.Popen([PROGRAM, *command, *options], cwd=self.directory, stdout=subprocess.DEVNULL,
                              stderr=subprocess.DEVNULL) as sweep:
            while not os.path.exists(self.path("job.h5.partial")) and sweep.poll() is None:
                time.sleep(0.005)
            sweep.send_signal(signal.SIGUSR1)
            self.assertEqual(sweep.wait(timeout=120), 75)
        return command

    def test_a_continued_sweep_does_not_replace_an_archive_created_meanwhile(self):
        self.run_program("sweep", self.job, *COARSE, "--scene.gravity", "9.7", "--output.file", "other.h5")
        command = self.unfinished()
        os.rename(self.path("other.h5"), self.path("job.h5"))
        self.assert_refused(command, "holds the archive of another job", "move it away to continue")
        os.remove(self.path("job.h5"))
        self.run_program(*command)

    def test_a_continued_overwrite_replaces_the_archive_it_was_started_for(self):
        self.run_program("sweep", self.job, *COARSE)
        command = self.unfinished("--overwrite")
        self.run_program(*command)
        with h5py.File(self.path("job.h5")) as file:
            self.assertIn("increment = 0.007", file.attrs["job"])

    def test_an_archive_with_a_missing_part_does_not_count_as_complete(self):
        def lose(name):
            def damage(file):
                del file[name]
            return damage

        for damage in (lose("speed"), lose("r1"), lose("tile_designs"), lambda file: file.attrs.pop("source")):
            self.run_program("sweep", self.job, *COARSE, "--overwrite")
            with h5py.File(self.path("job.h5"), "r+") as file:
                damage(file)
            self.assert_refused(["sweep", self.job, *COARSE], "output.file = job.h5")
            self.run_program("info", "job.h5", code=1)
            os.remove(self.path("job.h5"))

    def test_an_archive_without_tiles_is_reported_as_damaged(self):
        self.run_program("sweep", self.job, *COARSE)
        with h5py.File(self.path("job.h5"), "r+") as file:
            del file["tile_block"]
        self.assertIn("damaged", self.run_program("info", "job.h5", code=1).stderr)

    def test_ranks_that_cannot_see_the_file_end_instead_of_hanging(self):
        os.mkdir(self.path("elsewhere"))
        rank = [PROGRAM, "sweep", self.job, *COARSE, "--output.file", "seen.h5"]
        done = self.run_command(MPIEXEC, "-n", "1", *rank, ":", "-n", "1", "-wdir", self.path("elsewhere"), *rank,
                                code=None, timeout=60)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("rank 1 cannot see seen.h5.partial", done.stderr)
        self.assertEqual([name for name in os.listdir(self.directory) if name.startswith("seen")], [])

    def test_a_completed_job_is_not_run_again(self):
        self.run_program("sweep", self.job, *COARSE)
        before = self.snapshot()
        done = self.run_program("sweep", self.job, *COARSE, ranks=2)
        self.assertIn("job.h5 holds the complete archive of this job", done.stderr)
        self.assertEqual(self.snapshot(), before)

    def test_another_jobs_archive_is_kept_unless_overwritten(self):
        self.run_program("sweep", self.job, *COARSE)
        self.assert_refused(["sweep", self.job, *COARSE, "--scene.gravity", "9.81"],
                            "output.file = job.h5", "another job", "--overwrite")
        self.run_program("sweep", self.job, *COARSE, "--scene.gravity", "9.81", "--overwrite")
        with h5py.File(self.path("job.h5")) as file:
            self.assertIn("gravity = 9.81", file.attrs["job"])

    def test_a_file_that_is_not_an_archive_is_kept(self):
        self.write("notes.txt", "precious\n")
        self.assert_refused(["sweep", self.job, *COARSE, "--output.file", "notes.txt"],
                            "output.file = notes.txt", "already exists")
        self.assert_refused(["sweep", self.job, *COARSE, "--output.file", "job.cfg", "--overwrite"],
                            "output.file = job.cfg", "not an archive")
        with h5py.File(self.path("foreign.h5"), "w") as file:
            file.attrs["job"] = ["many"] * 2000
        self.assert_refused(["sweep", self.job, *COARSE, "--output.file", "foreign.h5"],
                            "output.file = foreign.h5", "not an archive")

    def test_files_that_are_not_those_of_a_sweep_are_kept(self):
        with h5py.File(self.path("foreign.h5"), "w") as file:
            file.attrs["job"] = "somebody's"
        foreign, job = self.read("foreign.h5"), self.read("job.cfg")
        for content in (b"half of it\n", foreign, job):
            self.write("job.h5.partial", content)
            for overwrite in ([], ["--overwrite"]):
                self.assert_refused(["sweep", self.job, *COARSE, *overwrite],
                                    "output.file = job.h5", "job.h5.partial is a file")
        os.remove(self.path("job.h5.partial"))
        os.mkdir(self.path("job.h5.partial"))
        self.write("job.h5.partial/notes.txt", "precious\n")
        for overwrite in ([], ["--overwrite"]):
            self.assert_refused(["sweep", self.job, *COARSE, *overwrite], "job.h5.partial exists and is not an unfinished sweep")
        os.rename(self.job, self.path("x.h5.partial"))
        self.assert_refused(["sweep", "x.h5.partial", "--output.file", "x.h5", "--overwrite"], "x.h5.partial")

    def test_links_in_the_way_are_kept(self):
        for target in ("job.cfg", "."):
            os.symlink(target, self.path("job.h5.partial"))
            self.assert_refused(["sweep", self.job, *COARSE, "--overwrite"], "job.h5.partial is a symbolic link")
            os.remove(self.path("job.h5.partial"))

    def test_names_too_long_for_a_suffix_are_refused(self):
        for length in (244, 248, 251, 255):
            self.assert_refused(["sweep", self.job, *COARSE, "--output.file", "x" * length], "too long")

    def test_an_output_file_that_is_a_link_is_followed(self):
        os.mkdir(self.path("far"))
        os.symlink("far/away.h5", self.path("job.h5"))
        self.run_program("sweep", self.job, *COARSE, "--time-limit", "1e-9", code=75)
        self.assertEqual(os.listdir(self.path("far")), ["away.h5.partial"])
        self.assertIn("far/away.h5.partial, unfinished", self.run_program("info", "job.h5").stdout)
        for options in ([], ["--overwrite"]):
            self.run_program("sweep", self.job, *COARSE, *options)
            self.assertEqual(os.readlink(self.path("job.h5")), "far/away.h5")
            self.assertEqual(os.listdir(self.path("far")), ["away.h5"])
        self.assertIn("job.h5, complete", self.run_program("info", "job.h5").stdout)
        os.symlink("loop.h5", self.path("loop.h5"))
        self.assert_refused(["sweep", self.job, *COARSE, "--output.file", "loop.h5"], "loop.h5", "Too many levels")

    def test_fifos_and_devices_do_not_block(self):
        os.mkfifo(self.path("fifo"))
        os.mkfifo(self.path("job.h5.partial"))
        self.assert_refused(["sweep", self.job, *COARSE], "job.h5.partial is a FIFO")
        self.assert_refused(["sweep", self.job, *COARSE, "--output.file", "fifo"], "output.file = fifo: is a FIFO")
        self.assert_refused(["sweep", self.job, *COARSE, "--output.file", "/dev/null"], "is a device")
        self.assert_refused(["info", "fifo"], "fifo is a FIFO")
        self.assert_refused(["info", "."], ". is a directory")
        self.assert_refused(["info", "/dev/zero"], "/dev/zero is a device")
        self.assert_refused(["info", "x" * 300], "no such file")
        self.write("empty.h5", "")
        for name in ("empty.h5", "job.cfg"):
            self.assertEqual(self.run_program("info", name, code=1).stderr.count("\n"), 1)

    def test_missing_file_locks_are_reported_once(self):
        library = self.path("no_locks.so")
        source = self.write("no_locks.c", """
            #include <errno.h>
            #include <fcntl.h>
            static int refuse(int command) { errno = command == F_SETLK ? ENOLCK : EINVAL; return -1; }
            int fcntl(int file, int command, ...) { return command == F_SETFL ? 0 : refuse(command); }
            int fcntl64(int file, int command, ...) { return command == F_SETFL ? 0 : refuse(command); }
            """)
        subprocess.run(["cc", "-shared", "-fPIC", "-o", library, source], check=True)
        # The address sanitizer insists on being loaded first, which does not matter here.
        sanitizer = os.environ.get("ASAN_OPTIONS", "") + ":verify_asan_link_order=0"
        environment = {"LD_PRELOAD": library, "ASAN_OPTIONS": sanitizer}
        done = self.run_program("sweep", self.job, *COARSE, "--progress", "none", environment=environment)
        self.assertEqual(done.stderr.count("job.h5.partial/lock: file locking does not work here (No locks available)"), 1, done.stderr)
        self.assertTrue(os.path.exists(self.path("job.h5")))
        self.assertFalse(os.path.exists(self.path("job.h5.partial")))


class Trace(CommandTest):
    DESIGN = ("--r1", "0.51", "--r2", "0.91", "--r3", "0.58")

    @staticmethod
    def table(text):
        """The rows below the comments, which numpy would take for the header."""
        return np.genfromtxt([line for line in text.splitlines() if line[0] != "#"], names=True)

    def test_comments_stand_only_above_the_header(self):
        done = self.run_program("trace", os.path.join(JOBS, "paper.cfg"), *self.DESIGN)
        lines = done.stdout.splitlines()
        header = next(i for i, line in enumerate(lines) if line.startswith("t phi1 phi2 "))
        self.assertTrue(all(line.startswith("# ") for line in lines[:header]))
        self.assertNotIn("#", "".join(lines[header:]))
        self.assertIn("# fulcrum-height = 1.5", lines)
        table = self.table(done.stdout)
        self.assertEqual(len(table), 93)
        self.assertAlmostEqual(table["speed"][-1], 17.47606519, places=7)

    def test_a_traced_swing_is_that_of_the_sweep(self):
        self.run_program("sweep", self.job, *COARSE)
        with h5py.File(self.path("job.h5")) as file:
            best = {name: file.attrs[f"best_{name}"] for name in ("r1", "r2", "r3", "speed")}
        options = [word for name in ("r1", "r2", "r3") for word in (f"--{name}", repr(float(best[name])))]
        table = self.table(self.run_program("trace", self.job, *options).stdout)
        self.assertAlmostEqual(table["speed"][-1], best["speed"], places=7)

    def test_a_swing_without_release_is_reported(self):
        done = self.run_program("trace", self.job, *self.DESIGN, "--solver.max-time", "0.3")
        self.assertEqual(done.stderr, "the swing ends without a release: not_released: "
                                      "no release before solver.max-time, or none above the ground\n")

    def test_invalid_designs_are_refused(self):
        self.assert_refused(["trace", self.job, "--r1", "1", "--r2", "1"], "--r3: missing")
        self.assert_refused(["trace", self.job, "--r1", "x", "--r2", "1", "--r3", "1"], "r1 = x")
        self.assert_refused(["trace", self.job, "--r1", "0.3", "--r2", "1", "--r3", "1"],
                            "r1 = 0.3", "0.5")


class Assess(CommandTest):
    SMALL = ("--assess.steppers", "euler, dopri5, rosenbrock4", "--assess.time-steps", "0.01, 0.005",
             "--assess.tolerances", "1e-5, 1e-8", "--assess.designs", "3", "--assess.repeats", "1",
             "--lattice.increment", "0.25")

    def test_tables_are_printed_and_open_in_xarray(self):
        import xarray as xr  # slow to import, and used by two tests only
        job = self.write("job.cfg", f"[assess]\nscenes = {JOBS}/extreme/long_steps.cfg\n"
                                    f"extremes = {JOBS}/extreme/upright.cfg\n")
        done = self.run_program("assess", job, *self.SMALL, ranks=2)
        for title in ("References", "Errors of each solver", "Extreme scenes", "Order of convergence",
                      "largest step", "A small oscillation", "whole lattice", "The cheapest solver"):
            self.assertIn(title, done.stdout)
        self.assertIn("not_released", done.stdout)
        for engine in ("netcdf4", "h5netcdf"):
            with xr.open_dataset(self.path("job-assess.h5"), group="accuracy", engine=engine) as data:
                frame = data.to_dataframe()
        self.assertEqual(list(frame.scene.unique()), ["long_steps"])
        dopri5 = frame[frame.stepper == "dopri5"]
        self.assertLess(dopri5.error_largest.iloc[1], 1e-2 * dopri5.error_largest.iloc[0])
        self.assertTrue((frame.seconds > 0).all())
        self.assertEqual(data.error_median.attrs["units"], "m s-1")
        with h5py.File(self.path("job-assess.h5")) as file:
            self.assertIn("time-steps = 0.01, 0.005", file.attrs["job"])
        self.assert_refused(["assess", job, *self.SMALL], "output.file", "already exists")
        self.run_program("assess", job, *self.SMALL, "--overwrite", "--progress", "none")

    def test_scene_options_apply_to_all_scenes(self):
        job = self.write("two.cfg", f"[assess]\nscenes = {JOBS}/extreme/no_beam.cfg\n")
        tables = [self.run_program("assess", job, *self.SMALL, "--overwrite", *options).stdout
                  for options in ([], ["--scene.gravity", "20"], ["--scene.file", f"{JOBS}/scenes/friction.cfg"])]
        speeds = [table.split("Errors of each")[0] for table in tables]  # the reference speeds
        self.assertEqual(len(set(speeds)), 3)

    def test_without_scenes_the_jobs_own_scene_is_assessed(self):
        done = self.run_program("assess", self.job, *self.SMALL, ranks=2)
        self.assertIn("scene job", done.stdout)

    def test_a_sweep_and_an_assessment_of_a_job_have_archives_of_their_own(self):
        done = self.run_program("assess", self.job, *self.SMALL)
        self.assertIn("archive   job-assess.h5", done.stdout)
        self.run_program("sweep", self.job, *self.SMALL[-2:])
        self.assertEqual(sorted(os.listdir(self.directory)), ["job-assess.h5", "job.cfg", "job.h5"])

    def test_sweeps_and_assessments_do_not_replace_each_other(self):
        file, lattice = ("--output.file", "job.h5"), self.SMALL[-2:]
        self.run_program("assess", self.job, *self.SMALL, *file)
        self.assert_refused(["sweep", self.job, *lattice], "job.h5", "holds an assessment")
        self.run_program("sweep", self.job, *lattice, "--overwrite")
        done = self.run_program("sweep", self.job, *lattice, ranks=2)
        self.assertIn("complete archive of this job", done.stderr)
        self.assert_refused(["assess", self.job, *self.SMALL, *file], "job.h5", "already exists")

    def test_an_assessment_does_not_replace_an_unfinished_sweep(self):
        self.run_program("sweep", self.job, *COARSE, "--output.file", "job-assess.h5", "--time-limit", "1e-9", code=75)
        self.assert_refused(["assess", self.job, *self.SMALL, "--overwrite"], "unfinished sweep")

    def test_info_describes_an_assessment(self):
        os.symlink("far.h5", self.path("job-assess.h5"))
        self.run_program("assess", self.job, *self.SMALL)
        self.assertEqual(os.readlink(self.path("job-assess.h5")), "far.h5")
        text = self.run_program("info", "job-assess.h5").stdout
        for words in ("job-assess.h5, an assessment", "accuracy", "reference", "source    trebsweep", "[assess]", "assess "):
            self.assertIn(words, text)

    def test_missing_scene_files_are_refused(self):
        self.assert_refused(["assess", self.job, "--assess.scenes", "nowhere.cfg"], "nowhere.cfg")

    def test_a_sweep_meets_its_target_error(self):
        job = self.write("target.cfg", "[solver]\nstepper = dopri5\ntarget-error = 1e-5\n")
        done = self.run_program("sweep", job, *COARSE, "--output.fields", "speed, speed-error", ranks=2)
        self.assertIn("tolerance ", done.stderr)
        with h5py.File(self.path("target.h5")) as file:
            self.assertLess(np.nanmax(np.abs(file["speed_error"])), 1e-5)
        self.run_program("sweep", job, *COARSE, "--output.fields", "speed, speed-error")  # already complete


if __name__ == "__main__":
    unittest.main()
