"""What the scripts of analysis/ have in common: unfinished archives, failures, streams, outputs, installation."""

import contextlib
import os
import random
import shutil
import signal
import subprocess
import sys
import unittest

import numpy as np

from scripts import ANALYSIS, EVERY_SUBCOMMAND, SIGNATURES, SUBCOMMANDS, TREB_PLOT, ScriptTest, leave_out, run_forked
from archives import h5py
from support import JOBS, PROGRAM, REPOSITORY
from trebsweep.backend import AXES
from trebsweep.scenes import load, only


BUNDLE = os.path.join(ANALYSIS, "explorer", "bundle.py")


class PartialArchives(ScriptTest):
    """Snapshots of unfinished sweeps, with any values in the cells of the tiles that are not done, and unfinished
    sweeps themselves, the folders FILE.partial."""

    FIELDS = ("--output.fields", "speed, status, speed-error")
    OPTIONS = {"complete.h5": FIELDS, "by_hand.h5": (*FIELDS, "--lattice.r2", "0.1:1.2:0.02")}

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        for name, options in cls.OPTIONS.items():
            cls.sweep("paper", *options, name=name.removesuffix(".h5"), increment="0.02")
        # The folders of unfinished sweeps, 1 tile of complete.h5, ...: each run computes a tile.
        for name, most in (("complete.h5", 5), ("by_hand.h5", 2)):
            for done in range(1, most + 1):
                cls().run_program("sweep", f"{JOBS}/paper.cfg", "--lattice.increment", "0.02", *cls.OPTIONS[name],
                                  "--output.file", "stopped.h5", "--time-limit", "1e-9", code=75)
                shutil.copytree(cls.path("stopped.h5.partial"), cls.path(f"{done} of {name}"))
            shutil.rmtree(cls.path("stopped.h5.partial"))

    def make_partial(self, source, name, done, junk):
        """Makes a snapshot, or an unfinished sweep, in which the first `done` tiles are done; returns the others and the
        message."""
        snapshot = name
        if name.endswith(".partial"):
            shutil.rmtree(self.path(name), ignore_errors=True)
            shutil.copytree(self.path(f"{done} of {source}"), self.path(name))
            snapshot = "snapshot.h5"
        shutil.copy(self.path(source), self.path(snapshot))
        undone = leave_out(self.path(snapshot), done, junk)
        return undone, f"{name}: unfinished: {done} of {done + len(undone)} tiles done; the rest is left blank\n"

    def test_tiles_that_are_not_done_read_as_blank(self):
        for source in ("complete.h5", "by_hand.h5"):
            for name, numbers in (("q.h5", (0, 5)), ("r.h5.partial", (2,))):
                for done in numbers:
                    undone, message = self.make_partial(source, name, done, junk=99)
                    with h5py.File(self.path(source)) as file:
                        speed, status = file["speed"][...], file["status"][...]
                    for tile in undone:
                        speed[tile], status[tile] = np.nan, 0
                    with open(self.path("stderr"), "w+", encoding="utf-8") as stderr, \
                            contextlib.redirect_stderr(stderr):
                        archive = only(load(self.path(name)))
                        stderr.seek(0)
                        self.assertTrue(stderr.read().endswith(message))
                    # Without the last values of r3, at which there is no design.
                    where = (slice(None), slice(archive.data.sizes["r3"]), slice(None))
                    np.testing.assert_array_equal(archive.data["speed"], speed[where])
                    np.testing.assert_array_equal(archive.data["status"], status[where])
                    where = (3, *where[1:])
                    np.testing.assert_array_equal(archive.data["speed"][3], speed[where])
                    archive.data.close()

    def test_the_optimum_is_the_fastest_design_in_the_tiles_done(self):
        undone, message = self.make_partial("complete.h5", "r.h5.partial", 3, junk=99)
        with h5py.File(self.path("complete.h5")) as file:
            speed = file["speed"][...]
            for tile in undone:
                speed[tile] = np.nan
            best = {name: file[name][i] for name, i in
                    zip(AXES, np.unravel_index(np.nanargmax(speed), speed.shape))}
        done = self.run_script("optimum", "r.h5.partial", says=message)
        self.assertEqual(done.stdout.split(),
                         [word for name in AXES for word in (f"--{name}", repr(float(best[name])))])
        _, message = self.make_partial("complete.h5", "q.h5", 0, 0)
        done = self.run_command(sys.executable, TREB_PLOT, "optimum", "q.h5")
        self.assertEqual(done.stdout, "")
        self.assertEqual(done.stderr, message + "q.h5: has no optimum: nothing released yet\n")

    def test_the_name_of_the_complete_archive_finds_the_partial_one(self):
        _, message = self.make_partial("complete.h5", "soon.h5.partial", 5, junk=0)
        self.make_partial("complete.h5", "elsewhere.h5.partial", 5, junk=0)
        os.symlink("elsewhere.h5", self.path("link.h5"))
        self.run_script("heatmap", "soon.h5", says=message)
        self.assert_picture("soon-speed.png")
        self.run_script("compare", "soon.h5", "complete.h5", says=message)
        self.assert_picture("soon-complete.png")
        self.assertEqual(self.run_script("optimum", "soon.h5", says=message).stdout,
                         self.run_script("optimum", "link.h5", says="elsewhere.h5.partial: unfinished").stdout)
        before = sorted(os.listdir(self.path("soon.h5.partial")))
        for name in ("soon.h5", "soon.h5.partial"):
            self.run_script("optimum", "soon.h5", "--job", name, code=2,
                            says=f"job = {name}: must not be an input file")
        self.assertFalse(os.path.exists(self.path("soon.h5")))
        self.assertEqual(sorted(os.listdir(self.path("soon.h5.partial"))), before)
        self.run_script("heatmap", "never.h5", code=1, says="never.h5: no such file")

    def test_every_script_reports_an_unfinished_sweep_once(self):
        self.run_program("assess", f"{JOBS}/paper.cfg", "--assess.scenes", f"{JOBS}/scenes/paper.cfg",
                         "--assess.steppers", "euler", "--assess.time-steps", "0.01", "--assess.repeats", "1",
                         "--assess.designs", "1", "--output.file", "assess.h5")
        for name, field in (("q.h5", "speed"), ("r.h5.partial", "status")):
            undone, message = self.make_partial("complete.h5", name, 5, junk=0)
            for script, *arguments in (("heatmap", name, "--field", field), ("compare", name, "complete.h5"),
                                       ("loads", name, "--count", "1", "--program", PROGRAM)):
                with self.subTest(script=script):
                    done = self.run_script(script, *arguments, "-o", "q.png", says=message)
                    self.assert_picture("q.png")
                    if script == "compare":
                        with h5py.File(self.path("complete.h5")) as file:
                            missing = sum(np.isfinite(file["speed"][tile]).sum() for tile in undone)
                            designs = np.isfinite(file["speed"][...]).sum()
                        self.assertIn(f"{designs - missing} with a speed in both, {missing} in one",
                                      done.stdout)
            self.run_script("assess", "assess.h5", "--maps", name, says=message)


