"""The job scripts: with a stub batch system that records its calls, what they start and when they requeue; and what
run.sh writes."""

import os
import re
import shutil
import signal
import subprocess
import time
import unittest

from commands import read_trace
from support import JOBS, MPIEXEC, PROGRAM, REPOSITORY, DirectoryTest

RECORDS_CALL = """#!/usr/bin/env bash
printf '%s' "$(basename "$0")" >>"$NOTES"
printf ' <%s>' "$@" >>"$NOTES"
echo >>"$NOTES"
"""
QSTAT = """#!/usr/bin/env bash
printf 'Job Id: %s\\n    Resource_List.ncpus = 64\\n    Resource_List.walltime = 02:09:30\\n' "$2"
printf '    run_count = %s\\n' "${RUN_COUNT:-1}"
"""
# Exits with CODE, or if that is "wait", runs until SIGUSR1 and exits with 75, as a sweep does.
MPIRUN = RECORDS_CALL + """
[[ $CODE == wait ]] || exit "$CODE"
trap 'echo usr1 >>"$NOTES"; exit 75' USR1
touch "$NOTES.running"
for _ in {1..1000}; do sleep 0.01; done
exit 1
"""


class JobScriptTest(DirectoryTest):
    """A directory with the commands of a batch system, which record how they were called."""

    def setUp(self):
        self.empty_directory()
        for name, text in (("mpirun", MPIRUN), ("scontrol", RECORDS_CALL), ("qstat", QSTAT),
                           ("qsub", RECORDS_CALL + 'echo "jobs=$jobs options=$options '
                                                  'restart=$restart" >>"$NOTES"\n')):
            os.chmod(self.write(name, text), 0o755)
        self.write("nodes", "one\none\ntwo\n")

    def start(self, script, *arguments, code=0, **variables):
        """Starts a script of jobs/ as a batch system does. `code` is the exit code of the launcher."""
        environment = {
            "PATH": self.directory + ":" + os.environ["PATH"], "NOTES": self.path("notes"),
            "CODE": str(code), "TREBSWEEP": "true", "SLURM_JOB_ID": "12", "PBS_JOBID": "12.server",
            "PBS_O_WORKDIR": self.directory, "PBS_NODEFILE": self.path("nodes"), **variables}
        return subprocess.Popen([os.path.join(JOBS, script), *arguments],
                                env=environment, cwd=self.directory, text=True,
                                stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def run_script(self, script, *arguments, **given):
        """Returns the exit code, the recorded calls, and the text on stderr."""
        process = self.start(script, *arguments, **given)
        errors = process.communicate(timeout=60)[1]
        return process.returncode, self.notes(), errors

    def run_until_signal(self, number, script, *arguments, **given):
        """The same for a script that gets a signal as soon as the sweep runs."""
        process = self.start(script, *arguments, code="wait", **given)
        while not os.path.exists(self.path("notes.running")):
            time.sleep(0.01)
        process.send_signal(number)
        errors = process.communicate(timeout=60)[1]
        return process.returncode, self.notes(), errors

    def notes(self):
        """The recorded calls, one per line."""
        return self.read("notes").decode().splitlines() if os.path.exists(self.path("notes")) else []


class Slurm(JobScriptTest):
    SWEEP = "mpirun <--bind-to> <core> <true> <sweep> "

    def test_a_complete_sweep_ends_the_job(self):
        code, notes, _ = self.run_script("slurm.sh", "a.cfg", "--", "--output.file", "a b.h5")
        self.assertEqual((code, notes), (0, [self.SWEEP + "<a.cfg> <--output.file> <a b.h5>"]))

    def test_a_sweep_that_stopped_cleanly_is_requeued(self):
        code, notes, _ = self.run_script("slurm.sh", "a.cfg", code=75)
        self.assertEqual((code, notes), (75, [self.SWEEP + "<a.cfg>", "scontrol <requeue> <12>"]))

    def test_the_sweep_is_stopped_before_the_time_limit(self):
        code, notes, _ = self.run_until_signal(signal.SIGUSR1, "slurm.sh", "a.cfg")
        self.assertEqual((code, notes[1:]), (75, ["usr1", "scontrol <requeue> <12>"]))

    def test_a_cancelled_sweep_stops_and_is_not_requeued(self):
        code, notes, _ = self.run_until_signal(signal.SIGTERM, "slurm.sh", "a.cfg")
        self.assertEqual((code, notes[1:]), (75, ["usr1"]))

    def test_a_failed_sweep_is_not_restarted(self):
        for code in (1, 2, 137, 205):
            self.assertEqual(self.run_script("slurm.sh", "a.cfg", code=code)[0], code)
        self.assertNotIn("scontrol", "".join(self.notes()))

    def test_the_number_of_restarts_is_limited(self):
        code, notes, errors = self.run_script("slurm.sh", "a.cfg", code=75, SLURM_RESTART_COUNT="100")
        self.assertEqual((code, len(notes)), (75, 1))
        self.assertIn("not complete after 100 restarts", errors)

    def test_a_restart_continues_the_partial_archive(self):
        for restarts, option in (("0", " <--overwrite>"), ("1", "")):
            _, notes, _ = self.run_script("slurm.sh", "a.cfg", "--", "--overwrite", "-x",
                                          SLURM_RESTART_COUNT=restarts)
            self.assertEqual(notes[-1], self.SWEEP + f"<a.cfg>{option} <-x>")

    def test_each_task_of_an_array_runs_its_own_job_file(self):
        for number, job in enumerate(("a.cfg", "b.cfg", "c.cfg"), 1):
            code, notes, _ = self.run_script("slurm.sh", "a.cfg", "b.cfg", "c.cfg", "--", "-x",
                                             SLURM_ARRAY_TASK_ID=str(number))
            self.assertEqual((code, notes[-1]), (0, self.SWEEP + f"<{job}> <-x>"))

    def test_invalid_submissions_are_refused(self):
        for arguments, variables, message in (
                ((), {}, "no job file"),
                (("a.cfg", "b.cfg"), {}, "--array=1-2"),
                (("a.cfg", "b.cfg"), {"SLURM_ARRAY_TASK_ID": "0"}, "number 0, only 1 to 2"),
                (("a.cfg", "b.cfg"), {"SLURM_ARRAY_TASK_ID": "3"}, "number 3, only 1 to 2"),
                (("a.cfg",), {"SLURM_JOB_ID": ""}, "submit it"),
                (("a.cfg",), {"TREBSWEEP": "no/such"}, "no/such: no such program")):
            code, notes, errors = self.run_script("slurm.sh", *arguments, code=75, **variables)
            self.assertEqual((code, notes), (2, []))
            self.assertIn(message, errors)

    def test_only_the_stopped_task_of_an_array_is_requeued(self):
        _, notes, _ = self.run_script("slurm.sh", "a.cfg", "b.cfg", code=75,
                                      SLURM_ARRAY_JOB_ID="12", SLURM_ARRAY_TASK_ID="2")
        self.assertEqual(notes, [self.SWEEP + "<b.cfg>", "scontrol <requeue> <12_2>"])


class Pbs(JobScriptTest):
    # The time limit is 02:09:30, 7770 s, less a margin of 180 s.
    SWEEP = ("mpirun <-machinefile> <{}> <-n> <3> <--bind-to> <core> <true> <sweep> <{}> "
             "<--time-limit> <7590>")

    def sweep(self, job, rest=""):
        return self.SWEEP.format(self.path("nodes"), job) + rest

    def test_a_complete_sweep_ends_the_job(self):
        code, notes, _ = self.run_script("pbs.sh", jobs="a.cfg", options="--output.file b.h5")
        self.assertEqual((code, notes), (0, [self.sweep("a.cfg", " <--output.file> <b.h5>")]))

    def test_a_sweep_that_stopped_cleanly_is_submitted_again(self):
        code, notes, _ = self.run_script("pbs.sh", code=75, jobs="a.cfg", options="-x", restart="3")
        self.assertEqual((code, notes), (75, [
            self.sweep("a.cfg", " <-x>"),
            "qsub <-v> <jobs,options,restart,script,TREBSWEEP> <jobs/pbs.sh>",
            "jobs=a.cfg options=-x restart=4"]))

    def test_a_restart_continues_the_partial_archive(self):
        _, notes, _ = self.run_script("pbs.sh", code=75, jobs="a.cfg", options="--overwrite -x")
        self.assertEqual(notes[0], self.sweep("a.cfg", " <--overwrite> <-x>"))
        self.assertEqual(notes[-1], "jobs=a.cfg options= -x restart=1")

    def test_a_job_rerun_by_pbs_continues_the_partial_archive(self):
        _, notes, _ = self.run_script("pbs.sh", jobs="a.cfg", options="--overwrite -x", RUN_COUNT="2")
        self.assertEqual(notes, [self.sweep("a.cfg", " <-x>")])

    def test_only_the_stopped_job_of_an_array_is_submitted_again(self):
        code, notes, _ = self.run_script("pbs.sh", code=75, jobs="a.cfg b.cfg", PBS_ARRAY_INDEX="2")
        self.assertEqual((code, notes[0]), (75, self.sweep("b.cfg")))
        self.assertEqual(notes[-1], "jobs=b.cfg options= restart=1")

    def test_a_deleted_job_stops_and_is_not_submitted_again(self):
        code, notes, _ = self.run_until_signal(signal.SIGTERM, "pbs.sh", jobs="a.cfg")
        self.assertEqual((code, notes[1:]), (75, ["usr1"]))

    def test_a_failed_sweep_is_not_restarted(self):
        for code in (1, 2, 137, 205):
            self.assertEqual(self.run_script("pbs.sh", code=code, jobs="a.cfg")[0], code)
        self.assertNotIn("qsub", "".join(self.notes()))

    def test_the_number_of_restarts_is_limited(self):
        code, notes, errors = self.run_script("pbs.sh", code=75, jobs="a.cfg", restart="100")
        self.assertEqual((code, len(notes)), (75, 1))
        self.assertIn("not complete after 100 restarts", errors)

    def test_invalid_submissions_are_refused(self):
        for variables, message in (
                ({}, "no job file"),
                ({"jobs": "a.cfg b.cfg"}, "qsub -J 1-2"),
                ({"jobs": "a.cfg b.cfg", "PBS_ARRAY_INDEX": "3"}, "number 3, only 1 to 2"),
                ({"jobs": "a.cfg", "TREBSWEEP": "no/such"}, "no/such: no such program")):
            code, notes, errors = self.run_script("pbs.sh", code=75, **variables)
            self.assertEqual((code, notes), (2, []))
            self.assertIn(message, errors)


class Run(DirectoryTest):
    """run.sh in a copy of the repository that is built already."""

    def setUp(self):
        self.empty_directory()
        for name in ("analysis", "jobs"):
            shutil.copytree(os.path.join(REPOSITORY, name), self.path(name))
        for name, text in (("jobs/build.sh", "#!/bin/sh\n"),
                           ("mpirun", f'#!/bin/sh\nexec {shutil.which(MPIEXEC)} "$@"\n')):
            os.chmod(self.write(name, text), 0o755)
        os.makedirs(self.path("build/release"))
        os.symlink(os.path.abspath(PROGRAM), self.path("build/release/trebsweep"))

    def run_script(self, *options):
        """Runs it on a coarse lattice; returns what it printed and the names of the results."""
        done = self.run_command("jobs/run.sh", "-n", "1", "--", "--lattice.increment", "0.05", *options,
                                PATH=self.directory + ":" + os.environ["PATH"])
        return done, set(os.listdir(self.path("results")))

    def test_the_optimum_is_reported_and_drawn_and_a_second_run_replaces_the_results(self):
        done, results = self.run_script()
        self.assertEqual(results, {"paper.h5", "paper.png", "paper-optimum.cfg", "paper-optimum.txt",
                                   "paper-swing.txt", "paper-flight.txt", "paper-swing.png",
                                   "paper-neighbourhood.png", "paper-sheet.pdf"})
        report = self.read("results/paper-optimum.txt").decode()
        self.assertIn(report, done.stdout)
        found = re.search(r"^optimum +speed ([\d.]+) m/s", report, re.MULTILINE)
        _, rows = read_trace(self.read("results/paper-swing.txt").decode())
        self.assertAlmostEqual(rows["speed"][-1], float(found[1]), places=6)
        for picture in ("paper.png", "paper-swing.png", "paper-neighbourhood.png"):
            self.assertTrue(self.read(f"results/{picture}").startswith(b"\x89PNG"))
            self.assertIn(f"results/{picture}\n", done.stdout)
        self.assertTrue(done.stdout.endswith("analysis/explorer/build.sh --archive results/paper.h5\n"))
        self.write("results/paper-optimum.cfg", "old")
        self.assertEqual(self.run_script()[1], results)
        self.assertIn(b"[lattice]", self.read("results/paper-optimum.cfg"))

    def test_of_a_study_the_optima_of_the_scenes_are_drawn(self):
        done, results = self.run_script("--scene.projectile-mass", "50, 100")
        self.assertEqual(results, {"paper.h5", "paper.png", "paper.txt"})
        self.assertIn(self.read("results/paper.txt").decode(), done.stdout)
        self.assertIn("projectile-mass", done.stdout)
        self.assertTrue(done.stdout.endswith("analysis/explorer/build.sh --archive results/paper.h5 --at KEY=VALUE\n"))
        self.assertTrue(self.read("results/paper.png").startswith(b"\x89PNG"))

    def test_an_installed_program_of_the_same_version_is_not_built_again(self):
        self.write("jobs/build.sh", "#!/bin/sh\nexit 1\n")
        os.remove(self.path("build/release/trebsweep"))
        os.symlink(os.path.abspath(PROGRAM), self.path("trebsweep"))
        shutil.copy(os.path.join(REPOSITORY, "CMakeLists.txt"), self.directory)
        _, results = self.run_script("--scene.projectile-mass", "50, 100")
        self.assertIn("paper.h5", results)
        self.write("CMakeLists.txt", "project(trebsweep VERSION 0.9.0 LANGUAGES CXX)\n")
        self.run_command("jobs/run.sh", PATH=self.directory + ":" + os.environ["PATH"], code=1)

    def test_a_job_without_an_optimum_is_swept_and_the_reason_printed(self):
        for option, reason in (("--solver.max-time=0.1", "nothing is released"),
                               ("--optimum.subject-to=peak-axle-load <= 1", "exclude every design")):
            done, results = self.run_script(option, "--overwrite")
            self.assertEqual(results, {"paper.h5", "paper.png", "paper-optimum.cfg"})
            self.assertIn(reason, done.stderr)


if __name__ == "__main__":
    unittest.main()
