"""Interrupted sweeps: kills, signals, limits and faults, and how the same command goes on after them.

Needs TREBSWEEP (the program) and MPIEXEC in the environment. TREBSWEEP_KILLS says how many times the
sweeps are killed in each way (default 2), TREBSWEEP_SEED when.
"""

import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import numpy as np

# A killed process may hold HDF5's own lock for a moment after its end was seen.
os.environ["HDF5_USE_FILE_LOCKING"] = "FALSE"
import h5py  # pylint: disable=wrong-import-position

PROGRAM = os.environ["TREBSWEEP"]
MPIEXEC = os.environ["MPIEXEC"]
KILLS = int(os.environ.get("TREBSWEEP_KILLS", "2"))
SEED = int(os.environ.get("TREBSWEEP_SEED", "1"))
MAPS = ("speed", "release_time", "status", "r1", "r3", "r2", "tile_done")
SUMMARY = ("best_speed", "best_r1", "best_r3", "best_r2", "best_release_time", "designs", "steps")
JOB = "[solver]\nstepper = fehlberg78\ntolerance = 1e-11\n"
COMPRESSED = ("--output.compression", "1")


def ranks_of(launcher):
    """Process ids of the ranks that mpirun started on this host."""
    found = subprocess.run(["pgrep", "-P", str(launcher.pid)], text=True, capture_output=True,
                           check=False)
    return [int(word) for word in found.stdout.split()]


def handles_signals(process):
    """Whether it is the program, and far enough to catch what asks it to stop."""
    try:
        with open(f"/proc/{process}/status", encoding="utf-8") as file:
            caught = int(re.search(r"SigCgt:\s*(\w+)", file.read()).group(1), 16)
        return os.path.samefile(f"/proc/{process}/exe", PROGRAM) and caught >> (signal.SIGUSR1 - 1) & 1
    except OSError:
        return False  # it has just ended


def kill_all(launcher):
    """SIGKILL to mpirun and its ranks."""
    for process in [*ranks_of(launcher), launcher.pid]:
        try:
            os.kill(process, signal.SIGKILL)
        except ProcessLookupError:
            pass


