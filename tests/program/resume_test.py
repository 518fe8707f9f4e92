"""Interrupted sweeps: kills, signals, limits and faults, and how the same command continues after them.

Needs TREBSWEEP (the program) and MPIEXEC in the environment. TREBSWEEP_KILLS is the number of kills in each
test of class Kills and signals in each test of class Stops (default 2), TREBSWEEP_SEED seeds their times.
"""

import contextlib
import itertools
import json
import os
import random
import re
import shutil
import signal
import subprocess
import time
import unittest

import numpy as np

from archives import differences, h5py, tiles, tiles_done
from support import JOBS, MPIEXEC, PROGRAM, DirectoryTest, mpirun

KILLS = int(os.environ.get("TREBSWEEP_KILLS", "2"))
SEED = int(os.environ.get("TREBSWEEP_SEED", "1"))
OPTIMUM = ("best_value", "best_speed", "best_r1", "best_r3", "best_r2", "best_release_time", "best_error")
SUMMARY = ("best_value", "best_speed", "best_r1", "best_r3", "best_r2", "best_release_time", "designs", "steps",
           "error_median", "error_largest", "error_at_optimum", "error_designs")
JOB = "[solver]\nstepper = fehlberg78\ntolerance = 1e-11\n"
COMPRESSED = ("--output.compression", "1")


def ranks_of(launcher):
    """Process ids of the ranks that mpirun started on this host."""
    found = subprocess.run(["pgrep", "-P", str(launcher.pid)], text=True, capture_output=True,
                           check=False)
    return [int(word) for word in found.stdout.split()]


def handles_signals(process):
    """Whether a process is the program and has installed its signal handlers."""
    try:
        with open(f"/proc/{process}/status", encoding="utf-8") as file:
            caught = int(re.search(r"SigCgt:\s*(\w+)", file.read()).group(1), 16)
        return os.path.samefile(f"/proc/{process}/exe", PROGRAM) and caught >> (signal.SIGUSR1 - 1) & 1
    except OSError:
        return False  # the process has just ended


def kill_all(launcher):
    """SIGKILL to mpirun and its ranks."""
    for process in [*ranks_of(launcher), launcher.pid]:
        try:
            os.kill(process, signal.SIGKILL)
        except ProcessLookupError:
            pass


