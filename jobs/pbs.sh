#!/usr/bin/env bash
# Sweeps as PBS jobs (OpenPBS, PBS Professional) that go on by themselves: ahead of its time limit the program stops;
# what is done is kept in the archive's .partial, and the job submits itself again until its archive is complete.
#
#   qsub -v jobs=jobs/millimetre.cfg jobs/pbs.sh                       one sweep
#   jobs="a.cfg b.cfg c.cfg" qsub -J 1-3 -v jobs jobs/pbs.sh           three, each a job of its own
#   options="--output.compression 1" qsub -v jobs=JOB,options jobs/pbs.sh
#
# Submit it in the folder that the archives shall go to. Resources and queue stand below, not on qsub's command line,
# as the job submits itself without it. A sweep that fails (exit codes 1 and 2) stays failed; correct it and submit
# it again: what was done counts.

#PBS -N trebsweep
#PBS -l select=2:ncpus=32:mpiprocs=32
#PBS -l walltime=01:00:00
#PBS -j oe
#PBS -r y
# No set -eu here: the scripts behind module load stumble over it, and old shells over empty lists.

cd "${PBS_O_WORKDIR:?submit it: qsub -v jobs=JOB jobs/pbs.sh}" || exit
script=${script:-jobs/pbs.sh}                 # this file, and the program: from the folder of qsub, or full paths
program=${TREBSWEEP:-build/release/trebsweep}
margin=180                                    # s, to stop ahead of the limit; a round of the sweep takes seconds
most_restarts=100                             # more: something is wrong
launch=(mpirun -machinefile "$PBS_NODEFILE" -n "$(wc -l <"$PBS_NODEFILE")" --bind-to core)
# module load gcc openmpi hdf5                # what the program was built with
# export HDF5_USE_FILE_LOCKING=FALSE          # where opening a file hangs, or fails for want of a lock

refuse() {
  echo "jobs/pbs.sh: $*" >&2
  exit 2
}

# PBS runs a job again whose node has failed: that goes on with what is there.
runs=$(qstat -f "$PBS_JOBID" | sed -n 's/^ *run_count = //p')
[[ ${runs:-1} -le 1 ]] || options=${options//--overwrite/}
read -ra files <<<"${jobs:-}"
read -ra arguments <<<"${options:-}"
restart=${restart:-0}
[[ ${#files[@]} -gt 0 ]] || refuse "no job file; qsub -v jobs=JOB jobs/pbs.sh"
[[ ${#files[@]} -eq 1 || -n ${PBS_ARRAY_INDEX:-} ]] ||
  refuse "${#files[@]} job files need an array: qsub -J 1-${#files[@]} ..."
number=${PBS_ARRAY_INDEX:-1}
[[ $number -ge 1 && $number -le ${#files[@]} ]] ||
  refuse "-J: there is no job file number $number, only 1 to ${#files[@]}"
job=${files[number - 1]}
command -v "$program" >/dev/null || refuse "$program: no such program; build it, or set TREBSWEEP"

# The limit of this job, h:m:s; PBS has no signal ahead of it.
walltime=$(qstat -f "$PBS_JOBID" | sed -n 's/^ *Resource_List.walltime = //p')
if [[ $walltime =~ ^([0-9]+):([0-9]+):([0-9]+)$ ]]; then
  seconds=$((10#${BASH_REMATCH[1]} * 3600 + 10#${BASH_REMATCH[2]} * 60 + 10#${BASH_REMATCH[3]} - margin))
  [[ $seconds -gt 0 ]] || refuse "walltime = $walltime: must be longer than $margin s"
  arguments=(--time-limit "$seconds" "${arguments[@]}")
fi

# TERM is qdel's, or the limit's: the launcher hands USR1 to the ranks, which then finish their round.
sweep='' cancelled=no
trap 'cancelled=yes; kill -USR1 $sweep' TERM
"${launch[@]}" "$program" sweep "$job" "${arguments[@]}" &
sweep=$!
while kill -0 $sweep 2>/dev/null; do wait $sweep; done # a trap ends a wait
wait $sweep
code=$?

if [[ $code -eq 75 && $cancelled == no ]]; then
  if [[ $restart -ge $most_restarts ]]; then
    echo "jobs/pbs.sh: not complete after $most_restarts restarts; submit it again to go on" >&2
  else
    echo "jobs/pbs.sh: submits itself again" >&2
    options=${options:-}
    export jobs=$job restart=$((restart + 1)) options=${options//--overwrite/} script TREBSWEEP=$program
    qsub -v jobs,options,restart,script,TREBSWEEP "$script" ||
      echo "jobs/pbs.sh: not submitted; submit it again to go on" >&2
  fi
fi
exit $code
