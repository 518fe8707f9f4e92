#!/usr/bin/env bash
# Runs sweeps as Slurm jobs that continue automatically: shortly before the time limit the sweep is stopped after a
# tile, and the job is requeued until its archive is complete.
#
#   sbatch jobs/slurm.sh jobs/millimetre.cfg                           one sweep
#   sbatch --array=1-3 jobs/slurm.sh a.cfg b.cfg c.cfg                 three, one per array task
#   sbatch --ntasks=256 jobs/slurm.sh JOB -- --output.compression 1    options of trebsweep after --
#
# Archives are written to the directory in which the job is submitted. Options of sbatch override the lines below.
# A sweep that fails (exit codes 1 and 2) is not requeued; fix the cause and submit it again to continue the sweep.

#SBATCH --job-name=trebsweep
#SBATCH --ntasks=64
#SBATCH --ntasks-per-core=1
#SBATCH --time=01:00:00
#SBATCH --output=%x-%j.log
# Signals this script 3 minutes before the limit: Slurm may be a minute late, and a tile of the sweep takes a second.
#SBATCH --signal=B:USR1@180
#SBATCH --requeue
# One log for the job and all its restarts.
#SBATCH --open-mode=append
# No set -eu: it breaks module load and, in old versions of bash, empty arrays.

program=trebsweep                             # the one on PATH, unless there is one in build/release
[[ ! -x build/release/trebsweep ]] || program=build/release/trebsweep
program=${TREBSWEEP:-$program}                # relative to the directory of sbatch, or absolute
launch=(mpirun --bind-to core)                # or (srun --mpi=pmix --cpu-bind=cores)
most_restarts=100                             # a limit in case something is wrong
# module load gcc openmpi hdf5                # those that the program was built with
# export HDF5_USE_FILE_LOCKING=FALSE          # if opening a file hangs, or fails for lack of locks

refuse() {
  echo "jobs/slurm.sh: $*" >&2
  exit 2
}

jobs=()
while [[ $# -gt 0 && $1 != -- ]]; do
  jobs+=("$1")
  shift
done
[[ $# -eq 0 ]] || shift
[[ -n ${SLURM_JOB_ID:-} ]] || refuse "submit it with: sbatch jobs/slurm.sh JOB"
[[ ${#jobs[@]} -gt 0 ]] || refuse "no job file given; usage: sbatch jobs/slurm.sh JOB"
[[ ${#jobs[@]} -eq 1 || -n ${SLURM_ARRAY_TASK_ID:-} ]] ||
  refuse "${#jobs[@]} job files need a job array: sbatch --array=1-${#jobs[@]} jobs/slurm.sh ..."
number=${SLURM_ARRAY_TASK_ID:-1}
[[ $number -ge 1 && $number -le ${#jobs[@]} ]] ||
  refuse "--array: there is no job file number $number, only 1 to ${#jobs[@]}"
command -v "$program" >/dev/null || refuse "$program: no such program; build or install it, or set TREBSWEEP"
options=()
for option in "$@"; do # a restart continues the unfinished sweep
  [[ $option == --overwrite && ${SLURM_RESTART_COUNT:-0} -gt 0 ]] || options+=("$option")
done

# The launcher forwards USR1 to the ranks, which then finish their tile. TERM is from scancel: no restart after it.
sweep='' cancelled=no
trap 'kill -USR1 $sweep' USR1
trap 'cancelled=yes; kill -USR1 $sweep' TERM
"${launch[@]}" "$program" sweep "${jobs[number - 1]}" "${options[@]}" &
sweep=$!
while kill -0 $sweep 2>/dev/null; do wait $sweep; done # a trap interrupts wait
wait $sweep
code=$?

if [[ $code -eq 75 && $cancelled == no ]]; then
  if [[ ${SLURM_RESTART_COUNT:-0} -ge $most_restarts ]]; then
    echo "jobs/slurm.sh: not complete after $most_restarts restarts; submit it again to continue" >&2
  else
    echo "jobs/slurm.sh: requeueing the job" >&2
    # The job number of an array task may be that of the whole array.
    me=${SLURM_ARRAY_JOB_ID:+${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID}
    scontrol requeue "${me:-$SLURM_JOB_ID}" || echo "jobs/slurm.sh: not requeued; submit it again to continue" >&2
  fi
fi
exit $code