class ResumeTest(DirectoryTest):
    """Interrupts sweeps of one job, job.h5, and compares them with an uninterrupted one, straight0.h5, and its
    compressed version, straight2.h5."""

    JOB_TEXT, VERSIONS = JOB, ((), COMPRESSED)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.job = cls.write("job.cfg", cls.JOB_TEXT)
        cls.seconds, cls.sweep_seconds = {}, {}  # of the whole run, and of its sweep
        for options in cls.VERSIONS:
            start = time.time()
            with cls.launch(2, *options, output=f"straight{len(options)}.h5") as launcher:
                assert launcher.wait(timeout=120) == 0
            cls.seconds[options] = time.time() - start
            with cls.straight(options) as straight:
                cls.sweep_seconds[options] = float(straight.attrs["sweep_seconds"])

    def setUp(self):
        random.seed(SEED)
        self.remove_leftovers()

    def leftovers(self):
        """The files and folders of the interrupted sweep."""
        return [name for name in os.listdir(self.directory) if name.startswith("job.h5")]

    def remove_leftovers(self):
        for name in self.leftovers():
            if os.path.isdir(self.path(name)):
                shutil.rmtree(self.path(name))
            else:
                os.remove(self.path(name))

    def files(self):
        """{name: bytes} of the files in job.h5.partial."""
        return {name: self.read(f"job.h5.partial/{name}") for name in sorted(os.listdir(self.path("job.h5.partial")))}

    @contextlib.contextmanager
    def snapshot(self):
        """What is done of the interrupted sweep, as an archive."""
        path = self.path("snapshot.h5")
        self.run_program("info", "job.h5.partial", "--snapshot", path)
        with h5py.File(path) as archive:
            yield archive
        os.remove(path)

    @classmethod
    def launch(cls, ranks, *options, output="job.h5", launcher=None, job=None, **variables):
        return subprocess.Popen(
            [*(launcher or mpirun(ranks)), PROGRAM, "sweep", job or cls.job, "--progress", "none",
             "--output.file", output, *options], cwd=cls.directory, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, env={**os.environ, **variables})

    def finish(self, launcher, codes=(0,)):
        """Waits for the end and checks the exit code, unless `codes` is None; returns the text on stderr."""
        try:
            output, errors = launcher.communicate(timeout=120)
        except subprocess.TimeoutExpired:
            kill_all(launcher)
            launcher.communicate()
            self.fail("hangs")
        if codes:
            self.assertIn(launcher.returncode, codes, output + errors)
        return errors

    def launch_slow(self, ranks):
        """Starts a sweep whose designs take a tenth of a second each."""
        return self.launch(ranks, job=self.write("slow.cfg", "[solver]\nstepper = rk4\ntime-step = 1e-5\n"))

    def wait_for(self, name, launcher):
        """Waits until a sweep has created a file."""
        while not os.path.exists(self.path(name)):
            if launcher.poll() is not None:
                self.fail(f"ended without {name}: {self.finish(launcher, codes=None)}")
            time.sleep(0.005)

    def run_sweep(self, ranks, *options, codes=(0,), **how):
        return self.finish(self.launch(ranks, *options, **how), codes)

    def stop_partway(self, *options, overwrite=()):
        """Stops a sweep by its time limit with some of its tiles done; returns the text on stderr. The limit is adjusted
        until it fits, since other processes share the machine."""
        limit = self.sweep_seconds[()] / 2
        for _ in range(30):
            launcher = self.launch(2, *options, *overwrite, "--time-limit", f"{limit:.4f}")
            errors = self.finish(launcher, codes=(0, 75))
            if launcher.returncode == 75:
                with self.snapshot() as partial:
                    done = tiles_done(partial)
                if done.any() and not done.all():
                    return errors
                shutil.rmtree(self.path("job.h5.partial"))  # a run that resumes it would not compute tiles
            elif not overwrite:
                os.remove(self.path("job.h5"))
            limit *= 0.7 if launcher.returncode == 0 or done.all() else 1.3
        self.fail("no time limit stops the sweep partway")

    @classmethod
    def straight(cls, options):
        return h5py.File(cls.path(f"straight{len(options)}.h5"))

    def assert_complete(self, options=()):
        """The archive is that of the uninterrupted sweep, and no other file is left. Returns the number of runs in its
        history."""
        with self.straight(options) as straight:
            self.assertEqual(differences(self.path("job.h5"), straight.filename), [])
        with h5py.File(self.path("job.h5")) as archive:
            runs = len(archive.attrs["history"].split("\n"))
        self.assertEqual(self.leftovers(), ["job.h5"])
        return runs

    def assert_sound(self, options=()):
        """What the interrupted sweep has done has the final values, and the rest reads as fill values. Returns the number
        of tiles done."""
        self.assertFalse(os.path.exists(self.path("job.h5")))
        if not os.path.exists(self.path("job.h5.partial/sweep.json")):
            return 0
        with self.snapshot() as partial, self.straight(options) as straight:
            done = tiles_done(partial)
            if "status" in straight:
                self.assert_sound_maps(partial, straight, done)
            if "best_value" in straight:
                self.assert_sound_optima(partial, straight)
            return int(done.sum())

    def assert_sound_maps(self, partial, straight, done):
        for tile in itertools.compress(tiles(straight), done):
            for name in ("speed", "release_time", "status"):
                self.assertEqual(partial[name][tile].tobytes(), straight[name][tile].tobytes())
        for name, is_fill in (("speed", np.isnan), ("release_time", np.isnan), ("status", np.logical_not)):
            for tile in tiles(straight):
                values = partial[name][tile]
                self.assertTrue((is_fill(values) | (values == straight[name][tile])).all(), name)

    def assert_sound_optima(self, partial, straight):
        """An optimum that has its error is final; another is at most as good."""
        known = np.isfinite(partial["best_error"][...])
        for name in OPTIMUM:
            np.testing.assert_array_equal(partial[name][...][known], straight[name][...][known])
        self.assertFalse((partial["best_value"][...] > straight["best_value"][...]).any())

    def assert_stopped(self, launcher, errors):
        self.assertEqual(launcher.returncode, 75, errors)
        self.assert_one_message(errors, "; the same command")
        self.assertFalse(os.path.exists(self.path("job.h5.partial/lock")))

    @staticmethod
    def strike_when_up(launcher, strike):
        """Strikes once all ranks have installed their signal handlers, which can take long to start."""
        while launcher.poll() is None:
            ranks = ranks_of(launcher)
            if ranks and all(handles_signals(rank) for rank in ranks):
                strike(launcher, ranks)
                break
            time.sleep(0.02)

    def interrupt(self, strike, options, after, **variables):
        """Calls strike(launcher) on KILLS sweeps at random times and continues them on 2, 1 and 3 ranks in turn.
        Calls after(launcher, stderr) if a strike has ended its sweep early."""
        hits = ends = runs = 0
        while hits < KILLS or ends == 0:
            launcher = self.launch((2, 1, 3)[runs % 3], *options, **variables)
            runs += 1
            hit = False
            if hits < KILLS:
                time.sleep(random.uniform(0.1, 0.9 * self.seconds[options]))
                hit = launcher.poll() is None
                if hit:
                    strike(launcher)
                    hits += 1
            errors = self.finish(launcher, codes=None)
            if os.path.exists(self.path("job.h5")):
                self.assert_complete(options)
                os.remove(self.path("job.h5"))
                ends += 1
            else:
                self.assertTrue(hit, errors)
                after(launcher, errors)
                self.assert_sound(options)