def tiles(archive):
    """The slices of the tiles, in the order of tile_done."""
    edge = [int(archive["tile_done"].attrs[f"edge_{axis}"]) for axis in ("r1", "r3", "r2")]
    extent = archive["speed"].shape
    for first in np.ndindex(*(-(-n // e) for n, e in zip(extent, edge))):
        yield tuple(slice(i * e, (i + 1) * e) for i, e in zip(first, edge))


def setUpModule():
    folder = tempfile.TemporaryDirectory(prefix="trebsweep_")
    unittest.addModuleCleanup(folder.cleanup)
    ResumeTest.sweep_uninterrupted(folder.name)


class ResumeTest(unittest.TestCase):
    """Runs sweeps of one job in a folder, and holds them against an uninterrupted one."""

    @classmethod
    def sweep_uninterrupted(cls, folder):
        cls.folder = folder
        cls.job = cls.path("job.cfg")
        with open(cls.job, "w", encoding="utf-8") as file:
            file.write(JOB)
        cls.seconds = {}
        for options in ((), COMPRESSED):
            start = time.time()
            with cls.launch(2, *options, output=f"straight{len(options)}.h5") as launcher:
                assert launcher.wait(timeout=120) == 0
            cls.seconds[options] = time.time() - start

    def setUp(self):
        random.seed(SEED)
        for name in os.listdir(self.folder):
            if name.startswith("job.h5"):
                os.remove(self.path(name))

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    @classmethod
    def launch(cls, ranks, *options, output="job.h5", launcher=None, job=None):
        return subprocess.Popen(
            [*(launcher or (MPIEXEC, "-n", str(ranks))), PROGRAM, "sweep", job or cls.job, "--progress",
             "none", "--output.file", output, *options], cwd=cls.folder, text=True,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def finish(self, launcher, codes=(0,)):
        """Waits for the end, with one of the exit codes; returns what was written to stderr."""
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
        """A sweep whose designs take a tenth of a second each."""
        job = self.path("slow.cfg")
        with open(job, "w", encoding="utf-8") as file:
            file.write("[solver]\nstepper = rk4\ntime-step = 1e-5\n")
        return self.launch(ranks, job=job)

    def wait_for(self, name, launcher):
        """Waits until a sweep has made a file."""
        while not os.path.exists(self.path(name)):
            if launcher.poll() is not None:
                self.fail(f"ended without {name}: {self.finish(launcher, codes=None)}")
            time.sleep(0.005)

    def run_sweep(self, ranks, *options, codes=(0,), **how):
        return self.finish(self.launch(ranks, *options, **how), codes)

    def stop_on_the_way(self, *options, overwrite=()):
        """A sweep stopped by its time limit with some tiles done; returns what it wrote to stderr. Machines
        are not always as fast as when the limit was measured: it is tried until it fits."""
        limit = self.seconds[()] / 3
        for _ in range(30):
            launcher = self.launch(2, *options, *overwrite, "--time-limit", f"{limit:.2f}")
            errors = self.finish(launcher, codes=(0, 75))
            if launcher.returncode == 0:
                limit *= 0.7
                if not overwrite:
                    os.remove(self.path("job.h5"))
                continue
            if os.path.exists(self.path("job.h5.partial")):
                with h5py.File(self.path("job.h5.partial")) as partial:
                    if partial["tile_done"][...].any():
                        return errors
            limit *= 1.3
        self.fail("no time limit stops it on its way")

    def straight(self, options):
        return h5py.File(self.path(f"straight{len(options)}.h5"))

    def assert_complete(self, options=()):
        """The archive is that of the uninterrupted sweep, and nothing else is left."""
        with h5py.File(self.path("job.h5")) as archive, self.straight(options) as straight:
            self.assertEqual(sorted(archive), sorted(straight))
            for name in MAPS:
                self.assertEqual(archive[name][...].tobytes(), straight[name][...].tobytes(), name)
            for name in SUMMARY:
                self.assertEqual(archive.attrs[name], straight.attrs[name], name)
            runs = len(archive.attrs["history"].split("\n"))
        self.assertEqual([name for name in os.listdir(self.folder) if name.startswith("job.h5")],
                         ["job.h5"])
        return runs

    def assert_sound(self, options=()):
        """What a partial file marks done is there, and what is not there reads as nothing; returns how many tiles
        are marked."""
        self.assertFalse(os.path.exists(self.path("job.h5")))
        if not os.path.exists(self.path("job.h5.partial")):
            return 0
        with h5py.File(self.path("job.h5.partial")) as partial, self.straight(options) as straight:
            done, holds = partial["tile_done"][...], straight["status"][...] > 0
            places = [place for place in tiles(straight) if holds[place].any()]
            self.assertEqual(len(places), len(done))
            for place in np.array(places, dtype=object)[done == 1]:
                for name in ("speed", "release_time", "status"):
                    self.assertEqual(partial[name][tuple(place)].tobytes(),
                                     straight[name][tuple(place)].tobytes())
            for name, nothing in (("speed", np.isnan), ("release_time", np.isnan), ("status", np.logical_not)):
                values = partial[name][...]
                self.assertTrue((nothing(values) | (values == straight[name][...])).all(), name)
            return int(done.sum())

    def assert_told_once(self, errors, *words):
        """One message of the program's own, which holds the words."""
        told = [line for line in errors.splitlines() if line.startswith("trebsweep: ")]
        self.assertEqual(len(told), 1, errors)
        for word in words:
            self.assertIn(word, told[0])

    def interrupt(self, strike, options, after):
        """Strikes sweeps at random moments, KILLS of them, and continues each on 2, 1 and 3 ranks
        in turn; calls after(launcher, stderr) where a strike hit."""
        hits = ends = runs = 0
        while hits < KILLS or ends == 0:
            launcher = self.launch((2, 1, 3)[runs % 3], *options)
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
    def test_a_sweep_killed_again_and_again_ends_in_the_same_archive(self):
        self.interrupt(kill_all, (), lambda launcher, errors: None)

    def test_and_so_does_a_compressed_one(self):
        self.interrupt(kill_all, COMPRESSED, lambda launcher, errors: None)

    def test_a_rank_that_dies_ends_the_sweep(self):
        launcher = self.launch(3)
        self.wait_for("job.h5.partial", launcher)
        os.kill(ranks_of(launcher)[-1], signal.SIGKILL)
        errors = self.finish(launcher, codes=None)
        self.assertNotEqual(launcher.returncode, 0)
        self.assertIn("signal 9", errors)
        self.assert_sound()
        self.run_sweep(2)
        self.assert_complete()


class Stops(ResumeTest):
    def assert_stopped(self, launcher, errors):
        self.assertEqual(launcher.returncode, 75, errors)
        self.assert_told_once(errors, "the same command continues")
        self.assertFalse(os.path.exists(self.path("job.h5.lock")))

    @staticmethod
    def strike_when_up(launcher, strike):
        """Strikes once the ranks handle signals; they may be long in coming where names are looked up."""
        while launcher.poll() is None:
            ranks = ranks_of(launcher)
            if ranks and all(handles_signals(rank) for rank in ranks):
                strike(launcher, ranks)
                break
            time.sleep(0.02)

    def stop(self, strike, options=(), after=None):
        self.interrupt(lambda launcher: self.strike_when_up(launcher, strike), options,
                       after or self.assert_stopped)

    def test_sigusr1_to_mpirun_stops_with_75(self):
        self.stop(lambda launcher, ranks: launcher.send_signal(signal.SIGUSR1))

    def test_sigterm_to_the_ranks_stops_with_75(self):
        def strike(_, ranks):
            for rank in ranks:
                os.kill(rank, signal.SIGTERM)
        self.stop(strike, COMPRESSED)

    def test_a_signal_to_one_rank_stops_all(self):
        self.stop(lambda launcher, ranks: os.kill(random.choice(ranks), signal.SIGINT))

    def test_sigterm_and_ctrl_c_to_mpirun_stop_in_good_order(self):
        # Open MPI's mpirun passes SIGTERM on, kills the ranks a second later, and returns 1 whatever they
        # return: on a busy machine they do not get to tell it.
        def after(launcher, errors):
            self.assertIn(launcher.returncode, (1, 75), errors)
            if "trebsweep: " in errors:
                self.assert_told_once(errors, "the same command continues")
        for number in (signal.SIGTERM, signal.SIGINT):
            self.stop(lambda launcher, ranks, number=number: launcher.send_signal(number),
                      after=after)

    def test_a_time_limit_stops_with_75_and_the_history_tells_of_each_run(self):
        self.assert_told_once(self.stop_on_the_way(), "the same command continues")
        with h5py.File(self.path("job.h5.partial")) as partial:
            runs = len(partial.attrs["history"].split("\n"))
        done = self.assert_sound()
        while not os.path.exists(self.path("job.h5")) and runs < 50:
            launcher = self.launch(2, "--time-limit", f"{self.seconds[()] / 4:.2f}")
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


    # The one takes seconds to fill, with 6.4 GB; the other has 600,000 tiles.
    LARGE = ("--lattice.r1", "0.6", "--lattice.r3", "0.4:1.19:0.01", "--lattice.r2", "0.3:1.29999:1e-7",
             "--output.fields", "speed")
    MANY_TILES = ("--lattice.r1", "0.6:1.39:0.01", *LARGE[2:], *COMPRESSED)

    def test_a_large_file_that_is_being_created_is_left_at_once(self):
        for options in (self.LARGE, self.MANY_TILES, (*self.LARGE, "--overwrite")):
            launcher = self.launch(2, *options)
            self.wait_for("job.h5.partial.new", launcher)
            time.sleep(1)
            start = time.time()
            launcher.send_signal(signal.SIGUSR1)
            errors = self.finish(launcher, codes=(75,))
            self.assertLess(time.time() - start, 5)
            self.assert_told_once(errors, "before the archive was created; the same command continues")
            self.assertNotIn("without --overwrite", errors)
            errors = self.run_sweep(2, *options, "--time-limit", "1", codes=(75,))
            self.assertEqual([name for name in os.listdir(self.folder) if name.startswith("job.h5")], [])


class Partials(ResumeTest):
    def partial(self):
        with open(self.path("job.h5.partial"), "rb") as file:
            return file.read()

    def assert_refused(self, code, *words, options=()):
        before = self.partial()
        errors = self.run_sweep(2, *options, codes=(code,))
        self.assert_told_once(errors, "job.h5.partial", "--overwrite", *words)
        self.assertEqual(self.partial(), before)
        self.assertFalse(os.path.exists(self.path("job.h5")))

    def test_another_job_is_refused_with_the_difference_named(self):
        self.stop_on_the_way()
        self.assert_refused(2, "scene.gravity = 9.8 there, 9.81 here",
                            "lattice.r1 = none there, 1 here",
                            options=("--scene.gravity", "9.81", "--lattice.r1", "1"))
        self.assert_refused(2, "output.fields = speed, release-time, status there, speed here",
                            options=("--output.fields", "speed"))
        self.run_sweep(1)
        self.assert_complete()

    def test_another_version_is_refused(self):
        self.stop_on_the_way()
        with h5py.File(self.path("job.h5.partial")) as partial:
            fuses = not partial.attrs["kernel"].startswith("baseline")
        other_kernel = "baseline (2 lanes)" if fuses else "AVX-512 (8 lanes)"
        for name, value, told in (("source", "trebsweep 0.0.9 (abc)", "0.0.9 (abc)"),
                                  ("kernel", other_kernel, other_kernel),
                                  ("format_version", np.uint64(9), "9")):
            with self.subTest(name=name), h5py.File(self.path("job.h5.partial"), "r+") as file:
                kept = file.attrs[name]
                file.attrs[name] = value
            self.assert_refused(1, told)
            with h5py.File(self.path("job.h5.partial"), "r+") as file:
                file.attrs[name] = kept

    def test_a_damaged_one_is_refused_and_kept(self):
        self.stop_on_the_way()
        whole = self.partial()
        for damaged in (b"", whole[:7], whole[:5000], whole[:len(whole) // 2], whole[:-1],
                        b"x" * len(whole), whole[:96] + bytes(3000) + whole[3096:]):
            with open(self.path("job.h5.partial"), "wb") as file:
                file.write(damaged)
            for options in ((), ("--overwrite",)):
                errors = self.run_sweep(2, *options, codes=(2,))
                self.assert_told_once(errors, "job.h5.partial exists and is not an unfinished sweep")
                self.assertEqual(self.partial(), damaged)
        with open(self.path("job.h5.partial"), "wb") as file:
            file.write(whole)
        self.run_sweep(3)
        self.assert_complete()

    def test_an_unfinished_archive_by_a_final_name_is_not_taken_for_complete(self):
        self.stop_on_the_way()
        os.rename(self.path("job.h5.partial"), self.path("job.h5"))
        with open(self.path("job.h5"), "rb") as file:
            before = file.read()
        errors = self.run_sweep(2, codes=(2,))
        self.assert_told_once(errors, "output.file = job.h5", "unfinished", "rename it to job.h5.partial", "--overwrite")
        with open(self.path("job.h5"), "rb") as file:
            self.assertEqual(file.read(), before)
        self.assertRegex(self.info("job.h5"), r"job\.h5, unfinished, \d+\.\d % of the tiles done; .* job\.h5\.partial")
        os.rename(self.path("job.h5"), self.path("job.h5.partial"))
        self.run_sweep(2)
        self.assert_complete()

    def test_a_complete_archive_by_a_partial_name_is_finished(self):
        self.run_sweep(2)
        os.rename(self.path("job.h5"), self.path("job.h5.partial"))
        self.assertIn("job.h5.partial, complete", self.info("job.h5"))
        self.run_sweep(1)
        self.assert_complete()

    def test_unwritten_cells_of_float32_read_nan(self):
        self.stop_on_the_way("--output.storage", "float32")
        with h5py.File(self.path("job.h5.partial")) as partial:
            speed, status = partial["speed"][...], partial["status"][...]
        self.assertTrue((status == 0).any() and (status != 0).any())
        self.assertTrue(np.isnan(speed[status == 0]).all())

    def test_a_sweep_whose_partial_file_is_replaced_ends_with_an_error(self):
        launcher = self.launch(2)
        self.wait_for("job.h5.partial", launcher)
        shutil.copy(self.path("job.h5.partial"), self.path("job.h5.copy"))
        os.replace(self.path("job.h5.copy"), self.path("job.h5.partial"))
        self.assert_told_once(self.finish(launcher, codes=(1,)), "another run has taken over job.h5.partial")
        self.assertFalse(os.path.exists(self.path("job.h5")))
        self.run_sweep(2)
        self.assert_complete()

    def test_tallies_that_cannot_be_are_refused(self):
        self.stop_on_the_way()
        for column, value in ((1, -1), (1, np.nan), (12, 1e14)):
            with h5py.File(self.path("job.h5.partial"), "r+") as file:
                kept = file["tile_tally"][0, column]
                file["tile_tally"][0, column] = value
            self.assert_refused(1, "tally" if column == 1 else "outside the lattice")
            with h5py.File(self.path("job.h5.partial"), "r+") as file:
                file["tile_tally"][0, column] = kept

    def test_overwriting_starts_anew(self):
        self.stop_on_the_way()
        self.run_sweep(2, "--overwrite")
        self.assertEqual(self.assert_complete(), 1)

    def test_an_interrupted_replacement_goes_on_without_the_option(self):
        self.run_sweep(2, "--solver.tolerance", "1e-6")
        errors = self.stop_on_the_way(overwrite=("--overwrite",))
        self.assert_told_once(errors, "without --overwrite")
        self.run_sweep(2)
        self.assertEqual(self.assert_complete(), 2)

    def test_the_summary_needs_no_maps_of_it(self):
        options = ("--output.fields", "release-time", "--output.optimum", "taut",
                   "--solver.tolerance", "1e-7")
        self.run_sweep(2, *options, output="other.h5")
        self.stop_on_the_way(*options)
        self.run_sweep(3, *options)
        with h5py.File(self.path("job.h5")) as archive, h5py.File(self.path("other.h5")) as other:
            for name in SUMMARY:
                self.assertEqual(archive.attrs[name], other.attrs[name])

    def test_somebody_who_looks_at_it_does_no_harm(self):
        self.stop_on_the_way()
        looks = "import h5py, sys; f = h5py.File(sys.argv[1]); print(flush=True); sys.stdin.read()"
        environment = {**os.environ, "HDF5_USE_FILE_LOCKING": "TRUE"}
        with subprocess.Popen([sys.executable, "-c", looks, self.path("job.h5.partial")],
                              stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                              env=environment) as looker:
            looker.stdout.readline()
            self.run_sweep(2)
            looker.stdin.close()
        self.assert_complete()

    def test_a_second_sweep_is_refused(self):
        first = self.launch_slow(1)
        self.wait_for("job.h5.partial", first)
        for options, job in (((), None), ((), "slow.cfg"), (("--overwrite",), None)):
            errors = self.run_sweep(1, *options, job=job, codes=(2,))
            self.assert_told_once(errors, "output.file = job.h5: another run is writing it",
                                  f"process {ranks_of(first)[0]}")
        first.send_signal(signal.SIGUSR1)
        self.finish(first, codes=(75,))

    def info(self, name, code=0):
        done = subprocess.run([PROGRAM, "info", name], cwd=self.folder, text=True, timeout=60,
                              capture_output=True, check=False)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout or done.stderr

    def test_info_tells_of_it(self):
        self.stop_on_the_way()
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
        self.assert_told_once(errors, *words)
        self.assert_sound(options)

    def test_a_limit_of_file_size(self):
        with self.straight(COMPRESSED) as straight:
            size = os.path.getsize(straight.filename)
        for ranks, part in ((2, 0.5), (3, 0.9)):
            # The limit is the program's alone: mpirun's own files need room.
            limited = [MPIEXEC, "-n", str(ranks), "bash", "-c",
                       f'ulimit -f {int(part * size / 1024)}; exec "$@"', "limited"]
            errors = self.run_sweep(0, *COMPRESSED, codes=(1,), launcher=limited)
            self.assert_failed(errors, "the file size limit (ulimit -f)", options=COMPRESSED)
        self.run_sweep(3, *COMPRESSED)
        self.assert_complete(COMPRESSED)

    def test_a_limit_below_the_size_that_is_known(self):
        limited = [MPIEXEC, "-n", "2", "bash", "-c", 'ulimit -f 14000; exec "$@"', "limited"]
        errors = self.run_sweep(0, codes=(1,), launcher=limited)
        self.assert_told_once(errors, "needs at least 14.71 MB", "ulimit -f", "14.34 MB", "output.storage = float32")
        self.assertEqual([name for name in os.listdir(self.folder) if name.startswith("job.h5")], [])

    def test_a_full_disk(self):
        place = self.path("small")
        os.mkdir(place)
        mount = ["mount", "-t", "tmpfs", "-o", "size=4m", "tmpfs", place]
        if subprocess.run(mount, capture_output=True, check=False).returncode != 0:
            os.rmdir(place)
            self.skipTest("a small disk can be made by root only")
        try:
            file = os.path.join(place, "job.h5")
            # Plain maps are known in size, compressed ones grow.
            errors = self.run_sweep(2, output=file, codes=(1,))
            self.assert_told_once(errors, "job.h5.partial.new needs at least 14.71 MB", "4.19 MB (4190208 bytes) are available",
                                  "output.storage", "output.fields", "output.compression", "lattice.increment")
            self.assertEqual(os.listdir(place), [])
            errors = self.run_sweep(3, *COMPRESSED, output=file, codes=(1,))
            self.assert_told_once(errors, "no space is left", "the same command will continue")
            self.assertFalse(os.path.exists(file))
            subprocess.run([*mount[:4], "remount,size=100m", place], check=True)
            self.run_sweep(2, *COMPRESSED, output=file)
            shutil.move(file, self.path("job.h5"))
        finally:
            subprocess.run(["umount", "-l", place], check=True)
            os.rmdir(place)
        self.assertGreater(self.assert_complete(COMPRESSED), 1)

    def test_a_final_name_that_cannot_be_taken(self):
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