class Failures(ScriptTest):
    """A missing or damaged file is reported as one line on stderr, with exit code 1."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.archive = cls.sweep("accurate", "--output.compression", "1", name="archive")

    def sources(self, script, name):
        """The arguments that make a script read the file `name`."""
        return [name, "archive.h5"] if script == "compare" else [name]

    def test_missing_empty_damaged_and_foreign_files_are_refused(self):
        whole = self.read("archive.h5")
        with h5py.File(self.path("other.h5"), "w") as file:
            file["numbers"] = np.arange(5)
        with h5py.File(self.path("axes.h5"), "w") as file:
            for name in (*AXES, "tile_block"):
                file[name] = "text"
        os.makedirs(self.path("folder.h5"), exist_ok=True)
        self.write("empty.h5", b"")
        self.write("cut.h5", whole[: len(whole) // 2])
        self.write("text.h5", b"t phi1\n1 2 3\n")
        self.write("noise.h5", random.Random(1).randbytes(5000))
        for script in SUBCOMMANDS:
            names = ["missing.h5", "cut.h5", "other.h5"]
            if script in ("heatmap", "study"):
                names += ["empty.h5", "text.h5", "noise.h5", "folder.h5", "axes.h5"]
            for name in names:
                with self.subTest(script=script, name=name):
                    done = self.run_script(script, *self.sources(script, name), code=1, says=name)
                    self.assertNotIn("Traceback", done.stderr)

    def test_truncated_and_empty_swings_are_refused(self):
        table = self.read(self.trace(comments=False))
        for content in (table[: table.rindex(b" ")], table.splitlines()[0], table.replace(b"\n0.05 ", b"\nx "),
                        b"# gravity = 9.8\n"):
            self.write("cut.txt", content)
            self.run_script("trajectory", "cut.txt", code=1, says="cut.txt: ")

    def test_a_crash_of_hdf5_is_reported(self):
        whole = self.read("archive.h5")
        chance = random.Random(7)
        for _ in range(25):
            damaged = bytearray(whole)
            for offset in chance.sample(range(8, 12000), 40):
                damaged[offset] = chance.randrange(256)
            self.write("damaged.h5", damaged)
            done = run_forked(self.directory, "optimum", "damaged.h5")
            self.assertIn(done.returncode, (0, 1, 2))
            if done.returncode:
                self.assertRegex(done.stderr, r"(?m)^damaged\.h5: .*\n\Z")  # after what glibc prints of a crash

    def test_missing_modules_are_reported(self):
        # -S: without installed packages
        done = self.run_command(sys.executable, "-B", "-S", TREB_PLOT, "heatmap", "archive.h5", code=1)
        self.assertRegex(done.stderr, r"\A.*cannot import.*h5py.*\n\Z")

    def test_loads_reports_an_unusable_program(self):
        for program in ("no/such/program", "false", "/etc/passwd"):
            self.run_script("loads", "archive.h5", "--program", program, code=1, says=program)

    def test_files_that_cannot_be_written_are_reported(self):
        self.run_script("heatmap", "archive.h5", "-o", "no/such/folder.png", code=1,
                        says="no/such/folder.png")
        self.run_script("optimum", "archive.h5", "--job", "no/such/folder.cfg", code=1,
                        says="no/such/folder.cfg")
        job = self.write("kept.cfg", "kept")
        before = set(os.listdir(self.directory))
        for limit, *command in ((1, "heatmap", "archive.h5", "-o", "large.png"),
                                (0, "optimum", "archive.h5", "--job", job, "--overwrite")):
            done = self.run_command("bash", "-c", f'ulimit -f {limit} && exec "$@"', "bash", sys.executable, "-B",
                                    TREB_PLOT, *command, code=1)
            self.assertRegex(done.stderr, r"^\S+: cannot be written: File too large\n$")
        self.assertEqual(self.read("kept.cfg"), b"kept")
        self.assertEqual(set(os.listdir(self.directory)) - {"large.png"}, before)


class Streams(ScriptTest):
    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sweep("accurate", "--scene.projectile-mass", "50, 100, 200", name="study", increment="0.1")
        cls.sweep("accurate", name="archive", increment="0.1")
        cls.sweep("accurate", "--lattice.r1", "0.7", "--lattice.r2", "0.8", "--lattice.r3", "0.5", name="single")

    def test_a_script_whose_reader_leaves_ends_silently(self):
        for command in (("study", "study.h5", "--csv"), ("study", "study.h5"), ("importance", "study.h5"),
                        ("rules", "study.h5", "--rule", "r1 < r2"), ("optimum", "archive.h5"),
                        ("compare", "archive.h5", "single.h5"), ("heatmap", "single.h5"),
                        ("heatmap", "archive.h5"), ("machine",)):
            with self.subTest(command=command):
                reader, writer = os.pipe()
                os.close(reader)
                done = subprocess.run([sys.executable, "-B", TREB_PLOT, *command], stdout=writer,
                                      stderr=subprocess.PIPE, text=True, cwd=self.directory, timeout=60, check=False)
                os.close(writer)
                self.assertEqual(done.returncode, 128 + signal.SIGPIPE, done.stderr)
                self.assertNotIn("pipe", done.stderr.lower())

    def test_no_exit_code_depends_on_stderr(self):
        self.sweep("accurate", "--solver.max-time", "0.1", name="none", increment="0.1")  # has no optimum: a message
        for redirection in ("2>&-", "2>/dev/full"):
            for name in ("none.h5", "archive.h5"):
                done = self.run_command("bash", "-c", f'exec "$@" {redirection}', "bash", sys.executable, "-B",
                                        TREB_PLOT, "optimum", name)
                self.assertEqual(done.stdout == "", name == "none.h5")


class Outputs(ScriptTest):
    """No script replaces a file by surprise, or waits for the other end of a FIFO."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.sweep("accurate", name="archive", increment="0.1")
        cls.write("module.wasm", b"a module")
        cls.write("table.txt", cls.read("archive.h5"))
        os.symlink("table.txt", cls.path("link"))
        os.symlink("nowhere", cls.path("dangling"))
        os.mkfifo(cls.path("fifo"))
        os.mkdir(cls.path("folder"))
        # A command for each output that is not a picture, before the name of the output.
        cls.texts = {"job": ("optimum", "archive.h5", "--job"), "output": (BUNDLE, "module.wasm")}

    def run_text(self, command, *words, code=0):
        """Runs treb-plot, or the script that bundles the explorer; stderr may be empty."""
        done = run_forked(self.directory, *command, *words)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def assert_refused(self, option, command, name, words, *options):
        with self.subTest(command=command, name=name):
            before = self.read("table.txt")
            done = self.run_text(command, name, *options, code=2)
            self.assertIn(f"{option} = {name}: {words}", done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1)
            self.assertEqual(done.stdout, "")
            self.assertEqual(self.read("table.txt"), before)

    def test_an_existing_file_is_not_replaced_by_a_text(self):
        for option, command in self.texts.items():
            for name in ("table.txt", "link", "dangling"):
                self.assert_refused(option, command, name, "exists; name another file, or give --overwrite")
            for name in ("fifo", "folder", "/dev/full"):
                for options in ((), ("--overwrite",)):
                    self.assert_refused(option, command, name, "is not a regular file", *options)
            self.assert_refused(option, command, command[1], "must not be an input file", "--overwrite")
        self.assertFalse(os.path.lexists(self.path("nowhere")))

    def test_overwrite_replaces_a_file_and_keeps_a_link_to_it(self):
        for command in self.texts.values():
            self.run_text(command, "text")
            expected = self.read("text")
            for name in ("old", "link to old"):
                self.write("old", "old")
                if not os.path.lexists(self.path("link to old")):
                    os.symlink("old", self.path("link to old"))
                self.run_text(command, name, "--overwrite")
                self.assertEqual(self.read("old"), expected)
                self.assertTrue(os.path.islink(self.path("link to old")))
            os.remove(self.path("text"))

    def test_a_picture_replaces_only_a_picture_of_its_format(self):
        self.write("text.png", "a text")
        for script in ("heatmap", "study"):
            for name, words in (("table.txt", "must end in"), ("link", "exists and is no PNG"),
                                ("text.png", "exists and is no PNG"), ("fifo", "is not a regular file"),
                                ("folder", "is not a regular file")):
                self.assert_refused("output", (script, "archive.h5", "-o"), name, words)
        for suffix in SIGNATURES:
            self.write(f"map.{suffix}", b"")
            for _ in range(2):
                self.run_script("heatmap", "archive.h5", "--r1", "0.7", "-o", f"map.{suffix}")
                self.assert_picture(f"map.{suffix}")

    def test_an_assessment_does_not_replace_other_files(self):
        self.run_program("assess", f"{JOBS}/scenes/paper.cfg", "--lattice.increment", "0.25", "--assess.designs", "1",
                         "--assess.steppers", "euler, rk4", "--assess.repeats", "1", "--output.file", "assess.h5")
        for name in ("x-precision.png", "x-order.png", "x-stability.png"):
            self.write(name, "a text")
            self.run_script("assess", "assess.h5", "-o", "x", code=2, says=f"output = {name}: exists and is no PNG")
            self.assertEqual(self.read(name), b"a text")
            os.remove(self.path(name))