class Kills(ResumeTest):
    JOB_TEXT = "[solver]\nstepper = rk4\ntime-step = 4e-4\n"  # takes several times as long as records are in memory
    VERSIONS = (COMPRESSED,)

    def test_a_compressed_sweep_killed_repeatedly_produces_the_same_archive(self):
        self.interrupt(kill_all, COMPRESSED, lambda launcher, errors: None)


class BuiltMachineKills(ResumeTest):
    JOB_TEXT = f"""[scene]
file = {JOBS}/scenes/laboratory.cfg
[lattice]
r1 = 0.15:0.31:0.02
r3 = 0.57:1.17:0.01
r2 = 0.675:1.275:0.01
[solver]
release = farthest
[output]
fields = speed, release-time, status, range, lift-off-time
[optimum]
objective = range
subject-to = speed <= 21
"""
    VERSIONS = ((),)

    def test_a_killed_sweep_of_a_machine_with_hanger_and_trough_produces_the_same_archive(self):
        self.interrupt(kill_all, (), lambda launcher, errors: None)


class Stops(ResumeTest):
    def stop(self, strike, options=(), after=None, **variables):
        self.interrupt(lambda launcher: self.strike_when_up(launcher, strike), options,
                       after or self.assert_stopped, **variables)

    def test_sigusr1_to_mpirun_stops_with_75(self):
        self.stop(lambda launcher, ranks: launcher.send_signal(signal.SIGUSR1))

    def test_sigterm_to_the_ranks_stops_with_75(self):
        def strike(_, ranks):
            for rank in ranks:
                os.kill(rank, signal.SIGTERM)
        self.stop(strike, COMPRESSED)

    def test_a_signal_to_one_rank_stops_all_ranks(self):
        self.stop(lambda launcher, ranks: os.kill(random.choice(ranks), signal.SIGINT))

    def test_sigterm_and_ctrl_c_to_mpirun_stop_cleanly(self):
        # Open MPI's mpirun forwards SIGTERM, kills the ranks a second later, and returns 1 whatever they return:
        # on a busy machine they may be killed before they print their message.
        default = {"OMPI_MCA_odls_base_sigkill_timeout": "1"}  # s; tests/CMakeLists.txt sets 0
        def after(launcher, errors):
            self.assertIn(launcher.returncode, (1, 75), errors)
            if "trebsweep: " in errors:
                self.assert_one_message(errors, "; the same command")
        for number in (signal.SIGTERM, signal.SIGINT):
            self.stop(lambda launcher, ranks, number=number: launcher.send_signal(number),
                      after=after, **default)

    def test_a_time_limit_stops_with_75_and_the_history_lists_each_run(self):
        self.assert_one_message(self.stop_partway(), "the same command continues")
        with self.snapshot() as partial:
            runs = len(partial.attrs["history"].split("\n"))
        done = self.assert_sound()
        while not os.path.exists(self.path("job.h5")) and runs < 50:
            launcher = self.launch(2, "--time-limit", f"{self.sweep_seconds[()] / 2:.2f}")
            errors = self.finish(launcher, codes=(0, 75))
            runs += 1
            if launcher.returncode == 75:
                self.assert_stopped(launcher, errors)
                before, done = done, self.assert_sound()
                self.assertGreaterEqual(done, before)
        self.assertEqual(self.assert_complete(), runs)

    def test_slow_designs_do_not_delay_a_stop(self):
        launcher = self.launch_slow(2)
        self.strike_when_up(launcher, lambda _, ranks: time.sleep(1))
        start = time.time()
        launcher.send_signal(signal.SIGUSR1)
        self.assert_stopped(launcher, self.finish(launcher, codes=(75,)))
        stop = time.time() - start
        self.run_program("trace", "slow.cfg", "--r1", "0.6", "--r3", "0.5", "--r2", "0.8", "--interval", "1")
        one_design = time.time() - start - stop
        self.assertLess(stop, 100 * one_design)  # of the thousands in a tile

    def test_the_death_of_one_rank_ends_the_sweep(self):
        launcher = self.launch(3)
        self.wait_for("job.h5.partial", launcher)
        os.kill(ranks_of(launcher)[-1], signal.SIGKILL)
        errors = self.finish(launcher, codes=None)
        self.assertNotEqual(launcher.returncode, 0)
        self.assertIn("signal 9", errors)
        self.assert_sound()
        self.run_sweep(2)
        self.assert_complete()

    def test_a_sweep_of_many_tiles_stops_within_20_times_its_start(self):
        start = time.time()
        launcher = self.launch(2, "--lattice.r1", "0.6:1.39:0.01", "--lattice.r3", "0.4:1.19:0.01", "--lattice.r2",
                               "0.3:1.29999:1e-6", "--output.fields", "status")
        self.wait_for("job.h5.partial/sweep.json", launcher)
        started = time.time() - start
        launcher.send_signal(signal.SIGUSR1)
        self.assert_stopped(launcher, self.finish(launcher, codes=(75,)))
        self.assertLess(time.time() - start - started, 20 * started)


