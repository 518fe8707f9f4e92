"""Interrupted sweeps: kills, signals, limits and faults, and how the same command continues after them.

Needs TREBSWEEP (the program) and MPIEXEC in the environment. TREBSWEEP_KILLS is the number of kills in each
test of class Kills and signals in each test of class Stops (default 2), TREBSWEEP_SEED seeds their times.
"""

import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest

import numpy as np

from archives import differences, h5py, tiles
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
        for name in self.leftovers():
            os.remove(self.path(name))

    def leftovers(self):
        """The files of the interrupted sweep."""
        return [name for name in os.listdir(self.directory) if name.startswith("job.h5")]

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
            if launcher.returncode == 0:
                limit *= 0.7
                if not overwrite:
                    os.remove(self.path("job.h5"))
                continue
            if os.path.exists(self.path("job.h5.partial")):
                with h5py.File(self.path("job.h5.partial")) as partial:
                    done = partial["tile_done"][...]
                if done.any() and not done.all():
                    return errors
                if done.all():  # stopped while it measured its error; the next run completes it
                    limit *= 0.5
            limit *= 1.3
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
        """What a partial archive marks done holds the final values, and what is not yet written reads as fill values.
        Returns the number of tiles done."""
        self.assertFalse(os.path.exists(self.path("job.h5")))
        if not os.path.exists(self.path("job.h5.partial")):
            return 0
        with h5py.File(self.path("job.h5.partial")) as partial, self.straight(options) as straight:
            done = partial["tile_done"][...] == 1
            if "status" in straight:
                self.assert_sound_maps(partial, straight, done, options)
            if "best_value" in straight:
                self.assert_sound_optima(partial, straight, done)
            return int(done.sum())

    def assert_sound_maps(self, partial, straight, done, options):
        holds = straight["status"][...] > 0
        occupied = [tile for tile in tiles(straight) if holds[tile].any()]
        self.assertEqual(len(occupied), len(done))
        for tile in np.array(occupied, dtype=object)[done]:
            for name in ("speed", "release_time", "status"):
                self.assertEqual(partial[name][tuple(tile)].tobytes(), straight[name][tuple(tile)].tobytes())
        for name, is_fill in (("speed", np.isnan), ("release_time", np.isnan), ("status", np.logical_not)):
            for tile in tiles(straight):
                try:
                    values = partial[name][tile]
                except OSError as error:
                    # A kill within a flush can leave the superblock behind the index of compressed chunks, whose
                    # newest ones then lie beyond the end of the file that it stores (archive/partial.hpp).
                    self.assertTrue(options == COMPRESSED and "addr overflow" in str(error), error)
                    continue
                self.assertTrue((is_fill(values) | (values == straight[name][tile])).all(), name)

    def assert_sound_optima(self, partial, straight, done):
        checksums = straight["tile_checksum"]
        best = checksums.attrs["columns"].split().index("best")
        scene_done = done[checksums[:, best] != 0]  # that of a scene's last tile
        for name in OPTIMUM:
            values, final = partial[name][...].ravel(), straight[name][...].ravel()
            self.assertEqual(values[scene_done].tobytes(), final[scene_done].tobytes(), name)
            self.assertTrue((np.isnan(values) | (values == final)).all(), name)

    def assert_reported_once(self, errors, *words):
        """The program prints exactly one message of its own, which contains the words."""
        messages = [line for line in errors.splitlines() if line.startswith("trebsweep: ")]
        self.assertEqual(len(messages), 1, errors)
        for word in words:
            self.assertIn(word, messages[0])

    def assert_stopped(self, launcher, errors):
        self.assertEqual(launcher.returncode, 75, errors)
        self.assert_reported_once(errors, "; the same command")
        self.assertFalse(os.path.exists(self.path("job.h5.lock")))

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
                time.sleep(random.uniform(0.1, 0.6 * self.seconds[options]))
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
    def test_a_sweep_killed_repeatedly_produces_the_same_archive(self):
        self.interrupt(kill_all, (), lambda launcher, errors: None)

    def test_a_compressed_sweep_killed_repeatedly_produces_the_same_archive(self):
        self.interrupt(kill_all, COMPRESSED, lambda launcher, errors: None)

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
                self.assert_reported_once(errors, "; the same command")
        for number in (signal.SIGTERM, signal.SIGINT):
            self.stop(lambda launcher, ranks, number=number: launcher.send_signal(number),
                      after=after, **default)

    def test_a_time_limit_stops_with_75_and_the_history_lists_each_run(self):
        self.assert_reported_once(self.stop_partway(), "the same command continues")
        with h5py.File(self.path("job.h5.partial")) as partial:
            runs = len(partial.attrs["history"].split("\n"))
        done = self.assert_sound()
        while not os.path.exists(self.path("job.h5")) and runs < 50:
            launcher = self.launch(2, "--time-limit", f"{self.sweep_seconds[()] / 2:.2f}")
            errors = self.finish(launcher, codes=(0, 75))
            runs += 1
            if launcher.returncode == 75:
                self.assert_stopped(launcher, errors)
                self.assertGreaterEqual(self.assert_sound(), done)
                done = self.assert_sound()
        self.assertEqual(self.assert_complete(), runs)

    def test_slow_designs_do_not_delay_a_stop(self):
        launcher = self.launch_slow(2)
        self.strike_when_up(launcher, lambda _, ranks: time.sleep(1))
        start = time.time()
        launcher.send_signal(signal.SIGUSR1)
        self.assert_stopped(launcher, self.finish(launcher, codes=(75,)))
        self.assertLess(time.time() - start, 20)

    # The first takes seconds to fill with 6.4 GB, the second has 600,000 tiles.
    LARGE = ("--lattice.r1", "0.6", "--lattice.r3", "0.4:1.19:0.01", "--lattice.r2", "0.3:1.29999:1e-7",
             "--output.fields", "speed")
    MANY_TILES = ("--lattice.r1", "0.6:1.39:0.01", *LARGE[2:], *COMPRESSED)

    def test_a_stop_interrupts_the_creation_of_a_large_file(self):
        for options in (self.LARGE, self.MANY_TILES, (*self.LARGE, "--overwrite")):
            launcher = self.launch(2, *options)
            self.wait_for("job.h5.partial.new", launcher)
            time.sleep(1)
            start = time.time()
            launcher.send_signal(signal.SIGUSR1)
            errors = self.finish(launcher, codes=(75,))
            self.assertLess(time.time() - start, 5)
            self.assert_reported_once(errors, "before the archive was created; the same command starts")
            self.assertNotIn("without --overwrite", errors)
            errors = self.run_sweep(2, *options, "--time-limit", "1", codes=(75,))
            self.assertEqual(self.leftovers(), [])