class Installed(ScriptTest):
    def test_every_subcommand_has_help_and_accepts_either_joint_of_words(self):
        for name in EVERY_SUBCOMMAND:
            done = self.run_script(name, "--help")
            self.assertTrue(done.stdout.startswith(f"usage: treb-plot {name} "))
            self.assertIn({"animation": ".gif", "optimum": "trebsweep trace", "machine": "machine.svg",
                           "sheet": ".pdf"}.get(name, ".png"), done.stdout)
        self.assertIn("heatmap", self.run_script("--help").stdout)
        self.run_script("heat", code=2, says="treb-plot: heat: must be one of heatmap, ")
        self.run_script("heatmap", "no.h5", "--at_all", "1", code=2, says="--at-all")

    def test_the_launcher_runs_by_its_name(self):
        os.symlink(sys.executable, self.path("python3"))
        done = subprocess.run([TREB_PLOT, "machine", "--help"], text=True, capture_output=True, check=True, timeout=60,
                              env={"PATH": self.directory, "PYTHONDONTWRITEBYTECODE": "1"})
        self.assertTrue(done.stdout.startswith("usage: treb-plot machine "))

    def test_the_installed_launcher_finds_the_installed_program(self):
        subprocess.run(["cmake", "--install", os.path.dirname(PROGRAM), "--prefix", self.directory],
                       check=True, capture_output=True, timeout=120)
        share = self.path("share/trebsweep")
        for name in ("jobs/paper.cfg", "jobs/scenes/wood.cfg", "jobs/slurm.sh", "jobs/pbs.sh", "analysis/treb-plot",
                     "analysis/pyproject.toml", "analysis/trebsweep/cli.py"):
            source, copy = f"{REPOSITORY}/{name}", f"{share}/{name}"
            self.assertEqual(os.stat(source).st_mode & 0o777, os.stat(copy).st_mode & 0o777, name)
        job = ["sweep", f"{share}/jobs/accurate.cfg", "--lattice.increment", "0.1", "--output.file",
               "small.h5"]
        self.run_command(self.path("bin/trebsweep"), *job)
        done = self.run_command(sys.executable, "-B", f"{share}/analysis/treb-plot", "loads", "small.h5",
                                "--count", "1", PATH="/nowhere", TREBSWEEP="")
        self.assertEqual(done.stderr, "")
        self.assert_picture("small-loads.png")


if __name__ == "__main__":
    unittest.main()