class Partials(ResumeTest):
    """Most tests start with a copy of the folder of a sweep that was stopped partway, `stopped`."""

    VERSIONS = ((),)

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls().stop_partway()
        os.rename(cls.path("job.h5.partial"), cls.path("stopped"))

    def copy_stopped(self):
        shutil.copytree(self.path("stopped"), self.path("job.h5.partial"))

    def assert_refused(self, code, *words, options=()):
        before = self.files()
        errors = self.run_sweep(2, *options, codes=(code,))
        self.assert_one_message(errors, "job.h5.partial", "--overwrite", *words)
        self.assertEqual(self.files(), before)
        self.assertFalse(os.path.exists(self.path("job.h5")))

    def test_a_different_job_is_refused_with_the_differences(self):
        self.copy_stopped()
        self.assert_refused(2, "scene.gravity = 9.8 there, 9.81 here",
                            "lattice.r1 = none there, 1 here",
                            options=("--scene.gravity", "9.81", "--lattice.r1", "1"))
        self.assert_refused(2, "output.fields = speed, release-time, status there, speed here",
                            options=("--output.fields", "speed"))
        self.assert_refused(2, "(optimum.objective = speed there, range here)",
                            options=("--optimum.objective", "range"))
        self.assert_refused(2, "(optimum.subject-to = none there, speed <= 10 here)",
                            options=("--optimum.subject-to", "speed <= 10"))

    def test_a_sweep_of_another_version_is_refused(self):
        self.copy_stopped()
        path = self.path("job.h5.partial/sweep.json")
        with open(path, encoding="utf-8") as file:
            sweep = json.load(file)
        has_fma = not sweep["kernel"].startswith("baseline")
        other_kernel = "baseline (2 lanes)" if has_fma else "AVX-512 (8 lanes)"
        for name, value, shown in (("numerics", 99, "99"), ("kernel", other_kernel, other_kernel)):
            with self.subTest(name=name):
                self.write("job.h5.partial/sweep.json", json.dumps({**sweep, name: value}))
                self.assert_refused(1, shown)
        # Another revision with the same numerics continues it.
        self.write("job.h5.partial/sweep.json", json.dumps({**sweep, "source": "trebsweep 0.0.9 (abc)"}))
        self.run_sweep(1)
        self.assert_complete()

    def test_a_damaged_folder_is_refused_and_kept(self):
        self.copy_stopped()
        self.write("job.h5.partial/sweep.json", b"x" * 100)
        before = self.files()
        for options in ((), ("--overwrite",)):
            errors = self.run_sweep(2, *options, codes=(2,))
            self.assert_one_message(errors, "job.h5.partial is damaged; move it away")
            self.assertEqual(self.files(), before)

    def test_records_that_are_damaged_are_computed_again(self):
        self.copy_stopped()
        journals = [name for name in self.files() if name.endswith(".journal")]
        before = self.assert_sound()
        for name in journals:
            journal = bytearray(self.read(f"job.h5.partial/{name}"))
            journal[random.randrange(len(journal))] ^= 1 << random.randrange(8)
            self.write(f"job.h5.partial/{name}", journal)
        self.assertEqual(self.assert_sound(), before - len(journals))
        for name in journals:  # as a kill, or a loss of power, leaves them
            journal = self.read(f"job.h5.partial/{name}")
            self.write(f"job.h5.partial/{name}", journal[:-random.randrange(1, 40)] + bytes(10))
        self.assertLess(self.assert_sound(), before - len(journals) + 1)
        self.run_sweep(2)
        self.assert_complete()

    def test_a_snapshot_does_not_count_as_the_archive(self):
        self.copy_stopped()
        self.run_program("info", "job.h5.partial", "--snapshot", "job.h5.snapshot")
        self.assertIn("job.h5.snapshot: exists",
                      self.run_program("info", "job.h5", "--snapshot", "job.h5.snapshot", code=2).stderr)
        shutil.rmtree(self.path("job.h5.partial"))
        os.rename(self.path("job.h5.snapshot"), self.path("job.h5"))
        before = self.read("job.h5")
        self.assert_one_message(self.run_sweep(2, codes=(2,)), "output.file = job.h5", "a snapshot of this job",
                                "--overwrite")
        self.assertEqual(self.read("job.h5"), before)
        self.assertRegex(self.info("job.h5"), r"job\.h5, a snapshot of an unfinished sweep, \d+\.\d % of the tiles done")
        self.assertIn("only complete archives are verified", self.run_program("info", "job.h5", "--verify", code=2).stderr)
        self.run_sweep(2, "--overwrite")
        self.assert_complete()

    def test_a_snapshot_that_cannot_be_written_leaves_no_file(self):
        self.copy_stopped()
        before = self.leftovers()
        snapshot = (PROGRAM, "info", "job.h5.partial/", "--snapshot", "snapshot.h5")
        limited = ("bash", "-c", 'trap "" XFSZ; ulimit -f 100; exec "$@"', "limited")
        self.assertRegex(self.run_command(*limited, *snapshot, code=1).stderr, "^trebsweep: --snapshot snapshot.h5: .*File too large\n$")
        self.assertEqual(self.leftovers(), before)
        self.run_command(*snapshot)
        os.remove(self.path("snapshot.h5"))

    def test_overwrite_discards_a_partial_archive(self):
        self.copy_stopped()
        self.run_sweep(2, "--overwrite")
        self.assertEqual(self.assert_complete(), 1)

    def test_an_interrupted_overwrite_continues_without_the_option(self):
        self.run_sweep(2, "--solver.tolerance", "1e-6")
        errors = self.stop_partway(overwrite=("--overwrite",))
        self.assert_one_message(errors, "without --overwrite")
        self.run_sweep(2)
        self.assertEqual(self.assert_complete(), 2)

    def test_a_continued_sweep_computes_the_summary_without_its_maps(self):
        for optimum in (("--output.optimum", "taut"),
                        ("--optimum.objective", "range", "--optimum.subject-to",
                         "peak-axle-load <= 180000, least-sling-tension >= 0"),
                        ("--optimum.objective", "pin-angle", "--optimum.subject-to", "pin-angle <= -0.1")):
            options = ("--output.fields", "release-time", "--solver.tolerance", "1e-7", *optimum)
            self.run_sweep(2, *options, output="other.h5")
            self.stop_partway(*options)
            self.run_sweep(3, *options)
            with h5py.File(self.path("job.h5")) as archive, h5py.File(self.path("other.h5")) as other:
                self.assertTrue(np.isfinite(other.attrs["best_value"]))
                for name in SUMMARY:
                    self.assertEqual(archive.attrs[name], other.attrs[name])
            for name in ("job.h5", "other.h5"):
                os.remove(self.path(name))

    def test_a_second_sweep_of_the_same_file_is_refused(self):
        first = self.launch_slow(1)
        self.wait_for("job.h5.partial", first)
        for options, job in (((), None), ((), "slow.cfg"), (("--overwrite",), None)):
            errors = self.run_sweep(1, *options, job=job, codes=(2,))
            self.assert_one_message(errors, "output.file = job.h5: another run is writing it",
                                    f"process {ranks_of(first)[0]}")
        self.assertIn("being written by process", self.info("job.h5"))
        first.send_signal(signal.SIGUSR1)
        self.finish(first, codes=(75,))

    def info(self, name, code=0):
        done = self.run_program("info", name, code=code)
        return done.stdout or done.stderr

    def test_info_describes_a_partial_archive(self):
        self.copy_stopped()
        done = self.assert_sound()
        for name in ("job.h5.partial", "job.h5"):
            self.assertRegex(self.info(name), r"job\.h5\.partial, unfinished, \d+\.\d % of the tiles done; interrupted")
            self.assertRegex(self.info(name), rf"tiles +{done} of \d+ done")
        self.run_sweep(2)
        text = self.info("job.h5")
        with h5py.File(self.path("job.h5")) as archive:
            attributes = dict(archive.attrs)
        for words in ("job.h5, complete", f"designs   {attributes['designs']}\n",
                      f"{attributes['best_speed']:.8f} m/s", attributes["source"],
                      attributes["history"].split("\n")[1], attributes["job"]):
            self.assertIn(words, text)
        self.assertIn("job.cfg: cannot open it", self.info("job.cfg", 1))
        self.assertIn("nowhere.h5: no such file", self.info("nowhere.h5", 2))


