#!/usr/bin/env bash
# Sweeps as Slurm jobs that go on by themselves: ahead of the time limit the program is told to stop; what is done
# is kept in the archive's .partial, and the job goes back into the queue until its archive is complete.
#
#   sbatch jobs/slurm.sh jobs/millimetre.cfg                           one sweep
#   sbatch --array=1-3 jobs/slurm.sh a.cfg b.cfg c.cfg                 three, each a job of its own
#   sbatch --ntasks=256 jobs/slurm.sh JOB -- --output.compression 1    options of the program behind --
#
# Submit it in the folder that the archives shall go to. Options of sbatch win over the lines below.
# A sweep that fails (exit codes 1 and 2) stays failed; correct it and submit it again: what was done counts.

#SBATCH --job-name=trebsweep
#SBATCH --ntasks=64
#SBATCH --ntasks-per-core=1
#SBATCH --time=01:00:00
#SBATCH --output=%x-%j.log
# To this script, 3 minutes ahead of the limit: Slurm may be a minute late, and a round of the sweep takes seconds.
#SBATCH --signal=B:USR1@180
#SBATCH --requeue
# One log for a job and all its restarts.
#SBATCH --open-mode=append
# No set -eu here: the scripts behind module load stumble over it, and old shells over empty lists.

program=${TREBSWEEP:-build/release/trebsweep} # from the folder of sbatch, or a full path
launch=(mpirun --bind-to core)                # or (srun --mpi=pmix --cpu-bind=cores)
most_restarts=100                             # more: something is wrong
# module load gcc openmpi hdf5                # what the program was built with
# export HDF5_USE_FILE_LOCKING=FALSE          # where opening a file hangs, or fails for want of a lock

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
[[ -n ${SLURM_JOB_ID:-} ]] || refuse "submit it: sbatch jobs/slurm.sh JOB"
[[ ${#jobs[@]} -gt 0 ]] || refuse "no job file; sbatch jobs/slurm.sh JOB"
[[ ${#jobs[@]} -eq 1 || -n ${SLURM_ARRAY_TASK_ID:-} ]] ||
  refuse "${#jobs[@]} job files need an array: sbatch --array=1-${#jobs[@]} jobs/slurm.sh ..."
number=${SLURM_ARRAY_TASK_ID:-1}
[[ $number -ge 1 && $number -le ${#jobs[@]} ]] ||
  refuse "--array: there is no job file number $number, only 1 to ${#jobs[@]}"
command -v "$program" >/dev/null || refuse "$program: no such program; build it, or set TREBSWEEP"
options=()
for option in "$@"; do # a restart goes on with what is there
  [[ $option == --overwrite && ${SLURM_RESTART_COUNT:-0} -gt 0 ]] || options+=("$option")
done

# The launcher hands USR1 to the ranks, which then finish their round. TERM is scancel's: no restart after it.
sweep='' cancelled=no
trap 'kill -USR1 $sweep' USR1
trap 'cancelled=yes; kill -USR1 $sweep' TERM
"${launch[@]}" "$program" sweep "${jobs[number - 1]}" "${options[@]}" &
sweep=$!
while kill -0 $sweep 2>/dev/null; do wait $sweep; done # a trap ends a wait
wait $sweep
code=$?

if [[ $code -eq 75 && $cancelled == no ]]; then
  if [[ ${SLURM_RESTART_COUNT:-0} -ge $most_restarts ]]; then
    echo "jobs/slurm.sh: not complete after $most_restarts restarts; submit it again to go on" >&2
  else
    echo "jobs/slurm.sh: back into the queue" >&2
    # One job of an array may have the number of all.
    me=${SLURM_ARRAY_JOB_ID:+${SLURM_ARRAY_JOB_ID}_$SLURM_ARRAY_TASK_ID}
    scontrol requeue "${me:-$SLURM_JOB_ID}" || echo "jobs/slurm.sh: not requeued; submit it again to go on" >&2
  fi
fi
exit $code
