"""Files in the way of a sweep's archive."""

import os
import signal
import subprocess
import time
import unittest

import h5py

from commands import COARSE, CommandTest
from support import MPIEXEC, PROGRAM


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

    def test_an_archive_with_a_missing_part_does_not_count_as_complete(self):
        def lose(name):
            def damage(file):
                del file[name]
            return damage

        self.run_program("sweep", self.job, *COARSE)
        whole = self.read("job.h5")
        for damage in (lose("speed"), lose("r1"), lose("tile_designs"), lose("tile_block"),
                       lambda file: file.attrs.pop("source")):
            self.write("job.h5", whole)
            with h5py.File(self.path("job.h5"), "r+") as file:
                damage(file)
            self.assert_refused(["sweep", self.job, *COARSE], "output.file = job.h5")
            error = self.run_program("info", "job.h5", code=1).stderr
            self.assertRegex(error, r"\Atrebsweep: job\.h5: .*damaged.*\n\Z")

    def test_ranks_that_cannot_see_the_file_end_instead_of_hanging(self):
        os.mkdir(self.path("elsewhere"))
        # By the rank's number, which Open MPI and MPICH put into the environment: one mpirun of two programs, with -wdir,
        # crashes in Open MPI 5.0.7.
        moved = '[[ ${OMPI_COMM_WORLD_RANK:-$PMI_RANK} != 1 ]] || cd elsewhere; exec "$@"'
        done = self.run_command(MPIEXEC, "-n", "2", "bash", "-c", moved, "moved", PROGRAM, "sweep", self.job, *COARSE,
                                "--output.file", "seen.h5", code=None, timeout=60)
        self.assertNotEqual(done.returncode, 0)
        self.assertIn("rank 1 cannot see seen.h5.partial", done.stderr)
        self.assertEqual([name for name in os.listdir(self.directory) if name.startswith("seen")], [])

    def test_an_hdf5_file_that_is_not_an_archive_is_kept(self):
        with h5py.File(self.path("foreign.h5"), "w") as file:
            file.attrs["job"] = ["many"] * 2000
        self.assert_refused(["sweep", self.job, *COARSE, "--output.file", "foreign.h5"],
                            "output.file = foreign.h5", "not an archive")

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

    def test_info_says_what_is_not_a_file(self):
        os.mkfifo(self.path("fifo"))
        self.assert_refused(["info", "fifo"], "fifo is a FIFO")
        self.assert_refused(["info", "."], ". is a directory")
        self.assert_refused(["info", "/dev/zero"], "/dev/zero is a device")
        self.assert_refused(["info", "x" * 300], "no such file")

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


if __name__ == "__main__":
    unittest.main()