class Partials(ResumeTest):
    def assert_refused(self, code, *words, options=()):
        before = self.read("job.h5.partial")
        errors = self.run_sweep(2, *options, codes=(code,))
        self.assert_reported_once(errors, "job.h5.partial", "--overwrite", *words)
        self.assertEqual(self.read("job.h5.partial"), before)
        self.assertFalse(os.path.exists(self.path("job.h5")))

    def test_a_different_job_is_refused_with_the_differences(self):
        self.stop_partway()
        self.assert_refused(2, "scene.gravity = 9.8 there, 9.81 here",
                            "lattice.r1 = none there, 1 here",
                            options=("--scene.gravity", "9.81", "--lattice.r1", "1"))
        self.assert_refused(2, "output.fields = speed, release-time, status there, speed here",
                            options=("--output.fields", "speed"))
        self.run_sweep(1)
        self.assert_complete()

    def test_a_partial_archive_of_another_version_is_refused(self):
        self.stop_partway()
        with h5py.File(self.path("job.h5.partial")) as partial:
            has_fma = not partial.attrs["kernel"].startswith("baseline")
        other_kernel = "baseline (2 lanes)" if has_fma else "AVX-512 (8 lanes)"
        for name, value, shown in (("source", "trebsweep 0.0.9 (abc)", "0.0.9 (abc)"),
                                  ("kernel", other_kernel, other_kernel),
                                  ("format_version", np.uint64(9), "9")):
            with self.subTest(name=name), h5py.File(self.path("job.h5.partial"), "r+") as file:
                kept = file.attrs[name]
                file.attrs[name] = value
            self.assert_refused(1, shown)
            with h5py.File(self.path("job.h5.partial"), "r+") as file:
                file.attrs[name] = kept

    def test_a_damaged_partial_archive_is_refused_and_kept(self):
        self.stop_partway()
        whole = self.read("job.h5.partial")
        for damaged in (b"", whole[:7], whole[:5000], whole[:len(whole) // 2], whole[:-1],
                        b"x" * len(whole), whole[:96] + bytes(3000) + whole[3096:]):
            self.write("job.h5.partial", damaged)
            for options in ((), ("--overwrite",)):
                errors = self.run_sweep(2, *options, codes=(2,))
                self.assert_reported_once(errors, "job.h5.partial exists and is not an unfinished sweep")
                self.assertEqual(self.read("job.h5.partial"), damaged)
        self.write("job.h5.partial", whole)
        self.run_sweep(3)
        self.assert_complete()

    def test_a_partial_archive_with_a_final_name_does_not_count_as_complete(self):
        self.stop_partway()
        os.rename(self.path("job.h5.partial"), self.path("job.h5"))
        before = self.read("job.h5")
        errors = self.run_sweep(2, codes=(2,))
        self.assert_reported_once(errors, "output.file = job.h5", "unfinished", "rename it to job.h5.partial", "--overwrite")
        self.assertEqual(self.read("job.h5"), before)
        self.assertRegex(self.info("job.h5"), r"job\.h5, unfinished, \d+\.\d % of the tiles done; .* job\.h5\.partial")
        os.rename(self.path("job.h5"), self.path("job.h5.partial"))
        self.run_sweep(2)
        self.assert_complete()

    def test_a_complete_archive_with_a_partial_name_is_renamed(self):
        self.run_sweep(2)
        os.rename(self.path("job.h5"), self.path("job.h5.partial"))
        self.assertIn("job.h5.partial, complete", self.info("job.h5"))
        self.run_sweep(1)
        self.assert_complete()

    def test_unwritten_cells_of_float32_read_nan(self):
        self.stop_partway("--output.storage", "float32")
        with h5py.File(self.path("job.h5.partial")) as partial:
            speed, status = partial["speed"][...], partial["status"][...]
        self.assertTrue((status == 0).any() and (status != 0).any())
        self.assertTrue(np.isnan(speed[status == 0]).all())

    def test_a_sweep_whose_partial_archive_is_replaced_ends_with_an_error(self):
        launcher = self.launch(2)
        self.wait_for("job.h5.partial", launcher)
        shutil.copy(self.path("job.h5.partial"), self.path("job.h5.copy"))
        os.replace(self.path("job.h5.copy"), self.path("job.h5.partial"))
        self.assert_reported_once(self.finish(launcher, codes=(1,)), "another run has taken over job.h5.partial")
        self.assertFalse(os.path.exists(self.path("job.h5")))
        self.run_sweep(2)
        self.assert_complete()

    def test_overwrite_discards_a_partial_archive(self):
        self.stop_partway()
        self.run_sweep(2, "--overwrite")
        self.assertEqual(self.assert_complete(), 1)

    def test_an_interrupted_overwrite_continues_without_the_option(self):
        self.run_sweep(2, "--solver.tolerance", "1e-6")
        errors = self.stop_partway(overwrite=("--overwrite",))
        self.assert_reported_once(errors, "without --overwrite")
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

    def test_a_sweep_of_another_objective_is_not_continued(self):
        self.stop_partway()
        for key, value, there, here in (("objective", "range", "speed", "range"),
                                        ("subject-to", "speed <= 10", "none", "speed <= 10")):
            errors = self.run_sweep(2, f"--optimum.{key}", value, codes=(2,))
            self.assert_reported_once(errors, f"(optimum.{key} = {there} there, {here} here)")

    def test_a_reader_of_the_partial_archive_does_no_harm(self):
        self.stop_partway()
        script = "import h5py, sys; f = h5py.File(sys.argv[1]); print(flush=True); sys.stdin.read()"
        environment = {**os.environ, "HDF5_USE_FILE_LOCKING": "TRUE"}
        with subprocess.Popen([sys.executable, "-c", script, self.path("job.h5.partial")],
                              stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                              env=environment) as reader:
            reader.stdout.readline()
            self.run_sweep(2)
            reader.stdin.close()
        self.assert_complete()

    def test_a_second_sweep_of_the_same_file_is_refused(self):
        first = self.launch_slow(1)
        self.wait_for("job.h5.partial", first)
        for options, job in (((), None), ((), "slow.cfg"), (("--overwrite",), None)):
            errors = self.run_sweep(1, *options, job=job, codes=(2,))
            self.assert_reported_once(errors, "output.file = job.h5: another run is writing it",
                                  f"process {ranks_of(first)[0]}")
        self.assertIn("being written by process", self.run_program("info", "job.h5", "--verify", code=1).stderr)
        first.send_signal(signal.SIGUSR1)
        self.finish(first, codes=(75,))

    def info(self, name, code=0):
        done = self.run_program("info", name, code=code)
        return done.stdout or done.stderr

    def test_info_describes_a_partial_archive(self):
        self.stop_partway()
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
        self.assert_reported_once(errors, *words)
        self.assert_sound(options)

    def test_a_file_size_limit_during_writing_is_reported(self):
        with self.straight(COMPRESSED) as straight:
            size = os.path.getsize(straight.filename)
        for ranks, part in ((2, 0.5), (3, 0.9)):
            # The limit applies to the program only: mpirun writes files of its own.
            limited = [MPIEXEC, "-n", str(ranks), "bash", "-c",
                       f'ulimit -f {int(part * size / 1024)}; exec "$@"', "limited"]
            errors = self.run_sweep(0, *COMPRESSED, codes=(1,), launcher=limited)
            self.assert_failed(errors, "the file size limit (ulimit -f)", options=COMPRESSED)
        self.run_sweep(3, *COMPRESSED)
        self.assert_complete(COMPRESSED)

    def test_a_file_size_limit_below_the_known_size_is_reported_at_once(self):
        limited = [MPIEXEC, "-n", "2", "bash", "-c", 'ulimit -f 14000; exec "$@"', "limited"]
        errors = self.run_sweep(0, codes=(1,), launcher=limited)
        self.assert_reported_once(errors, "needs at least 14.72 MB", "ulimit -f", "14.34 MB", "output.storage = float32")
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
            # The size of plain maps is known in advance, that of compressed ones is not.
            errors = self.run_sweep(2, output=file, codes=(2,))
            self.assert_reported_once(errors, f"output.file = {file}: needs at least 14.72 MB",
                                      "4.19 MB (4190208 bytes) are available", "output.maps = none", "output.storage",
                                      "output.fields", "output.compression", "lattice.increment")
            self.assertEqual(os.listdir(disk), [])
            errors = self.run_sweep(3, *COMPRESSED, output=file, codes=(1,))
            self.assert_reported_once(errors, "whose disk has no space left", "the same command will continue")
            self.assertFalse(os.path.exists(file))
            subprocess.run([*mount[:4], "remount,size=100m", disk], check=True)
            self.run_sweep(2, *COMPRESSED, output=file)
            shutil.move(file, self.path("job.h5"))
        finally:
            subprocess.run(["umount", "-l", disk], check=True)
            os.rmdir(disk)
        self.assertGreater(self.assert_complete(COMPRESSED), 1)

    def test_a_failed_rename_is_reported_and_the_sweep_continues_later(self):
        launcher = self.launch(2)
        self.wait_for("job.h5.partial", launcher)
        os.mkdir(self.path("job.h5"))
        errors = self.finish(launcher, codes=(1,))
        os.rmdir(self.path("job.h5"))
        self.assert_failed(errors, "cannot rename")
        self.run_sweep(1)
        self.assert_complete()


if __name__ == "__main__":
    unittest.main()