class Faults(ResumeTest):
    def assert_failed(self, errors, *words, options=()):
        self.assert_one_message(errors, *words)
        self.assert_sound(options)

    def limited(self, ranks, kilobytes):
        """A launcher with a limit of the size of files; for the program only: mpirun writes files of its own, and Open
        MPI 5 shares memory by larger ones."""
        return ["env", "OMPI_MCA_btl=self,tcp", "OMPI_MCA_btl_tcp_if_include=lo", MPIEXEC, "-n", str(ranks), "bash", "-c",
                f'ulimit -f {kilobytes}; exec "$@"', "limited"]

    def test_a_file_size_limit_during_the_final_write_is_reported(self):
        with self.straight(COMPRESSED) as straight:
            size = os.path.getsize(straight.filename)
        for ranks, part in ((1, 0.3), (2, 0.5), (3, 0.9)):
            launcher = self.limited(ranks, int(part * size / 1024))
            errors = self.run_sweep(0, *COMPRESSED, codes=(1,), launcher=launcher)
            self.assert_failed(errors, "job.h5.partial", "the same command will continue", options=COMPRESSED)
        self.run_sweep(3, *COMPRESSED)
        self.assert_complete(COMPRESSED)

    def test_a_journal_that_is_damaged_during_the_sweep_is_computed_again(self):
        job = self.write("long.cfg", "[solver]\nstepper = rk4\ntime-step = 1e-4\n[lattice]\nincrement = 0.02\n")
        launcher = self.launch(1, job=job)
        name = "job.h5.partial/0000-00000.journal"
        self.wait_for(name, launcher)
        while os.path.getsize(self.path(name)) < 1000:
            time.sleep(0.01)
        with open(self.path(name), "r+b") as journal:
            journal.seek(500)
            journal.write(b"damage")
        self.assert_one_message(self.finish(launcher, codes=(1,)), "a journal in job.h5.partial is damaged",
                                "the same command computes again")
        for output in ("job.h5", "again.h5"):
            self.finish(self.launch(2, job=job, output=output))
        self.assertEqual(differences(self.path("job.h5"), self.path("again.h5")), [])
        os.remove(self.path("again.h5"))
        os.remove(job)

    def test_a_file_size_limit_of_the_journals_is_reported(self):
        errors = self.run_sweep(0, *COMPRESSED, "--time-limit", "1e-9", codes=(1,), launcher=self.limited(2, 50))
        self.assert_failed(errors, ".journal", "the file size limit (ulimit -f)", "the same command will continue",
                           options=COMPRESSED)
        self.run_sweep(2, *COMPRESSED)
        self.assert_complete(COMPRESSED)

    def test_a_file_size_limit_below_the_known_size_is_reported_at_once(self):
        errors = self.run_sweep(0, codes=(2,), launcher=self.limited(2, 14000))
        self.assert_one_message(errors, "needs at least 15.97 MB", "ulimit -f", "14.34 MB", "output.storage = float32")
        self.assertEqual(self.leftovers(), [])

    def test_a_full_disk_is_reported_and_the_sweep_continues_later(self):
        disk = self.path("small")
        os.mkdir(disk)
        mount = ["mount", "-t", "tmpfs", "-o", "size=4m", "tmpfs", disk]
        if subprocess.run(mount, capture_output=True, check=False).returncode != 0:
            os.rmdir(disk)
            self.skipTest("only root can mount a small disk")
        try:
            file = os.path.join(disk, "job.h5")
            errors = self.run_sweep(2, output=file, codes=(2,))
            self.assert_one_message(errors, f"output.file = {file}: needs at least 31.8 MB",
                                    " bytes) are available in ", "output.maps = none", "output.storage",
                                    "output.fields", "output.compression", "lattice.increment")
            self.assertEqual(os.listdir(disk), [])
            # Something else fills the disk.
            limit = 0.9 * self.sweep_seconds[()]
            subprocess.run([*mount[:4], "remount,size=40m", disk], check=True)
            self.run_sweep(1, "--time-limit", "1e-9", output=file, codes=(75,))
            with open(os.path.join(disk, "other"), "wb") as other:
                other.write(bytes(35 << 20))
            errors = self.run_sweep(2, "--time-limit", f"{limit:.4f}", output=file, codes=(1,))
            self.assert_one_message(errors, "whose disk has no space left", "the same command will continue")
            os.remove(other.name)
            self.run_sweep(2, output=file)
            shutil.move(file, self.path("job.h5"))
        finally:
            subprocess.run(["umount", "-l", disk], check=True)
            os.rmdir(disk)
        self.assertGreater(self.assert_complete(), 1)

    def test_a_failed_rename_is_reported_and_the_sweep_continues_later(self):
        launcher = self.launch(2)
        self.wait_for("job.h5.partial/sweep.json", launcher)
        os.mkdir(self.path("job.h5"))
        errors = self.finish(launcher, codes=(1,))
        os.rmdir(self.path("job.h5"))
        self.assert_failed(errors, "cannot rename")
        self.run_sweep(1)
        self.assert_complete()


if __name__ == "__main__":
    unittest.main()
